"""§III.A.3: step points, finger candidates and their grasping directions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flatgrasp_cli.geometry import polygon
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.rectangle import longer_side
from flatgrasp_cli.kernels import chords as kernels
from flatgrasp_cli.model import FingerCandidates, Silhouette, StepPoints
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import FingerSettings

STEPS_PER_PERIMETER = 200
"""Step points on an outer loop, where the range below allows it: 20,000 pairs, which grow with the square."""
STEP_RANGE_M = (0.002, 0.006)
"""Shortest and longest derived step, metres: a silhouette is known to 1 or 2 mm, and a finger is some 10 to 20 mm
wide.
"""
MAX_DERIVED_STEPS, MAX_STEPS = 600, 3000
"""Largest number of step points on all loops, with a derived step and with one that was asked for: the matrices of
pairs then hold 3 MB and 70 MB."""
ALONG_ARC = np.linspace(0.0, 1.0, 17)
"""Points along the boundary under a chord: 1.4 mm apart under a pad of 22 mm, as fine as a silhouette is known."""
VARIANCES = ("mean", "rms", "max")
"""How far the boundary strays from a chord is told by one of these, besides the paper's sum."""
EITHER_JAW = -1
"""In the column `jaw`: the candidate may be for either of two equal jaws."""


def step_points(silhouette: Silhouette, settings: FingerSettings) -> tuple[StepPoints, ...]:
    """§III.A.3.1: points a step r apart along each loop, by eq. (1) or by arc length.

    r is the one in the settings, or a share of the outer loop. It is never so small that there would be more than
    `MAX_STEPS` step points, for the pairs of candidates grow with their square.
    """
    perimeters = [float(polygon.arc_positions(loop)[-1]) for loop in silhouette.loops]
    derived = float(np.clip(perimeters[0] / STEPS_PER_PERIMETER, *STEP_RANGE_M))
    most = MAX_STEPS if settings.step_m else MAX_DERIVED_STEPS
    step_m = max(settings.step_m or derived, sum(perimeters) / most)
    return tuple(_steps_of_loop(index, loop, step_m, settings) for index, loop in enumerate(silhouette.loops))


def _steps_of_loop(index: int, loop: FloatArray, step_m: float, settings: FingerSettings) -> StepPoints:
    """Step points of one loop, `step_m` apart in a straight line or along the boundary."""
    if settings.step == "chord":
        positions = polygon.chord_walk(loop, step_m)
    else:
        perimeter = polygon.arc_positions(loop)[-1]
        positions = np.arange(max(1, round(perimeter / step_m))) * (perimeter / max(1, round(perimeter / step_m)))
    return StepPoints(index, positions, polygon.points_at(loop, positions), step_m)


def finger_candidates(
    silhouette: Silhouette, steps: Sequence[StepPoints], gripper: Gripper, settings: FingerSettings
) -> FingerCandidates:
    """§III.A.3.2: a chord as long as a jaw is wide from each step point, its direction to the loop's left.

    A hand whose two jaws differ (a thumb against a pair) gets candidates for each of them. On an object hardly wider
    than a finger chords are shorter, for it meets only a part of the pad.
    """
    jaws = (EITHER_JAW,) if gripper.symmetric else (0, 1)
    longest = (settings.chord_share_max or np.inf) * longer_side(silhouette.loops[0])
    widths = {jaw: _chord_m(gripper, max(jaw, 0), longest) for jaw in jaws}
    parts = [_candidates_of_loop(silhouette.loops[step.loop], step, widths, settings) for step in steps]
    found = FingerCandidates.joined(parts)
    return found.select(np.argsort(found.jaw, kind="stable"))


def _chord_m(gripper: Gripper, jaw: int, longest: float) -> float:
    """Length of a jaw's chords, metres; a jaw of several fingers keeps its whole width, for all of them must touch."""
    width = gripper.jaw_width_m(jaw)
    return min(width, longest) if len(gripper.jaws[jaw]) == 1 else width


