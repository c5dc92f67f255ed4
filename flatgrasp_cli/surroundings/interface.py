"""What the method asks of whatever stands around an object."""

from __future__ import annotations

from typing import Protocol

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, OpenHands, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.surroundings.below import Stops


class Surroundings(Protocol):
    """What stands around an object along an approach direction, and what of it was seen.

    The hand comes against the normal of the plane that the method runs in; heights are along that normal.
    """

    @property
    def level_m(self) -> float | None:
        """The height above which the silhouette was taken; None where heights are those over the main plane."""

    @property
    def lowest_m(self) -> float:
        """The height at which fingertips may end."""

    @property
    def down(self) -> FloatArray:
        """Which way things fall: a unit vector (3,)."""

    def sides(self, fingers: FingerCandidates, funnel: Funnel, /) -> FingerCandidates:
        """The candidates at which a finger can stand, with what is hidden of the object there."""

    def approached(
        self,
        silhouette: Silhouette,
        fingers: FingerCandidates,
        grasps: GraspCandidates,
        gripper: Gripper,
        funnel: Funnel,
        /,
    ) -> GraspCandidates:
        """The pairs to which the hand can come, with its opening on the way and the heights of tips and contacts."""

    def stopped(self, hands: OpenHands, gripper: Gripper, /) -> Stops:
        """How high open hands are stopped by what stands below them, and how much of their place was not seen."""
