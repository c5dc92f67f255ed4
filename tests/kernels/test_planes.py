"""The plane that most points agree with: compiled, as written, and by a plain twin."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import planes
from tests.kernels.interpreted import interpreted


def twin(points: FloatArray, corners: IntArray, tolerance: FloatArray) -> list[int]:
    """All planes scored to the end; the first of the best."""
    best: list[int] = []
    for a, b, c in points[corners]:
        normal = np.cross(b - a, c - a)
        if np.linalg.norm(normal) > 1e-12:
            heights = (points - a) @ normal / np.linalg.norm(normal)
            agree = np.flatnonzero(np.abs(heights) < tolerance).tolist()
            best = agree if len(agree) > len(best) else best
    return best


@given(seed=st.integers(0, 999), flat=st.integers(0, 40))
def test_it_is_the_one_that_most_agree_with(seed: int, flat: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (40, 3))
    points[:flat, 2] = 0.01 * points[:flat, 2] + 0.3 * points[:flat, 0]
    corners, tolerance = rng.integers(40, size=(30, 3), dtype=np.intp), rng.uniform(0.01, 0.03, 40)
    found = planes.consensus(points, corners, tolerance).tolist()
    assert found == twin(points, corners, tolerance)
    assert found == interpreted("planes").consensus(points, corners, tolerance).tolist()


def test_points_in_line_make_none() -> None:
    points = np.arange(5.0)[:, None] * np.array([1.0, 2.0, 3.0])
    assert len(planes.consensus(points, np.array([[0, 1, 2], [4, 4, 1]]), np.full(5, 0.1))) == 0


@given(seed=st.integers(0, 999))
def test_so_is_what_lies_near_one(seed: int) -> None:
    points, normal = np.random.default_rng(seed).uniform(-1, 1, (40, 3)), np.array([0.6, 0.0, 0.8])
    own = planes.near_plane(points, normal, 0.1, 0.4)
    assert np.array_equal(own, points[np.abs(points @ normal - 0.1) < 0.4])
    assert np.array_equal(own, interpreted("planes").near_plane(points, normal, 0.1, 0.4))
