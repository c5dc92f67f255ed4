"""Beyond the paper: what is proved of a plan's grasps, their cages and their force closure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Cage, Closure, Grasp, ObjectPlan, Rejection, Silhouette, Stage
from flatgrasp_cli.planner.caging import Hands, Proof, prove
from flatgrasp_cli.planner.force_closure import friction_margin, lift_margins, pad_quality, point_quality, reference_of
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings

INSIDE_M = 1e-4
"""How far inside a basin the hand comes: at its very edge nothing is sure."""


def certified(plan: ObjectPlan, gripper: Gripper, settings: PlannerSettings, top: int) -> ObjectPlan:
    """The plan with certificates, and the best `top` of its grasps by the settings' preference.

    With `caging.require`, grasps without a cage are no grasps.
    """
    outline = plan.trace.silhouette
    if not plan.grasps or outline is None or not settings.caging.certify:
        return replace(plan, grasps=plan.grasps[:top])
    hands = hands_of(plan.grasps, outline)
    proof = prove(outline.loops, hands, gripper, settings.caging)
    hands = replace(hands, opening=_preshape(hands, proof, settings.hand.clearance_m))
    cages = proof.cages(hands)
    closures = _closures(plan, hands, outline, gripper, settings)
    grasps = [
        replace(grasp, cage=cage, closure=closure, opening_m=opening)
        for grasp, cage, closure, opening in zip(plan.grasps, cages, closures, hands.opening.tolist(), strict=True)
    ]
    funnel, rejection = plan.funnel, None
    if settings.caging.require:
        grasps = [grasp for grasp in grasps if is_caged(grasp)]
        funnel = (*funnel, Stage("cage", len(grasps)))
        if not grasps:
            rejection = Rejection("cage", f"none of the {len(cages)} best grasps is a cage: {_why_not(cages[0])}")
    if settings.caging.prefer == "cage":
        grasps.sort(key=surest_first)
    ranked = tuple(
        grasp if grasp.rank == rank else replace(grasp, rank=rank) for rank, grasp in enumerate(grasps[:top], start=1)
    )
    return replace(plan, grasps=ranked, funnel=funnel, rejection=rejection)


def hands_of(grasps: tuple[Grasp, ...], outline: Silhouette) -> Hands:
    """The grasps' hands in the outline's plane."""
    positions = np.array([grasp.position for grasp in grasps])
    axes = np.array([axes_from_quaternion(grasp.orientation)[1] for grasp in grasps]) @ outline.frame.axes[:2].T
    return Hands(
        center=outline.frame.to_local(positions)[:, :2],
        axis=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        width=np.array([grasp.width_m for grasp in grasps]),
        opening=np.array([grasp.opening_m for grasp in grasps]),
    )


def is_caged(grasp: Grasp) -> bool:
    """Whether the hand comes into a cage that closes into this grasp, even if the outline errs by its noise."""
    return grasp.cage is not None and grasp.cage.guaranteed and grasp.cage.basin_on_approach


def _why_not(cage: Cage) -> str:
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


def surest_first(grasp: Grasp) -> tuple[bool, float, float]:
    """Grasps with a cage first, those before others that forgive the larger miss; then the cheaper one."""
    forgiven = grasp.cage.tolerance.position_m if grasp.cage and grasp.cage.tolerance else 0.0
    return (not is_caged(grasp), -forgiven, grasp.cost_m)


def _closures(
    plan: ObjectPlan, hands: Hands, outline: Silhouette, gripper: Gripper, settings: PlannerSettings
) -> list[Closure]:
    """Force closure of pads that press along the closing axis, with the friction that the settings count on."""
    grasps, fingers = plan.grasps, plan.trace.fingers
    friction = settings.balance.friction_with(gripper)
    reference = reference_of(outline.loops)
    contacts = np.array([outline.frame.to_local(grasp.contacts)[:, :2] for grasp in grasps])
    normals = np.stack([hands.axis, -hands.axis], axis=1)
    width = np.full((len(grasps), 2), gripper.finger_width_m)
    if fingers is not None:  # a small object meets less of the pads
        width = np.minimum(width, fingers.width[np.array([grasp.fingers for grasp in grasps])])
    points = point_quality(contacts, normals, friction, reference)
    pads = pad_quality(contacts, normals, width, friction, reference)
    margins = friction_margin(np.array([grasp.required_friction for grasp in grasps]), friction)
    closures = [
        Closure(float(point), float(pad), float(margin) if np.isfinite(margin) else None)
        for point, pad, margin in zip(points, pads, margins, strict=True)
    ]
    if settings.caging.mass_kg is None or gripper.max_force_n is None:
        return closures
    away = np.array([grasp.gravity_distance_m for grasp in grasps])
    lift = lift_margins(away, settings.caging.mass_kg, gripper.max_force_n, friction, 0.5 * width.min(axis=1))
    return [
        replace(closure, lift_weight=float(weight), lift_torque=float(torque) if np.isfinite(torque) else None)
        for closure, weight, torque in zip(closures, lift.weight, lift.torque, strict=True)
    ]
