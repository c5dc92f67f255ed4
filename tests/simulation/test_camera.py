"""The camera measures what geometry says, and scatters as Nguyen, Izadi & Lovell measured."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_robot
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.robot import forward, in_dh_base
from flatgrasp_cli.simulation.camera import (
    DISPARITY_STEP_PX,
    EDGE_DROPOUT,
    XTION,
    axial_sigma_m,
    cast,
    scene_of,
    seen,
)
from flatgrasp_cli.simulation.looking import BESIDE_M, look_at, look_by_arm, spot_of
from flatgrasp_cli.simulation.solids import Mesh, box, ellipsoid
from flatgrasp_cli.simulation.trial import TABLE
from tests.robot.arms import ROBOTS, rows

DOWN = np.diag([1.0, -1.0, -1.0])


def above(height_m: float, tilt_deg: float = 0.0) -> Frame:
    """A camera over the origin that looks down, tilted about its x axis."""
    c, s = np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))
    return Frame(np.array([0.0, 0.0, height_m]), np.array([[1.0, 0, 0], [0, c, s], [0, -s, c]]) @ DOWN)


def random() -> np.random.Generator:
    return np.random.default_rng(1)


def test_a_plane_is_as_far_as_it_is() -> None:
    at = above(0.8, 25)
    hits = cast(scene_of([TABLE]), at, XTION.directions())
    assert (hits.depth * (XTION.directions() @ at.axes)[..., 2] + 0.8) == pytest.approx(0.0, abs=1e-5)
    assert hits.cosine[235, 314] == pytest.approx(np.cos(np.radians(25)), abs=1e-3)


def test_a_ball_is_as_far_as_it_is() -> None:
    hits = cast(scene_of([ellipsoid((0.1, 0.1, 0.1), (0, 0, 0.2)).surface, TABLE]), above(0.8), XTION.directions())
    rays = XTION.directions()
    center = np.array([0.0, 0.0, 0.6])
    a, b, c = (rays**2).sum(-1), rays @ center, center @ center - 0.01
    on_ball = (hits.depth < 0.7) & (b * b - a * c > 0)
    expected = (b - np.sqrt(np.maximum(b * b - a * c, 0))) / a
    assert on_ball.sum() > 20_000
    inner = on_ball & (hits.cosine > 0.3)
    assert np.abs(hits.depth - expected)[inner].max() < 1e-3  # a ball of flat triangles: 0.1 m (1 − cos 2.25°)/cos


def test_depth_scatters_by_nguyens_sigma_and_comes_in_steps_of_disparity() -> None:
    depth = seen(scene_of([TABLE]), above(1.0), random())[..., 2]
    expected = 0.0012 + 0.0019 * 0.6**2 + 0.0001
    middle = depth[180:290, 260:370]
    step = DISPARITY_STEP_PX / (XTION.focal_px * XTION.baseline_m)
    quantised = step / np.sqrt(12)  # of rounding
    assert axial_sigma_m(np.array(1.0), np.array(0.0)) == pytest.approx(expected - 0.0001)
    assert middle.std() == pytest.approx(np.hypot(expected - 0.0001, quantised), rel=0.03)
    assert middle.mean() == pytest.approx(1.0, abs=1e-4)
    assert 1 / middle / step == pytest.approx(np.round(1 / middle / step), abs=1e-6)
    assert np.isfinite(depth).all()


def test_an_edge_scatters_across_by_four_fifths_of_a_pixel_and_drops_pixels() -> None:
    half = box((0.4, 2.0, 0.2), (0.2, 0.0, 0.1)).surface  # fills the image's right
    image = seen(scene_of([half, TABLE]), above(0.8), random())[..., 2]
    rows = image[20:460]
    near = np.isfinite(rows) & (rows < 0.7)
    columns = np.arange(image.shape[1])
    edge = np.array([columns[row].min() for row in near])
    assert np.abs(edge - np.median(edge)).max() >= 2  # a straight edge is ragged
    beside = slice(int(np.median(edge)) - 1, int(np.median(edge)) + 2)
    assert np.isnan(rows[:, beside]).mean() == pytest.approx(EDGE_DROPOUT, abs=0.12)
    assert np.isfinite(rows[:, : beside.start - 8]).all()


def test_a_surface_seen_along_itself_is_not_measured() -> None:
    wall = Mesh(
        np.array([[-1, 0, 0], [1, 0, 0], [1, 0, 0.4], [-1, 0, 0.4]], dtype=float), np.array([[0, 1, 2], [0, 2, 3]])
    )
    image = seen(scene_of([wall, TABLE]), Frame(np.array([0.0, 0.05, 0.8]), DOWN), random())
    points = image[np.isfinite(image[..., 2])]
    assert (points[:, 2] > 0.7).all()  # the wall begins 0.4 m below the camera


def test_the_same_seed_gives_the_same_image() -> None:
    scene = scene_of([TABLE, box((0.1, 0.1, 0.1), (0, 0, 0.05)).surface])
    one, two, other = (seen(scene, above(0.8), np.random.default_rng(k)) for k in (1, 1, 2))
    assert np.array_equal(one, two, equal_nan=True)
    assert not np.array_equal(one, other, equal_nan=True)


@pytest.mark.parametrize("azimuth", [0.0, 2.0, -1.0])
def test_a_floating_camera_looks_at_the_spot_at_its_tilt(azimuth: float) -> None:
    spot = np.array([0.1, -0.2, 0.0])
    camera = look_at(spot, np.radians(20), azimuth).camera
    assert camera.to_local(spot) == pytest.approx([0, 0, 0.8])
    assert camera.axes[2] @ [0, 0, -1] == pytest.approx(np.cos(np.radians(20)))
    assert np.linalg.det(camera.axes) == pytest.approx(1)
    out = camera.origin - spot
    assert np.arctan2(out[1], out[0]) == pytest.approx(azimuth)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("gripper", ["lacquey", "franka_hand"])
def test_an_arm_brings_its_camera_there_and_the_hand_stays_out_of_view(robot: str, gripper: str) -> None:
    arm, hand = load_robot(robot), load_gripper(gripper).model_copy(update={"mounted_deg": 30.0})
    spot = spot_of(arm)
    look = look_by_arm(arm, hand, spot, np.radians(20), 0.3)
    assert look.joints is not None
    pose = forward(rows(arm), look.joints)[5]
    flange = Frame(in_dh_base(arm.base_frame, pose[:3, 3]), in_dh_base(arm.base_frame, pose[:3, :3].T))
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    hand_x, hand_y = c * flange.axes[0] + s * flange.axes[1], c * flange.axes[1] - s * flange.axes[0]
    assert look.camera.origin == pytest.approx(flange.origin + BESIDE_M * hand_x, abs=1e-6)
    assert look.camera.axes == pytest.approx(np.stack([hand_y, -hand_x, flange.axes[2]]), abs=1e-6)
    assert look.camera.to_local(spot)[:2] == pytest.approx([0, 0], abs=1e-6)
    assert look.camera.axes[2, 2] == pytest.approx(-np.cos(np.radians(20)))
    assert not any(in_view(look.camera, flange, corner) for corner in hand_corners(gripper))


def test_an_arm_that_gets_its_camera_nowhere_says_what_to_do() -> None:
    ur5 = load_robot("ur5")
    short = rows(ur5).model_copy(update={"a_m": (0.0, -0.05, -0.05, 0.0, 0.0, 0.0)})
    stump = ur5.model_copy(update={"dh": short})
    with pytest.raises(
        UsageError, match=r"ur5 brings its camera nowhere .* give another --sensor-tilt, or --robot none"
    ):
        look_by_arm(stump, load_gripper("pr2"), spot_of(ur5), np.radians(20), 0.0)


def hand_corners(name: str) -> list[FloatArray]:
    """Corners of the hand's widest parts, in its own frame at the flange: palm, and fingers fully open."""
    hand = load_gripper(name)
    x = max(abs(offset) for jaw in hand.jaws for offset in jaw) + hand.finger_width_m / 2
    y, end = hand.max_opening_m / 2 + hand.finger_thickness_m, hand.palm_offset_m + hand.finger_length_m
    palm = [(sx * hand.hand_width_m / 2, sy * hand.palm_m / 2, hand.palm_offset_m) for sx in (-1, 1) for sy in (-1, 1)]
    return [np.array(corner) for corner in [*palm, *((sx * x, sy * y, end) for sx in (-1, 1) for sy in (-1, 1))]]


def in_view(camera: Frame, flange: Frame, corner: FloatArray) -> bool:
    """Whether a point of the hand, given in its own frame (turned by 30° on the flange), is in the image."""
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]]) @ flange.axes
    x, y, z = camera.to_local(flange.origin + corner @ axes)
    u, v = XTION.focal_px * x / z + XTION.center_px[0], XTION.focal_px * y / z + XTION.center_px[1]
    return bool(0 <= u < XTION.width and 0 <= v < XTION.height)
