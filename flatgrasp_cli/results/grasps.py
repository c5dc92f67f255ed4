"""A grasp as a part of documents: poses, metrics, proofs and reach."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, TypeVar, cast

from flatgrasp_cli.model import Grasp, Pose, Poses, Reach
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.results.contracts.grasps import (
    ApproachPart,
    GraspPart,
    JointsPart,
    MetricsPart,
    PosePart,
    PosesPart,
    ReachPart,
)
from flatgrasp_cli.results.numbers import number, numbers, rounded

if TYPE_CHECKING:
    from flatgrasp_cli.model.grasps import Cage, Closure, Success

Thing = TypeVar("Thing")
Made = TypeVar("Made")


def optional(part: Callable[[Thing], Made], thing: Thing | None) -> Made | None:
    """The part that is made of a thing; None without one."""
    return None if thing is None else part(thing)


def grasp_part(grasp: Grasp, gripper: Gripper) -> GraspPart:
    """The part of a plan's document that tells one grasp of a gripper."""
    return GraspPart(
        rank=grasp.rank,
        pose=pose_part(Pose(grasp.position, grasp.orientation)),
        pre_grasp=pose_part(grasp.pre_grasp),
        tilt_deg=number(grasp.tilt_deg),
        approach=ApproachPart(
            direction=numbers(grasp.approach.direction),
            tilt_deg=number(grasp.approach.tilt_deg),
            known_from=grasp.approach.known_from,
        ),
        lift=pose_part(grasp.lift),
        flange=_poses(grasp.flange),
        hand=None if grasp.hand is grasp.flange else _poses(grasp.hand),
        tip_shift_m=number(gripper.finger_length_at_m(grasp.width_m) - gripper.finger_length_at_m(grasp.opening_m)),
        opening_m=number(grasp.opening_m),
        width_m=number(grasp.width_m),
        contacts=numbers(grasp.contacts),
        fingers=cast(Any, list(grasp.fingers)),
        success=optional(_fields, grasp.success),
        metrics=cast(MetricsPart, {name: number(getattr(grasp, name, None)) for name in MetricsPart.__annotations__}),
        force_closure=optional(_fields, grasp.closure),
        cage=optional(_fields, grasp.cage),
        reach=optional(_reach, grasp.reach),
    )


def _poses(poses: Poses) -> PosesPart:
    return PosesPart(pose=pose_part(poses.pose), pre_grasp=pose_part(poses.pre_grasp), lift=pose_part(poses.lift))


def pose_part(pose: Pose) -> PosePart:
    """A pose."""
    return PosePart(position=numbers(pose.position), orientation=numbers(pose.orientation))


def _reach(reach: Reach) -> ReachPart:
    joints = None if reach.joints_rad is None else numbers(reach.joints_rad)
    return ReachPart(
        ok=reach.ok,
        joints_rad=joints and JointsPart(pre_grasp=joints[0], grasp=joints[1], lift=joints[2]),
        manipulability=number(reach.manipulability),
        manipulability_share=number(reach.manipulability_share),
        twin=reach.twin,
        waypoint=reach.waypoint,
        limit=reach.limit,
    )


def _fields(record: Cage | Closure | Success) -> Any:
    """What a record of numbers holds, by name."""
    return rounded(asdict(record))
