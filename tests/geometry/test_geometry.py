"""Geometry against shapely, scipy and brute force."""

from __future__ import annotations

import base64

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry import polygon
from flatgrasp_cli.geometry.alpha_shape import _repaired, alpha_region
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.chain import Chain, closed_chain
from flatgrasp_cli.geometry.frames import Frame, quaternion_from_axes
from flatgrasp_cli.geometry.range_image import RangeImage
from flatgrasp_cli.geometry.rectangle import minimum_area_axis

seeds = st.integers(0, 2**32 - 1)


def star(seed: int, corners: int = 12) -> FloatArray:
    """A simple, non-convex, counter-clockwise loop about the origin."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    return np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(0.4, 1.0, (corners, 1))


def holed(seed: int) -> tuple[tuple[FloatArray, FloatArray], shapely.Polygon]:
    """A star with a hole, as loops and as a shapely polygon."""
    outer, inner = star(seed), 0.3 * star(seed + 1)[::-1]
    return (outer, inner), shapely.Polygon(outer, [inner])


@given(seeds)
def test_area_and_centroid_agree_with_shapely(seed: int) -> None:
    loops, shape = holed(seed)
    assert sum(polygon.signed_area(loop) for loop in loops) == pytest.approx(shape.area)
    assert polygon.area_centroid(loops) == pytest.approx(shapely.get_coordinates(shape.centroid)[0])


@given(seeds)
def test_contains_agrees_with_shapely(seed: int) -> None:
    loops, shape = holed(seed)
    points = np.random.default_rng(seed).uniform(-1, 1, (50, 2))
    assert polygon.contains(loops, points).tolist() == shapely.contains_xy(shape, points).tolist()


def test_a_ray_through_vertices_counts_once() -> None:
    diamond = np.array([[1.0, 0], [0, 1], [-1, 0], [0, -1]])
    points = np.array([[0.0, 0.0], [-2.0, 0.0], [-0.5, 0.0], [-2.0, 1.0]])
    assert polygon.contains([diamond], points).tolist() == [True, False, True, False]


@given(seeds)
def test_share_inside_agrees_with_shapely(seed: int) -> None:
    loops, shape = holed(seed)
    ends = np.random.default_rng(seed).uniform(-1, 1, (20, 2, 2))
    lines = shapely.linestrings(ends)
    expected = shapely.length(shapely.intersection(lines, shape)) / shapely.length(lines)
    assert polygon.share_inside(loops, ends[:, 0], ends[:, 1]) == pytest.approx(expected, abs=3e-4)


def test_share_inside_of_a_chord_from_edge_to_edge_is_whole() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    assert polygon.share_inside([square], np.array([[0.0, 0.5]]), np.array([[1.0, 0.5]])) == pytest.approx([1.0])


@given(seeds, st.floats(0.05, 1.5))
def test_circle_exit_is_the_first_point_that_far_away(seed: int, radius: float) -> None:
    loop = star(seed)
    perimeter = polygon.arc_positions(loop)[-1]
    begin = float(np.random.default_rng(seed).uniform(0, perimeter))
    exit_at = polygon.circle_exits(loop, np.array([begin]), radius)[0]
    walk = np.linspace(begin, begin + perimeter, 4001)
    away = np.linalg.norm(polygon.points_at(loop, walk) - polygon.points_at(loop, np.array([begin])), axis=1)
    if np.isnan(exit_at):
        assert away.max() <= radius + 1e-9
    else:
        assert away[walk < exit_at].max() <= radius + 1e-9
        reached = polygon.points_at(loop, np.array([begin, exit_at]))
        assert np.linalg.norm(reached[1] - reached[0]) == pytest.approx(radius)


@given(seeds)
def test_chord_walk_steps_are_all_of_one_length_but_the_last(seed: int) -> None:
    loop = star(seed)
    points = polygon.points_at(loop, polygon.chord_walk(loop, 0.1))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps == pytest.approx(np.full(len(points) - 1, 0.1))
    assert np.linalg.norm(points[0] - points[-1]) <= 0.1 + 1e-9


@given(seeds)
def test_rays_agree_with_the_crossing_number(seed: int) -> None:
    loop, rng = star(seed), np.random.default_rng(seed)
    angles = rng.uniform(0, 2 * np.pi, 25)
    far = 5 * np.column_stack([np.cos(angles), np.sin(angles)])
    for point in rng.uniform(-1, 1, (10, 2)):
        assert polygon.ray_parity_inside(loop, point, far) == polygon.contains([loop], point[None])[0]


def chain_of(*loops: FloatArray, shift: float = 0.0) -> Chain:
    points, breaks = closed_chain(loops)
    x, y = points[:, :1] - shift, points[:, 1:]
    return Chain.of(x, y, breaks)


def test_edges_are_clipped_to_a_strip() -> None:
    """The strip −1 ≤ x ≤ 1 and a triangle with a slanted, an upright and a level side; a second one lies outside."""
    triangle = np.array([[-2.0, 0.0], [2.0, 4.0], [-2.0, 4.0]])
    meets, low, high = chain_of(triangle, triangle + 10).clipped(-1.0, 1.0)
    assert np.flatnonzero(meets).tolist() == [0, 1]
    assert (low[meets].tolist(), high[meets].tolist()) == ([1.0, 4.0], [3.0, 4.0])


def test_an_upright_edge_in_the_strip_is_kept_whole() -> None:
    _, low, high = chain_of(np.array([[0.5, 1.0], [0.5, 3.0], [5.0, 2.0]])).clipped(-1.0, 1.0)
    assert (low[0, 0], high[0, 0]) == (1.0, 3.0)


def small_triangles(triangles: FloatArray, alpha: float) -> BoolArray:
    """Which `triangles` (n, 3, 2) belong to the α-shape: circumradius at most α, or no side longer than α."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    sides = np.array([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))])
    radius = sides.prod(axis=0) / np.maximum(2 * np.abs(polygon.cross(b - a, c - a)), 1e-15)
    return np.asarray((radius <= alpha) | (sides.max(axis=0) <= alpha))


