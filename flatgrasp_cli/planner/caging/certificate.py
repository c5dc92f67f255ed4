"""Whether a hand's grasps cage the object: a proof for its pads from points on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

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


def certify(loops: Sequence[FloatArray], hands: Hands, gripper: Gripper, settings: CagingSettings) -> tuple[Cage, ...]:
    """The cages of k grasps of the region `loops` (n_l, 2), the outer loop first.

    The pads are more than the two points on them that are reasoned about, so they have no way out that the points lack.
    """
    outward = settings.closing == "outward"
    outline = prepare(loops, settings)
    if outline is None:
        return (_uncaged("the outline crosses itself"),) * len(hands)
    if outline.convex:
        return (_uncaged("convex outline: two fingers never cage it"),) * len(hands)
    points, aside = pad_points(hands, gripper)
    found = _openings(caging_of(outline.boundary, settings), points, aside)
    best = _farthest(found, outward=outward)
    found = _pick(found, best)
    sure = np.full(len(hands), np.nan)
    eroded = outline.eroded(settings.noise_m) if found.caged.any() else None
    if eroded is not None:
        proof = _pick(_openings(caging_of(eroded, settings), points, aside), best)
        sure = np.where(proof.caged, proof.escape, np.nan)
    forgiven = _forgiven(loops, hands, found, gripper, outward=outward)
    return tuple(_cage(hands, found, k, (float(sure[k]), forgiven.get(k)), outward=outward) for k in range(len(hands)))


def caging_of(boundary: Boundary, settings: CagingSettings) -> Caging:
    """The levels for fingers that close in the settings' direction."""
    return (squeezing if settings.closing == "inward" else stretching)(boundary, settings.told_apart_m)


def _openings(caging: Caging, points: FloatArray, aside: FloatArray) -> Limits:
    """Limits (c, k) of the hand's opening for its points (c, k, 2, 2), `aside` (c,) of one another: √(σ² − aside²)."""
    shape = points.shape[:2]
    found = limits(caging, points.reshape(-1, 2, 2))

    def opening(sigma: FloatArray) -> FloatArray:
        sigma = sigma.reshape(shape)
        return np.where(np.isfinite(sigma), np.sqrt(np.maximum(sigma**2 - aside[:, None] ** 2, 0.0)), sigma)

    return Limits(
        opening=opening(found.opening),
        escape=opening(found.escape),
        merge=opening(found.merge),
        bottom=opening(found.bottom),
        meets=found.meets.reshape(shape),
        caged=found.caged.reshape(shape),
    )


def _farthest(found: Limits, *, outward: bool) -> IntArray:
    """Which points (k,) of each hand prove most: those that escape last, then those that reach another grasp last."""
    sign = 1.0 if outward else -1.0
    return np.asarray(np.lexsort((sign * found.merge, sign * found.escape, ~found.caged), axis=0)[0])


def _pick(found: Limits, row: IntArray) -> Limits:
    """Of limits (c, k) those in the named row of each column."""
    return Limits(*(getattr(found, each.name)[row, np.arange(len(row))] for each in fields(found)))


def _forgiven(
    loops: Sequence[FloatArray], hands: Hands, found: Limits, gripper: Gripper, *, outward: bool
) -> dict[int, Tolerance]:
    """The tolerances of the hands that are caged.

    Closing surely ends in the grasp's basin from the opening of the approach on or, if that is beyond, the basin's.
    """
    caged = np.flatnonzero(found.caged)
    if len(caged) == 0:
        return {}
    hands, merge = hands.select(caged), found.merge[caged]
    if outward:
        begin = np.minimum(np.maximum(hands.opening, merge), hands.width)
    else:
        begin = np.maximum(np.minimum(hands.opening, merge), hands.width)
    figures = tolerances(loops, hands, sweeps(hands, begin, gripper, outward=outward))
    return dict(zip(caged.tolist(), figures, strict=True))


def _cage(hands: Hands, found: Limits, k: int, proof: tuple[float, Tolerance | None], *, outward: bool) -> Cage:
    sure, forgiven = proof
    sign = -1.0 if outward else 1.0
    escape, merge, width, opening = (float(each[k]) for each in (found.escape, found.merge, hands.width, hands.opening))
    if not found.meets[k]:
        return _uncaged(f"nothing of the object lies {'outside' if outward else 'between'} the fingers")
    if not found.caged[k]:
        if not outward and found.bottom[k] == 0:
            return _uncaged("closing, the fingers slip off")
        side = "below" if outward else "above"
        return _uncaged(f"escapes at {escape:.4f} m, not {side} the grasp's width {width:.4f} m")
    guaranteed = sign * width < sign * sure
    ends = {"opening": escape, "basin_opening": merge, "guaranteed_opening": sure if guaranteed else np.nan}
    return Cage(
        squeezing=not outward,
        stretching=outward,
        reason=None,
        on_approach=sign * opening < sign * escape,
        basin_on_approach=sign * opening < sign * merge,
        margin_m=_finite(sign * (escape - width)),
        closes_into_m=_finite(float(found.bottom[k])),
        guaranteed=guaranteed,
        tolerance=forgiven,
        **{f"{name}_{'min' if outward else 'max'}_m": _finite(value) for name, value in ends.items()},
    )


def _uncaged(reason: str) -> Cage:
    return Cage(squeezing=False, stretching=False, reason=reason)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
