"""Convex hulls, and how far inside them places lie."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.hull import convex_hull, depths
from flatgrasp_cli.geometry.polygon import signed_area


@given(seed=st.integers(0, 999), count=st.integers(3, 40))
def test_places_lie_as_deep_in_a_hull_as_its_boundary_is_away(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points, places = rng.normal(size=(count, 2)), rng.normal(size=(8, 2))
    hull, whole = convex_hull(points), shapely.MultiPoint(points).convex_hull
    assert signed_area(hull) == pytest.approx(whole.area)
    inside = shapely.contains_xy(whole, *places.T)
    found = depths(hull, places)
    assert (found > 0).tolist() == inside.tolist()
    away = shapely.distance(whole.exterior, shapely.points(places))
    assert found[inside] == pytest.approx(away[inside])


@pytest.mark.parametrize("points", [np.zeros((4, 2)), np.arange(6.0).repeat(2).reshape(6, 2), np.empty((0, 2))])
def test_nothing_lies_in_the_hull_of_a_line(points: np.ndarray) -> None:
    assert len(convex_hull(points)) == 0
    assert depths(convex_hull(points), np.zeros((2, 2))).tolist() == [-np.inf, -np.inf]
