"""Polygons as people have them: a JSON list of [x, y], or of such lists with holes after the outline, or CSV."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import signed_area

SUFFIXES = (".json", ".csv", ".txt")
MAX_BYTES = 10_000_000


def is_polygon(source: str) -> bool:
    """Whether a path names a polygon and not a cloud, by its suffix."""
    return Path(source).suffix.lower() in SUFFIXES


def read_polygon(source: str) -> tuple[FloatArray, ...]:
    """Read loops (n_l, 2), the outline first and counter-clockwise, holes after it and clockwise.

    Raises
    ------
    SourceError
        If the file holds no such lists of numbers, an outline of less than three corners, or one that crosses itself.
    """
    try:
        if Path(source).stat().st_size > MAX_BYTES:
            raise SourceError(f"{source}: is too large for a polygon")
        text = Path(source).read_text(encoding="utf-8")
        loops = _from_json(text) if text.lstrip().startswith("[") else [_from_csv(text)]
    except OSError as error:
        raise SourceError(f"{source}: cannot be read: {error.strerror or error}") from error
    except (ValueError, TypeError, RecursionError) as error:
        raise SourceError(
            f"{source}: is no polygon: a JSON list of [x, y], or CSV of x,y is wanted ({error})"
        ) from error
    loops = [loop[:-1] if len(loop) > 1 and np.array_equal(loop[0], loop[-1]) else loop for loop in loops]
    for loop in loops:
        if loop.ndim != 2 or loop.shape[1:] != (2,) or len(loop) < 3 or not np.isfinite(loop).all():
            raise SourceError(f"{source}: is no polygon: every loop needs three or more corners of two finite numbers")
    _check_simple(source, loops)
    return tuple(_turned(loop, clockwise=k > 0) for k, loop in enumerate(loops))


def _check_simple(source: str, loops: list[FloatArray]) -> None:
    """Refuse loops that have no inside, and say where."""
    import shapely

    reason = shapely.is_valid_reason(shapely.Polygon(loops[0], loops[1:]))
    if reason != "Valid Geometry":
        text, _, place = str(reason).rstrip("]").partition("[")
        at = f" at {place}" if place else ""
        raise SourceError(f"{source}: is no simple polygon: {text.lower()}{at}")


def _from_json(text: str) -> list[FloatArray]:
    values: Any = json.loads(text)
    nested = bool(values) and isinstance(values[0], list) and bool(values[0]) and isinstance(values[0][0], list)
    return [np.array(loop, dtype=np.float64) for loop in (values if nested else [values])]


def _from_csv(text: str) -> FloatArray:
    rows = [line.replace(";", ",").split(",") for line in text.splitlines() if line.strip() and line.strip()[0] != "#"]
    if rows and not _is_number(rows[0][0]):
        rows = rows[1:]  # a heading
    return np.array([[float(cell) for cell in row] for row in rows], dtype=np.float64)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _turned(loop: FloatArray, *, clockwise: bool) -> FloatArray:
    return loop[::-1] if (signed_area(loop) < 0) != clockwise else loop
