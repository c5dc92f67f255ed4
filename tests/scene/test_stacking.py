"""Which objects lie on which; the table's top is z = 0."""

from __future__ import annotations

import pytest

from flatgrasp_cli import load_gripper, plan
from tests.conftest import TABLE, Box, Camera, Solid
from tests.scene.test_heaps import scene_of

KINECT = Camera(tilt_deg=40, pixels=(400, 300), focal=525.0)
PLATE = Box((0.0, 0.0, 0.02), (0.14, 0.12, 0.04))
LID = Box((0.0, 0.0, 0.055), (0.07, 0.05, 0.03))
BESIDE = Box((0.105, 0.0, 0.06), (0.07, 0.06, 0.12))
APART = Box((-0.2, 0.0, 0.02), (0.06, 0.06, 0.04))


def supports(*solids: Solid, tilt_deg: float) -> list[list[float]]:
    """For each object, the smallest first, how many points those have that lie on it."""
    objects = scene_of(Camera(tilt_deg=tilt_deg, pixels=(400, 300), focal=525.0).sees(TABLE, *solids)).objects
    assert len(objects) == len(solids)
    assert [item.id for item in objects] == list(range(len(objects)))
    return [[len(objects[k].points) for k in item.supports] for item in sorted(objects, key=lambda o: len(o.points))]


@pytest.mark.parametrize("tilt_deg", [5, 25, 45])
def test_what_is_surrounded_by_something_lower_lies_on_it(tilt_deg: float) -> None:
    small, large = supports(PLATE, LID, tilt_deg=tilt_deg)
    assert small == []
    assert len(large) == 1


@pytest.mark.parametrize("tilt_deg", [5, 25, 45])
def test_what_stands_beside_something_lower_does_not(tilt_deg: float) -> None:
    assert supports(PLATE, BESIDE, tilt_deg=tilt_deg) == [[], []]
    assert supports(PLATE, APART, tilt_deg=tilt_deg) == [[], []]


def test_what_others_lie_on_is_picked_after_them() -> None:
    """The plate alone would be the first: the other box is too wide for its lid to matter."""
    objects = plan(KINECT.sees(TABLE, PLATE, LID, APART), load_gripper("robotiq_2f_140")).objects
    assert len(objects) == 3
    assert all(item.grasps for item in objects)
    assert [bool(item.object.supports) for item in objects] == [False, False, True]