@settings(max_examples=25)  # each with thousands of points
@given(seeds, st.floats(0.06, 0.3))
def test_alpha_region_is_nearly_the_union_of_all_small_triangles(seed: int, alpha: float) -> None:
    """Against a triangulation of all points: the outlines are nearly one, and nowhere far apart."""
    rng = np.random.default_rng(seed)
    loop = star(seed)
    points = rng.uniform(-1, 1, (6000, 2))
    points = points[polygon.contains([loop], points)]
    region = alpha_region(points, alpha)
    triangles = points[Delaunay(points).simplices]
    full = shapely.coverage_union_all(shapely.polygons(triangles[small_triangles(triangles, alpha)]))
    largest = max(shapely.get_parts(full), key=lambda part: part.area)
    assert region.symmetric_difference(largest).area <= 0.04 * alpha * largest.length
    assert region.exterior.hausdorff_distance(largest.exterior) <= 2 * alpha


TOUCHING = (
    "5zweGEUpkj8ZtTqLc1NiPyMki2p885A/ANQxby7cYz/VlynBwSyRP9c2jWaiAVE/hgvIFwdmkT9M6SRFYNQ2v4Qg5Ku6HY0/nREg"
    "N6TtZr8jo63Pq92MPwfw8CcYbUY/a1zTw+xPjT9cArGoH+NGvznlyR7WD40/zhEgN6TtZj/+s0N56/SNP1xS0KTfdPs+KVpOSCtY"
    "iz9mzPnXNgpfvw7Leprne4g/Eozxdl1KNb/aaVrL5PuLPxDyVDFxN1O/prF3deMRhj/EXDE3yRgiv03fESN/d4A/oOBPDgQqZb+N"
    "uzEiaxOBP7l+mSirl16/SSAfTN49gT+IlK99+t4uP/wVUYfrVX0/BnZjfiaKW7+U4SdcEbRzPx8oqzAab1W/eF99HUrGbT9BC7GI"
    "lGFSv2jREx68b1A/cWq1xpwOWL9y7U9U8Twmv3MXh7YLA1W/YW+QfiybZL+Wusww0ddNv8J1bUbW/XS/pG98042XVL9l5yCQeaB/"
    "v+0wHzr6O1q/9WbvdmSTfr8WeC3pmQhNv/7IXaYifYe/gXVGRGzTXL/v03Chet+Jvz8pdiGozVm/4N6DnNJBjL/73KX+48dWvxUd"
    "jKDa+JC/UJXYgkFHOL/R6ZaXKqSOv7mQ1dsfwlO/2TweGEUpkr/gyUZgt28ovyNBps/98JG/2t8/E+9fWb8PTLgJUkKHP9AeGM+G"
    "c1k/smvZPXMDjr/qWot5fJtTPy3OdAZh95G/TPAJcEL1Uj8="
)
"""35 points of a thing's rim, float64 in base64. Rounding turns a touch of their ring into a crossing."""


