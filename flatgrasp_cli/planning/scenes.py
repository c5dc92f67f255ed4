"""One cloud → one Plan: composes scene, planner and robot; what the command line and the Python API call."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.model import Cloud, CloudWarning, Grasp, ObjectPlan, Scene, SupportPlane
from flatgrasp_cli.planner.silhouette import least_alpha_m
from flatgrasp_cli.planning.lifting import LISTED, plan_object
from flatgrasp_cli.profiles import Gripper, PlannerSettings, Robot, load_settings
from flatgrasp_cli.ranking import by_probability
from flatgrasp_cli.scene import segment, without_far_strays, without_repeats
from flatgrasp_cli.sensor import located

MAX_TABLE_TILT_DEG = 30.0
"""Things slide off a table that is tilted more (friction 0.58). A camera pose that is inverted, or not of the optical
frame, is out by far more as a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The answer for one cloud, with the profiles and the settings that it was found with.

    `gripper` is the hand that was planned for: what the method makes of the profile.
    `cloud` is the one that was planned on: its `sensor` is where the sensor was taken to be, and why.
    """

    cloud: Cloud
    gripper: Gripper
    robot: Robot | None
    settings: PlannerSettings
    scene: Scene
    objects: tuple[ObjectPlan, ...]
    scene_ms: float
    plan_ms: float

    @property
    def best(self) -> Grasp | None:
        """The best grasp of the first object that has one."""
        return next((obj.grasps[0] for obj in self.objects if obj.grasps), None)

    @property
    def warnings(self) -> tuple[CloudWarning, ...]:
        """What had to be assumed and can change the answer."""
        return tuple(
            dict.fromkeys(
                (
                    *self.cloud.warnings,
                    *self.scene.warnings,
                    *_approach_ignored(self.scene, self.settings),
                    *_sparse(self.objects, self.settings),
                    *_gaps_bridged(self.objects, self.settings),
                    *_doubtful(self.best, self.scene, self.settings),
                )
            )
        )

    @property
    def reason(self) -> str | None:
        """Why there is no grasp; None when there is one."""
        if self.best is not None:
            return None
        if not self.objects:
            return self.scene.reason
        rejection = self.objects[0].rejection
        return rejection.reason if rejection else None


def plan(
    cloud: Cloud,
    gripper: Gripper,
    settings: PlannerSettings | None = None,
    *,
    top: int = LISTED,
    robot: Robot | None = None,
) -> Plan:
    """Plan grasps on a cloud that shows one object alone, or objects on a support plane.

    Parameters
    ----------
    cloud
        From `read_clouds`, or made of an array of points in metres: `Cloud(points)`.
    gripper
        From `load_gripper`.
    settings
        From `load_settings`; the shipped ones when None.
    top
        How many grasps of each object to keep, best first; `ValueError` if less than one.
    robot
        From `load_robot`: only grasps that it reaches are kept. The cloud must be in its base frame (`in_base_frame`).
    """
    if top < 1:
        raise ValueError(f"top is how many grasps to keep, one or more, not {top}")
    resolved = (settings or load_settings()).resolve(gripper, robot)
    if resolved.hand.model == "paper":
        gripper = gripper.in_the_papers_symbols()
    began = time.perf_counter()
    cloud = located(without_far_strays(without_repeats(cloud)), resolved.scene.up, resolved.seed)
    scene = segment(cloud, resolved.scene, resolved.seed)
    scene = replace(scene, warnings=(*scene.warnings, *_table_tilted(scene.support))) if robot else scene
    segmented = time.perf_counter()
    plans = _planned(scene, gripper, resolved, top, robot)
    objects = tuple(in_picking_order(plans))
    scene_ms, plan_ms = 1e3 * (segmented - began), 1e3 * (time.perf_counter() - segmented)
    return Plan(
        cloud=cloud,
        gripper=gripper,
        robot=robot,
        settings=resolved,
        scene=scene,
        objects=objects,
        scene_ms=scene_ms,
        plan_ms=plan_ms,
    )


def _planned(
    scene: Scene, gripper: Gripper, settings: PlannerSettings, top: int, robot: Robot | None
) -> list[ObjectPlan]:
    """The plans of a scene's objects; where objects touch and none of them has a grasp, that of all of them as one."""
    plans = [plan_object(item, gripper, settings, top, robot) for item in scene.objects]
    for whole in scene.wholes:
        parts = [item for item in plans if item.object.group == whole.group]
        if parts and not any(item.grasps for item in parts):
            found = plan_object(whole, gripper, settings, top, robot)
            plans = [*(item for item in plans if item not in parts), found] if found.grasps else plans
    if any(item.grasps for item in plans) or settings.approach.directions not in ("auto", "any"):
        return plans
    return [_once_more(item, gripper, settings, top, robot) for item in plans]


def _once_more(
    item: ObjectPlan, gripper: Gripper, settings: PlannerSettings, top: int, robot: Robot | None
) -> ObjectPlan:
    """The plan for an object of a scene in which nothing has a grasp: from the sides between those that were tried."""
    if item.object.support is None:
        return item
    found = plan_object(item.object, gripper, settings, top, robot, between=True)
    return found if found.grasps else item


