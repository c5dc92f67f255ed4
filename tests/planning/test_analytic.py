"""Shapes whose best grasp can be worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.proof import is_caged
from tests.conftest import EACH, I_BEAM, L_SHAPE, MM, THICKNESS_M, cloud_of, disc, holds, rectangle, sampled


def best(result: Plan) -> Grasp:
    assert result.best is not None, result.reason
    return result.best


def closing_axis(grasp: Grasp) -> FloatArray:
    return np.asarray(Rotation.from_quat(grasp.orientation).as_matrix()[:, 1])


@pytest.mark.parametrize("name", ["pr2", "lacquey"])
def test_a_rectangle_is_grasped_across_its_short_side_through_the_centroid(
    name: str, request: pytest.FixtureRequest
) -> None:
    grasp = best(plan(cloud_of(sampled(rectangle(120, 40))), request.getfixturevalue(name)))
    assert grasp.gravity_distance_m < 1 * MM
    assert grasp.force_balance_deg < 1
    assert grasp.width_m == pytest.approx(40 * MM, abs=0.5 * MM)
    assert abs(closing_axis(grasp)[1]) > np.cos(np.radians(1))
    assert grasp.position == pytest.approx([0, 0, 0], abs=1 * MM)


def test_the_pose_meets_its_contract(pr2: Gripper) -> None:
    """Approach away from the sensor, pads at y = ±width/2, contacts there, at the box's mid-height."""
    grasp = best(plan(cloud_of(sampled(rectangle(120, 40)) + np.array([0, 0, 0.5]), (0, 0, 2)), pr2))
    turn = Rotation.from_quat(grasp.orientation)
    assert turn.as_matrix()[:, 2] == pytest.approx([0, 0, -1], abs=0.01)
    contacts = turn.inv().apply(grasp.contacts - grasp.position)
    assert contacts[:, 1] == pytest.approx([-grasp.width_m / 2, grasp.width_m / 2], abs=0.5 * MM)
    assert grasp.position[2] == pytest.approx(0.5, abs=THICKNESS_M / 10)
    assert grasp.width_m < grasp.opening_m <= pr2.max_opening_m


def test_the_hand_comes_from_the_sensors_side(pr2: Gripper) -> None:
    below = best(plan(cloud_of(sampled(rectangle(120, 40)), (0, 0, -1)), pr2))
    assert Rotation.from_quat(below.orientation).as_matrix()[2, 2] > 0.99


@pytest.mark.parametrize("name", ["pr2", "lacquey"])
def test_an_i_beam_is_caged_at_its_neck(name: str, request: pytest.FixtureRequest) -> None:
    """Which leaves fingers of 20 mm a centimetre on either side: a hand that misses lands on the beam's flanges."""
    gripper = request.getfixturevalue(name)
    slim = gripper.model_copy(update={"jaws": ((0.0,), (0.0,)), "finger_width_m": 0.02})
    cloud = cloud_of(sampled(I_BEAM))
    grasp = best(plan(cloud, slim, load_settings("default", ("ranking.prefer=cage",))))
    assert holds(best(plan(cloud, slim))) > holds(grasp) + 0.01
    assert is_caged(grasp.cage)
    assert grasp.width_m == pytest.approx(30 * MM, abs=0.5 * MM)
    assert abs(closing_axis(grasp)[0]) > 0.99
    assert grasp.gravity_distance_m < 2 * MM


def test_a_disc_is_grasped_through_its_centre(pr2: Gripper) -> None:
    grasp = best(plan(cloud_of(sampled(disc(35))), pr2))
    assert grasp.gravity_distance_m < 1 * MM
    assert grasp.width_m == pytest.approx(70 * MM, abs=1 * MM)
    assert grasp.required_friction < 0.05


@pytest.mark.parametrize(("name", "radius"), [("pr2", 30), ("lacquey", 45)])
def test_the_contacts_on_a_disc_are_as_far_apart_as_it_is_wide(
    name: str, radius: int, request: pytest.FixtureRequest
) -> None:
    """Not as its finger candidates' chords are, whose middles lie 2.2 mm inside a disc of 60 mm."""
    gripper = request.getfixturevalue(name)
    grasps = plan(cloud_of(sampled(disc(radius))), gripper).objects[0].grasps
    assert len(grasps) > 0
    for grasp in grasps:
        apart = grasp.contacts[1] - grasp.contacts[0]
        assert apart @ closing_axis(grasp) == pytest.approx(grasp.width_m, abs=1e-6)
        if gripper.symmetric:
            assert np.linalg.norm(grasp.contacts[:, :2], axis=1) == pytest.approx(radius * MM, abs=0.5 * MM)


