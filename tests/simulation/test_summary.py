"""Wilson's interval against the table of Newcombe (Statistics in Medicine 17, 1998), and its limits."""

from __future__ import annotations

import pytest

from flatgrasp_cli.simulation.summary import wilson


@pytest.mark.parametrize(
    ("held", "trials", "expected"),
    [(81, 263, (0.2553, 0.3662)), (15, 148, (0.0624, 0.1605)), (0, 20, (0.0, 0.1611)), (1, 29, (0.0061, 0.1718))],
)
def test_intervals_are_newcombes(held: int, trials: int, expected: tuple[float, float]) -> None:
    assert wilson(held, trials) == pytest.approx(expected, abs=6e-5)


def test_it_stays_within_what_a_rate_can_be() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    assert wilson(10, 10)[1] == pytest.approx(1.0)
    assert 1 - wilson(7, 10)[0] == pytest.approx(wilson(3, 10)[1])
