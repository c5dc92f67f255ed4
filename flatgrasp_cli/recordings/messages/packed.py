"""Points packed as records of equal size, each field at its own offset: what PointCloud2 and Foxglove share.

Decoding is bound by memory, not by arithmetic, and runs for every frame of a recording. So the usual layout, x, y and z
as float32 within 16 bytes, goes block by block through the cache: records are picked 16 bytes at a time, and turned to
float64 once, where they stay. Every other layout goes column by column.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray
from flatgrasp_cli.recordings.messages.decoded import MessageError

BLOCK = 32_768
"""Points in a block: large enough that calls cost nothing, small enough that it is in the cache when read again."""
WINDOW = 16
"""numpy moves items of 16 bytes fastest, and x, y, z as float32 fit in."""
PACKED_COLORS = ("rgb", "rgba")
SEPARATE_COLORS = (("r", "g", "b"), ("red", "green", "blue"))


@dataclass(frozen=True, slots=True)
class PackedField:
    """Where in each record a field begins, and its type, byte order included."""

    offset: int
    dtype: np.dtype[Any]


@dataclass(frozen=True, slots=True, eq=False)
class PackedPoints:
    """`count` records of `stride` bytes each in `data` (≥ count · stride,), which whoever makes this has checked."""

    data: ByteArray
    count: int
    stride: int
    fields: Mapping[str, PackedField]

    def check(self) -> None:
        """Raise `MessageError` unless x, y, z and the colours lie within the records."""
        missing = [axis for axis in "xyz" if axis not in self.fields]
        if missing:
            names = ", ".join(self.fields) or "none"
            raise MessageError(f"has no field {' or '.join(missing)} of a known type; its fields: {names}")
        for name in ("x", "y", "z", *PACKED_COLORS, *sum(SEPARATE_COLORS, ())):
            place = self.fields.get(name)
            if place and not 0 <= place.offset <= self.stride - place.dtype.itemsize:
                raise MessageError(
                    f"field {name} takes {place.dtype.itemsize} bytes at offset {place.offset}, "
                    f"but a point has {self.stride} bytes"
                )

    def column(self, name: str, dtype: Any = None) -> NDArray[Any]:
        """The values (count,) of a field, a view; `dtype` sees its bytes as another type."""
        place = self.fields[name]
        return self._view(place.offset, dtype or place.dtype)

    def _view(self, offset: int, dtype: Any) -> NDArray[Any]:
        return np.ndarray((self.count,), dtype, self.data.data, offset, (self.stride,))

    def unpack(self, *, colors: bool) -> tuple[FloatArray, BoolArray, ByteArray | None]:
        """The finite points (n, 3), which of the records (count,) they are, and if asked for their RGB (n, 3)."""
        self.check()
        window = self._window()
        points, kept = self._by_column() if window is None else self._by_window(window)
        return points, kept, self._colors(kept) if colors else None

    def _window(self) -> int | None:
        """Offset of 16 bytes of the record that hold x, y, z as native float32; None if there are none."""
        places = [self.fields[axis] for axis in "xyz"]
        begin = min(self.stride - WINDOW, *(place.offset for place in places))
        usual = begin >= 0 and all(
            place.dtype == np.float32
            and (place.offset - begin) % 4 == 0
            and place.offset + place.dtype.itemsize <= begin + WINDOW
            for place in places
        )
        return begin if usual else None

    def _by_column(self) -> tuple[FloatArray, BoolArray]:
        columns = [self.column(axis) for axis in "xyz"]
        kept = np.isfinite(columns[0])
        for column in columns[1:]:
            kept &= np.isfinite(column)
        points = np.empty((np.count_nonzero(kept), 3))
        for axis, column in enumerate(columns):
            points[:, axis] = column[kept]
        return points, kept

    def _by_window(self, begin: int) -> tuple[FloatArray, BoolArray]:
        """As `_by_column`, faster, for x, y, z among the four float32 at `begin`."""
        ix, iy, iz = ((self.fields[axis].offset - begin) // 4 for axis in "xyz")
        windows = self._view(begin, np.complex128)  # any type of 16 bytes
        points, kept = np.empty((self.count, 3)), np.empty(self.count, np.bool_)
        # one pass over both where y follows x: a complex number is a pair of floats
        pairs = np.ndarray((self.count,), np.complex128, points.data, 0, (points.strides[0],)) if iy == ix + 1 else None
        # whether four floats are finite is four bytes of 0 or 1; compared at once, the fourth left out
        wanted = np.array([slot in (ix, iy, iz) for slot in range(4)]).view(np.uint32)[0]
        block = np.empty(min(BLOCK, self.count), windows.dtype)
        finite = np.empty(4 * len(block), np.bool_)
        end = 0
        for start in range(0, self.count, BLOCK):
            part = kept[start : start + BLOCK]
            here, flags = block[: len(part)], finite[: 4 * len(part)]
            here[...] = windows[start : start + BLOCK]
            np.isfinite(here.view(np.float32), out=flags)
            packed_flags = flags.view(np.uint32)
            packed_flags &= wanted
            np.equal(packed_flags, wanted, out=part)
            values = here[part].view(np.float32).reshape(-1, 4)
            out = slice(end, end + len(values))
            if pairs is None:
                points[out, 0], points[out, 1] = values[:, ix], values[:, iy]
            else:
                pairs[out] = values[:, ix : ix + 2].view(np.complex64)[:, 0]
            points[out, 2] = values[:, iz]
            end = out.stop
        return points[:end], kept

    def _colors(self, kept: BoolArray) -> ByteArray | None:
        for name in PACKED_COLORS:
            place = self.fields.get(name)
            if place and place.dtype.itemsize == 4:
                # 0xAARRGGBB, whatever type the field claims: as bytes B G R A, or A R G B in big endian
                parts = self.column(name, np.uint32)[kept].view(np.uint8).reshape(-1, 4)
                big = place.dtype == place.dtype.newbyteorder(">")
                return np.asarray(parts[:, 1:] if big else parts[:, 2::-1])
        for names in SEPARATE_COLORS:
            if all(name in self.fields for name in names):
                return np.column_stack([_as_bytes(self.column(name)[kept]) for name in names])
        return None


def _as_bytes(values: NDArray[Any]) -> ByteArray:
    """One colour channel (n,) as 0 to 255; floats are 0 to 1."""
    if values.dtype.kind == "f":
        values = np.rint(255.0 * np.nan_to_num(values.astype(np.float64), posinf=1.0))
    return np.asarray(np.clip(values, 0, 255), dtype=np.uint8)
