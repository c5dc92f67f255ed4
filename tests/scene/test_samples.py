"""Samples are as large as their reasons say: what is told by them is known so well, neither coarser nor finer."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli import load_settings
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.geometry.scatter import deviation
from flatgrasp_cli.model import Cloud, Sensor
from flatgrasp_cli.scene import support_plane
from tests.by_hand import MM

ABOUT_1_PERCENT = pytest.approx(0.0105, abs=0.003)
"""A third of the points would be known to 2 %, three times as many to 0.6 %."""


def test_the_share_of_a_planes_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a table and as many points over it: what is found of them scatters by 1 % from one cloud to the next."""
    found, shares = [], []
    of_sample = support_plane._planes

    def recorded(*arguments: object) -> object:
        found.append(list(of_sample(*arguments)))  # type: ignore[arg-type]
        return iter(found[-1])

    monkeypatch.setattr(support_plane, "_planes", recorded)
    settings = load_settings().scene.model_copy(update={"min_plane_share": 0.4})
    for seed in range(40):
        rng = np.random.default_rng(seed)
        points = rng.uniform(-0.3, 0.3, (20_000, 3)) + np.array([0.0, 0.0, 0.31])
        flat = rng.random(len(points)) < 0.5
        points[flat, 2] = rng.normal(0, 0.5 * MM, flat.sum())
        above = Sensor("option", np.array([0, 0, 1.0]))
        assert support_plane.find_support_plane(Cloud(points), above, settings, 0) is not None
        shares.append(found[-1][0].share - flat.mean())
    assert np.std(shares) == ABOUT_1_PERCENT


def test_the_scatter_of_a_planes_cells() -> None:
    """Cells lie in rows, and their ripple is noise: here of a size of 1."""
    scatters = []
    for seed in range(300):
        ripple = np.random.default_rng(seed).normal(size=120_000)
        sample = ripple[spread_indices(len(ripple), support_plane.FINE_SAMPLE)]
        scatters.append(deviation(sample))
    assert np.mean(scatters) == pytest.approx(1, abs=0.01)
    assert np.std(scatters) == pytest.approx(0.0085, abs=0.0009)
