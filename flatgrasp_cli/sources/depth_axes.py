"""Which way the axes of the frame point that a depth image is stamped with.

Pixels and CameraInfo speak of an optical frame (REP 103: x right, y down, z forward), and drivers stamp images so.
Simulators stamp them with the link that the camera is fixed to, a body whose x points forward and whose z points up.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import Cloud, CloudWarning
from flatgrasp_cli.sensor.frame_names import is_optical
from flatgrasp_cli.sources.selection import DepthAxes
from flatgrasp_cli.sources.transforms import MissingTransform, TransformBuffer

OPTICAL_IN_BODY = Frame(np.zeros(3), np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]))
"""An optical frame in the body frame at its place."""
SAME_PLACE_M = 2e-3
"""Two frames of one camera are nearer to each other; those of two lenses are not."""
SAME_AXIS = 0.99
"""Cosine of the angle between axes that are meant to be the same."""
BODY_NAMES = ("_link", "_body", "_base")
"""What names of bodies end with; a few drivers give such a name to an optical frame."""
AXES_ASSUMED = CloudWarning(
    "depth_axes_assumed",
    "the name of the frame of the depth images does not say that it is an optical one (x right, y down, z forward), "
    "as was assumed; --depth-axes optical or --depth-axes body (x forward, z up) states it",
)


def axes_matter(frame_id: str, *, based: bool) -> bool:
    """Whether an answer depends on the axes of an image's frame: it is placed by them, or its name says otherwise."""
    return based or frame_id.endswith(BODY_NAMES)


def in_body_axes(cloud: Cloud) -> Cloud:
    """A cloud in optical axes in those of the body frame at its place."""
    return cloud.in_frame(OPTICAL_IN_BODY, cloud.frame_id)


def axes_by_transforms(buffer: TransformBuffer, frame_id: str, stamp_ns: int, logged_ns: int) -> DepthAxes | None:
    """What an optical frame at the same place says: it is turned to a body, and not to an optical frame.

    None if there is no such frame, or if two disagree.
    """
    found: set[DepthAxes] = set()
    for name in buffer.frames():
        if not is_optical(name):
            continue
        try:
            frame = buffer.lookup(frame_id, name, stamp_ns, logged_ns)
        except MissingTransform:
            continue
        if np.linalg.norm(frame.origin) > SAME_PLACE_M:
            continue
        if (np.diag(frame.axes @ OPTICAL_IN_BODY.axes.T) > SAME_AXIS).all():
            found.add("body")
        elif (np.diag(frame.axes) > SAME_AXIS).all():
            found.add("optical")
    return found.pop() if len(found) == 1 else None
