"""foxglove.PointCloud: as JSON, as protobuf, and as the ROS message foxglove_msgs/PointCloud."""

from __future__ import annotations

import base64
import binascii
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.recordings.messages.decoded import (
    Decoded,
    MessageError,
    frame_name,
    raw_bytes,
    reading,
    stamp_ns,
    unit_quaternion,
)
from flatgrasp_cli.recordings.messages.packed import PackedField, PackedPoints

TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<f4", 8: "<f8"}
"""foxglove.PackedElementField's NumericType: signed and unsigned are the other way round than in ROS."""


def decode_foxglove(message: Any, *, colors: bool = False) -> Decoded:
    """Decode a foxglove.PointCloud; its `pose` brings the points into `frame_id` and is where they are seen from.

    Raises
    ------
    MessageError
        If x, y or z is missing, a field lies outside its point, or the data is no whole number of points.
    """
    with reading("foxglove.PointCloud"):
        data, stride = _data(message.data), int(message.point_stride)
        stamp, frame_id = stamp_ns(message.timestamp), frame_name(message.frame_id)
        pose = _pose(getattr(message, "pose", None))
        viewpoint = None if pose is None else pose.origin
        if len(data) == 0:
            return Decoded(np.empty((0, 3)), None, 0, (1, 0), frame_id, stamp, viewpoint=viewpoint)
        if stride <= 0:
            raise MessageError(f"point_stride is {stride}")
        if len(data) % stride:
            raise MessageError(f"data has {len(data)} bytes, which is no whole number of points of {stride} bytes")
        fields = {
            field.name: PackedField(int(field.offset), np.dtype(TYPES[field.type]))
            for field in reversed(message.fields)
            if field.type in TYPES
        }
        count = len(data) // stride
        points, _, rgb = PackedPoints(data, count, stride, fields).unpack(colors=colors)
    dropped = count - len(points)
    if pose is not None:
        points = pose.to_world(points)
    return Decoded(points, rgb, dropped, (1, count), frame_id, stamp, viewpoint=viewpoint)


def _data(data: Any) -> ByteArray:
    """The bytes: JSON holds them as base64."""
    if not isinstance(data, str):
        return raw_bytes(data)
    try:
        return raw_bytes(base64.b64decode(data, validate=True))
    except binascii.Error as error:
        raise MessageError(f"data is not base64: {error}") from error


def _pose(pose: Any) -> Frame | None:
    """The cloud's frame in its frame of reference; None for the identity, which an unset pose means."""
    position = _values(getattr(pose, "position", None), "xyz")
    quaternion = _values(getattr(pose, "orientation", None), "xyzw")
    if not (np.isfinite(position).all() and np.isfinite(quaternion).all()):
        raise MessageError("its pose is not finite")
    if not position.any() and not quaternion[:3].any():
        return None
    unit = unit_quaternion(quaternion)
    return Frame(position, np.eye(3) if unit is None else axes_from_quaternion(unit))


def _values(record: Any, names: str) -> FloatArray:
    """Named numbers of a record; those not set are 0, as in protobuf."""
    return np.array([getattr(record, name, 0.0) for name in names], dtype=np.float64)
