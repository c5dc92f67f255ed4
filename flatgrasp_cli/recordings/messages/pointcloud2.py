"""sensor_msgs/PointCloud2 and its predecessor sensor_msgs/PointCloud."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import ByteArray
from flatgrasp_cli.recordings.messages.decoded import (
    ROW_STEP_IGNORED,
    Assumption,
    Decoded,
    MessageError,
    frame_name,
    raw_bytes,
    reading,
    stamp_ns,
)
from flatgrasp_cli.recordings.messages.packed import PackedField, PackedPoints

TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""sensor_msgs/PointField.datatype."""


def decode_pointcloud2(message: Any, *, colors: bool = False) -> Decoded:
    """Decode a PointCloud2 of any legal layout.

    x, y, z may be of any type, at any offset and in any order, big endian or not, with padding between points and rows.
    Colours are rgb or rgba packed in 4 bytes, or r, g, b apart. Where the data is exactly that of the points, a
    row_step that says otherwise is ignored, which is told as an assumption.

    Raises
    ------
    MessageError
        If x, y or z is missing, a field lies outside its point, or the data is shorter than what the message declares.
        Nothing is allocated before that is known.
    """
    with reading("PointCloud2"):
        height, width, step = int(message.height), int(message.width), int(message.point_step)
        header = message.header
        stamp, frame = stamp_ns(header.stamp), frame_name(header.frame_id)
        if height * width == 0:
            return Decoded(np.empty((0, 3)), None, 0, (height, width), frame, stamp)
        data, assumptions = _rows(raw_bytes(message.data), (height, width), step, int(message.row_step))
        order = ">" if message.is_bigendian else "<"
        fields = {
            field.name: PackedField(int(field.offset), np.dtype(order + TYPES[field.datatype]))
            for field in reversed(message.fields)
            if field.datatype in TYPES
        }
        points, kept, rgb = PackedPoints(data, height * width, step, fields).unpack(colors=colors)
    return Decoded(
        points,
        rgb,
        dropped=height * width - len(points),
        shape=(height, width),
        frame_id=frame,
        stamp_ns=stamp,
        filled=kept if min(height, width) > 1 else None,
        assumptions=assumptions,
    )


def _rows(
    data: ByteArray, shape: tuple[int, int], step: int, row_step: int
) -> tuple[ByteArray, tuple[Assumption, ...]]:
    """The data with nothing between its rows, once it is known to hold the declared points; and what was assumed."""
    height, width = shape
    if min(shape) < 0:
        raise MessageError(f"declares {width} × {height} points")
    if step <= 0:
        raise MessageError(f"point_step is {step}")
    row = width * step
    if height == 1:
        row_step = row  # many publishers leave it unset: there is no second row to find
    if row_step != row and len(data) == height * row:
        return data, (ROW_STEP_IGNORED,)  # with padding there would be more
    if row_step < row:
        raise MessageError(f"row_step is {row_step}, but {width} points of {step} bytes need {row}")
    # the padding of the last row may be left out
    need = (height - 1) * row_step + row
    if len(data) < need:
        padding = f" in rows of {row_step} bytes" if row_step != row else ""
        raise MessageError(
            f"data has {len(data)} bytes, {width} × {height} points of {step} bytes{padding} need {need}"
        )
    if row_step == row:
        return data, ()
    rows: ByteArray = np.ndarray((height, row), np.uint8, data.data, 0, (row_step, 1))
    return rows.reshape(-1), ()


def decode_pointcloud(message: Any, *, colors: bool = False) -> Decoded:
    """Decode a sensor_msgs/PointCloud: a list of points, and channels, of which "rgb" holds colours.

    Raises
    ------
    MessageError
        If the colours are not as many as the points.
    """
    with reading("PointCloud"):
        header = message.header
        points = np.array([(p.x, p.y, p.z) for p in message.points], dtype=np.float64).reshape(-1, 3)
        finite = np.isfinite(points).all(axis=1)
        channel = next((c for c in message.channels if c.name in {"rgb", "rgba"}), None) if colors else None
        rgb = None
        if channel is not None:
            if len(channel.values) != len(points):
                raise MessageError(f"channel {channel.name} has {len(channel.values)} values for {len(points)} points")
            # the bits of a float32, as in PointCloud2
            packed = np.asarray(channel.values, dtype="<f4")[finite]
            rgb = packed.view(np.uint8).reshape(-1, 4)[:, 2::-1]
        kept = points[finite]
        stamp, frame = stamp_ns(header.stamp), frame_name(header.frame_id)
    return Decoded(kept, rgb, len(points) - len(kept), (1, len(points)), frame, stamp)