def test_alpha_region_survives_rings_that_touch() -> None:
    points = np.frombuffer(base64.b64decode(TOUCHING)).reshape(-1, 2)
    region = alpha_region(points, 0.006135719910778963)
    assert region.is_valid
    assert region.area == pytest.approx(47.2e-6, rel=0.01)


@pytest.mark.parametrize("alpha", [1.5, 4.0, 30.0, 1e4])
def test_alpha_region_of_a_large_disc_is_nearly_the_convex_hull(alpha: float) -> None:
    """Of points that are 2 apart at most; a disc of radius 1.5 sinks in by 0.38 between those, but few are so far."""
    points = star(0)
    region, hull = alpha_region(points, alpha), shapely.MultiPoint(points).convex_hull
    assert region.hausdorff_distance(hull) <= alpha - np.sqrt(alpha**2 - 1)


def test_alpha_region_keeps_a_real_hole_and_fills_a_gap() -> None:
    x, y = np.meshgrid(np.arange(-30.0, 31), np.arange(-30.0, 31))
    points = np.column_stack([x.ravel(), y.ravel()])
    away = np.hypot(*points.T)
    gap = np.hypot(points[:, 0] - 20, points[:, 1] - 20) < 2
    points = points[(away > 10) & ~gap]
    region = alpha_region(points, 4.0)
    assert len(region.interiors) == 1
    assert shapely.Polygon(region.interiors[0]).area == pytest.approx(np.pi * 10**2, rel=0.15)


def test_alpha_region_drops_a_row_of_points_and_what_hangs_on_it() -> None:
    """A square with a row of points from a side to a smaller square: the disc rolls along both of the row's sides."""
    x, y = np.meshgrid(np.arange(0.0, 31), np.arange(0.0, 31))
    square = np.column_stack([x.ravel(), y.ravel()])
    row = np.column_stack([np.arange(31.0, 60, 2), np.full(15, 15.0)])
    points = np.vstack([square, row, 0.4 * square + [60, 9]])
    region = alpha_region(points, 3.0)
    assert region.geom_type == "Polygon"
    assert region.area == pytest.approx(30**2, rel=0.03)


@given(seeds)
def test_alpha_region_of_a_thin_ring_is_a_ring(seed: int) -> None:
    """Its inner and outer outline share points, and may cross."""
    angles = np.random.default_rng(seed).uniform(0, 2 * np.pi, 500)
    radii = np.where(np.arange(500) % 5 == 0, 10.3, 10.0)
    region = alpha_region(np.column_stack([radii * np.cos(angles), radii * np.sin(angles)]), 2.5)
    assert region.area < 1.1 * np.pi * (10.3**2 - 10**2)


