"""Beyond the paper: what is proved of grasps in the plane, their cages and their force closure."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import Cage, Closure, GraspCandidates, Silhouette
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.proof.caging import Hands, Proof, prove
from flatgrasp_cli.proof.force_closure import (
    friction_margin,
    lift_margins,
    pad_quality,
    point_quality,
    reference_of,
)

INSIDE_M = 1e-4
"""How far inside a basin the hand comes: at its very edge nothing is sure."""


@dataclass(frozen=True, slots=True)
class Certificates:
    """What is proved of k grasps, one of each for every grasp."""

    cages: tuple[Cage, ...]
    closures: tuple[Closure, ...]

    def select(self, keep: IntArray) -> Certificates:
        """Those of the grasps that `keep` names."""
        return Certificates(tuple(self.cages[k] for k in keep), tuple(self.closures[k] for k in keep))


def certified(
    grasps: GraspCandidates, silhouette: Silhouette, gripper: Gripper, settings: PlannerSettings
) -> tuple[GraspCandidates, Certificates]:
    """Certificates of k grasps; the grasps come with openings from which closing surely ends in them, where it can."""
    hands = hands_of(grasps)
    proof = prove(silhouette.loops, hands, gripper, settings.caging)
    hands = replace(hands, opening=_preshape(hands, proof, settings.hand.clearance_m))
    closures = _closures(grasps, silhouette, gripper, settings)
    return grasps.having(opening=hands.opening), Certificates(proof.cages(hands), tuple(closures))


def hands_of(grasps: GraspCandidates) -> Hands:
    """The grasps' hands."""
    return Hands(center=grasps.center, axis=grasps.axis, width=grasps.width, opening=grasps.opening)


def is_caged(cage: Cage | None) -> bool:
    """Whether the hand comes into a cage that closes into its grasp, even if the silhouette errs by its noise."""
    return cage is not None and cage.guaranteed and cage.basin_on_approach


def forgiven_m(cage: Cage | None) -> float:
    """How far the hand may miss in any direction and still close into its grasp."""
    return cage.tolerance.position_m if cage is not None and cage.tolerance is not None else 0.0


def why_not(cage: Cage) -> str:
    """Why the hand does not come into a cage."""
    if cage.reason is not None:
        return cage.reason
    return "its basin leaves no room to come with" if cage.guaranteed else "its cage is no deeper than the noise"


def _preshape(hands: Hands, proof: Proof, clearance_m: float) -> FloatArray:
    """Openings (k,) to come with: no more than that from which closing surely ends in the grasp, where there is one.

    A basin that would leave the fingers less than their clearance beside the object cannot be come into.
    """
    basin, least = proof.limits.merge, hands.width + 2 * clearance_m
    sure = np.zeros(len(hands), dtype=np.bool_) if proof.outward else proof.guaranteed(hands) & (basin > least)
    return np.where(sure, np.minimum(hands.opening, np.maximum(basin - INSIDE_M, least)), hands.opening)


def _closures(
    grasps: GraspCandidates, silhouette: Silhouette, gripper: Gripper, settings: PlannerSettings
) -> list[Closure]:
    """Force closure of pads that press along the closing axis, with the friction that the settings count on."""
    friction = settings.balance.friction_with(gripper)
    reference = reference_of(silhouette.loops)
    normals = np.stack([grasps.axis, -grasps.axis], axis=1)
    points = point_quality(grasps.contacts, normals, friction, reference)
    pads = pad_quality(grasps.contacts, normals, grasps.touched_m, friction, reference)
    margins = friction_margin(grasps.required_friction, friction)
    closures = [
        Closure(float(point), float(pad), float(margin) if np.isfinite(margin) else None)
        for point, pad, margin in zip(points, pads, margins, strict=True)
    ]
    if settings.caging.mass_kg is None or gripper.max_force_n is None:
        return closures
    radius, force_n = 0.5 * grasps.touched_m.min(axis=1), settings.uncertainty.figures.force_n
    lift = lift_margins(grasps.gravity_distance, settings.caging.mass_kg, force_n, friction, radius)
    return [
        replace(closure, lift_weight=float(weight), lift_torque=float(torque) if np.isfinite(torque) else None)
        for closure, weight, torque in zip(closures, lift.weight, lift.torque, strict=True)
    ]
