"""Points in an image: compiled, as written, and by a product of matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.kernels import projection
from tests.kernels.interpreted import interpreted


@given(seed=st.integers(0, 999))
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    rng, twin = np.random.default_rng(seed), interpreted("projection")
    normal, points, origin = rng.normal(size=3), rng.uniform(-1, 1, (20, 3)), rng.uniform(-1, 1, 3)
    axes = frame_on_plane(normal / np.linalg.norm(normal), 0.0).axes
    local = (points - origin) @ axes.T
    image = projection.projected(points.T, origin, axes)
    assert np.array_equal(image, twin.projected(points.T, origin, axes))
    ahead = local[:, 2] > 0
    assert np.isinf(image[0]).tolist() == (~ahead).tolist()
    assert image[:2, ahead] == pytest.approx((local[ahead, :2] / local[ahead, 2:]).T, rel=1e-9)
    assert image[2] == pytest.approx(np.linalg.norm(local, axis=1), rel=1e-12)
    seen = projection.image(points, origin, axes, 0.1)
    assert np.array_equal(seen, twin.image(points, origin, axes, 0.1))
    assert seen[2] == pytest.approx(local[:, 2], abs=1e-12)
    assert seen[:2] == pytest.approx((local[:, :2] / np.maximum(local[:, 2:], 0.1)).T, rel=1e-9, abs=1e-12)