def _candidates_of_loop(
    loop: FloatArray, steps: StepPoints, widths: dict[int, float], settings: FingerSettings
) -> FingerCandidates:
    """The candidates on one loop, for each jaw with chords as long as its entry of `widths`."""
    jaw = np.repeat(list(widths), len(steps.positions))
    width = np.repeat(list(widths.values()), len(steps.positions))
    begins = np.tile(steps.positions, len(widths))
    ends = polygon.circle_exits(loop, begins, width)
    perimeter = polygon.arc_positions(loop)[-1]
    found = np.isfinite(ends) & ((ends < perimeter) | (settings.walk == "cyclic"))
    found &= ends - begins <= (settings.arc_ratio_max or np.inf) * width
    begins, ends, width = begins[found], ends[found], width[found]
    arcs = polygon.points_at(loop, begins[:, None] + ALONG_ARC * (ends - begins)[:, None])
    start, end = arcs[:, 0], arcs[:, -1]
    normal = polygon.left_normal(end - start)
    return FingerCandidates(
        loop=np.full(len(begins), steps.loop),
        start=start,
        end=end,
        contact=0.5 * (start + end),
        direction=normal,
        width=width,
        jaw=jaw[found],
        arcs=arcs,
        variance=_hull_points_sum(loop, begins, ends, start, normal)
        if settings.variance == "sum"
        else kernels.strays(arcs)[VARIANCES.index(settings.variance)],
        arc_ratio=(ends - begins) / width,
        hidden=np.zeros(len(begins)),
    )


def _hull_points_sum(
    loop: FloatArray, begins: FloatArray, ends: FloatArray, start: FloatArray, normal: FloatArray
) -> FloatArray:
    """§III.B.4 to the letter: the plain sum (m,), metres, of the hull's points' distances from each candidate's chord.

    The points lie between the arc lengths `begins` and `ends` (m,); the chord is given by its `start` and `normal`.
    """
    row, vertex = polygon.vertices_between(loop, begins, ends)
    distance = np.abs(polygon.dot(loop[vertex] - start[row], normal[row]))
    return np.bincount(row, weights=distance, minlength=len(start)).astype(np.float64)


def inward_directions(
    silhouette: Silhouette, fingers: FingerCandidates, settings: FingerSettings, seed: int
) -> tuple[FingerCandidates, int]:
    """§III.A.3.3: candidates whose grasping direction points into the object, and the number of doubtful ones.

    `signed_area`: the loops' orientation already tells on which side the object lies. A candidate is doubtful, and is
    dropped, if there is no object at a distance δ from its middle, as over the mouth of a slot. `random_rays`: the
    paper's search decides for the first candidate, and cross products carry its side to all others; doubtful ones stay.
    """
    if settings.direction == "random_rays" and not _first_points_left(silhouette.loops[0], fingers, settings, seed):
        fingers = replace(fingers, direction=-fingers.direction)
    inside = polygon.contains(silhouette.loops, fingers.contact + settings.delta_m * fingers.direction)
    doubted = int(np.count_nonzero(~inside))
    return (fingers.select(inside) if settings.direction == "signed_area" else fingers), doubted


def _first_points_left(loop: FloatArray, fingers: FingerCandidates, settings: FingerSettings, seed: int) -> bool:
    """Whether the object lies to the first candidate's left: the paper's Fig. 11 (a), stepping δ both ways at once."""
    rng = np.random.default_rng(seed)
    reach = 4 * float(np.ptp(loop, axis=0).max())
    contact, left = fingers.contact[0], fingers.direction[0]
    for k in range(1, int(reach / settings.delta_m) + 1):
        angles = rng.uniform(0, 2 * np.pi, settings.rays)
        far = contact + reach * np.column_stack([np.cos(angles), np.sin(angles)])
        ahead = polygon.ray_parity_inside(loop, contact + k * settings.delta_m * left, far)
        behind = polygon.ray_parity_inside(loop, contact - k * settings.delta_m * left, far)
        if ahead != behind:
            return ahead
    return True  # a boundary that is the same on both sides has no inside
