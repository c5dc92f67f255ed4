"""Numbers as documents have them: finite, and of no more digits than mean something."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

DECIMALS = 9
"""A nanometre, and well below what a double holds of a scene's coordinates."""


def number(value: float | None) -> Any:
    """A rounded number, or None for what JSON cannot hold."""
    return None if value is None or not math.isfinite(value) else float(round(value, DECIMALS) + 0.0)  # no −0.0


def rounded(record: dict[str, Any]) -> dict[str, Any]:
    """A record with its numbers rounded, those of records in it, too."""
    return {
        key: rounded(value) if isinstance(value, dict) else number(value) if isinstance(value, float) else value
        for key, value in record.items()
    }


def numbers(values: Any) -> Any:
    """A nested list of rounded numbers."""
    return (np.round(values, DECIMALS) + 0.0).tolist()
