"""Polygons as people have them: a JSON list of [x, y], or of such lists with holes after the outline, or CSV."""

from __future__ import annotations

import re
import sys
from contextlib import nullcontext
from functools import cache
from io import BufferedReader
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import signed_area
from flatgrasp_cli.source_names import STDIN, name_of

SUFFIXES = (".json", ".csv", ".txt")
MAX_BYTES = 10_000_000
MAX_CORNERS = 20_000
"""Of all loops: simplifying that many takes a second, and it grows with their square."""
MAX_LOOPS = 100
"""Every loop keeps eight corners, and caging has a thousand at most."""
LARGEST = 1e9
"""In any unit: products of four coordinates stay far within what a double holds."""
SMALLEST = 1e-9
"""Of the outline's longer side, in any unit, for the same reason."""
SMALLEST_SHARE = 1e-7
"""Of the outline's longer side in its farthest coordinate: beyond that doubles leave its edges no directions."""
SAME_SHARE = 1e-9
"""Corners no farther apart than this share of the outline's longer side are one."""

Coordinate = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
Corner = tuple[Coordinate, Coordinate]
Loop = Annotated[list[Corner], Field(min_length=3, max_length=MAX_CORNERS)]
Loops = Annotated[list[Loop], Field(min_length=1, max_length=MAX_LOOPS)]
NESTED = re.compile(rb"\s*\[\s*\[\s*\[")


BEGINS = re.compile(rb"(\xef\xbb\xbf)?\s*(\[|([-+.\deE]+|[xX])\s*[,;])")
"""A list, or a line of CSV, be it the heading: no cloud and no mesh begins so."""


def is_polygon(source: str) -> bool:
    """Whether a source is a polygon and not a cloud: a file by its suffix, standard input by how it begins."""
    if source == STDIN:
        given = None if sys.stdin is None else sys.stdin.buffer
        return isinstance(given, BufferedReader) and BEGINS.match(given.peek()) is not None
    return Path(source).suffix.lower() in SUFFIXES


def read_polygon(source: str) -> tuple[FloatArray, ...]:
    """Read loops (n_l, 2), the outline first and counter-clockwise, holes after it and clockwise, of a file or "-".

    Raises
    ------
    SourceError
        If the file holds no such lists of numbers, an outline of less than three corners, or one that crosses itself;
        or if it has too many corners, or coordinates too large or too small to reckon with.
    """
    content = _content(source)
    source = name_of(source)
    try:
        is_json = source.lower().endswith(".json") or content.lstrip().startswith(b"[")
        values = _from_json(content) if is_json else [_from_csv(content.decode("utf-8"))]
    except ValidationError as error:
        raise SourceError(f"{source}: is no polygon: {_explain(error)}") from error
    except ValueError as error:
        raise SourceError(
            f"{source}: is no polygon: a JSON list of [x, y], or CSV of x,y is wanted ({error})"
        ) from error
    loops = [np.array(loop) for loop in values]
    size = _checked_size(source, loops)
    loops = [_apart(loop, SAME_SHARE * size) for loop in loops]
    _check_simple(source, loops)
    return tuple(_turned(loop, clockwise=k > 0) for k, loop in enumerate(loops))


def _content(source: str) -> bytes:
    """The file's bytes, without a byte order mark."""
    try:
        with nullcontext(sys.stdin.buffer) if source == STDIN else Path(source).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise SourceError(f"{source}: cannot be read: {error.strerror or error}") from error
    if len(content) > MAX_BYTES:
        raise SourceError(f"{source}: is too large for a polygon: {MAX_BYTES} bytes are the most")
    return content.removeprefix(b"\xef\xbb\xbf")


def _checked_size(source: str, loops: list[FloatArray]) -> float:
    """The outline's longer side; refuses more corners than can be worked on, and a side too small to reckon with."""
    count = sum(map(len, loops))
    if count > MAX_CORNERS:
        raise SourceError(f"{source}: has {count} corners, {MAX_CORNERS} are the most; simplify it first")
    size, farthest = float(np.ptp(loops[0], axis=0).max()), float(np.abs(loops[0]).max())
    if size < max(SMALLEST, SMALLEST_SHARE * farthest):
        raise SourceError(
            f"{source}: is only {size:g} long, with coordinates up to {farthest:g}: too small to reckon with; "
            "give it in a smaller unit, and nearer to the origin"
        )
    return size


def _apart(loop: FloatArray, least: float) -> FloatArray:
    """The loop without corners that lie within `least` of the one before, as the first does of a closed loop's last."""
    kept = [loop[0]]
    for corner in loop[1:]:
        if np.abs(corner - kept[-1]).max() > least:
            kept.append(corner)
    while len(kept) > 1 and np.abs(kept[-1] - kept[0]).max() <= least:
        kept.pop()
    return np.array(kept)


def _check_simple(source: str, loops: list[FloatArray]) -> None:
    """Refuse loops that have no inside, and say where."""
    import shapely

    if any(len(loop) < 3 for loop in loops):
        raise SourceError(f"{source}: is no polygon: every loop needs three corners that lie apart")
    reason = shapely.is_valid_reason(shapely.Polygon(loops[0], loops[1:]))
    if reason != "Valid Geometry":
        text, _, place = str(reason).rstrip("]").partition("[")
        at = f" at {place}" if place else ""
        raise SourceError(f"{source}: is no simple polygon: {text.lower()}{at}")


@cache
def _adapter(nested: bool) -> TypeAdapter[Any]:
    return TypeAdapter(Loops if nested else Loop)


def _from_json(content: bytes) -> list[list[Corner]]:
    nested = NESTED.match(content) is not None
    values = _adapter(nested).validate_json(content, strict=True)
    return values if nested else [values]


def _from_csv(text: str) -> list[Corner]:
    rows = [line.replace(";", ",").split(",") for line in text.splitlines() if line.strip() and line.strip()[0] != "#"]
    if rows and not _is_number(rows[0][0]):
        rows = rows[1:]  # a heading
    corners: list[Corner] = _adapter(nested=False).validate_python([[float(cell) for cell in row] for row in rows])
    return corners


def _explain(error: ValidationError) -> str:
    """The first fault in words: where, and what is wanted."""
    problem = error.errors(include_url=False)[0]
    places = problem["loc"]
    names = ("loop", "corner", "coordinate")[3 - len(places) if len(places) > 2 else 1 :]
    where = ", ".join(f"{name} {place}" for name, place in zip(names, places, strict=False))
    text = problem["msg"].replace("Input should be", "must be").replace("List should have", "must have")
    text = text.replace(" after validation", "")
    return f"{where}: {text}" if where else f"{text}; a JSON list of [x, y], or CSV of x,y is wanted"


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _turned(loop: FloatArray, *, clockwise: bool) -> FloatArray:
    return loop[::-1] if (signed_area(loop) < 0) != clockwise else loop
