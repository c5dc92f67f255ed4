"""§III of the paper, paragraph by paragraph: the silhouette of an object → its grasps in the plane, best first."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.polygon import share_inside
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, PlaneShape
from flatgrasp_cli.planner.balance import force_balance, force_balanced, torque_balanced
from flatgrasp_cli.planner.contacts import pad_contacts
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.planner.grasping_range import closing_axes, in_range, on_pads
from flatgrasp_cli.planner.gravity import best_first, gravity_distance
from flatgrasp_cli.planner.operability import operable
from flatgrasp_cli.planner.variance import flat
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.ranking import grasp_cost
from flatgrasp_cli.surroundings.interface import Surroundings


def section_three(
    shape: PlaneShape,
    surroundings: Surroundings,
    gripper: Gripper,
    settings: PlannerSettings,
    funnel: Funnel,
    top: int,
) -> GraspCandidates:
    """The best `top` grasps of an object, after A.1 and A.2, which made its `shape`.

    How many candidates each step keeps goes into the `funnel`, which ends the method where none is left by raising
    `NothingLeft`; what it saw on the way, into the funnel's trace.
    """
    outline, center, trace = shape.silhouette, shape.gravity_center.place, funnel.trace
    # A.3 step points, finger candidates, grasping directions
    steps = step_points(outline, settings.fingers)
    funnel.count("step_points", sum(len(step.points) for step in steps), "the outline has no step point")
    chords = finger_candidates(outline, steps, gripper, settings.fingers)
    funnel.count("finger_candidates", len(chords), _no_finger_place(shape, gripper))
    fingers, doubted = inward_directions(outline, chords, settings.fingers, settings.seed)
    funnel.count("grasping_direction", len(fingers), "no finger candidate has the object before it")
    fingers = surroundings.sides(fingers, funnel)
    trace.steps, trace.fingers, trace.doubted_directions = steps, fingers, doubted

    # B.1 force balance of all pairs; B.2 torque balance
    gamma_deg = trace.force_balance_deg = force_balance(fingers)
    grasps = force_balanced(fingers, gamma_deg, settings.balance, funnel)
    grasps = torque_balanced(grasps, settings.balance, funnel)

    # B.3 grasping range; B.4 variance; B.5 operability
    grasps = closing_axes(fingers, grasps, settings.hand.closing_axis)
    grasps = on_pads(fingers, grasps, gripper, funnel)
    grasps = surroundings.of_known_thickness(fingers, grasps, funnel)
    grasps = in_range(fingers, grasps, gripper, settings.hand, funnel)
    grasps = flat(fingers, grasps, settings.hand, funnel)
    grasps = operable(outline, fingers, grasps, gripper, settings.hand, funnel)
    grasps = surroundings.approached(outline, fingers, grasps, gripper, funnel)

    # C gravity, and the final grasp
    grasps = grasps.having(
        gravity_distance=gravity_distance(fingers, grasps, center),
        inside_share=share_inside(outline.loops, fingers.contact[grasps.i], fingers.contact[grasps.j]),
    )
    cost = grasp_cost(fingers, grasps, center, settings.gravity) + surroundings.cost(grasps)
    grasps = grasps.having(cost=cost)
    grasps = grasps.select(best_first(grasps))
    trace.ranked, trace.gravity_distance_m = np.column_stack([grasps.i, grasps.j]), grasps.gravity_distance
    return _touching(
        grasps.select(np.arange(min(top, len(grasps)))), fingers, gripper, settings.hand.contact_tolerance_m
    )


def _touching(
    grasps: GraspCandidates, fingers: FingerCandidates, gripper: Gripper, tolerance_m: float
) -> GraspCandidates:
    """The final grasps with what their pads touch, boundary within `tolerance_m` of it counting as touched."""
    touched = np.stack([fingers.width[grasps.i], fingers.width[grasps.j]], axis=1)
    return grasps.having(
        contacts=pad_contacts(fingers, grasps, gripper, tolerance_m),
        touched_m=np.minimum(gripper.finger_width_m, touched),
        variance=fingers.variance[grasps.i] + fingers.variance[grasps.j],
        arc_ratio=np.maximum(fingers.arc_ratio[grasps.i], fingers.arc_ratio[grasps.j]),
    )


def _no_finger_place(shape: PlaneShape, gripper: Gripper) -> str:
    widest, (length, across, _) = max(gripper.jaw_width_m(0), gripper.jaw_width_m(1)), shape.box.size
    return f"the outline is {length:.3f} m × {across:.3f} m, too small for fingers {widest:.3f} m wide"
