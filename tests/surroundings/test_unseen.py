"""What of an object was hidden: straight below its rim, and behind ridges and peaks; the table's top is z = 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_settings, plan
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.scene import segment
from flatgrasp_cli.surroundings import Tilted
from tests.conftest import MM, TABLE, Box, Camera, Solid, Tube
from tests.scene.test_heaps import distance

SETTINGS = load_settings()
CAMERA = Camera(tilt_deg=40)
"""It sees no far side that is steeper than 50°."""


@dataclass(frozen=True)
class Peak:
    """What `sides` planes enclose that lean by `lean` (tangent) and meet `height_m` over the plane; 2 make a ridge.

    The first of them, which faces +y, is `upright` or not.
    """

    sides: int
    lean: float
    height_m: float
    upright: bool = False

    def _planes(self) -> tuple[FloatArray, FloatArray]:
        """Outward normals (k, 3) and how far (k,) along them the planes lie; 2 sides face ±y and end at x."""
        turns = 2 * np.pi * np.arange(self.sides) / self.sides + np.pi / 2
        leans = np.full(self.sides, self.lean)
        leans[0] *= not self.upright
        slanted = np.column_stack([np.cos(turns), np.sin(turns), leans])
        others, off = [[0.0, 0.0, -1.0]], [0.0]
        if self.sides == 2:
            others, off = [*others, [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], [0.0, 0.05, 0.05]
        return np.concatenate([slanted, others]), np.concatenate([leans * self.height_m, off])

    def hit(self, origin: FloatArray, rays: FloatArray) -> FloatArray:
        """How far (n,) along `rays` (n, 3) from `origin` the surface lies; infinite where they miss."""
        normals, offsets = self._planes()
        along = rays @ normals.T
        along = np.where(np.abs(along) < 1e-12, 1e-12, along)
        at = (offsets - normals @ origin) / along
        first = np.where(along < 0, at, -np.inf).max(axis=1)
        last = np.where(along > 0, at, np.inf).min(axis=1)
        return np.where((first <= last) & (first > 0), first, np.inf)

    def height_over(self, points: FloatArray) -> FloatArray:
        """How high (n,) over the plane its surface is at points (n, 3)."""
        normals, offsets = (each[: self.sides] for each in self._planes())
        return np.asarray(((offsets - points[:, :2] @ normals[:, :2].T) / self.lean).min(axis=1))


TENT = Peak(2, 0.45, 0.07)
CONE = Peak(24, 0.4, 0.11)


def hidden(*solids: Solid | Peak, camera: Camera = CAMERA) -> FloatArray:
    """Points (n, 3) that were hidden of the first of what stands on the table."""
    item = segment(camera.sees(TABLE, *solids), SETTINGS.scene, 0).objects[0]  # type: ignore[arg-type]
    assert item.floor is not None
    return Tilted(item, item.floor, SETTINGS.resolve(load_gripper("pr2")))._body


@pytest.mark.parametrize("thing", [TENT, CONE])
def test_a_side_behind_a_ridge_or_a_peak_is_the_mirror_image_of_that_before_it(thing: Peak) -> None:
    """It goes as far out as it does, is nowhere higher than it, and leaves no gap that a finger could come through."""
    points = hidden(thing)
    behind = points[points[:, 1] > 8 * MM]
    foot = thing.lean * thing.height_m
    assert behind[:, 1].max() == pytest.approx(foot, abs=6 * MM)
    assert np.quantile(behind[:, 2] - thing.height_over(behind), 0.98) < 5 * MM
    for y in np.arange(12, 1000 * foot - 8, 4) * MM:
        amid = behind[(np.abs(behind[:, 1] - y) < 2.5 * MM) & (np.abs(behind[:, 0]) < 8 * MM)]
        assert amid[:, 2].max() > thing.height_over(np.array([[0.0, y, 0.0]]))[0] - 12 * MM


def test_a_hidden_side_reaches_into_its_corners() -> None:
    """That of a pyramid is a triangle, and whole also where it is narrower than a finger."""
    thing = Peak(4, 0.6, 0.08)
    behind, foot = hidden(thing), thing.lean * thing.height_m
    for y in np.arange(12 * MM, foot - 8 * MM, 4 * MM):
        across = behind[(np.abs(behind[:, 1] - y) < 2.5 * MM) & (np.abs(behind[:, 0]) < y), 0]
        assert np.diff(np.sort(across), prepend=-y, append=y).max() < 8 * MM


@pytest.mark.parametrize(
    "thing",
    [
        Box((0.0, 0.0, 0.03), (0.1, 0.06, 0.06)),
        Box((0.0, 0.0, 0.03), (0.1, 0.015, 0.06)),
        Tube((0.0, 0.0, 0.04), 0.05, 0.08),
        Tube((0.0, 0.0, 0.04), 0.05, 0.08, bore=0.046, floor=0.004),
    ],
    ids=["box", "board", "can", "cup"],
)
def test_what_ends_in_a_level_top_or_an_edge_goes_straight_down(thing: Solid) -> None:
    assert distance(thing, hidden(thing)).max() < 5 * MM


@pytest.mark.parametrize(("thick_m", "mirrored"), [(0.017, False), (0.04, True)])
def test_what_is_narrower_than_a_finger_is_mirrored_in_nothing(thick_m: float, mirrored: bool) -> None:
    """A post or a wall 6 cm high, at the far edge of a plate 8 cm long: behind a wall the plate may go on."""
    plate, post = Box((0.0, 0.0, 0.008), (0.08, 0.08, 0.016)), Box((0.0, 0.034, 0.03), (thick_m, 0.012, 0.06))
    assert (hidden(plate, post)[:, 1].max() > 55 * MM) == mirrored


def test_nothing_is_taken_to_be_where_rays_passed() -> None:
    """Right behind a ramp the table was seen from high up; the mirror image's foot would be 31 mm away."""
    camera, ramp = Camera(tilt_deg=15), Peak(2, 0.45, 0.07, upright=True)
    y, z = camera.frame.origin[1:]
    points = hidden(ramp, camera=camera)
    shadow = (ramp.height_m - points[:, 2]) * -y / (z - ramp.height_m)
    assert (points[:, 1] - shadow).max() < 8 * MM  # two pixels of the image that rays are told by


def test_no_hand_closes_on_sides_that_are_too_slanted_of_which_one_was_not_seen() -> None:
    """They lean by 31° each, and friction of 0.5 holds 27°."""
    camera = Camera(tilt_deg=45)
    settings = load_settings("default", ("approach.around=4",))
    found = plan(camera.sees(TABLE, Peak(2, 0.6, 0.07)), load_gripper("pr2"), settings)  # type: ignore[arg-type]
    assert found.best is None
