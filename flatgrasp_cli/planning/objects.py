"""One object → its grasps in the plane: the method on each place that it can be grasped in, and the best answer."""

from __future__ import annotations

from functools import reduce

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectCloud, OrientedBox, Rejection, Stage, Trace
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planning.answers import Answer, Search
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.surroundings import Place, Tilted, box_on, from_the_side, hanging_m, places, ways


def answer_for(cloud: ObjectCloud, gripper: Gripper, settings: PlannerSettings) -> Answer:
    """The best grasps of one object in the plane, with `settings` as `PlannerSettings.resolve` returns them.

    They have certificates where these decide which is best.

    An object alone is planned as in the paper. Over a support plane the method runs on each of the object's slices, and
    the grasps are those of the slice with the best one. What a hand that comes straight down cannot grasp, or only with
    its palm close to something, is planned for hands that come aslant, and a standing object at last in the main plane
    of its own bounding box.
    """
    if cloud.support is None:
        box = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
    else:
        box = box_on(cloud.support, cloud.points, settings.main_plane.method)
    if box is None:
        return _nothing("main_plane", _no_plane(cloud.points, settings.scene.crop is not None))
    whole, *slices = places(cloud, box, settings)
    if hanging := hanging_m(whole):
        reason = f"it hangs {1e3 * hanging:.0f} mm up in the air: only free space was seen below it"
        return _nothing("support", reason)
    search = Search(gripper, settings)
    best = _aslant(search, cloud, box, search.whole(whole, slices))
    if cloud.support is not None and best.grasps is None and (side := _standing(cloud, box.size, settings)):
        best = search.better(best, search.whole(side, ()))
    return best


def _aslant(search: Search, cloud: ObjectCloud, box: OrientedBox, best: Answer) -> Answer:
    """The answer for a hand that comes aslant, if that is better than the `best` one for a hand straight down.

    The tilts are tried one after the other, until one of them leaves grasps. If none does, it is the latter that says
    why: people look for that first.
    """
    blocked = best.rejection is not None and best.rejection.cause == "palm"
    tried = cloud.in_container or blocked or search.settings.approach.tried == "always"
    if cloud.floor is None or not tried or (best.grasps is not None and not _is_close(best, search.settings)):
        return best
    tilted = Tilted(cloud, cloud.floor, search.settings)
    for directions in ways(cloud, box.frame.axes[0], search.settings):
        placed = [place for toward in directions if (place := tilted.place(toward, search.gripper))]
        answers = [search.whole(place, ()) for place in placed]
        best = reduce(search.better, (answer for answer in answers if answer.grasps is not None), best)
        if best.grasps is not None:
            break
    return best


def _is_close(best: Answer, settings: PlannerSettings) -> bool:
    """Whether the palm of the best grasp comes closer to something than is aimed at beside the pads."""
    room = best.grasps.palm_room if best.grasps is not None else np.empty(0)
    return len(room) > 0 and bool(room[0] < settings.hand.preshape_m)


def _standing(cloud: ObjectCloud, size: FloatArray, settings: PlannerSettings) -> Place | None:
    """The place to grasp an object of `size` (3,) from the side; None when it is too low for that."""
    if size[2] < settings.depth.standing_ratio * size[:2].max():
        return None
    box = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
    return None if box is None else from_the_side(cloud, box, settings)


def _nothing(stage: str, reason: str) -> Answer:
    """The answer for what cannot be planned at all."""
    return Answer((Stage(stage, 0),), Rejection(stage, reason), Trace())


def _no_plane(points: FloatArray, cropped: bool) -> str:
    if len(points) == 0 and cropped:
        return "no point lies in the region of interest"
    if len(points) == 0:
        return (
            "no point of the cloud was measured: all are invalid, 0 0 0, farther than 10 km from the origin, "
            "or within 1 cm of the sensor; are they in metres (--scale)?"
        )
    distinct = len(np.unique(points, axis=0))
    if distinct < 3:
        return f"the cloud has {distinct} distinct point{'s' if distinct > 1 else ''}, an outline needs three"
    return f"all {len(points)} points lie on a line"
