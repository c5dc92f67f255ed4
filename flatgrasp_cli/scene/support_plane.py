"""The plane that objects stand on: random sample consensus, then least squares on the inliers of a larger sample."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.planes import consensus_plane, least_squares_plane
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import Sensor, SupportPlane
from flatgrasp_cli.profiles.settings import SceneSettings

SAMPLE = 2000
REFINEMENT_SAMPLE = 10_000
MAX_PLANES = 4
"""Planes looked for, one after another, while enough of the sample is left for one that counts."""
TOLERANCE_SHARE, TOLERANCE_RANGE_M = 0.008, (0.004, 0.03)
"""How far from a hypothesis points agree with it: a share of their distance from the sensor."""
TYPICAL_DISTANCE_M = 1.0
"""Of a sensor whose place is not known from what it sees."""
MIN_SENSOR_HEIGHT_M = 0.1
"""A viewpoint closer to the plane is no sensor's: clouds in a table's own frame leave it at the origin."""
PARALLEL_COS = np.cos(np.radians(10))
SECOND_SHARE = 0.3
"""Of planes on top of each other (table, floor) the nearer counts if it has this share of the bigger one's points."""
CLEAR_BELOW, MOST_BELOW_M, MOST_CUT = 2.0, 0.1, 0.15
"""What lies lower by so many tolerances, and no more than by this, is close below a plane; and how many such points,
over its own, a plane may have. Beside tables there are edges, and below them a floor that is farther away; a plane
through the tops of things in a bin has half of the bin below it."""
REFINEMENTS = 2
INLIER_SIGMAS = 3.0
LEAST_NOISE_M = 1e-4
"""Of clouds that a simulator made, whose planes are flat to the last digit."""
MAD_TO_SIGMA = 1.4826
"""Of normally distributed values: standard deviation over median absolute deviation."""


class _Fit(NamedTuple):
    normal: FloatArray
    offset: float
    share: float


def find_support_plane(points: FloatArray, sensor: Sensor, settings: SceneSettings, seed: int) -> SupportPlane | None:
    """The plane of `points` (n, 3) that objects could stand on; None when no plane has enough of the points.

    With `settings.up` (3,) the biggest plane that it is normal to, else the biggest one that faces the `sensor`. Of
    planes on top of each other the nearer to the sensor is taken, unless it is small.
    """
    sample = points[spread_indices(len(points), SAMPLE)]
    planes = [fit for fit in _planes(sample, sensor, settings, seed) if fit.share >= settings.min_plane_share]
    fits = [fit for fit in planes if _faces(fit, sample, sensor, settings)]
    if not fits and settings.up is None and float(np.ptp(sample, axis=0).max()) > settings.max_size_m:
        fits = planes  # too large for an object alone: a low camera looks along the floor
    if not fits:
        return None
    fits = [fit for fit in fits if not _cuts(fit, sample, sensor)] or fits
    biggest = max(fits, key=lambda fit: fit.share)
    stacked = [fit for fit in fits if fit.normal @ biggest.normal > PARALLEL_COS]
    stacked = [fit for fit in stacked if fit.share > SECOND_SHARE * biggest.share]
    return _refined(points, sensor, max(stacked, key=lambda fit: fit.offset))


def looks_down(sensor: Sensor, normal: FloatArray, offset: float) -> bool:
    """Whether the `sensor` looks at the plane from the side of its normal, as far as its place is known."""
    if sensor.position is None:
        return False
    return bool(normal @ sensor.position - offset >= MIN_SENSOR_HEIGHT_M)


def _cuts(fit: _Fit, sample: FloatArray, sensor: Sensor) -> bool:
    """Whether much goes on close below a plane, which then is one through things and not what they stand on."""
    heights, tolerance = sample @ fit.normal - fit.offset, _tolerance(sample, sensor)
    below = (heights < -CLEAR_BELOW * tolerance) & (heights > -MOST_BELOW_M)
    return int(np.count_nonzero(below)) > MOST_CUT * int(np.count_nonzero(np.abs(heights) < tolerance))


def _faces(fit: _Fit, sample: FloatArray, sensor: Sensor, settings: SceneSettings) -> bool:
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
    """Planes one after another, each from the points that the ones before left over."""
    rng = np.random.default_rng(seed)
    rest, biggest = sample, 0.0
    for _ in range(MAX_PLANES):
        if len(rest) < max(3, len(sample) * max(settings.min_plane_share, SECOND_SHARE * biggest)):
            return
        plane = consensus_plane(rest, _tolerance(rest, sensor), rng)
        if plane is None:
            return
        normal, offset = _oriented(*plane, sample, sensor, settings)
        inliers = np.abs(rest @ normal - offset) < _tolerance(rest, sensor)
        share = float(inliers.sum()) / len(sample)
        biggest = max(biggest, share)
        yield _Fit(normal, offset, share)
        rest = rest[~inliers]


def _tolerance(points: FloatArray, sensor: Sensor) -> FloatArray:
    if sensor.position is None:
        return np.full(len(points), TOLERANCE_SHARE * TYPICAL_DISTANCE_M)
    apart = points - sensor.position
    distance = np.sqrt(np.einsum("ij,ij->i", apart, apart))
    return np.asarray(np.clip(TOLERANCE_SHARE * distance, *TOLERANCE_RANGE_M))


def _refined(points: FloatArray, sensor: Sensor, fit: _Fit) -> SupportPlane:
    """Least squares on an even sample's inliers, with a tolerance that follows from their own scatter."""
    points = points[spread_indices(len(points), REFINEMENT_SAMPLE)]
    normal, offset = fit.normal, fit.offset
    residuals = points @ normal - offset
    tolerance = float(np.median(_tolerance(points, sensor)))
    noise = tolerance
    for _ in range(REFINEMENTS):
        inliers = points[np.flatnonzero(np.abs(residuals) < tolerance)]
        refined, _ = least_squares_plane(inliers)
        normal = refined if refined @ normal > 0 else -refined
        offset = float(np.median(inliers @ normal))
        residuals = points @ normal - offset
        scatter = np.abs(residuals)
        noise = MAD_TO_SIGMA * float(np.median(scatter[scatter < tolerance]))
        tolerance = min(tolerance, max(INLIER_SIGMAS * noise, TOLERANCE_RANGE_M[0]))
    return SupportPlane(normal, offset, max(noise, LEAST_NOISE_M))


def _oriented(
    normal: FloatArray, offset: float, points: FloatArray, sensor: Sensor, settings: SceneSettings
) -> tuple[FloatArray, float]:
    """The same plane, its normal along `settings.up`, else to the sensor, else to where most other points lie."""
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
