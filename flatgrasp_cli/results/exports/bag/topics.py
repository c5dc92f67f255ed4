"""What a frame's messages are, topic by topic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flatgrasp_cli.geometry.sampling import one_a_cell
from flatgrasp_cli.results.exports.bag.markers import markers
from flatgrasp_cli.results.exports.bag.messages import Messages
from flatgrasp_cli.results.exports.hands import flange_of

if TYPE_CHECKING:
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.results.saved import SavedDocument

CLOUD, GRASPS, PRE_GRASPS = "/flatgrasp/cloud", "/flatgrasp/grasps", "/flatgrasp/pre_grasps"
MARKERS, DOCUMENT, TF_STATIC = "/flatgrasp/markers", "/flatgrasp/document", "/tf_static"
TYPES = {
    CLOUD: "sensor_msgs/msg/PointCloud2",
    GRASPS: "geometry_msgs/msg/PoseArray",
    PRE_GRASPS: "geometry_msgs/msg/PoseArray",
    MARKERS: "visualization_msgs/msg/MarkerArray",
    TF_STATIC: "tf2_msgs/msg/TFMessage",
    DOCUMENT: "std_msgs/msg/String",
}
VOXEL_M = 0.003
"""Of the cloud in a bag one point is kept in each cube of so many metres: as fine as a depth camera sees at 1.7 m."""
FLOAT32, STEP_BYTES = 7, 16
"""PointField's name for a float; and x, y, z and a colour take so many bytes."""


def messages_of(document: SavedDocument, text: str, cloud: Cloud | None, messages: Messages) -> dict[str, Any]:
    """The messages about one frame, by topic; `text` is the document as it was written."""
    grasps = [grasp for _, grasp in document.grasps]
    found = {
        GRASPS: _poses([messages.pose(grasp.pose.pose) for grasp in grasps], messages),
        PRE_GRASPS: _poses([messages.pose(grasp.pre_grasp.pose) for grasp in grasps], messages),
        MARKERS: markers(document, messages),
        DOCUMENT: messages.make("std_msgs/msg/String", data=text),
    }
    if cloud is not None:
        found[CLOUD] = _cloud(cloud, messages)
    if grasps:
        found[TF_STATIC] = _frames(document, messages)
    return found


def _poses(poses: list[Any], messages: Messages) -> Any:
    return messages.make("geometry_msgs/msg/PoseArray", header=messages.header, poses=poses)


def _frames(document: SavedDocument, messages: Messages) -> Any:
    """The frames of the best grasp, by name: what a node or a viewer can look up."""
    _, best = next(document.grasps)
    frames = {"pre_grasp": best.pre_grasp.pose, "grasp": best.pose.pose, "lift": best.lift.pose}
    frames["flange"] = flange_of(best, document.gripper)
    transforms = [messages.transform(f"flatgrasp/{name}", pose) for name, pose in frames.items()]
    return messages.make("tf2_msgs/msg/TFMessage", transforms=transforms)


def _cloud(cloud: Cloud, messages: Messages) -> Any:
    """The cloud, thinned, with colours where it has some."""
    rows = one_a_cell(cloud.points, VOXEL_M)
    names = "xyz" if cloud.colors is None else ("x", "y", "z", "rgb")
    packed = np.zeros((len(rows), 4), dtype="<f4")
    packed[:, :3] = cloud.points[rows]
    if cloud.colors is not None:
        red, green, blue = cloud.colors[rows].astype("<u4").T
        packed.view("<u4")[:, 3] = red << 16 | green << 8 | blue
    fields = [
        messages.make("sensor_msgs/msg/PointField", name=name, offset=4 * k, datatype=FLOAT32, count=1)
        for k, name in enumerate(names)
    ]
    return messages.make(
        "sensor_msgs/msg/PointCloud2",
        header=messages.header,
        height=1,
        width=len(rows),
        fields=fields,
        point_step=STEP_BYTES,
        row_step=STEP_BYTES * len(rows),
        data=packed.view(np.uint8).ravel(),
        is_dense=True,
    )
