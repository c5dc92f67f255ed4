"""A list of moveit_msgs/Grasp in YAML, with the names of fields that ROS 2 gives them.

`grasp_pose` is that of the end effector's parent link, the arm's flange. The hand approaches along the flange's z axis
and retreats the way of the lift. The message has place for one straight way: a hand that came aslant, which is lifted
back first and then up, goes back as it came. Only of that way is it known that nothing is in it; up from there is for
the next motion, which MoveIt plans itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.exports.hands import flange_of, joints_at
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp

FORMAT = "moveit"
FLANGE = "tool0"
"""What ROS-Industrial's arms call the flange."""
ROUNDED = 1e-6
"""Of the sine between two directions in a document: what rounding its numbers does."""
NO_LIMIT_N = 0.0
"""Of `max_contact_force`, which MoveIt takes for none."""


def content(documents: Sequence[SavedDocument]) -> bytes:
    """The file of one frame; raises `ProfileError` if the gripper's profile does not name its joints."""
    (document,) = documents
    header = _header(document.source.stamp_ns, document.frame_id)
    messages = [
        _message(grasp, document.gripper, header, f"object_{item.id}_grasp_{grasp.rank}")
        for item, grasp in document.grasps
    ]
    return str(yaml.dump(messages, Dumper=_NoAliases, sort_keys=False, allow_unicode=True)).encode()


class _NoAliases(yaml.SafeDumper):
    """Writes every header out, however often it is the same: not all readers know YAML's references."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
        return True


def _message(grasp: SavedGrasp, gripper: Gripper, header: dict[str, Any], name: str) -> dict[str, Any]:
    flange = flange_of(grasp, gripper)
    tips, before, after = (np.array(pose.position) for pose in (grasp.pose, grasp.pre_grasp, grasp.lift))
    length_m, grip_m = float(np.linalg.norm(tips - before)), grasp.metrics.get("grip_m") or 0.0
    straight = np.allclose(np.cross(_direction(before - tips), _direction(after - tips)), 0.0, atol=ROUNDED)
    away = (after if straight else before) - tips
    back = -axes_from_quaternion(grasp.pose.pose.orientation)[2]
    along_z = {"header": _header(None, FLANGE), "vector": _xyz(np.array([0.0, 0.0, 1.0]))}
    return {
        "id": name,
        "pre_grasp_posture": _posture(gripper, grasp.opening_m),
        "grasp_posture": _posture(gripper, grasp.width_m),
        "grasp_pose": {
            "header": header,
            "pose": {
                "position": _xyz(flange.position),
                "orientation": dict(zip("xyzw", flange.orientation.tolist(), strict=True)),
            },
        },
        "grasp_quality": grasp.score,
        # straight at least while the fingers go down beside the object; MoveIt wants less than all of the way
        "pre_grasp_approach": _translation(along_z, length_m, grip_m if grip_m < length_m else 0.0),
        "post_grasp_retreat": _translation(
            # the message has a direction and a distance apart: a lift of no length has a direction, too
            {"header": header, "vector": _xyz(_direction(away) if away.any() else back)},
            float(np.linalg.norm(away)),
            0.0,
        ),
        "post_place_retreat": _translation(
            {"header": _header(None, FLANGE), "vector": _xyz(np.array([0.0, 0.0, -1.0]))}, length_m, 0.0
        ),
        "max_contact_force": NO_LIMIT_N if gripper.max_force_n is None else gripper.max_force_n,
        "allowed_touch_objects": [],
    }


def _posture(gripper: Gripper, opening_m: float) -> dict[str, Any]:
    joints = joints_at(gripper, opening_m, FORMAT)
    point = {"positions": list(joints.values()), "time_from_start": {"sec": 0, "nanosec": 0}}
    return {"joint_names": list(joints), "points": [point]}


def _translation(direction: dict[str, Any], desired_m: float, min_m: float) -> dict[str, Any]:
    return {"direction": direction, "desired_distance": desired_m, "min_distance": min_m}


def _header(stamp_ns: int | None, frame_id: str) -> dict[str, Any]:
    seconds, ns = divmod(stamp_ns or 0, 10**9)
    return {"stamp": {"sec": seconds, "nanosec": ns}, "frame_id": frame_id}


def _direction(vector: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector


def _xyz(vector: FloatArray) -> dict[str, float]:
    return dict(zip("xyz", vector.tolist(), strict=True))
