"""Decides where the sensor was that saw a cloud.

What somebody says is believed, then what the image's geometry or the recording's transforms tell, then a viewpoint that
the file states, if the cloud can have been seen from there. Else places are held against the cloud's own shape; and
where that does not decide, either, the way up does, or the origin is assumed, with a warning.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.frames import axes_about
from flatgrasp_cli.kernels.points import near
from flatgrasp_cli.model import SENSOR_FROM_TF, UP_UNTOLD, Cloud, CloudWarning, Sensor
from flatgrasp_cli.model.clouds import LARGEST_COORDINATE_M
from flatgrasp_cli.sensor.frame_names import has_z_up
from flatgrasp_cli.sensor.projection import center_of_projection
from flatgrasp_cli.sensor.surface import Surface, Verdict

Z_UP = np.array([0.0, 0.0, 1.0])
LEAST_POINTS = 10
OVERHEAD_M = 1.0
TILTS_DEG, AROUND = (0.0, 30.0, 55.0), 8
"""Places above a cloud that a sensor may have looked down from, and how many of each tilt."""
WIDEST_VIEW_COS = np.cos(np.radians(45))
"""A camera sees what lies within this angle of its line of sight: wider ones are rare."""
IN_VIEW_SHARE = 0.95
SAME_PLACE_M, LENS_M = 0.05, 0.1
"""Places this near to each other count as one; a lens that is no pinhole moves the centre that a pinhole would have."""
NEAREST_M = 0.01
"""No sensor sees what is closer to it: invalid points that were transformed lie at its own place."""
REMEDY = "--sensor X,Y,Z, above or none states where it was"


def located(cloud: Cloud, up: tuple[float, float, float] | None, seed: int) -> Cloud:
    """The cloud with its sensor, a warning where that had to be assumed, and without points at the sensor's place.

    `up` (3,), of any length, is the way up in the cloud's frame, where that is known.
    """
    rng = np.random.default_rng(seed)
    if cloud.viewpoint is not None and np.abs(cloud.viewpoint).max() > LARGEST_COORDINATE_M:
        cloud = replace(cloud, viewpoint=None, inverse_viewpoint=None)
    upward = None if up is None else np.asarray(up) / np.linalg.norm(up)
    sensor, warnings = _stated(cloud, upward, rng)
    if sensor is None and len(cloud.points) < LEAST_POINTS:  # which nothing can be grasped of
        sensor = Sensor("assumed", np.zeros(3)) if cloud.viewpoint is None else Sensor("viewpoint", cloud.viewpoint)
    elif sensor is None:
        invalid = _at(np.zeros(3), cloud)  # if a camera at the origin it is
        some = 0 < len(invalid) <= len(cloud.points) - LEAST_POINTS
        points = np.delete(cloud.points, invalid, axis=0) if some else cloud.points
        sensor, warnings = _found(cloud, upward, Surface.of(points, rng))
    settled = {SENSOR_FROM_TF: sensor.known_from != "transforms", UP_UNTOLD: up is not None}
    kept = [item for item in cloud.warnings if not settled.get(item.code, False)]
    return _without_sensor_itself(replace(cloud, sensor=sensor, warnings=tuple(kept)).warned(*warnings))


def _stated(
    cloud: Cloud, up: FloatArray | None, rng: np.random.Generator
) -> tuple[Sensor | None, tuple[CloudWarning, ...]]:
    """The sensor that is known already, or that an organised cloud tells; None if there is none of both."""
    sensor = cloud.sensor
    if sensor is not None and sensor.known_from in ("option", "all_sides"):
        if sensor.position is None and sensor.direction is None:
            sensor = replace(sensor, direction=_upward(cloud, rng) if up is None else up)
        return sensor, ()
    center = center_of_projection(cloud.points, cloud.pixels, rng) if cloud.pixels is not None else None
    if center is not None and (sensor is None or not _nearby(sensor.position, center, LENS_M)):
        wrong = cloud.viewpoint is not None and not _nearby(cloud.viewpoint, center, SAME_PLACE_M)
        return Sensor("projection", center), (_not_believed("the image's own geometry"),) if wrong else ()
    if sensor is not None and sensor.known_from == "transforms" and sensor.position is not None:
        seen = Surface.of(cloud.points, rng).seen_from(sensor.position) != "impossible"
        return sensor if seen else None, ()
    return sensor, ()


def _nearby(place: FloatArray | None, other: FloatArray, distance_m: float) -> bool:
    """Whether two places (3,) are closer than a distance."""
    return place is not None and bool(np.linalg.norm(place - other) < distance_m)


def _upward(cloud: Cloud, rng: np.random.Generator) -> FloatArray:
    """The side from which the hand comes to what was seen from all sides: where things stand on a plane, else +z."""
    standing = Surface.of(cloud.points, rng).standing
    return Z_UP if standing is None or has_z_up(cloud.frame_id) else standing[0]


def _found(cloud: Cloud, up: FloatArray | None, surface: Surface) -> tuple[Sensor, tuple[CloudWarning, ...]]:
    """The sensor by the cloud's own shape, and by the viewpoint that is stated."""
    at_origin = _camera_at_origin(surface)
    if cloud.viewpoint is not None:
        answer = _by_viewpoint(cloud, cloud.viewpoint, surface, at_origin)
        return answer or _looking_down(cloud, up, surface, at_origin)
    if at_origin == "seen" and not has_z_up(cloud.frame_id):
        return Sensor("visibility", np.zeros(3)), ()
    if at_origin == "seen" and _from_above(surface, Z_UP if up is None else up) != "seen":
        text = "the frame's name says that z is up, but by its shape the cloud was seen from the origin"
        return Sensor("visibility", np.zeros(3)), (CloudWarning("sensor_found", f"{text}: {REMEDY}"),)
    return _looking_down(cloud, up, surface, at_origin)


