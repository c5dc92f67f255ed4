"""Grasps in the formats of other programs, one module a format.

This module imports none of them before one is asked for: the command line lists the formats in its help.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flatgrasp_cli.results.saved import SavedDocument


@dataclass(frozen=True, slots=True)
class Format:
    """A format: the end of its files' names, what reads it, and whether one file holds several frames."""

    ending: str
    about: str
    many_frames: bool = False


FORMATS = {
    "isaac": Format(".isaac.yaml", "isaac_grasp, for Isaac Sim, Isaac ROS and GraspGen"),
    "graspnet": Format(".graspnet.npy", "GraspNet's GraspGroup, an array (n, 17)"),
    "moveit": Format(".moveit.yaml", "a list of moveit_msgs/Grasp"),
    "csv": Format(".grasps.csv", "a row for each grasp", many_frames=True),
}


def exported(name: str, documents: Sequence[SavedDocument]) -> bytes:
    """The content of a file of one of the `FORMATS`, with the grasps of all documents or of the only one.

    Raises
    ------
    ProfileError
        If the gripper's profile lacks what the format needs.
    """
    content: bytes = import_module(f"{__name__}.{name}_file").content(documents)
    return content
