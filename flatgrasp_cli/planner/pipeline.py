"""§III of the paper, paragraph by paragraph: the silhouette of an object → its grasps in the plane, best first."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, PlaneShape
from flatgrasp_cli.planner.balance import force_balanced, torque_balanced
from flatgrasp_cli.planner.contacts import touching
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.planner.grasping_range import closing_axes, in_range, on_pads
from flatgrasp_cli.planner.gravity import inside_share, weighed
from flatgrasp_cli.planner.operability import operable
from flatgrasp_cli.planner.variance import flat
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.ranking import Situation, best_first
from flatgrasp_cli.surroundings.interface import Surroundings


def section_three(
    shape: PlaneShape,
    surroundings: Surroundings,
    gripper: Gripper,
    settings: PlannerSettings,
    funnel: Funnel,
    top: int,
) -> tuple[FingerCandidates, GraspCandidates]:
    """The best `top` grasps of an object whose `shape` was made by A.1 and A.2, and what they are pairs of.

    The `funnel` counts what each step keeps, and raises `NothingLeft` if that is nothing.
    """
    silhouette, trace = shape.silhouette, funnel.trace
    # A.3 step points, finger candidates, grasping directions
    fingers = _fingers(shape, gripper, settings, funnel)
    fingers = trace.fingers = surroundings.sides(fingers, funnel)

    # B.1 force balance of all pairs; B.2 torque balance
    grasps = force_balanced(fingers, settings.balance, funnel)
    grasps = torque_balanced(grasps, settings.balance, funnel)

    # B.3 grasping range; B.4 variance; B.5 operability
    grasps = closing_axes(fingers, grasps, settings.hand.closing_axis)
    grasps = on_pads(fingers, grasps, gripper, funnel)
    grasps = in_range(fingers, grasps, gripper, settings.hand, funnel)
    grasps = flat(fingers, grasps, settings.hand, funnel)
    grasps = operable(silhouette, fingers, grasps, gripper, settings.hand, funnel)
    grasps = surroundings.approached(silhouette, fingers, grasps, gripper, funnel)

    # C gravity, and the final grasp
    grasps = weighed(fingers, grasps, shape)
    grasps = best_first(grasps, Situation(shape, surroundings, gripper, settings))
    trace.ranked, trace.gravity_distance_m = np.column_stack([grasps.i, grasps.j]), grasps.gravity_distance
    return fingers, grasps.first(top)


def final(
    fingers: FingerCandidates, grasps: GraspCandidates, shape: PlaneShape, gripper: Gripper, settings: PlannerSettings
) -> GraspCandidates:
    """The grasps with what is told of final ones alone: what their pads touch, and how much of their line is inside."""
    grasps = touching(grasps, fingers, gripper, settings.hand)
    return grasps.having(inside_share=inside_share(fingers, grasps, shape.silhouette))


def _fingers(shape: PlaneShape, gripper: Gripper, settings: PlannerSettings, funnel: Funnel) -> FingerCandidates:
    """§III.A.3: places for a finger all along the boundary, the object before each of them."""
    silhouette, trace = shape.silhouette, funnel.trace
    steps = trace.steps = step_points(silhouette, settings.fingers)
    funnel.count("step_points", sum(len(step.points) for step in steps), "the outline has no step point")
    chords = finger_candidates(silhouette, steps, gripper, settings.fingers)
    funnel.count("finger_candidates", len(chords), _no_finger_place(shape, gripper))
    fingers, trace.doubted_directions = inward_directions(silhouette, chords, settings.fingers, settings.seed)
    funnel.count("grasping_direction", len(fingers), "no finger candidate has the object before it")
    return fingers


def _no_finger_place(shape: PlaneShape, gripper: Gripper) -> str:
    widest, (length, across, _) = max(gripper.jaw_width_m(0), gripper.jaw_width_m(1)), shape.box.size
    return f"the outline is {length:.3f} m × {across:.3f} m, too small for fingers {widest:.3f} m wide"
