"""YAML profiles → frozen, validated models whose names carry their units."""

from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.loading import (
    list_profiles,
    load_gripper,
    load_profile,
    load_robot,
    load_settings,
    profile_path,
)
from flatgrasp_cli.profiles.robot import Robot
from flatgrasp_cli.profiles.settings import PlannerSettings

__all__ = [
    "Gripper",
    "PlannerSettings",
    "Robot",
    "list_profiles",
    "load_gripper",
    "load_profile",
    "load_robot",
    "load_settings",
    "profile_path",
]
