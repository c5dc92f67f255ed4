"""What the name of a frame says of its axes: ROS's REP 103 and REP 105, and common use."""

from __future__ import annotations

import re

UPRIGHT = re.compile(r"(base|base_link|base_footprint|footprint|world|map|odom|table|ground|floor)(_(frame|link))?")
"""Names, without what stands before the last slash, of frames whose z axis points up."""


def is_optical(frame_id: str) -> bool:
    """Whether a frame is a camera's optical one, by its name: x right, y down, z forward (REP 103)."""
    return frame_id.endswith(("optical_frame", "optical"))


def has_z_up(frame_id: str) -> bool:
    """Whether a frame's z axis points up, by its name: a robot's base, a map, a table (REP 103, REP 105)."""
    return UPRIGHT.fullmatch(frame_id.rpartition("/")[2].lower()) is not None
