"""What of a plan may be otherwise than it seems: a warning for each doubt, with the option that settles it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from flatgrasp_cli.geometry.spacing import spacing
from flatgrasp_cli.model import CloudWarning, Grasp, ObjectPlan, Scene, SupportPlane
from flatgrasp_cli.planner.silhouette import least_alpha_m
from flatgrasp_cli.profiles import PlannerSettings

MAX_TABLE_TILT_DEG = 30.0
"""Things slide off a table that is tilted more (friction 0.58). A camera pose that is inverted, or not of the optical
frame, is out by far more as a rule."""


def doubts(
    scene: Scene, objects: Sequence[ObjectPlan], best: Grasp | None, settings: PlannerSettings
) -> tuple[CloudWarning, ...]:
    """The warnings of what was planned of a scene, the `best` grasp of all of which comes first."""
    spacings_m = [_spacing_m(item) for item in objects]
    return (
        *_approach_ignored(scene, settings),
        *_sparse(objects, spacings_m, settings),
        *_gaps_bridged(objects, spacings_m, settings),
        *_doubtful(best, scene, settings),
    )


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


def _sparse(
    objects: Sequence[ObjectPlan], spacings_m: Sequence[float], settings: PlannerSettings
) -> tuple[CloudWarning, ...]:
    """The warning that points lie so far apart that edges are known less well than where the hand comes to stand.

    An edge is anywhere between the last point that it holds and the next one that it does not.
    """
    known_m = 2 * settings.uncertainty.figures.position_m
    if not any(each_m > known_m for item, each_m in zip(objects, spacings_m, strict=True) if item.grasps):
        return ()
    text = (
        "points lie farther apart than twice uncertainty.position_m: objects may be wider than is said, and "
        "probabilities do not count that; a nearer or denser cloud tells, and a larger uncertainty.position_m counts it"
    )
    return (CloudWarning("sparse_cloud", text),)


def _gaps_bridged(
    objects: Sequence[ObjectPlan], spacings_m: Sequence[float], settings: PlannerSettings
) -> tuple[CloudWarning, ...]:
    """The warning that the outline of an object alone is, in part, one of gaps between its points."""
    if not any(
        outline.alpha_m > least_alpha_m(outline.points, settings.silhouette, each_m)
        for item, each_m in zip(objects, spacings_m, strict=True)
        if item.object.support is None and (outline := item.silhouette) is not None
    ):
        return ()
    text = (
        "an object alone has gaps that are wider than most of its points are apart, and its outline bridges them; if "
        "they are gaps between things: --crop to one of them, or leave the plane that they stand on in the cloud"
    )
    return (CloudWarning("gaps_bridged", text),)


def _spacing_m(item: ObjectPlan) -> float:
    """How far apart points lie, metres: those of what the object stands on, or its own in the plane of its grasps."""
    if item.object.floor is not None:
        return item.object.floor.spacing_m
    return 0.0 if item.silhouette is None else spacing(item.silhouette.points)


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


def table_tilted(support: SupportPlane | None) -> tuple[CloudWarning, ...]:
    """The warning that the support plane is no table of a robot that stands upright."""
    if support is None or support.normal[2] >= math.cos(math.radians(MAX_TABLE_TILT_DEG)):
        return ()
    text = (
        f"the support plane is tilted by more than {MAX_TABLE_TILT_DEG:.0f}° against the robot's base, "
        "which is right only if the arm is not mounted upright: check --camera-pose"
    )
    return (CloudWarning("table_tilted", text),)
