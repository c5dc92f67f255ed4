"""One object → its grasps in the plane: the method from each direction that hands may come from, and which is best."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectCloud, OrientedBox, Rejection, Stage, Trace
from flatgrasp_cli.planner.main_plane import oriented_box
from flatgrasp_cli.planner.silhouette import STRAY_M, largest_share
from flatgrasp_cli.planning.answers import Answer
from flatgrasp_cli.planning.search import Search
from flatgrasp_cli.profiles.settings import PlannerSettings, SilhouetteSettings
from flatgrasp_cli.surroundings import (
    Direction,
    Place,
    Tilted,
    asked_of,
    beside,
    between,
    box_across,
    box_on,
    directions,
    hanging_m,
    not_allowed,
    places,
    tilt_deg,
)


def answer_for(cloud: ObjectCloud, search: Search) -> Answer:
    """The best grasps of one object in the plane; they have certificates where these decide which is best.

    An object alone is planned as in the paper. Over a support plane the method runs on each of the object's slices, and
    the grasps are those of the slice with the best one; where straight down is not enough, from other directions, too.
    """
    box = _box(cloud, search.settings)
    if box is None:
        return _nothing(Rejection("main_plane", _no_plane(cloud.points, search.settings.scene.crop is not None)))
    slices = places(cloud, box, search.gripper, search.settings)
    whole = next(slices)
    if hanging := hanging_m(whole):
        reason = f"it hangs {1e3 * hanging:.0f} mm up in the air: only free space was seen below it"
        return _nothing(Rejection("support", reason))
    if refused := not_allowed(cloud, search.settings.approach) or _in_pieces(whole, search.settings.silhouette):
        return _nothing(refused)
    if cloud.support is None or cloud.floor is None:
        stated = _stated(cloud, search.settings) if cloud.support is None else None
        return replace(search.whole(whole, slices), direction=stated)
    asked = search.settings.approach.directions
    first = search.whole(whole, slices) if asked in ("auto", "top", "any") else None
    if first and (asked == "top" or (asked == "auto" and search.is_enough(first))):
        return first
    most_m3 = first.shape.volume_m3 if first and first.shape else search.volume_m3(whole)
    return _from_any_side(search, Tilted(cloud, cloud.floor, search.settings), box, first, most_m3)


def _from_any_side(search: Search, tilted: Tilted, box: OrientedBox, found: Answer | None, most_m3: float) -> Answer:
    """The best answer for hands that come from any side, the one for straight down among them if that was `found`.

    Directions are tried one after the other until one is enough. If none is, those beside the best one are tried, too;
    if none leaves a grasp, it is the nearest miss that says why.
    """
    cloud, settings = tilted.cloud, search.settings
    if search.between:
        ways = between(cloud, box.frame.axes[0], settings.approach)
    else:
        own = oriented_box(cloud.points, cloud.toward, settings.main_plane.method)
        ways = directions(cloud, box.frame.axes[0], own, settings.approach)
    best = _best_of(search, tilted, ways, found, most_m3)
    if best is not None and best.direction is not None and not search.is_enough(best):
        best = _best_of(search, tilted, beside(best.direction, cloud, settings.approach), best, most_m3)
    if best is None:
        return _nothing(
            Rejection("palm_room", "from no direction that was asked for has the palm room over the object")
        )
    if found is None or best is found:
        return best
    if not best.is_served and found.grasps is not None:
        return found  # the arm gets to none of them: people look for those from straight above
    return replace(best, why_not_top=search.shortcoming(found)) if best.grasps else _nearest(found, best, cloud)


def _best_of(
    search: Search, tilted: Tilted, ways: Iterable[Direction], best: Answer | None, most_m3: float
) -> Answer | None:
    """The best of an answer and those for hands that come some `ways`, as far as they are tried."""
    for direction in ways:
        if search.is_in_vain(direction.toward, best):
            continue
        answer = _from(search, tilted, direction, most_m3)
        best = search.better(best, answer) if best and answer else best or answer
        if best is not None and search.settings.approach.directions == "auto" and search.is_enough(best):
            break
    return best


def _nearest(top: Answer, aslant: Answer, cloud: ObjectCloud) -> Answer:
    """The answer `top` for straight down, which people look for first, with the nearer miss of another direction."""
    missed, nearer = top.rejection, aslant.rejection
    if missed is None or nearer is None or aslant.direction is None or cloud.support is None:
        return top
    tilt = tilt_deg(aslant.direction.toward, cloud.support.normal)
    return replace(top, rejection=replace(missed, reason=f"{missed.reason}; {tilt:.0f}° aslant, {nearer.reason}"))


def _from(search: Search, tilted: Tilted, direction: Direction, most_m3: float) -> Answer | None:
    """The answer for a hand that comes from one direction; None where there is no room for its palm."""
    places = tilted.places(direction.toward, search.gripper)
    whole = next(places, None)
    return None if whole is None else replace(search.whole(whole, places, most_m3), direction=direction)


def _box(cloud: ObjectCloud, settings: PlannerSettings) -> OrientedBox | None:
    """The box whose main plane the method runs in first: an object's own, if it is alone and nothing else is asked."""
    method = settings.main_plane.method
    if cloud.support is not None:
        return box_on(cloud.support, cloud.points, method)
    if stated := _stated(cloud, settings):
        return box_across(stated.toward, cloud.points, method)
    return oriented_box(cloud.points, cloud.toward, method)


def _stated(cloud: ObjectCloud, settings: PlannerSettings) -> Direction | None:
    """The direction in which the settings want an object alone to be gripped; straight down if the way up is known."""
    asked, up = settings.approach.directions, settings.scene.up
    toward = asked_of(cloud, settings.approach)
    if toward is not None:
        return Direction(toward, "view" if asked == "view" else "given")
    return Direction(np.asarray(up) / np.linalg.norm(up), "top") if asked == "top" and up is not None else None


def _in_pieces(whole: Place, settings: SilhouetteSettings) -> Rejection | None:
    """Why points that lie apart in the main plane are no object alone: its outline would be one of air."""
    if whole.surroundings.level_m is not None:
        return None
    projected, least = np.ascontiguousarray(whole.points[:, :2]), settings.min_coverage
    share = largest_share(projected, settings, whole.spacing_m)
    if share >= least:
        return None
    reason = (
        f"the points lie in pieces more than about {1e3 * STRAY_M:.0f} mm apart: the largest has {100 * share:.0f} % "
        f"of them, an object alone {100 * least:.0f} %"
    )
    return Rejection("silhouette", reason, share, least)


def _nothing(rejection: Rejection) -> Answer:
    """The answer for what cannot be planned at all."""
    return Answer((Stage(rejection.stage, 0),), rejection, Trace())


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
