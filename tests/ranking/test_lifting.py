"""What friction it takes to lift, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.ranking.lifting import Load, friction_to_lift
from tests.by_hand import MM

PADS = np.array([[20 * MM, 20 * MM]])


def needs(mass_kg: float, arm_mm: float, beyond_mm: float = 300.0, force_n: float = 40.0) -> tuple[float, float]:
    load = Load(np.array([mass_kg]), np.array([[arm_mm * MM]]), np.array([beyond_mm * MM]))
    found = friction_to_lift(load, force_n, PADS, 100 * MM)
    return float(found.weight[0, 0]), float(found.turning[0, 0])


def test_two_pads_bear_the_weight_and_half_as_much_again() -> None:
    """1 kg weighs 9.81 N, and 14.7 N as it is lifted; two pads with 40 N each: friction 0.18."""
    assert needs(1.0, 0.0) == pytest.approx((0.1839, 0.0), rel=1e-3)


def test_a_pad_of_20_mm_squared_bears_a_torque_with_an_arm_of_7_6_mm() -> None:
    """The mean distance of a square's points from its middle is 0.3826 of its side."""
    x, y = np.meshgrid(*2 * [np.linspace(-10, 10, 401)])
    arm_mm = np.hypot(x, y).mean()
    assert needs(1.0, arm_mm)[1] == pytest.approx(9.80665 / 80, rel=0.01)


def test_what_turns_and_is_short_is_lifted_all_the_same() -> None:
    assert needs(1.0, 50.0, beyond_mm=99.0)[1] == 0.0
    assert needs(1.0, 50.0, beyond_mm=101.0)[1] > 0.5


def test_twice_the_force_takes_half_the_friction() -> None:
    assert np.multiply(2, needs(1.0, 30.0, force_n=80.0)) == pytest.approx(needs(1.0, 30.0))
