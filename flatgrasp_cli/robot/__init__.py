"""Where an arm of the UR family can go: its kinematics, and how it carries out a grasp. Knows a pose, not a cloud."""

from flatgrasp_cli.robot.frames import in_dh_base
from flatgrasp_cli.robot.kinematics import forward, inverse, manipulability, max_manipulability
from flatgrasp_cli.robot.motion import Motion, carried_out, flange_at
from flatgrasp_cli.robot.reach import Plane, reach

__all__ = [
    "Motion",
    "Plane",
    "carried_out",
    "flange_at",
    "forward",
    "in_dh_base",
    "inverse",
    "manipulability",
    "max_manipulability",
    "reach",
]