def test_a_ring_that_touches_itself_within_rounding_is_mended() -> None:
    """The edges along both sides of a row of points lie less than a micrometre apart."""
    row = [
        (0.08109285651636626, -0.0020811875836538696),
        (0.06115120117122869, 0.01837029582682415),
        (0.05866506229212172, 0.020883578769223417),
        (0.05631574038699716, 0.023316911143694385),
        (0.054576769100725, 0.02511869861170663),
        (0.05511871060395794, 0.024527010290020846),
        (0.05659197806881642, 0.02303765745453055),
        (0.05903337911545861, 0.020511240603696718),
    ]
    assert _repaired(np.array(row)).is_valid


@given(st.floats(0, np.pi), seeds)
def test_minimum_area_axis_finds_the_long_side(angle: float, seed: int) -> None:
    points = np.random.default_rng(seed).uniform([-2, -1], [2, 1], (300, 2))
    points = np.vstack([points, [[-2, -1], [2, -1], [2, 1], [-2, 1]]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axis = minimum_area_axis(points @ turn.T)
    assert abs(axis @ turn[:, 0]) == pytest.approx(1.0)


@given(seeds)
def test_quaternion_agrees_with_scipy(seed: int) -> None:
    rotation = Rotation.random(random_state=seed % 2**31).as_matrix()
    expected = Rotation.from_matrix(rotation).as_quat(canonical=True)
    assert quaternion_from_axes(rotation.T) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_quaternion_of_half_turns(axis: str) -> None:
    matrix = Rotation.from_euler(axis, 180, degrees=True).as_matrix()
    assert Rotation.from_quat(quaternion_from_axes(matrix.T)).as_matrix() == pytest.approx(matrix, abs=1e-12)


@given(seeds)
def test_frame_there_and_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frame = Frame(rng.normal(size=3), Rotation.random(random_state=seed % 2**31).as_matrix())
    points = rng.normal(size=(5, 3))
    assert frame.to_world(frame.to_local(points)) == pytest.approx(points)


class TestRangeImage:
    def test_rays_end_at_the_nearest_point(self) -> None:
        plane = np.stack(np.meshgrid(np.arange(-0.1, 0.1, 0.01), np.arange(-0.1, 0.1, 0.01), [1.0]), axis=-1)
        image = RangeImage.of(np.vstack([plane.reshape(-1, 3), [[0.0, 0.0, 0.5]]]), np.zeros(3), 0.015)
        nearest, ranges = image.nearest(np.array([[0.0, 0.0, 0.8], [0.06, 0.0, 0.8], [0.9, 0.0, 0.8]]).T)
        assert ranges == pytest.approx([0.8, np.hypot(0.06, 0.8), np.hypot(0.9, 0.8)])
        assert nearest[:2] == pytest.approx([0.5, np.hypot(0.075, 1.0)], rel=0.01)
        assert nearest[2] == np.inf

    def test_points_beside_and_behind_the_sensor_change_nothing(self) -> None:
        ahead = np.random.default_rng(0).uniform([-0.2, -0.2, 0.5], [0.2, 0.2, 0.7], (2000, 3))
        around = np.array([[0.0, 0.3, -0.2], [0.5, 0.0, 0.0], [0.4, 0.4, 0.01]])
        alone, amid = (RangeImage.of(points, np.zeros(3), 0.01) for points in (ahead, np.vstack([ahead, around])))
        assert amid.pixels.cell_m == pytest.approx(alone.pixels.cell_m, rel=0.01)
        assert np.isfinite(amid.ranges).sum() == pytest.approx(np.isfinite(alone.ranges).sum(), rel=0.05)
        assert amid.nearest(around.T)[0].tolist() == [np.inf] * 3

    def test_a_sensor_in_the_middle_of_the_points_sees_something(self) -> None:
        points = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
        assert np.isfinite(RangeImage.of(points, np.zeros(3), 0.1).ranges).any()
        assert not np.isfinite(RangeImage.of(np.zeros((3, 3)), np.zeros(3), 0.1).ranges).any()