def _camera_at_origin(surface: Surface) -> Verdict:
    """Whether a camera at the origin can have seen the cloud: in an optical frame, or else in a body's, x forward.

    A robot's frame looks like a body's, for in both z is up. So in those only a clear case counts.
    """
    if _in_view(surface.all_points, axis=2):
        return surface.seen_from(np.zeros(3))
    forward = _in_view(surface.all_points, axis=0) and surface.seen_from(np.zeros(3)) == "seen"
    return "seen" if forward else "impossible"


def _by_viewpoint(
    cloud: Cloud, stated: FloatArray, surface: Surface, at_origin: Verdict
) -> tuple[Sensor, tuple[CloudWarning, ...]] | None:
    """The sensor at the `stated` viewpoint (3,), or where that may mean; None if the cloud was not seen from there."""
    verdict, inverse = surface.seen_from(stated), cloud.inverse_viewpoint
    elsewhere = float(np.linalg.norm(stated)) > SAME_PLACE_M
    if verdict in ("seen", "flat"):
        if inverse is None or at_origin == "impossible" or not elsewhere:
            return Sensor("viewpoint", stated), ()
        if at_origin != verdict:
            text = "the cloud may have been seen from the origin as well as from the stated viewpoint, which is taken"
            return Sensor("viewpoint", stated), (CloudWarning("viewpoint_unsure", f"{text}: {REMEDY}"),)
        return Sensor("visibility", np.zeros(3)), (_not_believed("the origin, whose view the cloud lies in,"),)
    if inverse is not None and surface.seen_from(inverse) == "seen":
        return Sensor("inverse_viewpoint", inverse), (_not_believed("its inverse"),)
    if at_origin == "seen" and elsewhere:
        return Sensor("visibility", np.zeros(3)), (_not_believed("the origin"),)
    return (Sensor("viewpoint", stated), ()) if verdict == "hollow" else None


