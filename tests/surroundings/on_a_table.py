"""Plans of things on a table, and what a hand on its way sweeps."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli import Plan, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import Cloud, Grasp, Source
from flatgrasp_cli.profiles import Gripper
from tests.conftest import EACH, MM, TABLE, Box, Camera, Solid

ABOVE = Camera(pixels=(320, 240), focal=420.0)
KINECT = Camera(tilt_deg=50, pixels=(640, 480), focal=525.0)
DEPTH, HAND = load_settings().depth, load_settings().hand
BLOCK = Box((0.0, 0.0, 0.02), (0.10, 0.04, 0.04))
SLACK_M = 3 * MM
"""A cell of the height maps: fingers may come this much nearer to a point than their own boxes."""
PALM_SLACK_M = 6 * MM
"""The same of the palm's coarser map."""
HEIGHT_SLACK_M = 2 * MM
"""What the sensor's noise of 0.5 mm does to a single point, at most."""


def planned(cloud: Cloud, gripper: Gripper, *overrides: str, top: int = 10) -> Plan:
    """The best `top` grasps from straight above, those at about one place, too."""
    return plan(cloud, gripper, load_settings("default", (*EACH, "approach.directions=top", *overrides)), top=top)


def best(result: Plan) -> Grasp:
    assert result.best is not None, result.reason
    return result.best


def seen(gripper: Gripper, *solids: Solid, camera: Camera = ABOVE) -> Grasp:
    """The best grasp of what a camera sees on the table."""
    return best(planned(camera.sees(TABLE, *solids), gripper))


def ground() -> tuple[FloatArray, FloatArray]:
    """X and y (n, n) of places 1 mm apart on a table of 30 × 30 cm."""
    x, y = np.meshgrid(np.arange(-150, 151) * MM, np.arange(-150, 151) * MM)
    return x, y


def relief(heights: FloatArray) -> Cloud:
    """The cloud of a surface so high over `ground`, seen from above, with noise of 0.3 mm."""
    x, y = ground()
    noise = np.random.default_rng(0).normal(0, 0.3 * MM, heights.size)
    return Cloud(
        np.column_stack([x.ravel(), y.ravel(), heights.ravel() + noise]), np.array([0, 0, 0.8]), Source("relief")
    )


def in_hand(grasp: Grasp, points: FloatArray) -> FloatArray:
    """Points (n, 3) in the fingertip frame."""
    return Frame(grasp.position, axes_from_quaternion(grasp.orientation)).to_local(points)


def struck(grasp: Grasp, gripper: Gripper, points: FloatArray) -> FloatArray:
    """Which of `points`, in the fingertip frame, fingers and palm sweep on their way down, opened for the approach."""
    local = in_hand(grasp, points)
    x, y, z = local.T
    hit = np.zeros(len(local), dtype=np.bool_)
    half, above = 0.5 * grasp.opening_m, z < -HEIGHT_SLACK_M
    for sign, offsets in zip((-1, 1), gripper.jaws, strict=True):
        out = sign * y
        in_depth = (out > half + SLACK_M) & (out < half + gripper.finger_thickness_m - SLACK_M)
        for offset in offsets:
            hit |= above & in_depth & (np.abs(x - offset) < 0.5 * gripper.finger_width_m - SLACK_M)
    in_palm = (np.abs(x) < 0.5 * gripper.hand_width_m - PALM_SLACK_M) & (
        np.abs(y) < 0.5 * gripper.palm_m - PALM_SLACK_M
    )
    return np.asarray(local[hit | (in_palm & (z < -gripper.finger_length_m))])


def hand_in(grasp: Grasp, gripper: Gripper, *, back_m: float = 0.0) -> FloatArray:
    """Places in the open fingers and the palm, the hand so far back on its way, in the world."""
    across = np.linspace(-0.5, 0.5, 7)
    finger = np.stack(np.meshgrid(across, across, np.linspace(0.02, 1, 15)), axis=-1).reshape(-1, 3)
    places = []
    for sign in (-1, 1):
        out = sign * 0.5 * (grasp.opening_m + gripper.finger_thickness_m)
        size = [gripper.finger_width_m, gripper.finger_thickness_m, -gripper.finger_length_m]
        places.append(finger * size + [0, out, 0])
    palm = np.stack(np.meshgrid(across, np.linspace(-0.5, 0.5, 31), [1.0]), axis=-1).reshape(-1, 3)
    places.append(palm * [gripper.hand_width_m, gripper.palm_m, -gripper.finger_length_m])
    local = np.concatenate(places) - [0, 0, back_m]
    return Frame(grasp.position, axes_from_quaternion(grasp.orientation)).to_world(local)
