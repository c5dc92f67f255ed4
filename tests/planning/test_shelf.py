"""Before a shelf: what stands in front of it is grasped from above, what stands below the board is not."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, plan
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.profiles import Gripper
from tests.conftest import TABLE, Box, Camera, Tube

BOARD, BACK = Box((0.0, 0.14, 0.26), (0.7, 0.28, 0.02)), Box((0.0, 0.29, 0.15), (0.7, 0.02, 0.34))
SIDE = Box((-0.36, 0.14, 0.13), (0.02, 0.28, 0.28))
BELOW, ON_BOARD = Box((0.05, 0.12, 0.05), (0.05, 0.05, 0.1)), Box((0.1, 0.1, 0.30), (0.05, 0.08, 0.06))
FRONT = (Box((-0.1, -0.12, 0.04), (0.06, 0.1, 0.08), 20), Tube((0.15, -0.15, 0.05), 0.03, 0.1))
CAMERA = Camera(tilt_deg=60, distance=0.9, target=(0.0, 0.05, 0.1), pixels=(400, 300), focal=400.0)


def reaches_into(grasp: Grasp, gripper: Gripper, solid: Box) -> bool:
    """Whether a hand that comes straight down to a grasp passes through an upright box, on its way or there."""
    half = 0.5 * (max(gripper.palm_m, grasp.opening_m + 2 * gripper.finger_thickness_m) + gripper.hand_width_m)
    low, high = np.array(solid.center) - 0.5 * np.array(solid.size), np.array(solid.center) + 0.5 * np.array(solid.size)
    above = (np.abs(grasp.position[:2] - np.clip(grasp.position[:2], low[:2], high[:2])) < 0.5 * half).all()
    return bool(above and high[2] > grasp.position[2])


@pytest.mark.parametrize("name", ["pr2", "robotiq_2f_140"])
@pytest.mark.parametrize("shelf", [(BOARD,), (BOARD, BACK), (BOARD, BACK, SIDE)], ids=["board", "back", "side"])
def test_what_stands_before_a_shelf_is_had_and_what_is_below_the_board_is_not(
    shelf: tuple[Box, ...], name: str
) -> None:
    gripper = load_gripper(name)
    objects = plan(CAMERA.sees(TABLE, *shelf, *FRONT, BELOW, ON_BOARD), gripper).objects
    had = [item for item in objects if item.grasps]
    assert all(np.linalg.norm(item.object.points - BELOW.center, axis=1).min() > 0.05 for item in had)
    for solid in FRONT:
        near = [item for item in had if np.linalg.norm(item.grasps[0].position[:2] - solid.center[:2]) < 0.04]
        assert len(near) == 1
    for item in had:
        for grasp in item.grasps:
            assert not any(reaches_into(grasp, gripper, part) for part in shelf)