def _doubtful(best: Grasp | None, scene: Scene, settings: PlannerSettings) -> tuple[CloudWarning, ...]:
    """The warning that what comes first is no good grasp, but the best of the sides that hands were to come from."""
    if best is None or best.success is None:
        return ()
    if best.success.probability >= settings.approach.enough:
        return ()
    if settings.ranking.prefer != "success":
        sides = f"for {settings.ranking.prefer} decides which is best (--prefer success takes what most probably holds)"
    elif scene.support is None:
        sides = "from the one side that an object alone is tried from (--approach X,Y,Z states another)"
    elif settings.approach.directions in ("auto", "any"):
        sides = f"whatever side it comes from, up to {settings.approach.max_tilt_deg:g}° off straight down (--max-tilt)"
    else:
        sides = "from the only side that was asked for (--approach any tries all)"
    text = (
        f"the best grasp holds with a probability of less than approach.enough, {sides}: "
        "its success.causes say why, and a view from another side may show a better one"
    )
    return (CloudWarning("doubtful_grasp", text),)


def _sparse(objects: Sequence[ObjectPlan], settings: PlannerSettings) -> tuple[CloudWarning, ...]:
    """The warning that points lie so far apart that edges are known less well than where the hand comes to stand.

    An edge is anywhere between the last point that it holds and the next one that it does not.
    """
    known_m = 2 * settings.uncertainty.figures.position_m
    if not any(_spacing_m(item) > known_m for item in objects if item.grasps):
        return ()
    text = (
        "points lie farther apart than twice uncertainty.position_m: objects may be wider than is said, and "
        "probabilities do not count that; a nearer or denser cloud tells, and a larger uncertainty.position_m counts it"
    )
    return (CloudWarning("sparse_cloud", text),)


def _gaps_bridged(objects: Sequence[ObjectPlan], settings: PlannerSettings) -> tuple[CloudWarning, ...]:
    """The warning that the outline of an object alone is, in part, one of gaps between its points."""
    alone = [item.silhouette for item in objects if item.object.support is None and item.silhouette is not None]
    if not any(each.alpha_m > least_alpha_m(each.points, settings.silhouette) for each in alone):
        return ()
    text = (
        "an object alone has gaps between its points, which its outline bridges as if nothing were missing but a few "
        "pixels; if they are gaps between things: --crop to one of them, or leave the plane that they stand on in the "
        "cloud"
    )
    return (CloudWarning("gaps_bridged", text),)


def _spacing_m(item: ObjectPlan) -> float:
    """How far apart points lie, metres: those of what the object stands on, or its own in the plane of its grasps."""
    if item.object.floor is not None:
        return item.object.floor.spacing_m
    return 0.0 if item.silhouette is None else spacing(item.silhouette.points)


def _approach_ignored(scene: Scene, settings: PlannerSettings) -> tuple[CloudWarning, ...]:
    """The warning that an object alone is gripped across its own main plane, whatever side was wanted."""
    asked, limit_deg = settings.approach.directions, settings.approach.max_tilt_deg
    if scene.support is not None or not scene.objects or isinstance(asked, tuple) or asked == "view":
        return ()
    if asked == "top" and settings.scene.up is not None:
        return ()
    ignored = (f"--approach {asked}" if asked != "auto" else "", f"--max-tilt {limit_deg:g}" if limit_deg < 90 else "")
    if not any(ignored):
        return ()
    text = (
        f"{' and '.join(filter(None, ignored))}: an object alone is gripped across its main plane, however that lies; "
        "--approach X,Y,Z states a direction, and so does --approach top with --up X,Y,Z"
    )
    return (CloudWarning("approach_ignored", text),)


def _table_tilted(support: SupportPlane | None) -> tuple[CloudWarning, ...]:
    """The warning that the support plane is no table of a robot that stands upright."""
    if support is None or support.normal[2] >= math.cos(math.radians(MAX_TABLE_TILT_DEG)):
        return ()
    text = (
        f"the support plane is tilted by more than {MAX_TABLE_TILT_DEG:.0f}° against the robot's base, "
        "which is right only if the arm is not mounted upright: check --camera-pose"
    )
    return (CloudWarning("table_tilted", text),)


def in_picking_order(plans: list[ObjectPlan]) -> Iterator[ObjectPlan]:
    """The order of picking: that of the objects' best grasps, but later what others lie on, or what lies at an edge.

    Of grasps that hold as probably, those from straight above come first: what stands beside the others may be gone by
    then. Gravity distances of different objects compare only where nothing else does. Objects without a grasp come
    last, larger first.
    """
    for _, alike in groupby(sorted(plans, key=_how_late), key=_how_late):
        items = sorted(alike, key=lambda item: -len(item.object.points))
        best = [item.grasps[0] if item.grasps else None for item in items]
        chances = np.array([grasp.success.probability if grasp and grasp.success else 0.0 for grasp in best])
        distances = np.array([grasp.gravity_distance_m if grasp else 0.0 for grasp in best])
        aslant = np.array([grasp is not None and grasp.approach.known_from != "top" for grasp in best])
        places = np.argsort(np.lexsort((distances, -chances, aslant)))
        yield from (items[k] for k in by_probability(chances, places))


def _how_late(item: ObjectPlan) -> tuple[bool, bool, bool]:
    """What comes later whatever its grasps are like."""
    cloud = item.object
    return (not item.grasps, cloud.cut_off or cloud.at_edge, bool(cloud.supports))
