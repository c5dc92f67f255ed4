"""The methods that can be asked for by name: the same records in, the same grasp table out, another composition."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from flatgrasp_cli.methods.allen import point_fingers
from flatgrasp_cli.planner import section_three

if TYPE_CHECKING:
    from flatgrasp_cli.funnel import Funnel
    from flatgrasp_cli.model import FingerCandidates, GraspCandidates, PlaneShape
    from flatgrasp_cli.profiles.gripper import Gripper
    from flatgrasp_cli.profiles.settings import PlannerSettings
    from flatgrasp_cli.surroundings import Surroundings

    Found = tuple[FingerCandidates | None, GraspCandidates]
    Method = Callable[[PlaneShape, Surroundings, Gripper, PlannerSettings, Funnel, int], Found]

METHODS: dict[str, Method] = {"lei_wisse": section_three, "allen": point_fingers}

__all__ = ["METHODS"]
