"""From a cloud to a plan: objects in order, poses in the base frame, and the document's words for them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli import (
    Plan,
    funnel,
    in_base_frame,
    load_gripper,
    load_robot,
    load_settings,
    plan,
    read_clouds,
    to_document,
)
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion, quaternion_from_axes
from flatgrasp_cli.model import Cloud, Grasp, Source
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.profiles.robot import CameraPose
from flatgrasp_cli.results.contracts import json_schema
from flatgrasp_cli.results.document import to_json
from flatgrasp_cli.results.remedies import remedy_of
from flatgrasp_cli.results.table import ROWS, grasp_table, headline, refusals
from flatgrasp_cli.robot import forward
from flatgrasp_cli.robot.reach import LIMITS
from tests.conftest import EACH, MM, SAMPLES, TABLE, Box, Camera, cloud_of, holds, rectangle, sampled
from tests.robot.arms import rows

BESIDE = Box((0.45, 0.0, -0.01), (0.9, 0.7, 0.02))
"""A table in front of a robot whose base stands on its height."""
BLOCK = Box((0.45, -0.1, 0.02), (0.10, 0.04, 0.04), 30)
SMALL, WIDE = Box((0.40, -0.15, 0.02), (0.10, 0.04, 0.04)), Box((0.50, 0.02, 0.03), (0.16, 0.14, 0.06))
CAMERA = Camera(tilt_deg=20, target=(0.45, -0.1, 0.0))
DEPTH = load_settings().depth


def in_camera(camera: Camera, cloud: Cloud) -> Cloud:
    """The cloud as the camera gives it, in its own optical frame."""
    return replace(cloud, points=camera.frame.to_local(cloud.points), viewpoint=np.zeros(3), frame_id="camera")


def pose_of(camera: Camera) -> CameraPose:
    frame = camera.frame
    x, y, z = frame.origin.tolist()
    qx, qy, qz, qw = quaternion_from_axes(frame.axes).tolist()
    return CameraPose(position_m=(x, y, z), orientation_xyzw=(qx, qy, qz, qw))


def best(result: Plan) -> Grasp:
    assert result.best is not None, result.reason
    return result.best


def numbers_in(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [number for item in value.values() for number in numbers_in(item)]
    if isinstance(value, list):
        return [number for item in value for number in numbers_in(item)]
    return [value] if isinstance(value, float) else []


def checked(result: Plan) -> dict[str, Any]:
    """The plan's document, valid and finite, after a journey through text."""
    document: dict[str, Any] = json.loads(to_json(to_document(result)))
    Draft202012Validator(json_schema()).validate(document)
    assert np.isfinite(numbers_in(document)).all()
    return document


def flange_z(robot: Robot, joints: FloatArray) -> tuple[FloatArray, FloatArray]:
    pose = forward(rows(robot), joints)[5]
    return pose[:3, 3], pose[:3, :3].T


@pytest.fixture(scope="module")
def seen() -> Cloud:
    return CAMERA.sees(BESIDE, BLOCK)


@pytest.fixture(scope="module")
def of_two(pr2: Gripper) -> Plan:
    """Of something that the hand holds, and something that is too wide for it."""
    return plan(CAMERA.sees(BESIDE, SMALL, WIDE), pr2)


@pytest.fixture(scope="module")
def ur5() -> Robot:
    return load_robot("ur5")


@pytest.fixture(scope="module")
def reached(seen: Cloud, ur5: Robot, pr2: Gripper) -> Plan:
    return plan(seen, pr2, robot=ur5, top=5)


class TestPlan:
    def test_objects_come_by_their_best_grasp_and_those_without_last(self, of_two: Plan) -> None:
        small, wide = of_two.objects
        assert (len(wide.object.points) > len(small.object.points), wide.object.id) == (True, 0)
        assert small.grasps
        assert wide.grasps == ()
        assert of_two.best is small.grasps[0]
        assert of_two.reason is None

    def test_what_most_probably_holds_orders_the_objects(self, pr2: Gripper) -> None:
        result = plan(
            Camera().sees(TABLE, Box((-0.1, 0, 0.02), (0.1, 0.04, 0.04)), Box((0.1, 0, 0.02), (0.1, 0.07, 0.04))), pr2
        )
        chances = [holds(item.grasps[0]) for item in result.objects]
        assert chances == sorted(chances, reverse=True)
        assert result.objects[0].grasps[0].position[0] < 0

    def test_without_any_grasp_it_says_why(self, pr2: Gripper) -> None:
        result = plan(CAMERA.sees(BESIDE, WIDE), pr2, load_settings("default", ("approach.around=2",)))
        assert result.best is None
        assert result.reason is not None
        assert "narrowest graspable width" in result.reason

    def test_an_empty_table_says_that_nothing_stands_on_it(self, pr2: Gripper) -> None:
        result = plan(CAMERA.sees(BESIDE), pr2, load_settings("default", ("scene.mode=table",)))
        assert (result.objects, result.reason) == ((), "nothing stands on the support plane")
        document = checked(result)
        assert (document["status"], document["reason"], document["objects"]) == ("no_grasp", result.reason, [])

    def test_the_same_cloud_gives_the_same_bytes(self, of_two: Plan, pr2: Gripper) -> None:
        texts = []
        for result in (of_two, plan(of_two.cloud, pr2)):
            document = to_document(result)
            document.pop("timing_ms")
            texts.append(to_json(document))
        assert texts[0] == texts[1]


