"""isaac_grasp, format version 1.0, as Isaac Sim's Grasp Editor writes and Isaac ROS and GraspGen read it.

Poses are those of the gripper's own link in the document's frame. `confidence` is the probability that the grasp holds,
or one over the rank; readers drop what has none, so that a grasp of probability 0 goes unread.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml

from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.exports.hands import base_link_at, base_link_of, joints_at
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp

FORMAT = "isaac"


def content(documents: Sequence[SavedDocument]) -> bytes:
    """The file of one frame; raises `ProfileError` if the gripper's profile does not name link and joints."""
    (document,) = documents
    text = yaml.safe_dump(
        {
            "format": "isaac_grasp",
            "format_version": 1.0,
            "object_frame": document.frame_id,
            "gripper_frame": base_link_of(document.gripper, FORMAT),
            "grasps": {
                f"object_{item.id}_grasp_{grasp.rank}": _grasp(grasp, document.gripper)
                for item, grasp in document.grasps
            },
        },
        sort_keys=False,
        default_flow_style=None,
        allow_unicode=True,
    )
    return str(text).encode()


def _grasp(grasp: SavedGrasp, gripper: Gripper) -> dict[str, Any]:
    pose = base_link_at(grasp, gripper)
    *xyz, w = pose.orientation.tolist()
    return {
        "confidence": grasp.score,
        "position": pose.position.tolist(),
        "orientation": {"w": w, "xyz": xyz},
        "cspace_position": joints_at(gripper, grasp.width_m, FORMAT),
        "pregrasp_cspace_position": joints_at(gripper, grasp.opening_m, FORMAT),
    }
