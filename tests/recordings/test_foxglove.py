"""Foxglove's clouds become the points that were recorded, and broken ones an error that says how."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages import (
    CLOUD_TYPES,
    MessageError,
)
from flatgrasp_cli.recordings.messages.foxglove import decode_foxglove
from flatgrasp_cli.recordings.messages.pointcloud2 import decode_pointcloud2
from tests.recordings.clouds import FINITE, NAN, POINTS, record

FOXGLOVE_TYPES = {"u1": 1, "i1": 2, "u2": 3, "i2": 4, "u4": 5, "i4": 6, "f4": 7, "f8": 8}


def foxglove(points: FloatArray = POINTS, **changes: Any) -> Any:
    fields = {"x": "f8", "y": "f4", "z": "f4", "red": "u1", "green": "u1", "blue": "u1", "alpha": "u1"}
    table = np.zeros(len(points), np.dtype(list(fields.items())))
    for axis, column in zip("xyz", points.T, strict=True):
        table[axis] = column
    table["red"], table["green"], table["blue"] = 1, 2, 3
    assert table.dtype.fields is not None
    message = record(
        timestamp=record(seconds=3, nanos=7),
        frame_id="map",
        pose=record(position=record(x=0, y=0, z=0), orientation=record(x=0, y=0, z=0, w=0)),
        point_stride=table.dtype.itemsize,
        fields=[
            record(name=name, offset=table.dtype.fields[name][1], type=FOXGLOVE_TYPES[kind])
            for name, kind in fields.items()
        ],
        data=table.tobytes(),
    )
    message.__dict__.update(changes)
    return message


def test_foxglove_protobuf_and_json() -> None:
    plain = foxglove()
    in_json = foxglove(data=base64.b64encode(plain.data).decode(), timestamp=record(sec=3, nsec=7))
    del in_json.pose
    for message in (plain, in_json):
        decoded = decode_foxglove(message, colors=True)
        np.testing.assert_array_equal(decoded.points, FINITE)
        np.testing.assert_array_equal(decoded.colors, [[1, 2, 3]] * 4)
        assert decoded.viewpoint is None
        assert (decoded.dropped, decoded.stamp_ns, decoded.frame_id) == (2, 3_000_000_007, "map")


def test_foxglove_pose_is_applied() -> None:
    turned = record(position=record(x=10, y=0, z=0), orientation=record(x=0, y=0, z=2, w=2))
    decoded = decode_foxglove(foxglove(pose=turned))
    np.testing.assert_allclose(decoded.points[0], [10 - 2, 1, 3], atol=1e-12)  # a quarter turn: (1, 2) → (−2, 1)
    assert decoded.viewpoint == pytest.approx([10, 0, 0])


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"data": "no base64!"}, "data is not base64"),
        ({"data": bytes(21)}, "data has 21 bytes, which is no whole number of points of 20 bytes"),
        ({"point_stride": 0}, "point_stride is 0"),
        ({"fields": [record(name="x", offset=0, type=7)]}, "has no field y or z"),
        ({"pose": record(position=record(x=NAN, y=0, z=0), orientation=None)}, "its pose is not finite"),
    ],
)
def test_broken_foxglove_says_how(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode_foxglove(foxglove(**changes))


def test_every_cloud_type_has_its_decoder() -> None:
    assert CLOUD_TYPES["sensor_msgs/msg/PointCloud2"] is decode_pointcloud2
    assert CLOUD_TYPES["foxglove.PointCloud"] is CLOUD_TYPES["foxglove_msgs/msg/PointCloud"] is decode_foxglove
