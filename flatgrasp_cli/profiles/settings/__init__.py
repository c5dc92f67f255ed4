"""Settings of the planner, section by section of the paper. `null` (None) means: derive it, as the comment says."""

from flatgrasp_cli.profiles.settings.beyond import (
    ApproachSettings,
    CagingSettings,
    DepthSettings,
    RankingSettings,
    VarietySettings,
)
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
from flatgrasp_cli.profiles.uncertainty import UncertaintySettings

__all__ = [
    "ApproachSettings",
    "BalanceSettings",
    "CagingSettings",
    "DepthSettings",
    "FingerSettings",
    "GravitySettings",
    "HandSettings",
    "MainPlaneSettings",
    "PlannerSettings",
    "RankingSettings",
    "SceneSettings",
    "SilhouetteSettings",
    "UncertaintySettings",
    "VarietySettings",
]
