"""Whether the hand's grasps cage the object: a proof for its pads from points on them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.model import Cage, Tolerance
from flatgrasp_cli.planner.caging.boundary import Boundary
from flatgrasp_cli.planner.caging.contact_space import Caging, squeezing
from flatgrasp_cli.planner.caging.hands import Hands, pad_points, sweeps
from flatgrasp_cli.planner.caging.limits import Limits, limits
from flatgrasp_cli.planner.caging.outline import prepare
from flatgrasp_cli.planner.caging.stretching import stretching
from flatgrasp_cli.planner.caging.tolerance import tolerances
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import CagingSettings


def caging_of(boundary: Boundary, settings: CagingSettings) -> Caging:
    """The levels for fingers that close in the settings' direction."""
    return (squeezing if settings.closing == "inward" else stretching)(boundary, settings.told_apart_m)


def certify(loops: Sequence[FloatArray], hands: Hands, gripper: Gripper, settings: CagingSettings) -> tuple[Cage, ...]:
    """The cages of k grasps of the region `loops` (n_l, 2), the outer loop first.

    The pads are thicker than the two points on them that are reasoned about, so they have no way out that the points
    lack. The points being `aside` of one another where no finger stands opposite, an opening is √(σ² − aside²).
    """
    if len(hands) == 0:
        return ()
    outline = prepare(loops, settings)
    if outline is None:
        return (_uncaged("the outline crosses itself"),) * len(hands)
    if outline.convex and settings.closing == "inward":
        return (_uncaged("convex outline: two fingers never cage it"),) * len(hands)
    points, aside = pad_points(hands, gripper)
    found = _openings(limits(caging_of(outline.boundary, settings), points.reshape(-1, 2, 2)), aside)
    best = _best(found, settings)
    found = _chosen(found, best)
    sure = np.full(len(hands), np.nan)
    if outline.eroded is not None:
        proof = limits(caging_of(outline.eroded, settings), points.reshape(-1, 2, 2))
        sure = _chosen(_openings(proof, aside), best).escape
    outward = settings.closing == "outward"
    begin = _begin(hands, found, outward=outward)
    forgiven = tolerances(loops, hands, sweeps(hands, begin, gripper, outward=outward))
    return tuple(_cage(k, found, (float(sure[k]), forgiven[k]), hands, outward=outward) for k in range(len(hands)))


def _openings(found: Limits, aside: FloatArray) -> Limits:
    """The same (c, k) in openings of the hand instead of distances of the points, c·k of them."""
    shift = aside[:, None] ** 2

    def opening(sigma: FloatArray) -> FloatArray:
        sigma = sigma.reshape(len(aside), -1)
        with_sign = np.sqrt(np.maximum(sigma**2 - shift, 0.0))
        return np.where(np.isfinite(sigma), with_sign, sigma)

    return Limits(
        opening=opening(found.opening),
        escape=opening(found.escape),
        merge=opening(found.merge),
        bottom=opening(found.bottom),
        meets=found.meets.reshape(len(aside), -1),
        caged=found.caged.reshape(len(aside), -1),
    )


def _best(found: Limits, settings: CagingSettings) -> IntArray:
    """Which pair of points (k,) proves most: escape is farthest, then the next basin."""
    sign = 1.0 if settings.closing == "inward" else -1.0
    order = np.lexsort((-sign * found.merge, -sign * found.escape, ~found.caged), axis=0)
    return np.asarray(order[0])


def _chosen(found: Limits, pick: IntArray) -> Limits:
    columns = np.arange(len(pick))
    return Limits(
        found.opening[pick, columns],
        found.escape[pick, columns],
        found.merge[pick, columns],
        found.bottom[pick, columns],
        found.meets[pick, columns],
        found.caged[pick, columns],
    )


def _begin(hands: Hands, found: Limits, *, outward: bool) -> FloatArray:
    """Opening (k,) from which on closing surely ends in the grasp's basin: the approach's, or the basin's limit."""
    merge = np.where(found.caged, found.merge, hands.width)
    if outward:
        return np.minimum(np.maximum(hands.opening, merge), hands.width)
    return np.maximum(np.minimum(hands.opening, merge), hands.width)


def _cage(k: int, found: Limits, proof: tuple[float, Tolerance | None], hands: Hands, *, outward: bool) -> Cage:
    sure, forgiven = proof
    escape, merge, width = float(found.escape[k]), float(found.merge[k]), float(hands.width[k])
    if not found.meets[k]:
        where = "outside" if outward else "between"
        return _uncaged(f"nothing of the object lies {where} the fingers")
    if not found.caged[k]:
        limit = f"escapes at {escape:.4f} m, not {'below' if outward else 'above'} the grasp's width {width:.4f} m"
        return _uncaged(limit, escape if outward else None, None if outward else escape)
    sign, opening = (-1.0 if outward else 1.0), float(hands.opening[k])
    ends = {
        "opening": _finite(escape),
        "basin_opening": _finite(merge),
        "guaranteed_opening": _finite(sure) if sign * width < sign * sure else None,
    }
    return Cage(
        squeezing=not outward,
        stretching=outward,
        reason=None,
        on_approach=sign * opening < sign * escape,
        basin_on_approach=sign * opening < sign * merge,
        margin_m=_finite(sign * (escape - width)),
        closes_into_m=_finite(float(found.bottom[k])),
        guaranteed=sign * width < sign * sure,
        tolerance=forgiven,
        **{f"{name}_{'min' if outward else 'max'}_m": value for name, value in ends.items()},
    )


def _uncaged(reason: str, opening_min_m: float | None = None, opening_max_m: float | None = None) -> Cage:
    return Cage(False, False, reason, opening_min_m=opening_min_m, opening_max_m=opening_max_m)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
