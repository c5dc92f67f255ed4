"""From which side the hand comes: what is asked for, what is enough, and what is said of it; the table is z = 0."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from flatgrasp_cli import Plan, load_gripper, load_robot, load_settings, plan
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Cloud, Sensor, Source
from flatgrasp_cli.planning import objects
from flatgrasp_cli.profiles import Robot
from flatgrasp_cli.results.document import to_document
from flatgrasp_cli.results.remedies import remedy_of
from flatgrasp_cli.surroundings import Direction
from tests.conftest import TABLE, Box, Camera, Solid, Tube
from tests.scene.test_heaps import distance
from tests.surroundings.on_a_table import KINECT, hand_in

CAMERA = Camera(tilt_deg=45, distance=0.9, target=(0.0, 0.0, 0.1), pixels=(400, 300), focal=400.0)
TOWER = tuple(Tube((0.0, 0.0, 0.1 * k + 0.05), 0.033, 0.1) for k in range(3))
LYING_CAN = Tube((0.0, 0.0, 0.033), 0.033, 0.12, (1.0, 0.0, 0.0))


def planned(*solids: Solid, camera: Camera = CAMERA, robot: Robot | None = None, **asked: Any) -> Plan:
    overrides = tuple(f"approach.{key}={value}" for key, value in asked.items())
    return plan(camera.sees(TABLE, *solids), load_gripper("pr2"), load_settings("default", overrides), robot=robot)


class Tried(NamedTuple):
    direction: Direction
    most_m3: float


@pytest.fixture
def tried_ways(monkeypatch: pytest.MonkeyPatch) -> list[Tried]:
    """The directions that the search plans from, in their order, and the most that the object's volume can be."""
    found, from_one = [], objects._from

    def spied(search: Any, tilted: Any, direction: Direction, most_m3: float) -> Any:
        found.append(Tried(direction, most_m3))
        return from_one(search, tilted, direction, most_m3)

    monkeypatch.setattr(objects, "_from", spied)
    return found


def free_m(found: Plan, *solids: Solid) -> float:
    """How much room the hands of all grasps of the first object have at least, at the grasp and on the way there."""
    hands = [hand_in(g, found.gripper, back_m=back) for g in found.objects[0].grasps for back in (0, 0.03, 0.06, 0.1)]
    return min(min(float(distance(solid, hand).min()) for solid in solids) for hand in hands)


class TestTower:
    def test_of_three_cans_is_had_from_the_side_that_is_asked_for(self) -> None:
        found = planned(*TOWER, directions="[0, 1, 0]")
        assert found.best is not None, found.reason
        assert found.best.approach.known_from == "given"
        assert found.best.tilt_deg == pytest.approx(90, abs=0.5)
        assert found.best.width_m == pytest.approx(0.066, abs=0.004)
        assert free_m(found, *TOWER, TABLE) > 0

    def test_goes_back_before_it_is_lifted(self) -> None:
        grasp = planned(*TOWER, directions="[0, 1, 0]").best
        assert grasp is not None
        assert grasp.pre_grasp.position - grasp.position == pytest.approx([0, -0.1, 0], abs=1e-3)
        assert grasp.lift.position - grasp.position == pytest.approx([0, -0.1, 0.1], abs=1e-3)


class TestEnough:
    @pytest.mark.parametrize(("enough", "aslant"), [(0.01, False), (0.999, True)])
    def test_other_directions_are_tried_where_straight_down_is_not_enough(self, enough: float, aslant: bool) -> None:
        found = planned(LYING_CAN, camera=KINECT, enough=enough, around=4)
        down = planned(LYING_CAN, camera=KINECT, directions="top")
        for each in (found, down):
            assert each.best is not None
            assert each.best.success is not None
        assert (found.best.tilt_deg > 1) == aslant  # type: ignore[union-attr]
        assert found.best.success.probability >= down.best.success.probability  # type: ignore[union-attr]
        assert (found.objects[0].why_not_top is not None) == aslant

    def test_any_is_at_least_as_good_as_what_is_enough(self) -> None:
        enough, best = (planned(LYING_CAN, camera=KINECT, directions=way, around=4).best for way in ("auto", "any"))
        assert enough is not None
        assert best is not None
        assert best.success.probability >= enough.success.probability - 0.01  # type: ignore[union-attr]


