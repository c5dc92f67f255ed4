"""The records of one element of a PLY file: as many as the header says, or an error; never more memory than the file.

Where all lists of a property are equally long, as those of triangles, records are a plain table and numpy reads them;
otherwise they are walked one by one.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.ascii_rows import parsed_rows, read_columns
from flatgrasp_cli.sources.ply_header import PlyElement, PlyHeader

STRUCT_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One property of all records: `values` one after another, `sizes` (records,) how many of them each has."""

    values: NDArray[Any]
    sizes: NDArray[np.int64]


@dataclass(slots=True, eq=False)
class _Growing:
    """A column that is filled record by record."""

    values: array[float] = field(default_factory=lambda: array("d"))
    sizes: array[int] = field(default_factory=lambda: array("q"))

    def add(self, entries: Sequence[float]) -> None:
        self.values.extend(entries)
        self.sizes.append(len(entries))

    def column(self) -> Column:
        return Column(np.array(self.values, dtype=np.float64), np.array(self.sizes, dtype=np.int64))


def read_element(
    file: BinaryIO, header: PlyHeader, element: PlyElement, wanted: Sequence[int], name: str
) -> list[Column]:
    """The columns of the properties at the places `wanted`; the file, which stands at the element, is left behind it.

    Of a text file the lines must end in LF.

    Raises
    ------
    SourceError
        If there are fewer records than declared, or they are malformed.
    """
    if element.count == 0 or not element.properties:
        return [Column(np.empty(0), np.empty(0, dtype=np.int64)) for _ in wanted]
    if header.format == "ascii":
        return _read_text(file, element, wanted, name)
    order = ">" if header.format == "binary_big_endian" else "<"
    if element.has_lists:
        return _read_lists(file, element, wanted, order, name)
    dtype = np.dtype([(f"p{k}", order + item.code) for k, item in enumerate(element.properties)])
    need, have = element.count * dtype.itemsize, _left(file)
    if need > have:
        raise _truncated(element, name)
    if not wanted:
        file.seek(need, 1)
        return []
    records = np.frombuffer(file.read(need), dtype=dtype)
    return [_column(records, place) for place in wanted]


def _left(file: BinaryIO) -> int:
    """How many bytes follow."""
    here = file.tell()
    size = file.seek(0, 2)
    file.seek(here)
    return size - here


def _truncated(element: PlyElement, name: str) -> SourceError:
    kind = "points" if element.name == "vertex" else f"records of {element.name!r}"
    return SourceError(
        f"{name}: the header declares {element.count} {kind}, which go beyond the end of the file; it is truncated or "
        "its header is wrong"
    )


def _grown(wanted: Sequence[int], records: Iterator[list[Sequence[float]]]) -> list[Column]:
    """Columns of records, each of which has the entries of every property."""
    growing = [_Growing() for _ in wanted]
    for record in records:
        for place, column in zip(wanted, growing, strict=True):
            column.add(record[place])
    return [column.column() for column in growing]


def _read_text(file: BinaryIO, element: PlyElement, wanted: Sequence[int], name: str) -> list[Column]:
    if not element.has_lists:
        columns = read_columns(file, element.count, len(element.properties), wanted, name)
        return [Column(column, np.ones(len(column), dtype=np.int64)) for column in columns]

    def parse(numbers: list[float]) -> list[Sequence[float]] | None:
        record: list[Sequence[float]] = []
        place = 0
        for item in element.properties:
            size = 1
            if item.count_code:
                if place >= len(numbers) or not numbers[place] >= 0 or not numbers[place].is_integer():
                    return None
                size = int(numbers[place])
                place += 1
            record.append(numbers[place : place + size])
            place += size
        return record if place == len(numbers) else None

    return _grown(wanted, parsed_rows(file, element.count, parse, name, f"a {element.name} as its header says"))


def _read_lists(file: BinaryIO, element: PlyElement, wanted: Sequence[int], order: str, name: str) -> list[Column]:
    begin = file.tell()
    data = file.read()
    table = _table(data, element, order)
    if table is not None:
        file.seek(begin + table.nbytes)
        return [_column(table, place) for place in wanted]
    walk = _Walk(data, element, order, frozenset(wanted))
    try:
        columns = _grown(wanted, walk.records())
    except (struct.error, IndexError) as error:
        raise _truncated(element, name) from error
    except ValueError as error:
        raise SourceError(f"{name}: a {element.name} is malformed: {error}") from error
    file.seek(begin + walk.place)
    return columns


def _table(data: bytes, element: PlyElement, order: str) -> NDArray[np.void] | None:
    """The records, if they all have lists as long as the first one's."""
    walk = _Walk(data, element, order, frozenset(range(len(element.properties))))
    try:
        first = next(walk.records())
    except (struct.error, IndexError, ValueError):
        return None
    if element.count * walk.place > len(data):
        return None
    fields: list[Any] = []
    for k, (item, entries) in enumerate(zip(element.properties, first, strict=True)):
        if item.count_code:
            fields += [(f"n{k}", order + item.count_code), (f"p{k}", order + item.code, (len(entries),))]
        else:
            fields.append((f"p{k}", order + item.code))
    table = np.frombuffer(data, dtype=np.dtype(fields), count=element.count)
    alike = (
        (table[f"n{k}"] == len(entries)).all()
        for k, (item, entries) in enumerate(zip(element.properties, first, strict=True))
        if item.count_code
    )
    return table if all(alike) else None


def _column(table: NDArray[np.void], place: int) -> Column:
    values = table[f"p{place}"]
    size = values.shape[1] if values.ndim > 1 else 1
    return Column(values.reshape(-1), np.broadcast_to(np.int64(size), len(table)))


class _Walk:
    """Goes through the binary records of an element one by one; `place` is where it has come to in `data`."""

    def __init__(self, data: bytes, element: PlyElement, order: str, wanted: frozenset[int]) -> None:
        self.place = 0
        self._data, self._element, self._order, self._wanted = data, element, order, wanted

    def records(self) -> Iterator[list[Sequence[float]]]:
        """The entries of every property of each record, none for those that are not wanted.

        Raises
        ------
        struct.error, IndexError
            If the data end within a record.
        ValueError
            If a list has less than no entries.
        """
        steps = [
            (
                struct.Struct(self._order + STRUCT_CODES[item.count_code or item.code]),
                STRUCT_CODES[item.code] if item.count_code else "",
                int(item.code[1:]),
                k in self._wanted,
            )
            for k, item in enumerate(self._element.properties)
        ]
        data, order = self._data, self._order
        for _ in range(self._element.count):
            record: list[Sequence[float]] = []
            place = self.place
            for head, code, size, is_wanted in steps:
                entries: Sequence[float] = head.unpack_from(data, place)
                place += head.size
                if code:
                    count = int(entries[0])
                    if count < 0:
                        raise ValueError(f"it has a list of {count} entries")
                    end = place + count * size
                    if end > len(data):
                        raise IndexError
                    entries = struct.unpack_from(f"{order}{count}{code}", data, place) if is_wanted else ()
                    place = end
                record.append(entries)
            self.place = place
            yield record
