"""What friction it takes to lift, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.ranking.lifting import Load, Needs, friction_to_lift
from tests.by_hand import MM

QUARTER = np.pi / 2


def needs(
    mass_kg: float,
    arm_mm: float,
    beyond_mm: float = 300.0,
    force_n: float = 40.0,
    pads_mm: tuple[float, float] = (20.0, 20.0),
) -> Needs:
    """Of a flat object that is held at its box's centre, and whose weight pulls beside that to both sides."""
    wide, high = pads_mm[0] * MM, pads_mm[1] * MM
    grips = np.array([[0.0, 0.0, 0.0, 1.0, -0.5 * high, wide, high]])
    load = Load(
        size=np.array([2 * beyond_mm * MM, 20 * MM, 0.0]),
        middle=np.zeros(2),
        pulls=np.array([[arm_mm * MM, arm_mm * MM]]),
        mass=np.array([mass_kg]),
        down=np.array([0.0, 0.0, -1.0]),
    )
    return friction_to_lift(load, np.array([[[0.0, 0.0, 0.0, 1.0, 0.03]]]), grips, force_n, 100 * MM)


def test_two_pads_bear_the_weight_and_half_as_much_again() -> None:
    """1 kg weighs 9.81 N, and 14.7 N as it is lifted; two pads with 40 N each: friction 0.18."""
    found = needs(1.0, 0.0)
    assert (found.weight[0], found.turning[0, 0]) == pytest.approx((0.1839, 0.0), rel=1e-3)


@pytest.mark.parametrize(("wide_mm", "high_mm"), [(20.0, 20.0), (22.0, 4.0), (10.0, 30.0)])
def test_a_pad_bears_a_torque_with_the_arm_that_its_points_have_on_average(wide_mm: float, high_mm: float) -> None:
    """The mean distance from its middle: 7.7 mm of a square of 20 mm, 5.7 mm of a strip of 22 mm × 4 mm."""
    places = [np.linspace(-0.5, 0.5, 401) * side for side in (wide_mm, high_mm)]
    arm_mm = float(np.hypot(*np.meshgrid(*places)).mean())
    found = needs(1.0, arm_mm, pads_mm=(wide_mm, high_mm))
    assert found.turning[0, 0] == pytest.approx(9.80665 / 80, rel=0.01)
    assert found.slide[0, 0] == pytest.approx(arm_mm * MM * QUARTER, rel=0.01)


@pytest.mark.parametrize(
    ("arm_mm", "beyond_mm", "may_turn"), [(49, 80, True), (51, 80, False), (149, 300, True), (151, 300, False)]
)
def test_what_turns_must_come_up_by_half(arm_mm: float, beyond_mm: float, may_turn: bool) -> None:
    """Lifted by 10 cm: what is shorter than that hangs free, all else is a lever about its far end."""
    assert np.isfinite(needs(1.0, arm_mm, beyond_mm=beyond_mm).slide[0, 0]) == may_turn


def test_pads_that_are_tilted_press_higher_and_lower_by_what_the_torque_takes() -> None:
    """9.81 N at an arm of 60 mm: each pad's 40 N move by 7.36 mm up or down, 14.7 mm apart."""
    assert needs(1.0, 60.0).tilt[0, 0] == pytest.approx(14.71 * MM, rel=1e-3)


def test_twice_the_force_takes_half_the_friction() -> None:
    strong, weak = needs(1.0, 30.0, force_n=80.0), needs(1.0, 30.0)
    for name in ("weight", "turning", "tilt"):
        assert 2 * getattr(strong, name) == pytest.approx(getattr(weak, name))
    assert strong.slide == pytest.approx(weak.slide)  # how far it slides for a share of the friction