class TestBaseFrame:
    def test_a_point_is_moved_as_the_pose_says(self) -> None:
        """A quarter turn about z takes x to y, and then everything goes up by 2."""
        half = np.sqrt(0.5)
        pose = CameraPose(position_m=(0, 0, 2), orientation_xyzw=(0, 0, half, half))
        moved = in_base_frame(
            replace(CAMERA.sees(BLOCK), points=np.array([[1.0, 0, 0]]), viewpoint=np.zeros(3)), pose, "base"
        )
        assert moved.points == pytest.approx(np.array([[0.0, 1, 2]]))
        assert moved.viewpoint == pytest.approx([0, 0, 2])
        assert moved.frame_id == "base"

    def test_a_plan_in_the_base_frame_is_the_cameras_plan_moved(self, seen: Cloud, pr2: Gripper) -> None:
        cloud, frame = in_camera(CAMERA, seen), CAMERA.frame
        own, base = best(plan(cloud, pr2)), best(plan(in_base_frame(cloud, pose_of(CAMERA), "base"), pr2))
        assert base.position == pytest.approx(frame.to_world(own.position), abs=1.5 * MM)
        before, after = (axes_from_quaternion(grasp.orientation) for grasp in (own, base))
        assert (before[2] @ frame.axes) @ after[2] > np.cos(np.radians(1.5))
        assert abs((before[1] @ frame.axes) @ after[1]) > np.cos(np.radians(1.5))
        assert base.opening_m == pytest.approx(own.opening_m, abs=1.5 * MM)

    def test_it_stands_on_the_table_of_the_base_frame(self, seen: Cloud, pr2: Gripper) -> None:
        grasp = best(plan(in_base_frame(in_camera(CAMERA, seen), pose_of(CAMERA), "base"), pr2))
        assert grasp.position == pytest.approx([0.45, -0.1, DEPTH.table_clearance_m], abs=5 * MM)


