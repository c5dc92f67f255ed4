"""Where an arm can go: its kinematics, and how it carries out a grasp. Knows a pose, not a cloud."""

from flatgrasp_cli.robot.arms import Arm, arm_of, ur_rows
from flatgrasp_cli.robot.frames import in_dh_base
from flatgrasp_cli.robot.kinematics import forward, inverse, manipulability, max_manipulability
from flatgrasp_cli.robot.motion import Motion, flange_at, way_to
from flatgrasp_cli.robot.reach import Plane, is_too_far, reach

__all__ = [
    "Arm",
    "Motion",
    "Plane",
    "arm_of",
    "flange_at",
    "forward",
    "in_dh_base",
    "inverse",
    "is_too_far",
    "manipulability",
    "max_manipulability",
    "reach",
    "ur_rows",
    "way_to",
]
