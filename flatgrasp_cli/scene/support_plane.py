"""The plane that objects stand on: random sample consensus, then least squares on the inliers of a larger sample."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.planes import consensus_plane, least_squares_plane
from flatgrasp_cli.geometry.scatter import deviation, median
from flatgrasp_cli.kernels.planes import near_plane
from flatgrasp_cli.kernels.points import distances
from flatgrasp_cli.model import Cloud, Sensor, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings

SAMPLE = 2000
"""Points of an even sample by which planes are looked for and extents told: shares of them are then known to 1 %, and
hypotheses are scored in a few milliseconds."""
FINE_SAMPLE = 20_000
"""Points by which a plane is fitted and its raster laid out: of one of 60 cm with noise of 3 mm, its normal is then
known to 0.01°, its scatter to 0.7 %, and how densely it was seen: several lie in each of the cells that tell it."""
TOLERANCE_SHARE = 0.008
"""How far from a hypothesis points agree with it, as a share of their distance from the sensor: three times the noise
of a structured-light sensor at 2 m (Khoshelham & Elberink 2012)."""
REACH_M = 1.0
"""Arms reach no farther, metres: a sensor whose place is not known is so far away, and strays are farther off."""
NEAREST_M = 0.1
"""Nearer than this, metres, no sensor sees anything: a viewpoint that is closer to the plane is none's. Clouds in a
table's own frame have it at the origin."""
GOOD_PART = 0.3
"""A good part of a whole. Of planes on top of each other (table, floor) the nearer counts if it has such a part of the
larger one's points: a table that is the subject of a view fills it, a box on it does not."""
NEAR_M = 0.2
"""Points farther than this from something, metres, have nothing to do with it: they cannot meet a hand at an object,
and what lies so far below or beside a table is the floor, or the room behind it."""
SIGMAS = 3.0
"""Standard deviations of noise within which points belong to a plane, and depths to one surface: 99.7 % do."""


class _Fit(NamedTuple):
    """A plane, its unit normal (3,) turned to the side that objects stand on, and its share of the points."""

    normal: FloatArray
    offset: float
    share: float


def find_support_plane(cloud: Cloud, sensor: Sensor, settings: SceneSettings, seed: int) -> SupportPlane | None:
    """The plane of a cloud that objects could stand on; None when no plane has enough of the points.

    It is the largest plane that `settings.up` (3,) is normal to or, without that, the largest one that faces the
    `sensor`. Of planes on top of each other it is the one nearer to the sensor, unless that is small.
    """
    sample = cloud.sample(SAMPLE)
    planes = [fit for fit in _planes(sample, sensor, settings, seed) if fit.share >= settings.min_plane_share]
    fits = [fit for fit in planes if _faces(fit, sample, sensor, settings)]
    if not fits and settings.up is None and float(np.ptp(sample, axis=0).max()) > settings.max_size_m:
        fits = planes  # too large for an object alone: a low camera looks along the floor
    if not fits:
        return None
    fits = [fit for fit in fits if not _cuts(fit, sample, sensor, settings)] or fits
    biggest = max(fits, key=lambda fit: fit.share)
    stacked = [fit for fit in fits if fit.normal @ biggest.normal > np.cos(np.radians(settings.max_tilt_deg))]
    stacked = [fit for fit in stacked if fit.share > GOOD_PART * biggest.share]
    nearest = max(stacked, key=lambda fit: fit.offset)
    points = cloud.sample(FINE_SAMPLE)
    tolerance = median(_tolerance(points, sensor))
    first = _fitted(points, nearest.normal, nearest.offset, tolerance)
    return _fitted(points, first.normal, first.offset_m, min(tolerance, flatness_m(first, settings)))


def flatness_m(plane: SupportPlane, settings: SceneSettings) -> float:
    """How far a plane's own points lie from it, metres; without noise, those nearer to it than to the lowest object."""
    return max(SIGMAS * plane.noise_m, 0.5 * settings.min_height_m)


def looks_down(sensor: Sensor, normal: FloatArray, offset: float) -> bool:
    """Whether the `sensor` looks at the plane from the side of its normal; False if its place is not known."""
    if sensor.position is None:
        return False
    return bool(normal @ sensor.position - offset >= NEAREST_M)