class TestNotAllowed:
    """From where no hand comes, whatever is asked for: the table is a flat one, the camera looks 45° down."""

    @pytest.mark.parametrize(
        ("asked", "cause", "remedy"),
        [
            ({"directions": "[0, -0.6, 0.8]"}, "below", "--approach=0,0.6,-0.8 is the opposite one"),
            ({"directions": "[0, 0, 1]"}, "below", "--approach=0,0,-1 is the opposite one"),
            ({"directions": "[0, 1, -1]", "max_tilt_deg": "30"}, "tilt", "--max-tilt 45 allows it"),
            ({"directions": "view", "max_tilt_deg": "30"}, "tilt", "allows it, or --approach auto"),
        ],
    )
    def test_it_is_said_and_what_would_do(self, asked: dict[str, Any], cause: str, remedy: str) -> None:
        found = planned(LYING_CAN, **asked)
        (item,) = found.objects
        assert item.rejection is not None
        assert (item.grasps, item.rejection.stage, item.rejection.cause) == ((), "approach", cause)
        assert remedy in str(remedy_of(found, item))

    def test_along_a_view_that_nobody_knows(self) -> None:
        cloud = replace(CAMERA.sees(TABLE, LYING_CAN), viewpoint=None)
        settings = load_settings("default", ("approach.directions=view",))
        found = plan(replace(cloud, sensor=Sensor("all_sides")), load_gripper("pr2"), settings)
        assert "where the sensor was is not known" in str(found.reason)
        assert "--sensor X,Y,Z" in str(remedy_of(found, found.objects[0]))

    @pytest.mark.parametrize("up", [-0.05, 0.05])
    def test_along_the_table_is_meant_where_it_is_nearly_so(self, up: float) -> None:
        """3° from above or from below: no palm is lower than at the grasp, and the document says what was planned."""
        best = planned(*TOWER, directions=f"[0, 1, {up}]").best
        assert best is not None
        assert best.tilt_deg == pytest.approx(min(90.0, 90 + np.degrees(np.arctan(up))), abs=0.1)
        assert best.approach.direction[1] > 0.99


@pytest.mark.parametrize(("friction", "doubtful"), [(0.5, False), (0.03, True)])
def test_a_best_grasp_that_is_not_enough_comes_with_a_warning(friction: float, doubtful: bool) -> None:
    """On pads as slippery as ice the can is more likely lost than held."""
    settings = load_settings("default", (f"balance.friction={friction}", "approach.directions=top"))
    found = plan(KINECT.sees(TABLE, LYING_CAN), load_gripper("pr2"), settings)
    assert found.best is not None
    assert found.best.success is not None
    assert (found.best.success.probability < settings.approach.enough) == doubtful
    said = {warning.code: warning.text for warning in found.warnings}
    assert ("doubtful_grasp" in said) == doubtful
    assert not doubtful or "the only side that was asked for (--approach any" in said["doubtful_grasp"]


@pytest.mark.parametrize("prefer", ["gravity_distance", "cage"])
def test_the_warning_does_not_depend_on_what_decides_which_grasp_is_best(prefer: str) -> None:
    settings = load_settings(
        "default", ("balance.friction=0.03", "approach.directions=top", f"ranking.prefer={prefer}")
    )
    found = plan(KINECT.sees(TABLE, LYING_CAN), load_gripper("pr2"), settings)
    said = {warning.code: warning.text for warning in found.warnings}
    assert f"for {prefer} decides which is best (--prefer success" in said["doubtful_grasp"]


def test_a_direction_that_the_arm_cannot_serve_falls_out() -> None:
    """At the robot's own base no hand comes straight down; from aslant it gets there."""
    at_base, near = Box((0.02, 0.0, 0.02), (0.1, 0.04, 0.04)), Camera(target=(0.02, 0.0, 0.0))
    found = planned(at_base, camera=near, robot=load_robot("ur5"))
    assert found.best is not None, found.reason
    assert found.best.tilt_deg > 1
    assert found.objects[0].why_not_top == "the robot reaches none of the grasps from straight above"


@pytest.mark.parametrize(("x_m", "tried"), [(1.15, True), (1.6, False)])
def test_directions_from_which_the_arm_is_too_short_are_not_tried(
    x_m: float, tried: bool, tried_ways: list[Tried]
) -> None:
    """From straight above an UR5 reaches neither thing; from its own side it might reach the nearer one."""
    thing, camera = Box((x_m, 0.0, 0.02), (0.1, 0.04, 0.04)), Camera(target=(x_m, 0.0, 0.0))
    table = Box((x_m, 0.0, -0.01), (0.9, 0.7, 0.02))
    asked = ("approach.tilts_deg=[60]", "approach.around=4")
    found = plan(
        camera.sees(table, thing), load_gripper("pr2"), load_settings("default", asked), robot=load_robot("ur5")
    )
    assert str(found.reason).startswith("ur5 reaches none of the ")
    assert bool(tried_ways) == tried
    assert all(each.direction.toward[0] < 0.1 for each in tried_ways)  # never from beyond it


