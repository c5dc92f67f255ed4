"""Depth that no arm reaches is a hint that a count is not what the encoding says."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.sources.depth_unit import unit_warning


@pytest.mark.parametrize(
    ("unit_m", "depth_m", "said"),
    [
        (1e-3, 0.8, None),
        (1e-3, 8.0, "millimetres"),
        (1e-3, 0.04, "millimetres"),
        (1.0, 0.8, None),
        (1.0, 800.0, "metres"),
    ],
)
def test_depth_that_no_arm_reaches_is_a_hint_at_the_unit(unit_m: float, depth_m: float, said: str | None) -> None:
    depth = np.full(48, depth_m)
    warning = unit_warning(depth, unit_m)
    if said is None:
        assert warning is None
    else:
        assert warning is not None
        assert warning.code == "depth_unit_assumed"
        assert f"taken to be in {said}," in warning.text
        assert "--depth-unit" in warning.text
    depth[:4] = 1.0  # a twelfth of the picture is near enough
    assert unit_warning(depth, unit_m) is None


def test_no_depth_at_all_is_no_hint() -> None:
    assert unit_warning(np.empty(0), 1e-3) is None
