"""Depth images and their cameras, and the pinhole equation pixel by pixel."""

from __future__ import annotations

import struct
from typing import Any

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages import (
    DepthCameras,
)
from tests.recordings.clouds import HEADER, record

WIDTH, HEIGHT, F, CX, CY = 8, 6, 10.0, 3.5, 2.5
NO_ROI = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0, "do_rectify": False}
IMAGE, INFO = "/camera/depth/image_raw", "/camera/depth/camera_info"
DEPTH_MM = (1000 + 10 * np.arange(WIDTH * HEIGHT)).reshape(HEIGHT, WIDTH)


def info(**changes: Any) -> Any:
    message = record(
        header=record(stamp=record(sec=3, nanosec=0), frame_id="camera"),
        width=WIDTH,
        height=HEIGHT,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=np.array([F, 0, CX, 0, F, CY, 0, 0, 1]),
        r=np.eye(3).ravel(),
        p=np.array([F, 0, CX, 0, 0, F, CY, 0, 0, 0, 1, 0]),
        binning_x=0,
        binning_y=0,
        roi=record(**NO_ROI),
    )
    message.__dict__.update(changes)
    return message


def image(raw: Any = DEPTH_MM, encoding: str = "16UC1", big: bool = False, padding: int = 0) -> Any:
    kind = np.dtype("f4" if encoding == "32FC1" else "u2").newbyteorder(">" if big else "<")
    rows = [row.astype(kind).tobytes() + b"\xff" * padding for row in np.asarray(raw)]
    height, width = np.shape(raw)
    return record(
        header=HEADER, height=height, width=width, encoding=encoding, is_bigendian=big,
        step=width * kind.itemsize + padding, data=np.frombuffer(b"".join(rows), np.uint8),
    )  # fmt: skip


def compressed(raw: Any, form: str = "16UC1; compressedDepth png", a: float = 0, b: float = 0) -> Any:
    png = cv2.imencode(".png", np.asarray(raw, np.uint16))[1].tobytes()
    return record(header=HEADER, format=form, data=struct.pack("<iff", 0, a, b) + png)


def decode(message: Any, calibration: Any = None, topic: str = IMAGE) -> Any:
    cameras = DepthCameras()
    cameras.add_info(INFO, calibration or info())
    return cameras.decode(topic, message)


def expected(depth_mm: Any = DEPTH_MM) -> FloatArray:
    """The pinhole equation, pixel by pixel."""
    return np.array(
        [
            [(u - CX) / F * z / 1000, (v - CY) / F * z / 1000, z / 1000]
            for v, row in enumerate(depth_mm)
            for u, z in enumerate(row)
            if z > 0
        ]
    )


def patched(message: Any, **changes: Any) -> Any:
    message.__dict__.update(changes)
    return message
