"""YAML profiles → frozen, validated models whose names carry their units."""

from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.loading import (
    list_profiles,
    load_camera_pose,
    load_gripper,
    load_profile,
    load_robot,
    load_settings,
    profile_path,
)
from flatgrasp_cli.profiles.robot import CameraPose, Robot
from flatgrasp_cli.profiles.settings import PlannerSettings

__all__ = [
    "CameraPose",
    "Gripper",
    "PlannerSettings",
    "Robot",
    "list_profiles",
    "load_camera_pose",
    "load_gripper",
    "load_profile",
    "load_robot",
    "load_settings",
    "profile_path",
]
