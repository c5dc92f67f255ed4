"""§III.A.1 and A.2 on points that are a fraction of a millimetre, or a metre, from deciding otherwise."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Silhouette
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.silhouette import silhouette_of, without_strays
from tests.by_hand import MM, WORLD

SETTINGS = load_settings().silhouette
UP = np.array([0.0, 0.0, 1.0])


def grid(*shapes: shapely.Geometry, pitch_mm: float = 0.5) -> FloatArray:
    """Points (n, 3) in metres, exactly `pitch_mm` apart, of plates given in millimetres, edges included."""
    shape = shapely.union_all(shapes).buffer(1e-6)
    x0, y0, x1, y1 = shape.bounds
    steps = (np.arange(np.floor(low), high + pitch_mm, pitch_mm) for low, high in ((x0, x1), (y0, y1)))
    x, y = (axis.ravel() for axis in np.meshgrid(*steps))
    inside = shapely.contains_xy(shape, x, y)
    return np.asarray(MM * np.column_stack([x, y, 0 * x])[inside])


def outlined(points: FloatArray) -> Silhouette:
    return silhouette_of(points, WORLD, SETTINGS)


PLATE = shapely.box(-60, -20, 60, 20)


@pytest.mark.parametrize(("notch_mm", "left_open"), [(4, False), (8, True)])
def test_the_disc_of_3_mm_gets_into_notches_of_7_mm(notch_mm: float, left_open: bool) -> None:
    outline = outlined(grid(PLATE.difference(shapely.box(-notch_mm / 2, 0, notch_mm / 2, 20.5))))
    assert outline.alpha_m == pytest.approx(3 * MM)
    assert shapely.Polygon(outline.loops[0]).contains(shapely.Point(0, 0.01)) != left_open


def test_the_disc_grows_with_the_points_spacing() -> None:
    assert outlined(grid(PLATE, pitch_mm=3)).alpha_m == pytest.approx(12 * MM, rel=0.01)  # the sixth neighbour's, twice


@pytest.mark.parametrize(("apart_mm", "size_mm", "whole"), [(30, 8, False), (30, 24, True)])
def test_a_detached_piece_counts_if_it_is_more_than_a_tenth(apart_mm: float, size_mm: float, whole: bool) -> None:
    """4 % are left out; of 16 % the gap is bridged, by a disc hardly larger than that takes."""
    piece = shapely.box(60 + apart_mm, -20, 60 + apart_mm + size_mm, 20)
    small = shapely.box(60 + apart_mm, -10, 60 + apart_mm + size_mm, 10)
    outline = outlined(grid(PLATE, piece if whole else small, pitch_mm=1))
    assert (outline.loops[0][:, 0].max() > 0.07) == whole
    assert outline.alpha_m < 40 * MM


@pytest.mark.parametrize(("tooth_mm", "kept"), [(0.3, False), (1.0, True)])
def test_half_a_millimetre_is_the_outlines_noise(tooth_mm: float, kept: bool) -> None:
    points = grid(PLATE)
    tooth = (np.abs(points[:, 0]) < 10 * MM) & (points[:, 1] == 20 * MM)
    points[tooth, 1] += tooth_mm * MM
    assert (outlined(points).loops[0][:, 1].max() > 20.1 * MM) == kept


@pytest.mark.parametrize(("diameter_mm", "loops"), [(8, 1), (13, 2)])
def test_holes_smaller_than_a_finger_are_missing_pixels(diameter_mm: float, loops: int) -> None:
    hole = shapely.Point(0, 0).buffer(diameter_mm / 2)
    assert len(outlined(grid(PLATE.difference(hole))).loops) == loops


@pytest.mark.parametrize(("apart_mm", "belongs"), [(20, True), (25, False)])
def test_what_is_more_than_about_2_cm_away_belongs_to_nothing(apart_mm: float, belongs: bool) -> None:
    plate = grid(PLATE, pitch_mm=2)
    speck = np.array([[0.06 + apart_mm * MM, 0.0, 0.0]])
    assert len(without_strays(np.vstack([plate, speck]), SETTINGS)) == len(plate) + belongs


@pytest.mark.parametrize(("wide_m", "spans"), [(0.05e-3, False), (0.2e-3, True)])
def test_points_on_a_line_of_a_metre_span_a_plane_from_a_tenth_of_a_millimetre_on(wide_m: float, spans: bool) -> None:
    steps = np.linspace(-0.5, 0.5, 400)
    line = np.column_stack([steps, wide_m * np.sign(np.sin(97 * steps)) * 0.29, 0 * steps])
    assert (oriented_box(line, UP, "pca") is not None) == spans


@pytest.mark.parametrize(("size_m", "spans"), [(2.5e-7, False), (5e-7, True)])
def test_points_closer_than_single_precision_tells_are_one(size_m: float, spans: bool) -> None:
    ball = np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3)) * size_m
    assert (oriented_box(ball, UP, "pca") is not None) == spans


STRIPE = shapely.box(-12, -15, 12, 15)
SKIN = grid(PLATE.buffer(10, join_style="mitre").difference(STRIPE), pitch_mm=2)
OTHER_SKIN = SKIN + 80 * MM * UP
WALL = np.concatenate([grid(STRIPE.exterior, pitch_mm=1) + z * MM * UP for z in range(0, 82, 2)])


class TestGaps:
    """A stripe of 24 mm in which there is no point of a body that is 80 mm high."""

    def holes(self, *parts: FloatArray) -> int:
        return len(outlined(np.concatenate(parts)).loops) - 1

    def test_between_two_skins_it_is_no_hole(self) -> None:
        assert self.holes(SKIN, OTHER_SKIN) == 0

    def test_with_walls_it_is_one(self) -> None:
        assert self.holes(SKIN, OTHER_SKIN, WALL) == 1

    def test_of_one_skin_nobody_knows(self) -> None:
        assert self.holes(SKIN) == 1

    @pytest.mark.parametrize(("walled_mm", "holes"), [(-14, 0), (10, 1)])
    def test_most_of_the_way_round_decides(self, walled_mm: float, holes: int) -> None:
        assert self.holes(SKIN, OTHER_SKIN, WALL[WALL[:, 1] < walled_mm * MM]) == holes
