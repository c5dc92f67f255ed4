"""All that the planner can be told, in one profile."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from flatgrasp_cli.profiles.base import Profile
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.robot import Robot
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
from flatgrasp_cli.profiles.settings.scene import SceneSettings
from flatgrasp_cli.profiles.uncertainty import UncertaintySettings


class PlannerSettings(Profile):
    """Everything that the planner can be told."""

    profile: Literal["planner"] = "planner"
    """What kind of profile this is."""
    name: str
    """The profile's name: of a shipped one, or of the file's own."""
    method: Literal["lei_wisse", "allen"]
    """Whose grasps: the paper's, or those of two point fingers (Allen, Burdick & Rimon 2012, its reference [1])."""
    seed: Annotated[int, Field(ge=0, lt=2**32)]
    """The number from which everything random follows."""
    scene: SceneSettings
    """Beyond the paper: the support plane and the objects on it."""
    main_plane: MainPlaneSettings
    """§III.A.1: the oriented bounding box."""
    silhouette: SilhouetteSettings
    """§III.A.2: the concave hull."""
    fingers: FingerSettings
    """§III.A.3: step points, finger candidates, grasping directions."""
    balance: BalanceSettings
    """§III.B.1 and B.2: force and torque balance."""
    hand: HandSettings
    """§III.B.3 to B.5: grasping range, variance, operability."""
    depth: DepthSettings
    """Beyond the paper: how deep the fingertips go over a support plane."""
    approach: ApproachSettings
    """Beyond the paper: from which sides the hand comes."""
    gravity: GravitySettings
    """§III.C: the centre of gravity."""
    ranking: RankingSettings
    """Which of the grasps is best."""
    uncertainty: UncertaintySettings
    """Beyond the paper: what may be off when the hand closes."""
    variety: VarietySettings
    """Beyond the paper: how much the listed grasps differ."""
    caging: CagingSettings
    """Beyond the paper: proofs."""

    def resolve(self, gripper: Gripper, robot: Robot | None = None) -> PlannerSettings:
        """The same with every None that gripper or robot decides replaced; those that the object decides stay None."""
        balance = self.balance
        friction = balance.friction_with(gripper)
        cone = math.atan(friction)
        gamma = balance.force_balance_max_deg or math.degrees(2 * balance.force_share * cone)
        torque_max = balance.torque_max
        if torque_max is None:
            # facts of the friction cone: T/d < sin(φ − γ/2)·cos(γ/2) keeps a pair with the largest γ force closed
            rest = max(cone - math.radians(gamma) / 2, 0.0)
            normalised = math.sin(rest) * math.cos(math.radians(gamma) / 2)
            arm = normalised * gripper.max_opening_m
            torque_max = {"friction": friction, "normalised": normalised, "arm": arm}[balance.torque]
        resolved = {"friction": friction, "force_balance_max_deg": min(gamma, 180.0), "torque_max": torque_max}
        force = UncertaintySettings(force_n=gripper.max_force_n)
        uncertainty = self.uncertainty.resolved(force, gripper.uncertainty, robot.uncertainty if robot else None)
        return self.model_copy(update={"balance": balance.model_copy(update=resolved), "uncertainty": uncertainty})
