"""Pairs of finger candidates: compiled, as written, and by a plain twin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import pairs
from tests.kernels.interpreted import interpreted

seeds = st.integers(0, 999)


def candidates(seed: int, count: int = 14) -> tuple[FloatArray, FloatArray, IntArray]:
    """Contacts, directions, jaws; some of the contacts and directions are the same."""
    rng = np.random.default_rng(seed)
    contact = rng.uniform(-0.1, 0.1, (count, 2))[rng.integers(0, count, count)]
    angle = rng.integers(0, 16, count) * np.pi / 8
    jaw = rng.integers(0, 2, count) if seed % 2 else np.full(count, -1)
    return contact, np.column_stack([np.cos(angle), np.sin(angle)]), jaw


def plain(contact: FloatArray, direction: FloatArray, jaw: IntArray, facing: bool) -> dict[tuple[int, int], float]:
    """γ of all pairs by the definitions, in degrees."""
    found = {}
    for i, j in np.argwhere((jaw[:, None] != 1) & (jaw != 0)).tolist():
        apart = contact[j] - contact[i]
        if (jaw[i] < 0 and i >= j) or (facing and not (direction[i] @ apart > 0 > direction[j] @ apart)):
            continue
        found[i, j] = float(np.degrees(np.arccos(np.clip(-direction[i] @ direction[j], -1, 1))))
    return found


@given(seed=seeds, facing=st.booleans(), limit_deg=st.sampled_from([10.0, 25.0, 100.0, 180.0]))
def test_they_are_those_of_the_definitions(seed: int, facing: bool, limit_deg: float) -> None:
    arguments = candidates(seed)
    gamma_deg = plain(*arguments, facing)
    named = pairs.balanced(*arguments, facing, limit_deg, np.zeros(2, dtype=np.intp)).T.tolist()
    small = [list(pair) for pair, gamma in gamma_deg.items() if gamma <= limit_deg]
    if small or not gamma_deg:
        assert named == small
    else:  # the nearest miss; others may be as near but for rounding
        assert named
        assert max(gamma_deg[i, j] for i, j in named) == pytest.approx(min(gamma_deg.values()), abs=1e-5)


@given(seed=seeds)
def test_compiled_and_as_written_they_are_the_same(seed: int) -> None:
    contact, direction, jaw = candidates(seed)
    counts, twin_counts = np.zeros(2, dtype=np.intp), np.zeros(2, dtype=np.intp)
    found = pairs.balanced(contact, direction, jaw, True, 30.0, counts)
    twin = interpreted("pairs")
    assert np.array_equal(found, twin.balanced(contact, direction, jaw, True, 30.0, twin_counts))
    assert np.array_equal(counts, twin_counts)
    assert pairs.weighed(contact, direction, found) == pytest.approx(twin.weighed(contact, direction, found), rel=1e-12)
