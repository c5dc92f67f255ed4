"""What is told of values by their order, and of vectors by their products, as numpy does it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import axes_about, cross_product
from flatgrasp_cli.geometry.scatter import median, quantile

VALUES = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30)
VECTORS = st.lists(st.floats(-10, 10), min_size=3, max_size=3).map(np.array)


@given(values=VALUES, share=st.floats(0, 1))
def test_medians_and_quantiles_are_numpys(values: list[float], share: float) -> None:
    assert median(np.array(values)) == np.median(values)
    assert quantile(np.array(values), share) == pytest.approx(np.quantile(values, share), abs=1e-9)


@given(a=VECTORS, b=VECTORS)
def test_so_are_products_of_vectors(a: np.ndarray, b: np.ndarray) -> None:
    assert np.array_equal(cross_product(a, b), np.cross(a, b))


@given(vector=VECTORS.filter(lambda vector: bool(np.linalg.norm(vector) > 0.1)))
def test_axes_about_a_vector_are_right_handed(vector: np.ndarray) -> None:
    axes = axes_about(vector / np.linalg.norm(vector))
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.allclose(axes[2] * np.linalg.norm(vector), vector)