def _cuts(fit: _Fit, sample: FloatArray, sensor: Sensor, settings: SceneSettings) -> bool:
    """Whether as much goes on close below a plane as would make another: then it cuts through things.

    Beside tables there are edges, but a plane through the tops of things in a bin has half of the bin below it.
    """
    heights, tolerance = sample @ fit.normal - fit.offset, _tolerance(sample, sensor)
    below = (heights < -tolerance) & (heights > -NEAR_M)
    return int(np.count_nonzero(below)) > settings.min_plane_share * int(np.count_nonzero(np.abs(heights) < tolerance))


def _faces(fit: _Fit, sample: FloatArray, sensor: Sensor, settings: SceneSettings) -> bool:
    """Whether objects could stand on the plane: by the way up or, where that is not given, by the way to the sensor."""
    if settings.up is not None:
        up = np.asarray(settings.up)
        return bool(fit.normal @ up > np.cos(np.radians(settings.max_tilt_deg)) * np.linalg.norm(up))
    if sensor.position is None and sensor.direction is not None:
        return bool(fit.normal @ sensor.direction > np.cos(np.radians(settings.max_tilt_deg)))
    if not looks_down(sensor, fit.normal, fit.offset):
        return True
    to_sensor = sensor.toward(sample.mean(axis=0))
    return bool(fit.normal @ to_sensor > np.cos(np.radians(settings.max_view_deg)) * np.linalg.norm(to_sensor))


def _planes(sample: FloatArray, sensor: Sensor, settings: SceneSettings, seed: int) -> Iterator[_Fit]:
    """Planes one after another, each from the points that the ones before it left over."""
    rng = np.random.default_rng(seed)
    rest, biggest = sample, 0.0
    while len(rest) >= max(3, len(sample) * max(settings.min_plane_share, GOOD_PART * biggest)):
        plane = consensus_plane(rest, _tolerance(rest, sensor), rng)
        if plane is None:
            return
        normal, offset = _oriented(*plane, sample, sensor, settings)
        inliers = np.abs(rest @ normal - offset) < _tolerance(rest, sensor)
        share = float(inliers.sum()) / len(sample)
        if share == 0:
            return
        biggest = max(biggest, share)
        yield _Fit(normal, offset, share)
        rest = rest[~inliers]


def _tolerance(points: FloatArray, sensor: Sensor) -> FloatArray:
    """How far (n,) from a plane points (n, 3) may lie to agree with it, metres."""
    if sensor.position is None:
        return np.full(len(points), TOLERANCE_SHARE * REACH_M)
    return np.asarray(TOLERANCE_SHARE * distances(points, sensor.position))


def _fitted(points: FloatArray, normal: FloatArray, offset: float, tolerance: float) -> SupportPlane:
    """Least squares on those of `points` (n, 3) that lie within a tolerance of a plane, and their scatter."""
    inliers = near_plane(points, normal, offset, tolerance)
    refined, _ = least_squares_plane(inliers)
    normal = refined if refined @ normal > 0 else -refined
    offset = median(inliers @ normal)
    own = near_plane(points, normal, offset, tolerance)
    return SupportPlane(normal, offset, deviation(own @ normal - offset))


def _oriented(
    normal: FloatArray, offset: float, points: FloatArray, sensor: Sensor, settings: SceneSettings
) -> tuple[FloatArray, float]:
    """The same plane with its normal along `settings.up`, or else to the sensor, or else to where most points lie."""
    if settings.up is not None:
        positive = float(normal @ np.asarray(settings.up)) > 0
    elif sensor.position is None and sensor.direction is not None:
        positive = float(normal @ sensor.direction) > 0
    elif looks_down(sensor, normal, offset):
        positive = True
    elif looks_down(sensor, -normal, -offset):
        positive = False
    else:
        heights = points @ normal - offset
        heights = heights[np.abs(heights) > _tolerance(points, sensor)]
        positive = int(np.count_nonzero(heights > 0)) * 2 >= len(heights)
    return (normal, offset) if positive else (-normal, -offset)
