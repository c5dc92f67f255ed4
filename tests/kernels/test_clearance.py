"""How far outlines stay off boxes: compiled, as written, and by shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.chain import closed_chain
from flatgrasp_cli.geometry.polygon import in_frames
from flatgrasp_cli.kernels import clearance
from tests.kernels.interpreted import interpreted

FRAMES = 6


@given(seed=st.integers(0, 999))
def test_it_is_the_distance_of_the_region_and_the_box(seed: int) -> None:
    """Boxes stand beside a star, in its hole, across its wall or in that."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, 9, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(0.8, 1.4, (9, 1))
    points, breaks = closed_chain([ring, 0.5 * ring[::-1]])
    joined = np.ones(len(points) - 1, dtype=np.uint8)
    joined[breaks] = 0
    turn, origins = rng.uniform(0, 2 * np.pi, FRAMES), rng.uniform(-1.5, 1.5, (FRAMES, 2))
    x, y = in_frames(points, origins, np.column_stack([np.cos(turn), np.sin(turn)]))
    across, near = np.array([-0.1, 0.05]), rng.uniform(-0.3, 0.3, FRAMES)
    along = np.stack([near, near + rng.uniform(0.01, 0.5, FRAMES)])
    found = clearance.clearance(x, y, joined, across, along)
    assert np.array_equal(found, interpreted("clearance").clearance(x, y, joined, across, along))
    for frame in range(FRAMES):
        outer, inner = (np.column_stack([x[:, frame], y[:, frame]])[rows] for rows in (slice(0, 10), slice(10, 20)))
        box = shapely.box(across[0], along[0, frame], across[1], along[1, frame])
        assert found[frame] == pytest.approx(shapely.Polygon(outer, [inner]).distance(box), abs=1e-12)