class TestReach:
    def test_the_joints_put_the_fingertips_at_the_pose(self, reached: Plan, ur5: Robot, pr2: Gripper) -> None:
        grasps = reached.objects[0].grasps
        assert len(grasps) > 1
        for grasp in grasps:
            assert grasp.reach is not None
            assert grasp.reach.ok
            assert grasp.reach.joints_rad is not None
            before, at, after = grasp.reach.joints_rad
            axes = axes_from_quaternion(grasp.orientation)
            tool = pr2.palm_offset_m + pr2.finger_length_at_m(grasp.width_m)
            origin, turned = flange_z(ur5, at)
            assert origin + tool * turned[2] == pytest.approx(grasp.position, abs=1e-6)
            assert turned[2] == pytest.approx(axes[2], abs=1e-6)
            assert turned[1] == pytest.approx((-1 if grasp.reach.twin else 1) * axes[1], abs=1e-6)
            assert flange_z(ur5, before)[0] == pytest.approx(origin - DEPTH.approach_m * axes[2], abs=1e-6)
            assert reached.scene.support is not None
            lifted = origin + DEPTH.lift_m * reached.scene.support.normal
            assert flange_z(ur5, after)[0] == pytest.approx(lifted, abs=1e-6)

    def test_a_palm_offset_brings_the_flange_back(self, seen: Cloud, ur5: Robot, pr2: Gripper) -> None:
        hand = pr2.model_copy(update={"palm_offset_m": 0.07})
        grasp = best(plan(seen, hand, robot=ur5, top=1))
        assert grasp.reach is not None
        assert grasp.reach.joints_rad is not None
        tool = 0.07 + hand.finger_length_at_m(grasp.width_m)
        origin, axes = flange_z(ur5, grasp.reach.joints_rad[1])
        assert origin + tool * axes[2] == pytest.approx(grasp.position, abs=1e-6)

    def test_reach_only_removes_grasps_and_numbers_the_rest_anew(
        self, reached: Plan, seen: Cloud, pr2: Gripper
    ) -> None:
        item, free = reached.objects[0], plan(seen, pr2, load_settings("default", EACH), top=500).objects[0]
        assert [grasp.rank for grasp in item.grasps] == list(range(1, len(item.grasps) + 1))
        assert {grasp.fingers for grasp in item.grasps} <= {grasp.fingers for grasp in free.grasps}
        assert item.funnel[-1].stage == "reach"
        assert item.funnel[:-1] == free.funnel

    def test_base_and_base_link_give_the_same_joints(
        self, reached: Plan, seen: Cloud, ur5: Robot, pr2: Gripper
    ) -> None:
        """ROS's base_link is turned by 180° about z against the controller's base, and so is what is seen in it."""
        turned = np.array([-1.0, -1.0, 1.0])
        cloud = replace(seen, points=seen.points * turned, viewpoint=seen.viewpoint * turned)
        linked = plan(cloud, pr2, robot=ur5.model_copy(update={"base_frame": "base_link"}), top=5)
        one, other = best(reached).reach, best(linked).reach
        assert one is not None
        assert other is not None
        assert best(linked).position == pytest.approx(best(reached).position * turned, abs=1.5 * MM)
        assert one.joints_rad is not None
        assert other.joints_rad is not None
        near = np.abs(np.sin(0.5 * (one.joints_rad - other.joints_rad)))
        near[:, 5] = np.abs(np.sin(one.joints_rad - other.joints_rad))[:, 5]  # the twin will do as well
        assert near.max() < np.radians(1.5)

    def test_what_is_out_of_reach_is_refused_with_the_limit(self, ur5: Robot, pr2: Gripper) -> None:
        far = Camera(target=(1.6, 0.0, 0.0))
        result = plan(
            far.sees(Box((1.6, 0, -0.01), (0.9, 0.7, 0.02)), Box((1.6, 0, 0.02), (0.1, 0.04, 0.04))),
            pr2,
            robot=ur5,
            top=3,
        )
        item = result.objects[0]
        assert (result.best, item.grasps) == (None, ())
        assert len(item.refused) == 3
        for grasp in item.refused:
            assert grasp.reach is not None
            assert (grasp.reach.ok, grasp.reach.limit, grasp.reach.joints_rad) == (False, "out of reach", None)
        assert result.reason is not None
        assert result.reason.startswith("ur5 reaches none of the ")
        assert "out of reach at the pre-grasp" in result.reason

    def test_a_grasp_at_the_base_itself_fails_another_limit(self, ur5: Robot, pr2: Gripper) -> None:
        near = Camera(target=(0.02, 0.0, 0.0))
        down = load_settings("default", ("approach.directions=top",))
        result = plan(near.sees(TABLE, Box((0.02, 0.0, 0.02), (0.1, 0.04, 0.04))), pr2, down, robot=ur5, top=3)
        assert result.best is None
        assert {grasp.reach.limit for grasp in result.objects[0].refused if grasp.reach} <= set(LIMITS)


class TestTable:
    """A camera pose that is wrong tilts the table in the robot's base frame."""

    @staticmethod
    def codes(cloud: Cloud, tilt_deg: float, robot: Robot | None, pr2: Gripper) -> list[str]:
        half = np.radians(tilt_deg) / 2
        pose = CameraPose(position_m=(0, 0, 0), orientation_xyzw=(np.sin(half), 0, 0, np.cos(half)))
        tilted = in_base_frame(cloud, pose, "base")
        return [warning.code for warning in plan(tilted, pr2, robot=robot, top=1).warnings]

    @pytest.mark.parametrize(
        ("tilt_deg", "codes"),
        [(0, []), (25, []), (-25, []), (35, ["table_tilted"]), (-40, ["table_tilted"]), (180, ["table_tilted"])],
    )
    def test_more_than_a_table_can_be_tilted_is_told(
        self, tilt_deg: float, codes: list[str], seen: Cloud, ur5: Robot, pr2: Gripper
    ) -> None:
        assert self.codes(seen, tilt_deg, ur5, pr2) == codes

    def test_without_a_robot_any_frame_will_do(self, seen: Cloud, pr2: Gripper) -> None:
        assert self.codes(seen, 40, None, pr2) == []

    def test_an_object_alone_has_no_table(self, ur5: Robot, pr2: Gripper) -> None:
        assert self.codes(CAMERA.sees(BLOCK), 40, ur5, pr2) == []


