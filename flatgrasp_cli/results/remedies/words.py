"""Numbers in the words of remedies."""

from __future__ import annotations

import math


def mm(length_m: float) -> str:
    """A length in millimetres, three digits."""
    return f"{1e3 * length_m:.3g} mm"


def down(value: float, digits: int = 2) -> str:
    """A number rounded down, so that as a least value it is kept."""
    return f"{math.floor(value * 10**digits) / 10**digits:g}"


def up(value: float, digits: int = 2) -> str:
    """A number rounded up, so that as a limit it is kept."""
    return f"{math.ceil(value * 10**digits) / 10**digits:g}"
