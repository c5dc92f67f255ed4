"""Before a shelf: what stands in front of it is grasped from above, and what stands below the board from the front."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli import Plan, load_gripper, load_settings, plan
from flatgrasp_cli.model import ObjectPlan
from flatgrasp_cli.planning.scenes import in_picking_order
from flatgrasp_cli.ranking import TIE
from tests.conftest import TABLE, Box, Camera, Tube
from tests.scene.test_heaps import distance
from tests.surroundings.on_a_table import hand_in

BOARD, BACK = Box((0.0, 0.14, 0.26), (0.7, 0.28, 0.02)), Box((0.0, 0.29, 0.15), (0.7, 0.02, 0.34))
SIDE = Box((-0.36, 0.14, 0.13), (0.02, 0.28, 0.28))
BELOW, ON_BOARD = Box((0.05, 0.12, 0.05), (0.05, 0.05, 0.1)), Box((0.1, 0.1, 0.30), (0.05, 0.08, 0.06))
FRONT = (Box((-0.1, -0.12, 0.04), (0.06, 0.1, 0.08), 20), Tube((0.15, -0.15, 0.05), 0.03, 0.1))
CAMERA = Camera(tilt_deg=60, distance=0.9, target=(0.0, 0.05, 0.1), pixels=(400, 300), focal=400.0)
SHELVES = pytest.mark.parametrize("shelf", [(BOARD,), (BOARD, BACK), (BOARD, BACK, SIDE)], ids=["board", "back", "all"])
HANDS = pytest.mark.parametrize("name", ["pr2", "robotiq_2f_140"])


def of(solid: Box | Tube, found: Plan) -> ObjectPlan:
    """The plan of what stands where `solid` does."""
    return min(found.objects, key=lambda item: float(np.abs(item.object.points.mean(axis=0) - solid.center).sum()))


@HANDS
@SHELVES
def test_no_hand_touches_the_shelf_and_all_that_it_can_get_at_is_had(shelf: tuple[Box, ...], name: str) -> None:
    found = plan(CAMERA.sees(TABLE, *shelf, *FRONT, BELOW, ON_BOARD), load_gripper(name))
    for solid in (*FRONT, ON_BOARD):
        assert of(solid, found).grasps[0].approach.known_from == "top"
    below = of(BELOW, found)
    assert below.grasps[0].approach.direction[1] > 0.5, "from the front"
    assert below.why_not_top is not None
    assert "too high to grip" in below.why_not_top
    hands = [hand_in(each, found.gripper, back_m=back) for each in below.grasps for back in (0, 0.03, 0.06, 0.1)]
    for hand in hands:
        assert min(distance(part, hand).min() for part in shelf) > 0
        assert hand[:, 2].min() > 0


@HANDS
def test_from_straight_above_what_is_below_the_board_is_not_had(name: str) -> None:
    down = load_settings("default", ("approach.directions=top",))
    below = of(BELOW, plan(CAMERA.sees(TABLE, BOARD, BACK, *FRONT, BELOW, ON_BOARD), load_gripper(name), down))
    assert not below.grasps
    assert below.rejection is not None
    assert "mm high" in below.rejection.reason


def test_of_equals_what_is_had_from_straight_above_is_picked_first() -> None:
    found = plan(CAMERA.sees(TABLE, BOARD, BACK, *FRONT, BELOW), load_gripper("pr2"))
    above, below = of(FRONT[0], found), of(BELOW, found)
    one, other = (item.grasps[0].success.probability if item.grasps[0].success else 0.0 for item in (above, below))
    assert abs(one - other) < TIE
    farther = replace(above, grasps=(replace(above.grasps[0], gravity_distance_m=0.1),))
    assert list(in_picking_order([below, farther])) == [farther, below]
