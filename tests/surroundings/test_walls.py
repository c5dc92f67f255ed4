"""What pads rest on beside an outline: profiles in millimetres, 25 mm above the table, before a pad 20 mm wide."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.surroundings.envelope import Envelope
from flatgrasp_cli.surroundings.view import View
from flatgrasp_cli.surroundings.walls import Walls, as_where_known, upright, walls
from tests.by_hand import MM, WORLD, Relief, candidates

LEVEL_M = 25 * MM
FRICTION = 0.5
NOT_LOOKED_AT = View(None, WORLD, None)
AT_ORIGIN = candidates(np.zeros((1, 2)), np.array([[0.0, 1.0]]))
"""One candidate: the object lies toward +y, the pad along x."""


def surface(relief_mm: Relief) -> HeightMap:
    """The map of a surface whose height is given over x and y, the way inward, all in millimetres."""
    steps = np.arange(-39.75, 40.0, 0.5)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    return HeightMap.of(MM * np.column_stack([x, y, relief_mm(x, y)]), 0.5 * MM)


def found(relief_mm: Relief) -> Walls:
    chart = surface(relief_mm)
    return walls(AT_ORIGIN, chart, Envelope(chart, NOT_LOOKED_AT), LEVEL_M, FRICTION)


class TestTheWallsTop:
    @pytest.mark.parametrize(("begins_mm", "top_mm"), [(4.5, 60), (5.5, 40)])
    def test_it_is_that_of_the_first_5_mm(self, begins_mm: float, top_mm: float) -> None:
        step = found(lambda _x, y: np.where(y < begins_mm, 40.0, 60.0))
        assert step.top[0] == pytest.approx(top_mm * MM)

    @pytest.mark.parametrize(("beyond_mm", "top_mm"), [(3, 60), (10, 40)])
    def test_it_is_that_of_most_of_the_pad_and_of_nothing_beside_it(self, beyond_mm: float, top_mm: float) -> None:
        beside = found(lambda x, _y: np.where(np.abs(x) < beyond_mm, 40.0, 60.0))
        assert beside.top[0] == pytest.approx(top_mm * MM)

    def test_it_is_the_level_where_nothing_was_seen(self) -> None:
        empty = HeightMap.of(np.empty((0, 3)), MM)
        nothing = walls(AT_ORIGIN, empty, Envelope(empty, NOT_LOOKED_AT), LEVEL_M, FRICTION)
        assert (nothing.top[0], nothing.boundary[0], nothing.foot[0], nothing.flank[0]) == (*3 * [LEVEL_M], 0.0)

    @pytest.mark.parametrize(("begins_mm", "boundary_mm"), [(6, 40), (3.5, 40 + 20 * 2 / 5), (1.5, 40 + 20 * 4 / 5)])
    def test_the_boundary_is_the_mean_of_the_first_5_mm(self, begins_mm: float, boundary_mm: float) -> None:
        step = found(lambda _x, y: np.where(y < begins_mm, 40.0, 60.0))
        assert step.boundary[0] == pytest.approx(boundary_mm * MM)


@pytest.mark.parametrize(("rise", "flank_mm"), [(0.3, 0), (1.0, 5), (1.8, 9), (2.5, 0)])
def test_what_rises_by_half_to_one_over_friction_is_a_flank_for_5_mm(rise: float, flank_mm: float) -> None:
    """What is flatter is the top, what is steeper holds by friction."""
    slope = found(lambda _x, y: 30 + rise * y)
    assert slope.flank[0] == pytest.approx(flank_mm * MM, rel=0.05)


@pytest.mark.parametrize(
    ("rise", "recesses_mm"), [(5.0, [4, 5, 6, 7]), (25.0, [0.8, 1.0, 1.2, 1.4])], ids=["slope", "steep"]
)
def test_leans_are_told_for_fingertips_a_quarter_of_the_grip_higher_each(rise: float, recesses_mm: list[float]) -> None:
    """Of two walls that rise by so much a millimetre: over the lower half of what is left of the grip.

    Up to 40 mm, of grips of 40, 30, 20 and 10 mm, those halves end at 20, 25, 30 and 35 mm. The steep one has come that
    high before the first place that is looked at, and goes on outward of it as inward.
    """
    rising = found(lambda _x, y: rise * np.maximum(y, 0))
    leans = rising.lean(np.zeros((2, 1), dtype=np.intp), np.zeros(1), np.array([40 * MM]))
    assert leans[0] * [20, 15, 10, 5] == pytest.approx(recesses_mm, abs=0.3)  # a cell of the map is 0.5 mm


def test_an_upright_wall_leans_by_nothing() -> None:
    upright_wall = found(lambda x, _y: np.full_like(x, 40.0))
    assert not upright_wall.lean(np.zeros((2, 1), dtype=np.intp), np.zeros(1), np.array([40 * MM])).any()


class TestTheWallsFoot:
    """A wall 40 mm high, of which the lower part may be missing."""

    @pytest.mark.parametrize(("seen_down_to_mm", "foot_mm"), [(0, 0), (30, 30)])
    def test_it_is_how_far_down_a_face_was_seen(self, seen_down_to_mm: float, foot_mm: float) -> None:
        """Its points lie evenly from there to its top, in the cells of the boundary."""
        top = surface(lambda _x, y: np.where(y < 1, 40.0, np.nan))
        mean = surface(lambda _x, y: np.where(y < 1, 0.5 * (40.0 + seen_down_to_mm), np.nan))
        face = walls(AT_ORIGIN, mean, Envelope(top, NOT_LOOKED_AT), LEVEL_M, FRICTION)
        assert face.foot[0] == pytest.approx(foot_mm * MM)

    @pytest.mark.parametrize(
        ("free_mm", "tip_mm", "feet_mm"),
        [(20, 10, (20, 30)), (20, 25, (25, 25)), (35, 10, (30, 30)), (0, 10, (10, 10))],
    )
    def test_a_rim_overhangs_where_rays_passed_above_the_fingertips(
        self, free_mm: float, tip_mm: float, feet_mm: tuple[float, float]
    ) -> None:
        """It ends between what was seen of it and what they passed; else the wall goes down to the fingertips."""
        rim = found(lambda x, _y: np.full_like(x, 40.0))._replace(
            foot=np.full(1, 30 * MM), free=np.full(1, free_mm * MM)
        )
        feet = rim.feet(np.zeros((2, 1), dtype=np.intp), np.full(1, tip_mm * MM))
        assert feet == pytest.approx(np.broadcast_to(np.array(feet_mm) * MM, (1, 2, 2)))

    def test_where_it_is_not_known_it_is_as_elsewhere_on_the_loop(self) -> None:
        """Rays passed below two of five sides of a rim; of a hole one side was seen down to the level."""
        loops = np.array([0, 0, 0, 0, 0, 1, 1, 2])
        free = np.array([20, 0, 0, 24, 0, 0, 0, 0]) * MM
        foot = np.array([40, 42, 30, 44, LEVEL_M / MM + 1, 40, LEVEL_M / MM, 40]) * MM
        others = as_where_known(loops, free, foot, LEVEL_M)
        assert others[0] / MM == pytest.approx([20, 20, 20, 24, 0, 0, 0, 0])
        assert others[1] / MM == pytest.approx([40, 40, 30, 44, 26, 25, 25, 40])


class TestUpright:
    @staticmethod
    def stands(below_mm: Relief) -> bool:
        """Whether the candidate is before a wall, where what the slice stands on is so far below its level."""
        rest = surface(lambda x, y: LEVEL_M / MM - below_mm(x, -y))
        return bool(upright(AT_ORIGIN, rest, LEVEL_M, load_settings().depth.wall_drop)[0])

    @pytest.mark.parametrize(("fall", "stands"), [(2.0, False), (3.7, True)])
    def test_what_falls_by_less_than_70_degrees_is_a_flank(self, fall: float, stands: bool) -> None:
        assert self.stands(lambda _x, out: fall * out) == stands

    def test_a_ledge_5_mm_away_is_not_looked_at(self) -> None:
        assert self.stands(lambda _x, out: np.where(out < 5, 20.0, 0.0))

    def test_a_rim_1_mm_wide_is_not_looked_at(self) -> None:
        """It is the outline's own uncertainty."""
        assert self.stands(lambda _x, out: np.where(out > 1.5, 20.0, 0.0))

    def test_half_of_the_pad_is_enough(self) -> None:
        assert self.stands(lambda x, _out: np.where(x < 3, 20.0, 0.0))
        assert not self.stands(lambda x, _out: np.where(x < -3, 20.0, 0.0))
