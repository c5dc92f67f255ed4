"""What may be off: one set of samples, evenly spread, the same for the same seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli.profiles.uncertainty import Uncertainty
from flatgrasp_cli.ranking.errors import errors_of

MANY = replace(Uncertainty(), samples=2048)


@pytest.mark.parametrize(
    ("name", "spread"),
    [("across", 0.005), ("along", 0.005), ("height", 0.002), ("yaw", np.radians(5)), ("outline", 1.0)],
)
def test_what_is_normally_distributed_has_its_mean_and_spread(name: str, spread: float) -> None:
    values = getattr(errors_of(MANY, 0), name)
    assert values.mean() == pytest.approx(0, abs=0.01 * spread)
    assert values.std() == pytest.approx(spread, rel=0.02)
    assert np.mean(np.abs(values) < spread) == pytest.approx(0.6827, abs=0.01)


def test_what_is_evenly_distributed_fills_its_range() -> None:
    errors = errors_of(MANY, 0)
    for values, low, high in ((errors.density, 200.0, 1200.0), (errors.luck, 0.0, 1.0)):
        assert low <= values.min() < values.max() <= high
        assert np.quantile(values, [0.25, 0.5, 0.75]) == pytest.approx(
            low + (high - low) * np.array([0.25, 0.5, 0.75]), rel=0.02
        )


def test_no_two_of_them_go_together() -> None:
    errors = errors_of(MANY, 0)
    columns = [errors.across, errors.along, errors.height, errors.yaw, errors.outline, *errors.center.T]
    together = np.corrcoef([*columns, errors.density, errors.luck])
    assert np.abs(together - np.eye(len(together))).max() < 0.06


@pytest.mark.parametrize("seed", [0, 7])
def test_even_a_few_are_spread_evenly(seed: int) -> None:
    """Of 32, between three and seven have the miss in each quarter of its distribution along both axes of the plane;
    of as many drawn at random, none to thirteen.
    """
    errors = errors_of(replace(MANY, samples=32), seed)
    quarters = [np.digitize(values, np.array([-0.6745, 0, 0.6745]) * 0.005) for values in (errors.across, errors.along)]
    for quarter in quarters:
        assert 3 <= np.bincount(quarter, minlength=4).min() <= np.bincount(quarter, minlength=4).max() <= 13


def test_they_are_the_same_for_a_seed_and_others_for_another() -> None:
    first, again, other = (errors_of(Uncertainty(), seed) for seed in (3, 3, 4))
    for name in ("across", "yaw", "density", "luck"):
        assert getattr(first, name).tobytes() == getattr(again, name).tobytes()
        assert getattr(first, name).tolist() != getattr(other, name).tolist()


def test_the_first_of_many_are_those_of_few() -> None:
    """So that grasps which were tried briefly and others that were tried longer had the same luck."""
    few, many = errors_of(replace(MANY, samples=32), 0), errors_of(MANY, 0)
    assert few.across.tolist() == many.across[:32].tolist()


def test_what_is_switched_off_is_not_off() -> None:
    known = Uncertainty(position_m=0.0, height_m=0.0, yaw_deg=0.0, center_share=0.0)
    errors = errors_of(known, 0)
    for values in (errors.across, errors.along, errors.height, errors.yaw, errors.center):
        assert not values.any()