def test_the_document_says_which_way_the_hand_comes_and_why_not_straight_down() -> None:
    board, below = Box((0.0, 0.14, 0.26), (0.7, 0.28, 0.02)), Box((0.05, 0.12, 0.05), (0.05, 0.05, 0.1))
    shelf = Camera(tilt_deg=60, distance=0.9, target=(0.0, 0.05, 0.1), pixels=(400, 300), focal=400.0)
    objects = to_document(planned(board, below, camera=shelf))["objects"]
    (item,) = (each for each in objects if each["grasps"])
    grasp = item["grasps"][0]
    approach = axes_from_quaternion(np.array(grasp["pose"]["orientation"]))[2]
    assert grasp["approach"]["direction"] == pytest.approx(approach.tolist(), abs=1e-6)
    assert grasp["approach"]["tilt_deg"] == pytest.approx(np.degrees(np.arccos(-approach[2])), abs=1)
    assert grasp["approach"]["known_from"] in {"main_plane", "view"}
    assert "too high to grip" in item["why_not_top"]


TOO_LARGE = Box((0.0, 0.2, 0.1), (0.3, 0.15, 0.2))


@pytest.mark.parametrize(("things", "between"), [([TOO_LARGE], True), ([TOO_LARGE, LYING_CAN], False)])
def test_where_nothing_has_a_grasp_the_sides_between_those_are_tried(
    things: list[Solid], between: bool, tried_ways: list[Tried]
) -> None:
    """Of six sides at one tilt the first is along the thing's longer side; between are 30°, 90° and so on."""
    found = planned(*things, tilts_deg="[40]", around=6)
    assert (found.best is None) == between
    ways = [each.direction for each in tried_ways]
    x, y, z = np.array([each.toward for each in ways if each.known_from == "tilt"]).T
    turn = np.degrees(np.arctan2(y, x)) % 360
    aside = (np.abs(turn % 60 - 30) < 3) & (np.abs(z - np.cos(np.radians(40))) < 0.01)
    assert (len(np.unique(np.round(turn[aside], -1))) == 6) == between  # two of them lie beside the nearest miss


def test_without_a_grasp_the_nearest_miss_of_all_directions_is_named() -> None:
    found = planned(Box((0.0, 0.0, 0.1), (0.3, 0.15, 0.2)), tilts_deg="[60, 90]", around=2)
    assert found.best is None
    straight, aslant = str(found.reason).split("; ", 1)
    assert "narrowest graspable width" in straight
    assert "° aslant, " in aslant


def test_from_a_direction_that_is_stated_a_thing_is_no_heavier_than_where_all_are_tried(
    tried_ways: list[Tried],
) -> None:
    """From aslant it has more below what was seen than from straight above, where it is all there."""
    planned(LYING_CAN, directions="any", tilts_deg="[60]", around=1)
    among_all = {each.most_m3 for each in tried_ways}
    tried_ways.clear()
    planned(LYING_CAN, directions="[0.0, -0.87, -0.5]")
    known = {each.most_m3 for each in tried_ways}
    assert known == among_all
    assert max(known) < 0.066 * 0.12 * 0.066


class TestAnObjectAlone:
    """A block 12 cm high, of which a sensor saw the top and a side: its main plane is upright."""

    SIZE = np.array([0.04, 0.07, 0.12])

    def planned(self, **settings: Any) -> Plan:
        a, b = np.meshgrid(np.linspace(-0.5, 0.5, 30), np.linspace(-0.5, 0.5, 30))
        half = np.full(a.size, 0.5)
        top = np.column_stack([a.ravel(), b.ravel(), half])
        side = np.column_stack([half, a.ravel(), b.ravel()])
        cloud = Cloud(np.concatenate([top, side]) * self.SIZE, np.array([1.0, 0.0, 1.0]), Source("alone"))
        overrides = tuple(f"{key.replace('__', '.')}={value}" for key, value in settings.items())
        return plan(cloud, load_gripper("wsg_50"), load_settings("default", ("scene.mode=object", *overrides)))

    def test_straight_down_is_against_the_way_up(self) -> None:
        best = self.planned(approach__directions="top", scene__up="[0, 0, 2]").best
        assert best is not None
        assert best.approach.direction == pytest.approx([0, 0, -1], abs=1e-9)
        assert best.approach.known_from == "top"

    def test_a_direction_that_is_given_is_said_to_be(self) -> None:
        best = self.planned(approach__directions="[0, 0, -1]").best
        assert best is not None
        assert best.approach.known_from == "given"

    @pytest.mark.parametrize(
        ("asked", "told"),
        [
            ({}, ()),
            ({"approach__directions": "top"}, ("--approach top",)),
            ({"approach__directions": "any", "approach__max_tilt_deg": 10}, ("--approach any", "--max-tilt 10")),
            ({"approach__max_tilt_deg": 10, "scene__up": "[0, 0, 1]"}, ("--max-tilt 10",)),
            ({"approach__directions": "top", "scene__up": "[0, 0, 1]"}, ()),
            ({"approach__directions": "view"}, ()),
        ],
    )
    def test_what_says_nothing_of_it_is_told(self, asked: dict[str, Any], told: tuple[str, ...]) -> None:
        warned = [warning.text for warning in self.planned(**asked).warnings if warning.code == "approach_ignored"]
        assert len(warned) == bool(told)
        assert all(option in text for text in warned for option in told)
