"""Settings of the planner, section by section of the paper. `null` (None) means: derive it, as the comment says."""

from flatgrasp_cli.profiles.settings.beyond import CagingSettings, DepthSettings, VarietySettings
from flatgrasp_cli.profiles.settings.method import (
    BalanceSettings,
    FingerSettings,
    GravitySettings,
    HandSettings,
    MainPlaneSettings,
    SilhouetteSettings,
)
from flatgrasp_cli.profiles.settings.planner import PlannerSettings
from flatgrasp_cli.profiles.settings.scene import SceneSettings

__all__ = [
    "BalanceSettings",
    "CagingSettings",
    "DepthSettings",
    "FingerSettings",
    "GravitySettings",
    "HandSettings",
    "MainPlaneSettings",
    "PlannerSettings",
    "SceneSettings",
    "SilhouetteSettings",
    "VarietySettings",
]
