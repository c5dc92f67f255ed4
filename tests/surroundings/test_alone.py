"""How deep hands come down on an object that is seen alone."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import Cloud, Plan, load_gripper, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import Silhouette
from flatgrasp_cli.surroundings.alone import palm_intrusion
from tests.ranking.situations import grasp as a_grasp

GRIP_M = load_settings().depth.min_grip_m


def top_of_a_box(x: tuple[float, float], y: float, low: float, high: float) -> FloatArray:
    """Points (n, 3), 1.5 mm apart, on the top and the sides of a box between x, as wide as 2 y, seen from above."""
    along, across = np.arange(*x, 0.0015), np.arange(-y, y, 0.0015)
    levels = np.arange(low, high, 0.0015)
    top = np.stack(np.meshgrid(along, across, [high]), axis=-1).reshape(-1, 3)
    long_sides = np.stack(np.meshgrid(along, [-y, y], levels), axis=-1).reshape(-1, 3)
    ends = np.stack(np.meshgrid(x, across, levels), axis=-1).reshape(-1, 3)
    return np.concatenate([top, long_sides, ends])


BLOCK = top_of_a_box((-0.06, 0.06), 0.06, -0.02, 0.03)
"""Wider than the hand opens."""
HANDLE = top_of_a_box((0.06, 0.20), 0.012, -0.02, -0.012)
"""Its main plane lies far above this."""


def planned(points: FloatArray, method: str = "default") -> Plan:
    cloud = Cloud(points, viewpoint=np.array([0.0, 0.0, 1.0]))
    return plan(cloud, load_gripper("pr2"), load_settings(method, ("scene.mode=object",)))


def heights(found: Plan, places: FloatArray) -> FloatArray:
    """Of places (n, 3) over the main plane, which sides that were seen tilt a little."""
    silhouette = found.objects[0].silhouette
    assert silhouette is not None
    return silhouette.frame.to_local(places)[:, 2]


def tips(found: Plan) -> FloatArray:
    """How high the fingertips of all grasps end over the main plane (n,)."""
    return heights(found, np.array([grasp.position for grasp in found.objects[0].grasps]))


def test_pads_get_hold_of_a_handle_below_the_main_plane() -> None:
    found = planned(np.concatenate([BLOCK, HANDLE]))
    for grasp, tip in zip(found.objects[0].grasps, tips(found), strict=True):
        near = HANDLE[np.abs(HANDLE[:, 0] - grasp.position[0]) < 0.012]
        top = heights(found, near).max()
        assert grasp.width_m == pytest.approx(0.024, abs=0.003)
        assert tip == pytest.approx(min(0.0, top - GRIP_M), abs=0.002)
        assert heights(found, grasp.contacts) == pytest.approx(min(0.0, top), abs=0.002)
    assert tips(found).min() < -0.01


def test_what_stands_in_the_main_plane_is_held_there() -> None:
    assert tips(planned(top_of_a_box((-0.06, 0.06), 0.02, -0.02, 0.02)))[0] == pytest.approx(0.0, abs=1e-9)


def test_the_papers_hand_never_leaves_the_main_plane() -> None:
    assert tips(planned(np.concatenate([BLOCK, HANDLE]), "paper")) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("tip_mm", [0.0, -15.0])
def test_what_is_held_lower_reaches_farther_into_the_palm(tip_mm: float) -> None:
    """A post between the fingers, 10 mm higher over the main plane than they are long."""
    hand = load_gripper("pr2")
    post = np.array([hand.finger_length_m + 0.010, 0.0])
    shape = Silhouette(Frame(np.zeros(3), np.eye(3)), (), np.zeros((2, 2)), post, alpha_m=0.01, coverage=1.0)
    met = palm_intrusion(shape, a_grasp(20, 40, tip=1e-3 * tip_mm), hand)
    assert met == pytest.approx(0.010 - 1e-3 * tip_mm)
