"""What would help where no object was found, or too little of one seen."""

from __future__ import annotations

import math

from flatgrasp_cli.model import ObjectPlan, Rejection
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles.settings.method import LEAST_COVERAGE
from flatgrasp_cli.results.remedies.words import down, up
from flatgrasp_cli.scene import NO_OBJECT_AT, NO_PLANE, NOTHING_STANDS

OTHER_VIEW = "look from another side; if the cloud is merged from several views: --sensor none"


def of_scene(plan: Plan) -> str | None:
    """Where no object was found at all."""
    scene, settings = plan.scene, plan.settings.scene
    if scene.reason == NO_PLANE:
        least = f"a plane needs {100 * settings.min_plane_share:.0f} % of the points"
        return (
            f"--scene object takes all for one object; {least} (--crop to the table), and --up X,Y,Z helps to find it"
        )
    if scene.reason and scene.reason.startswith(NO_OBJECT_AT):
        return "--object X,Y is in metres, in the frame of the answer; without it all are planned, each with its place"
    if scene.reason != NOTHING_STANDS or scene.support is None:
        return "choose a region with --crop; if the cloud is in millimetres: --scale 0.001" if scene.reason else None
    others = "if the plane is part of the object: --scene object; if it is the wrong one: --up X,Y,Z"
    if len(scene.clutter) == 0:
        return f"nothing lower than {1e3 * settings.min_height_m:g} mm counts (--set scene.min_height_m); {others}"
    highest = 1e3 * float(scene.support.heights(scene.clutter).max())
    return (
        f"{len(scene.clutter)} points up to {highest:.0f} mm above it belong to no object, which is "
        f"{1e3 * settings.min_size_m:.0f} to {1e3 * settings.max_size_m:.0f} mm long (--set scene.min_size_m, "
        f"scene.max_size_m) and not cut off at the plane's edge; {others}"
    )


def no_points(plan: Plan, item: ObjectPlan, _rejection: Rejection) -> str | None:
    """Where the region of interest holds nothing: where the cloud is."""
    if plan.settings.scene.crop is None or len(plan.cloud.points) == 0 or len(item.object.points) > 0:
        return None
    low, high = plan.cloud.points.min(axis=0), plan.cloud.points.max(axis=0)
    spans = (f"{axis} {a:.3f} … {b:.3f}" for axis, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True))
    return f"nothing is left after --crop: the cloud spans {', '.join(spans)} m"


def hanging(_plan: Plan, _item: ObjectPlan, _rejection: Rejection) -> str:
    """Where only free space was seen below a small thing."""
    return "a stereo camera sees such things where nothing is; if it is real: --sensor none"


def one_piece(_plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str | None:
    """Where an object alone is in pieces: they may be several things."""
    if rejection.value is None:
        return None
    remedy = "if they are several things: --crop to one of them, or leave the plane that they stand on in the cloud"
    if rejection.value < LEAST_COVERAGE:
        return remedy
    return f"{remedy}; if the largest is meant: --set silhouette.min_coverage={down(rejection.value)}"


def other_view(_plan: Plan, _item: ObjectPlan, _rejection: Rejection) -> str:
    """Where what was not seen decides."""
    return OTHER_VIEW


def unseen(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str:
    """Where hidden ways are refused: to hands from straight above by one setting, to others by a second one, too."""
    if plan.settings.depth.unseen == "refuse":
        return f"--set depth.unseen=rank lets such grasps hold less probably instead; or {OTHER_VIEW}"
    if rejection.value is None:
        return OTHER_VIEW
    return f"--set approach.hidden_share={up(rejection.value)} allows as much; or {OTHER_VIEW}"


def other_direction(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str:
    """Where the hand does not come the way that is asked for."""
    if rejection.cause == "view":
        return "--sensor X,Y,Z states it, or --approach auto"
    asked = plan.settings.approach.directions
    if rejection.cause == "below" and isinstance(asked, tuple):
        opposite = ",".join(f"{-each + 0.0:g}" for each in asked)  # never a -0
        return f"vectors point the way that the hand moves: --approach={opposite} is the opposite one"
    if rejection.cause == "below" or rejection.value is None:
        return "--approach auto; if the sensor was above: --sensor X,Y,Z states where"
    return f"--max-tilt {min(math.ceil(rejection.value), 90)} allows it, or --approach auto"