class TestDocument:
    def test_it_tells_the_table_the_heights_and_the_way(self, reached: Plan, pr2: Gripper) -> None:
        document = checked(reached)
        assert document["support_plane"]["normal"] == pytest.approx([0, 0, 1], abs=0.005)
        assert document["support_plane"]["offset_m"] == pytest.approx(0, abs=1 * MM)
        assert document["robot"]["name"] == "ur5"
        item = document["objects"][0]
        assert item["silhouette"]["level_m"] == pytest.approx(DEPTH.table_clearance_m)
        assert {stage["stage"] for stage in item["funnel"]} >= {"depth", "reach"}
        for part, grasp in zip(item["grasps"], reached.objects[0].grasps, strict=True):
            approach = axes_from_quaternion(grasp.orientation)[2]
            position = np.array(part["pose"]["position"])
            assert position == pytest.approx(grasp.position, abs=1e-8)
            before, lifted = (np.array(part[key]["position"]) for key in ("pre_grasp", "lift"))
            assert before == pytest.approx(position - DEPTH.approach_m * approach, abs=1e-7)
            assert lifted - position == pytest.approx([0, 0, DEPTH.lift_m], abs=1 * MM)
            assert part["pre_grasp"]["orientation"] == part["lift"]["orientation"] == part["pose"]["orientation"]
            shift = pr2.tip_advance_m * (part["opening_m"] - part["width_m"]) / pr2.max_opening_m
            assert part["tip_shift_m"] == pytest.approx(shift, abs=1e-7)
            assert part["metrics"]["tip_height_m"] == pytest.approx(position[2], abs=1 * MM)
            assert part["metrics"]["grip_m"] > DEPTH.min_grip_m
            assert part["metrics"]["unseen_m"] >= 0
            assert part["cage"] is not None
            assert part["reach"]["ok"] is True
            assert set(part["reach"]["joints_rad"]) == {"pre_grasp", "grasp", "lift"}
            assert (part["reach"]["waypoint"], part["reach"]["limit"]) == (None, None)
            assert 0 < part["reach"]["manipulability_share"] <= 1

    def test_an_object_alone_has_null_heights(self, pr2: Gripper) -> None:
        document = checked(plan(Camera().sees(Box((0.0, 0.0, 0.0), (0.1, 0.04, 0.04))), pr2))
        assert document["support_plane"] is None
        assert document["robot"] is None
        item = document["objects"][0]
        assert item["silhouette"]["level_m"] is None
        grasp = item["grasps"][0]
        assert [grasp["metrics"][key] for key in ("tip_height_m", "grip_m", "unseen_m")] == [None] * 3
        assert grasp["reach"] is None
        lift = np.array(grasp["lift"]["position"]) - grasp["pose"]["position"]
        assert lift == pytest.approx([0, 0, DEPTH.lift_m], abs=2 * MM)

    def test_a_wide_object_says_by_how_much(self, of_two: Plan) -> None:
        document = checked(of_two)
        assert document["status"] == "ok"
        wide = document["objects"][1]
        assert (wide["status"], wide["grasps"], wide["refused"]) == ("no_grasp", [], [])
        miss = wide["nearest_miss"]
        assert miss["value"] > miss["limit"]
        assert f"{miss['value']:.3f} m" in wide["reason"]


def test_the_table_lists_every_object_and_why_it_has_no_grasp(of_two: Plan) -> None:
    rejected = next(item for item in of_two.objects if item.rejection)
    assert headline(of_two).splitlines() == ["test · pr2: two fingers on an arc", "2 objects on a support plane"]
    assert grasp_table(of_two).row_count == len(of_two.objects[0].grasps[:ROWS])
    assert rejected.rejection is not None
    said, remedy = refusals(of_two).splitlines()
    assert said == f"object {rejected.object.id}: no grasp: {rejected.rejection.reason}"
    assert remedy == f"  remedy: {remedy_of(of_two, rejected)}"


class Nothing:
    """Diagnostics that forget whatever they are told."""

    def __setattr__(self, name: str, value: object) -> None:
        pass

    @property
    def survivors(self) -> dict[str, object]:
        return {}


@pytest.mark.parametrize("options", [(), ("ranking.prefer=cage",), ("method=allen",)])
def test_no_grasp_depends_on_the_diagnostics(
    options: tuple[str, ...], pr2: Gripper, monkeypatch: pytest.MonkeyPatch
) -> None:
    (scene,) = read_clouds(SAMPLES / "pan_on_table.pcd")
    settings = load_settings("default", options)
    with_trace = plan(scene, pr2, settings).objects[0]
    monkeypatch.setattr(funnel, "Trace", Nothing)
    without = plan(scene, pr2, settings).objects[0]
    assert len(with_trace.grasps) > 0
    assert with_trace.funnel == without.funnel
    assert repr(with_trace.grasps) == repr(without.grasps)


