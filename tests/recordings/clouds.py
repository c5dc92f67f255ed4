"""Points with known answers, and messages of them written field by field."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray

ROS_TYPES = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
NAN, INF = np.nan, np.inf
record = SimpleNamespace

POINTS = np.array([[1, 2, 3], [-4, 5, 0.5], [0, 0, 0], [7, -8, 9], [NAN, NAN, NAN], [1, INF, 2]], dtype=float)
FINITE = POINTS[:4]
PIXEL = 0x00_AB_CD_EF  # as R G B: 171 205 239
HEADER = record(stamp=record(sec=3, nanosec=7), frame_id="/camera")


def cloud2(
    points: FloatArray,
    fields: dict[str, tuple[int, str]],
    step: int,
    rows: tuple[int, int] | None = None,
    padding: int = 0,
    *,
    big: bool = False,
    columns: dict[str, Any] | None = None,
) -> Any:
    """A PointCloud2 written field by field, struct by struct: slow and plain."""
    height, width = rows or (1, len(points))
    row_step = width * step + padding
    data = bytearray(b"\xff" * (height * row_step))
    values = {**dict(zip("xyz", points.T, strict=True)), **(columns or {})}
    for i in range(len(points)):
        begin = (i // width) * row_step + (i % width) * step
        for name, (offset, kind) in fields.items():
            item = np.array([values[name][i]]).astype(np.dtype(kind).newbyteorder(">" if big else "<"))
            data[begin + offset : begin + offset + item.itemsize] = item.tobytes()
    return record(
        header=HEADER,
        height=height,
        width=width,
        fields=[record(name=n, offset=o, datatype=ROS_TYPES[k], count=1) for n, (o, k) in fields.items()],
        is_bigendian=big,
        point_step=step,
        row_step=row_step,
        data=np.frombuffer(bytes(data), np.uint8),
        is_dense=False,
    )


XYZ = {"x": (0, "f4"), "y": (4, "f4"), "z": (8, "f4")}
