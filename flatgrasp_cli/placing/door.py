"""The door through which each cloud comes into the frame that answers are wanted in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import Cloud, CloudWarning

if TYPE_CHECKING:
    from flatgrasp_cli.profiles.robot import CameraPose


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """The pose of one frame in another, and what had to be assumed of the transforms between them."""

    frame: Frame
    warnings: tuple[CloudWarning, ...] = ()


Lookup = Callable[[str, str], Route]
"""Gives the pose in a frame, the first, of another one, at a cloud's time, as a recording's transforms have it."""


def placed(cloud: Cloud, base_frame: str | None, camera: CameraPose | None, lookup: Lookup | None = None) -> Cloud:
    """The cloud in `base_frame`; as it is where that is None.

    The pose of the `camera`, which is that of the cloud's own frame, counts before transforms, which `lookup` looks up.

    Raises
    ------
    UsageError
        If nothing tells where the cloud's frame is in the base frame.
    LookupError
        What `lookup` raises where transforms do not lead there.
    """
    if base_frame is None:
        return cloud
    if camera is not None:
        return in_base_frame(cloud, camera, base_frame)
    if lookup is not None:
        route = lookup(base_frame, cloud.frame_id)
        return cloud.in_frame(route.frame, base_frame).warned(*route.warnings)
    if cloud.frame_name != base_frame:
        raise UsageError(
            f"{cloud.source.path}: the cloud is in frame {cloud.frame_name!r}, the answer is wanted in "
            f"{base_frame!r}; say where the camera stands: --camera-pose x,y,z,qx,qy,qz,qw"
        )
    return cloud


def in_base_frame(cloud: Cloud, camera: CameraPose, frame_id: str) -> Cloud:
    """The cloud in the frame `frame_id` in which its own frame has the pose `camera`."""
    frame = Frame(np.array(camera.position_m), axes_from_quaternion(np.array(camera.orientation_xyzw)))
    if cloud.sensor is None and cloud.viewpoint is None:
        cloud = replace(cloud, viewpoint=np.zeros(3))  # the frame with that pose is the camera's
    return cloud.in_frame(frame, frame_id)
