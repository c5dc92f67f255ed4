"""A gripper as other programs know it: by a link of its own and its joints' positions."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.frames import axes_from_quaternion, quaternion_from_axes, turned_about_z
from flatgrasp_cli.model import Pose
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.saved import SavedGrasp
from flatgrasp_cli.robot import flange_at

CLOSING, APPROACH = 1, 2
"""The hand's own axes: y closes, z approaches."""


def joints_at(gripper: Gripper, opening_m: float, purpose: str) -> dict[str, float]:
    """The position of each driven joint at an opening, radians or metres.

    Raises
    ------
    ProfileError
        If the gripper's profile does not say; `purpose` is what they are wanted for.
    """
    if gripper.joint_names is None or gripper.joints_at_opening is None:
        raise _lacking(gripper, "joint_names and joints_at_opening", purpose)
    openings, *positions = np.array(gripper.joints_at_opening).T
    return {
        name: float(np.interp(opening_m, openings, at)) for name, at in zip(gripper.joint_names, positions, strict=True)
    }


def base_link_of(gripper: Gripper, purpose: str) -> str:
    """The name of the hand's own link; raises `ProfileError` if its profile does not say."""
    if gripper.base_link is None:
        raise _lacking(gripper, "base_link", purpose)
    return gripper.base_link


def base_link_at(grasp: SavedGrasp, gripper: Gripper) -> Pose:
    """The pose of the hand's own link where the fingertips have closed on the object."""
    tips = grasp.pose.pose
    hand = axes_from_quaternion(tips.orientation)
    axes = np.empty((3, 3))
    closing, approach = gripper.base_link_closes, gripper.base_link_approaches
    for name, axis in ((closing, CLOSING), (approach, APPROACH)):
        axes["xyz".index(name[-1])] = hand[axis] if len(name) == 1 else -hand[axis]
    third = ({0, 1, 2} - {"xyz".index(name[-1]) for name in (closing, approach)}).pop()
    axes[third] = np.cross(axes[(third + 1) % 3], axes[(third + 2) % 3])
    back = gripper.tool_length_m(grasp.width_m) - gripper.adapter_m
    return Pose(tips.position - back * hand[APPROACH], quaternion_from_axes(axes))


def flange_of(grasp: SavedGrasp, gripper: Gripper) -> Pose:
    """The pose of the arm's flange there, turned as the joint angles of a document with a robot have it."""
    flange = flange_at(grasp.pose.pose, grasp.width_m, gripper)
    twin = grasp.reach is not None and grasp.reach.twin
    return Pose(flange.position, turned_about_z(flange.orientation, 180.0)) if twin else flange


def _lacking(gripper: Gripper, keys: str, purpose: str) -> ProfileError:
    return ProfileError(
        f"gripper {gripper.name!r}: its profile has no {keys}, which {purpose} needs; "
        "add what its URDF says (`flatgrasp profiles show franka_hand` is an example), and plan again"
    )
