"""What RViz and Foxglove draw of a plan: the open hand at each object's best grasp, outlines, and numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Pose
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.exports.bag.messages import IDENTITY, Messages
from flatgrasp_cli.results.hand_boxes import hand_boxes
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp, SavedObject

CUBE, LINE_STRIP, TEXT_VIEW_FACING = 1, 4, 9
DELETE_ALL = 3
"""An action: what was drawn of the frame before goes."""
ORANGE, BLUE, GREY, WHITE = (0.90, 0.62, 0.0, 0.8), (0.34, 0.71, 0.91, 1.0), (0.6, 0.6, 0.6, 1.0), (1.0, 1.0, 1.0, 1.0)
LINE_M, TEXT_M = 0.002, 0.03
"""Width of lines and height of letters, metres."""


def markers(document: SavedDocument, messages: Messages) -> Any:
    """A MarkerArray that replaces all that was drawn before."""
    drawn = [messages.make("visualization_msgs/msg/Marker", header=messages.header, action=DELETE_ALL)]
    for item in document.objects:
        drawn += _outline(item, messages)
        if item.grasps:
            drawn += _hand(item.id, item.grasps[0], document.gripper, messages)
        drawn += _number(item, messages)
    for number, marker in enumerate(drawn):
        marker.id = number
    return messages.make("visualization_msgs/msg/MarkerArray", markers=drawn)


def _marker(messages: Messages, kind: int, name: str, color: tuple[float, ...], pose: Pose, **more: Any) -> Any:
    return messages.make(
        "visualization_msgs/msg/Marker",
        header=messages.header,
        ns=name,
        type=kind,
        pose=messages.pose(pose),
        color=messages.color(*color),
        **more,
    )


def _hand(thing: int, grasp: SavedGrasp, gripper: Gripper, messages: Messages) -> Iterator[Any]:
    """The open hand where it closes."""
    tips = grasp.pose.pose
    axes = axes_from_quaternion(tips.orientation)
    for box in hand_boxes(gripper, grasp.opening_m, grasp.width_m):
        place = Pose(tips.position + np.array(box.center) @ axes, tips.orientation)
        yield _marker(messages, CUBE, f"object {thing}: hand", ORANGE, place, scale=messages.vector(np.array(box.size)))


def _outline(item: SavedObject, messages: Messages) -> Iterator[Any]:
    for loop in item.silhouette.in_space() if item.silhouette else ():
        closed: FloatArray = np.vstack([loop, loop[:1]])
        yield _marker(
            messages,
            LINE_STRIP,
            f"object {item.id}: outline",
            BLUE if item.grasps else GREY,
            IDENTITY,
            scale=messages.vector(np.array([LINE_M, 0.0, 0.0])),
            points=[messages.point(point) for point in closed],
        )


def _number(item: SavedObject, messages: Messages) -> Iterator[Any]:
    """The object's number, over the middle of its outline."""
    loops = item.silhouette.in_space() if item.silhouette else []
    if loops:
        yield _marker(
            messages,
            TEXT_VIEW_FACING,
            f"object {item.id}: number",
            WHITE,
            Pose(loops[0].mean(axis=0), IDENTITY.orientation),
            scale=messages.vector(np.array([0.0, 0.0, TEXT_M])),
            text=str(item.id),
        )