def test_strays_of_an_object_alone_are_no_points_of_it(pr2: Gripper) -> None:
    """A second, smaller plate 10 cm aside: neither planned nor counted."""
    plate, speck = sampled(rectangle(120, 40)), sampled(rectangle(12, 4)) + np.array([0.0, 0.1, 0.0])
    (item,) = plan(
        cloud_of(np.concatenate([plate, speck])), pr2, load_settings("default", ("scene.mode=object",))
    ).objects
    assert len(item.object.points) == len(plate)


def test_fewer_grasps_are_the_first_of_more() -> None:
    """What the last steps find out of a grasp, as that it is in a cage, changes the order of those beside it alone."""
    (cloud,) = read_clouds(str(SAMPLES / "table_scene.pcd"))
    hand = load_gripper("pr2")
    all_of_them = [item.grasps for item in plan(cloud, hand, top=20).objects]
    for top in (1, 3, 10, 13):
        for item, more in zip(plan(cloud, hand, top=top).objects, all_of_them, strict=True):
            assert [grasp.fingers for grasp in item.grasps] == [grasp.fingers for grasp in more[:top]]


def two_tops(gap_m: float) -> Cloud:
    """Two boxes' tops side by side, 12 × 5 cm each, of a cloud without the table they stand on."""
    x, y = np.meshgrid(np.arange(-0.12, 0.12, 0.002) + 0.001, np.arange(-0.025, 0.025, 0.002))
    x = x + 0.5 * gap_m * np.sign(x)
    return Cloud(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.7)]), np.zeros(3), Source("tops"))


@pytest.mark.parametrize("gap_m", [0.03, 0.06, 0.4])
def test_no_hand_closes_on_the_air_between_things(gap_m: float, pr2: Gripper) -> None:
    found = plan(two_tops(gap_m), pr2)
    assert found.best is None
    (item,) = found.objects
    assert item.rejection is not None
    assert (item.rejection.stage, item.rejection.value) == ("silhouette", 0.5)
    remedy = remedy_of(found, item)
    assert remedy is not None
    least = re.search(r"--set (silhouette.min_coverage=\S+)", remedy)
    assert least is not None
    (one,) = plan(two_tops(gap_m), pr2, load_settings("default", (least[1],))).objects
    assert one.grasps
    assert abs(one.grasps[0].position[0]) == pytest.approx(0.5 * gap_m + 0.06, abs=30 * MM)


@pytest.mark.parametrize("lines_m", [0.015, 0.02, 0.025, 0.03, 0.04])
def test_lines_of_a_scanner_are_no_pieces(lines_m: float, pr2: Gripper) -> None:
    """Points lie 2 mm apart along each, and the six nearest of a point are all of its own line."""
    x, y = np.meshgrid(np.arange(-0.08, 0.081, lines_m), np.arange(-0.03, 0.03, 0.002))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.7)])
    assert plan(Cloud(points, np.zeros(3), Source("lines")), pr2).best is not None


@pytest.mark.parametrize(("gap_m", "told"), [(0.0, False), (0.012, True)])
def test_gaps_that_an_outline_bridges_are_told(gap_m: float, told: bool, pr2: Gripper) -> None:
    found = plan(two_tops(gap_m), pr2)
    assert found.best is not None
    assert any(warning.code == "gaps_bridged" for warning in found.warnings) == told


@pytest.mark.parametrize(("apart_m", "told"), [(0.004, False), (0.012, True)])
@pytest.mark.parametrize("alone", [True, False])
def test_points_that_lie_far_apart_are_told(apart_m: float, alone: bool, told: bool) -> None:
    """On a table, or alone: the least that has an answer is warned of, and what is usual is not."""
    x, y = np.meshgrid(np.arange(-0.3, 0.3, apart_m), np.arange(-0.3, 0.3, apart_m))
    on = (np.abs(x) < 0.08) & (np.abs(y) < 0.03)
    points = np.column_stack([x.ravel(), y.ravel(), np.where(on, 0.05, 0.0).ravel()])
    cloud = Cloud(points[on.ravel()] if alone else points, np.array([0.0, 0.0, 1.0]), Source("sparse"))
    found = plan(cloud, load_gripper("pr2"))
    assert found.best is not None, found.reason
    assert any(warning.code == "sparse_cloud" for warning in found.warnings) == told
