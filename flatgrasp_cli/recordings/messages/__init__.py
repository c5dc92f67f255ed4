"""Decoded messages → points: one module per kind of message, each into `Decoded`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from flatgrasp_cli.recordings.messages.camera_info import CameraInfo
from flatgrasp_cli.recordings.messages.decoded import CloudDecoder, Decoded, MessageError
from flatgrasp_cli.recordings.messages.depth_cameras import (
    DepthCameras,
    MissingCameraInfo,
    info_topics_for,
    unit_topic_for,
)
from flatgrasp_cli.recordings.messages.depth_image import is_depth, is_lossy_depth
from flatgrasp_cli.recordings.messages.foxglove import decode_foxglove
from flatgrasp_cli.recordings.messages.png import LOSSY
from flatgrasp_cli.recordings.messages.pointcloud2 import decode_pointcloud, decode_pointcloud2

CLOUD_TYPES: Mapping[str, CloudDecoder] = MappingProxyType(
    {
        "sensor_msgs/msg/PointCloud2": decode_pointcloud2,
        "sensor_msgs/msg/PointCloud": decode_pointcloud,
        "foxglove.PointCloud": decode_foxglove,
        "foxglove_msgs/msg/PointCloud": decode_foxglove,
    }
)
"""The decoder of each type of topic that holds point clouds."""
IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})
"""Types of topic that may hold depth images; `is_depth` tells from a message, nothing before it does."""
INFO_TYPE, UNIT_TYPE = "sensor_msgs/msg/CameraInfo", "std_msgs/msg/Float32"

__all__ = [
    "CLOUD_TYPES",
    "IMAGE_TYPES",
    "INFO_TYPE",
    "LOSSY",
    "UNIT_TYPE",
    "CameraInfo",
    "CloudDecoder",
    "Decoded",
    "DepthCameras",
    "MessageError",
    "MissingCameraInfo",
    "info_topics_for",
    "is_depth",
    "is_lossy_depth",
    "unit_topic_for",
]