def _looking_down(
    cloud: Cloud, up: FloatArray | None, surface: Surface, at_origin: Verdict
) -> tuple[Sensor, tuple[CloudWarning, ...]]:
    """The sensor as one that looked down, if the cloud or the way up tells that; else at the origin."""
    known_up = up if up is not None else Z_UP if has_z_up(cloud.frame_id) else None
    upward = Z_UP if known_up is None else known_up
    above = _from_above(surface, upward)
    if surface.standing is not None and (known_up is None or surface.standing[0] @ known_up > 0):
        upward, above = surface.standing[0], "seen"
    if at_origin == "impossible" and (above == "seen" or (above == "flat" and cloud.viewpoint is None)):
        place = "the stated viewpoint" if cloud.viewpoint is not None else "a camera at the origin"
        side = "+z" if surface.standing is None else "the side on which things stand on a plane"
        text = f"by its shape and place the cloud was hardly seen from {place}; the hand comes from {side}"
        return Sensor("visibility", direction=upward), (CloudWarning("sensor_found", f"{text}: {REMEDY}"),)
    if known_up is not None:
        text = "nothing says where the sensor was; the hand comes from above, as the frame's name or --up says"
        return Sensor("up", direction=upward), (CloudWarning("sensor_unknown", f"{text}: {REMEDY}"),)
    if cloud.viewpoint is not None:
        text = "the cloud cannot have been seen from the viewpoint that the source states, which is taken all the same"
        return Sensor("viewpoint", cloud.viewpoint), (CloudWarning("viewpoint_doubted", f"{text}: {REMEDY}"),)
    text = "nothing says where the sensor was, which decides from which side the hand comes; the origin is assumed"
    return Sensor("assumed", np.zeros(3)), (CloudWarning("sensor_assumed", f"{text}: {REMEDY}, --up X,Y,Z the way up"),)


def _from_above(surface: Surface, up: FloatArray) -> Verdict:
    """The best that can be said of the places above the cloud."""
    middle = np.median(surface.all_points, axis=0)
    side, ahead, _ = axes_about(up)
    best: Verdict = "impossible"
    for tilt in np.radians(TILTS_DEG):
        for angle in 2 * np.pi * np.arange(AROUND if tilt > 0 else 1) / AROUND:
            aside = np.cos(angle) * side + np.sin(angle) * ahead
            verdict = surface.seen_from(middle + OVERHEAD_M * (np.cos(tilt) * up + np.sin(tilt) * aside))
            if verdict == "seen":
                return "seen"
            best = verdict if best == "impossible" or verdict == "flat" else best
    return best


def _in_view(points: FloatArray, axis: int) -> bool:
    """Whether a camera at the origin that looks along an axis could have `points` (n, 3) in view."""
    ahead = points[:, axis] > WIDEST_VIEW_COS * np.linalg.norm(points, axis=1)
    return bool(np.mean(ahead) >= IN_VIEW_SHARE)


def _not_believed(instead: str) -> CloudWarning:
    text = f"the cloud was hardly seen from the viewpoint that the source states; {instead} is taken instead"
    return CloudWarning("viewpoint_not_believed", f"{text}: {REMEDY}")


def _without_sensor_itself(cloud: Cloud) -> Cloud:
    """The cloud without points at the sensor's own place, which count as dropped."""
    position = None if cloud.sensor is None else cloud.sensor.position
    if position is None:
        return cloud
    lost = _at(position, cloud)
    return cloud.without(lost) if len(lost) else cloud


def _at(place: FloatArray, cloud: Cloud) -> IntArray:
    """Rows (k,) of a cloud's points that lie at a place (3,); none do if that is outside of the box around them."""
    low, high = cloud.measured.corners
    if (place < low - NEAREST_M).any() or (place > high + NEAREST_M).any():
        return np.empty(0, dtype=np.intp)
    return near(cloud.points, place, NEAREST_M)