def test_an_l_is_never_grasped_across_its_notch(lacquey: Gripper) -> None:
    """None of a thousand grasping lines passes through the notch, a finger's flatness aside."""
    result = plan(cloud_of(sampled(L_SHAPE)), lacquey, load_settings("default", EACH), top=1000)
    assert best(result).inside_share == pytest.approx(1.0, abs=0.01)
    contacts = np.array([grasp.contacts[:, :2] for grasp in result.objects[0].grasps])
    along = np.linspace(0, 1, 50)[:, None, None]
    lines = contacts[:, 0] + along * (contacts[:, 1] - contacts[:, 0])
    notch = shapely.box(*(MM * np.array([36, 36, 200, 200])))
    assert not shapely.contains_xy(notch, lines.reshape(-1, 2)).any()


def test_a_ring_too_wide_is_grasped_by_its_wall_with_a_finger_in_the_hole(pr2: Gripper) -> None:
    ring = disc(80).difference(disc(55))
    result = plan(cloud_of(sampled(ring)), pr2)
    grasp = best(result)
    assert grasp.width_m == pytest.approx(25 * MM, abs=2 * MM)
    away = np.linalg.norm(grasp.contacts[:, :2], axis=1)
    assert sorted(away) == pytest.approx([55 * MM, 80 * MM], abs=2.5 * MM)
    fingers = result.objects[0].trace.fingers
    assert fingers is not None
    assert sorted(fingers.loop[list(grasp.fingers)]) == [0, 1]


def test_a_hole_too_small_for_a_finger_is_not_used(pr2: Gripper) -> None:
    """16 mm of hole cannot take a finger 22 mm wide: the wall grasp is refused, and 160 mm are too wide."""
    result = plan(cloud_of(sampled(disc(80).difference(disc(8)))), pr2)
    assert result.best is None


def test_an_object_wider_than_the_gripper_is_refused_with_numbers(pr2: Gripper) -> None:
    result = plan(cloud_of(sampled(rectangle(104, 180))), pr2)
    assert result.best is None
    rejection = result.objects[0].rejection
    assert rejection is not None
    assert rejection.stage == "grasping_range"
    assert rejection.value == pytest.approx(0.104, abs=1 * MM)
    assert "0.104 m" in rejection.reason
    assert "0.090 m" in rejection.reason
    assert result.objects[0].funnel[-1].kept == 0


def test_an_object_too_thin_for_the_gripper_is_refused() -> None:
    points = sampled(rectangle(150, 2), pitch_mm=0.25) * [1, 1, 0.1]
    thin = plan(cloud_of(points), load_gripper("wsg_50"))
    assert thin.best is None
    assert "smallest opening" in (thin.reason or "")


def test_a_neighbouring_wall_leaves_no_room_for_a_finger(pr2: Gripper) -> None:
    """Two bars 8 mm apart, joined at one end: a 9 mm finger and its clearance do not fit between them."""
    fork = shapely.union_all([shapely.box(0, 0, 100, 30), shapely.box(0, 38, 100, 68), shapely.box(0, 0, 8, 68)])
    result = plan(cloud_of(sampled(fork)), pr2, load_settings("default", EACH), top=1000)
    assert result.best is not None
    for grasp in result.objects[0].grasps:
        v = grasp.contacts[:, 1]
        between = (v > 29 * MM) & (v < 39 * MM) & (grasp.contacts[:, 0] > 10 * MM)
        assert not between.any()


def test_the_palm_meets_what_stands_higher_than_the_fingers_are_long(pr2: Gripper) -> None:
    points = sampled(rectangle(150, 60))
    points[:, 2] *= 50 * MM / THICKNESS_M
    tall = plan(cloud_of(points), pr2.model_copy(update={"finger_length_m": 0.02}))
    assert tall.best is None
    assert tall.objects[0].funnel[-1].stage == "palm"
    assert "above the fingertips" in (tall.reason or "")


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (np.empty((0, 3)), "no point of the cloud was measured"),
        (np.ones((1, 3)), "1 distinct point,"),
        (np.ones((500, 3)), "1 distinct point,"),
        (np.linspace(0, 1, 50)[:, None] * [[1.0, 2.0, 3.0]], "lie on a line"),
    ],
    ids=["none", "one", "duplicates", "line"],
)
def test_a_cloud_that_spans_no_plane_is_refused(points: FloatArray, reason: str, pr2: Gripper) -> None:
    result = plan(cloud_of(points), pr2)
    assert result.best is None
    assert reason in (result.reason or "")


@pytest.mark.parametrize("top", [0, -1])
def test_to_keep_no_grasp_is_refused(top: int, pr2: Gripper) -> None:
    with pytest.raises(ValueError, match="one or more"):
        plan(cloud_of(sampled(rectangle(120, 40))), pr2, top=top)


def test_two_far_off_points_do_not_spoil_the_outline(pr2: Gripper) -> None:
    stray = np.array([[0.4, 0.3, 0.0], [-0.3, 0.1, 0.0]])
    grasp = best(plan(cloud_of(np.vstack([sampled(rectangle(120, 40)), stray])), pr2))
    assert grasp.width_m == pytest.approx(40 * MM, abs=1 * MM)
