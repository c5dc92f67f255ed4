"""Beyond the paper: from where hands come to what stands on a support plane, and in which order that is tried."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.model import ObjectCloud, OrientedBox, Rejection
from flatgrasp_cli.profiles.settings import ApproachSettings
from flatgrasp_cli.profiles.settings.beyond import LEAST_TILT_DEG


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """A unit vector `toward` (3,) that a hand comes against, and what it follows from."""

    toward: FloatArray
    known_from: Literal["top", "main_plane", "view", "tilt", "given"]


def asked_of(cloud: ObjectCloud, settings: ApproachSettings) -> FloatArray | None:
    """The unit vector (3,) against which the settings want hands to come to an object; None if there are several.

    What is meant as the largest tilt is that: a direction along the support plane is asked for by rounded numbers.
    """
    if isinstance(settings.directions, tuple):
        toward = -_unit(np.array(settings.directions))
    elif settings.directions == "view" and cloud.viewpoint is not None:
        toward = _to_sensor(cloud.viewpoint, cloud.points)
    else:
        return None
    if cloud.support is None:
        return toward
    normal = cloud.support.normal
    beyond_deg = tilt_deg(toward, normal) - settings.max_tilt_deg
    if not 0 < beyond_deg <= LEAST_TILT_DEG:
        return toward
    side = _unit(toward - (toward @ normal) * normal)
    return _tilted(normal, side, float(np.radians(settings.max_tilt_deg)), 0.0).toward


def not_allowed(cloud: ObjectCloud, settings: ApproachSettings) -> Rejection | None:
    """Why hands do not come to an object the way that is asked for; None if they do, or if there are several ways."""
    toward = asked_of(cloud, settings)
    if toward is None:
        unknown = "where the sensor was is not known, and so no view along which the hand could come"
        return Rejection("approach", unknown, cause="view") if settings.directions == "view" else None
    tilt, limit = 0.0 if cloud.support is None else tilt_deg(toward, cloud.support.normal), settings.max_tilt_deg
    if tilt <= limit + LEAST_TILT_DEG:
        return None
    x, y, z = (-toward).tolist()
    words = f"a hand along {x:.2f}, {y:.2f}, {z:.2f} comes {tilt:.0f}° off straight down"
    if tilt > 90 + LEAST_TILT_DEG:
        return Rejection("approach", f"{words}, from below the support plane", tilt, limit, cause="below")
    return Rejection("approach", f"{words}, allowed {limit:g}°", tilt, limit, cause="tilt")


def directions(
    cloud: ObjectCloud, across: FloatArray, own: OrientedBox | None, settings: ApproachSettings
) -> Iterator[Direction]:
    """The directions other than straight down, in the order of trying them.

    First come the sensor's view and the normal of the object's `own` box, then tilts around the support plane's normal.
    The first of each is tilted along `across` (3,), a side of the object: then the ends of fingers that close along
    that side, or across it, are parallel to the plane, and get as low as they can.
    """
    asked = asked_of(cloud, settings)
    if settings.directions in ("auto", "any"):
        yield from _met_in_sight(cloud, _all_around(cloud, across, own, settings))
    elif asked is not None:
        yield Direction(asked, "view" if settings.directions == "view" else "given")


def _all_around(
    cloud: ObjectCloud, across: FloatArray, own: OrientedBox | None, settings: ApproachSettings
) -> Iterator[Direction]:
    """The directions of a search that was told none."""
    if cloud.support is None:
        return
    normal = cloud.support.normal
    first = [] if own is None else [Direction(own.frame.axes[2], "main_plane")]
    if cloud.viewpoint is not None:
        first.append(Direction(_to_sensor(cloud.viewpoint, cloud.points), "view"))
    least_deg = min(settings.tilts_deg, default=LEAST_TILT_DEG)  # what is turned by less is as good as straight down
    yield from (each for each in first if least_deg < tilt_deg(each.toward, normal) <= settings.max_tilt_deg)
    yield from _tilts(normal, across, settings, 0.0)


def between(cloud: ObjectCloud, across: FloatArray, settings: ApproachSettings) -> Iterator[Direction]:
    """The same tilts halfway between the sides that were tried, for what cannot be had from any of those.

    Of a search that was told its directions there are none.
    """
    if cloud.support is not None and settings.directions in ("auto", "any"):
        yield from _met_in_sight(cloud, _tilts(cloud.support.normal, across, settings, 0.5))


def _tilts(normal: FloatArray, across: FloatArray, settings: ApproachSettings, first: float) -> Iterator[Direction]:
    """All tilts around, the `first` by a share of the angle between two turned from `across` (3,)."""
    turns = 2 * np.pi * (first + np.arange(settings.around)) / settings.around
    for tilt in np.radians([each for each in settings.tilts_deg if each <= settings.max_tilt_deg]):
        yield from (_tilted(normal, across, float(tilt), float(turn)) for turn in turns)


def beside(direction: Direction, cloud: ObjectCloud, settings: ApproachSettings) -> Iterator[Direction]:
    """The directions around one that was nearly enough, halfway to those that were tried beside it.

    Of a search that was told its directions there are none.
    """
    if cloud.support is None or settings.directions not in ("auto", "any"):
        return
    normal = cloud.support.normal
    tilt = np.radians(tilt_deg(direction.toward, normal))
    side = _unit(direction.toward - (direction.toward @ normal) * normal)
    ways = (
        _tilted(normal, side, float(share * tilt), float(turn))
        for turn in np.pi / settings.around * np.array([0.0, 1.0, -1.0])
        for share in (1.0, np.sqrt(0.5), np.sqrt(2.0))  # tilts double from one to the next
        if (turn != 0 or share != 1) and share * tilt <= np.radians(settings.max_tilt_deg)
    )
    yield from _met_in_sight(cloud, ways)


def _met_in_sight(cloud: ObjectCloud, ways: Iterable[Direction]) -> Iterator[Direction]:
    """The `ways` that do not come from behind: a hand that comes towards the sensor meets a side that it did not see.

    What is meant as across its view is that.
    """
    if cloud.viewpoint is None:
        yield from ways
        return
    view, least = _to_sensor(cloud.viewpoint, cloud.points), -np.sin(np.radians(LEAST_TILT_DEG))
    yield from (each for each in ways if each.toward @ view >= least)


def _tilted(normal: FloatArray, side: FloatArray, tilt: float, turn: float) -> Direction:
    """The direction tilted from the plane's `normal` (3,) toward a `side` (3,) of the plane, turned; radians."""
    level = np.cos(turn) * side + np.sin(turn) * np.cross(normal, side)
    return Direction(np.cos(tilt) * normal + np.sin(tilt) * level, "tilt")


def tilt_deg(toward: FloatArray, normal: FloatArray) -> float:
    """How far from straight down on a plane with a unit `normal` (3,) hands against `toward` (3,) come, degrees."""
    return float(np.degrees(np.arccos(np.clip(toward @ normal, -1.0, 1.0))))


def _to_sensor(viewpoint: FloatArray, points: FloatArray) -> FloatArray:
    """The unit vector (3,) from the middle of `points` (n, 3) to where the sensor was."""
    return _unit(viewpoint - mean_of(points))


def _unit(vector: FloatArray) -> FloatArray:
    """A vector (3,) of length 1 that points the same way."""
    return np.asarray(vector / np.linalg.norm(vector))
