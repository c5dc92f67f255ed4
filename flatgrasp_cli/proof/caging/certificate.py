"""Whether a hand's grasps cage the object: a proof for its pads from points on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray
from flatgrasp_cli.model import Cage, Tolerance
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.contact_space import Caging, squeezing
from flatgrasp_cli.proof.caging.hands import Hands, pad_points, sweeps
from flatgrasp_cli.proof.caging.limits import Limits, limits
from flatgrasp_cli.proof.caging.outline import prepare
from flatgrasp_cli.proof.caging.stretching import stretching
from flatgrasp_cli.proof.caging.tolerance import tolerances


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What an outline proves of k grasps, with whatever opening the hand comes.

    `limits` (k,) are those of the points on the pads that prove most, `sure` (k,) is the escape opening of every
    outline within the noise, NaN where not all of them cage. `reason` says why nothing is proved.
    """

    loops: Sequence[FloatArray]
    gripper: Gripper
    outward: bool
    limits: Limits
    sure: FloatArray
    reason: str | None = None

    def guaranteed(self, hands: Hands) -> BoolArray:
        """Whether the grasps (k,) are caged even if the outline errs by its noise."""
        sign = -1.0 if self.outward else 1.0
        return np.asarray(sign * hands.width < sign * self.sure)

    def cages(self, hands: Hands) -> tuple[Cage, ...]:
        """The certificates of the grasps."""
        if self.reason is not None:
            return (_uncaged(self.reason),) * len(hands)
        guaranteed, forgiven = self.guaranteed(hands), _forgiven(self, hands)
        return tuple(_cage(self, hands, k, forgiven.get(k), guaranteed=bool(guaranteed[k])) for k in range(len(hands)))


def prove(loops: Sequence[FloatArray], hands: Hands, gripper: Gripper, settings: CagingSettings) -> Proof:
    """What the region `loops` (n_l, 2), the outer loop first, proves of k grasps.

    The pads are more than the two points on them that are reasoned about, so they have no way out that the points lack.
    """
    outward = settings.closing == "outward"
    outline = prepare(loops, settings)
    nothing = np.full(len(hands), np.nan)
    if outline is None or outline.convex:
        reason = "convex outline: two fingers never cage it" if outline else "the outline crosses itself"
        no = np.zeros(len(hands), dtype=np.bool_)
        return Proof(
            loops=loops,
            gripper=gripper,
            outward=outward,
            limits=Limits(opening=nothing, escape=nothing, merge=nothing, bottom=nothing, meets=no, caged=no),
            sure=nothing,
            reason=reason,
        )
    points, aside = pad_points(hands, gripper)
    found = _openings(caging_of(outline.boundary, settings), points, aside)
    best = _farthest(found, outward=outward)
    found = _pick(found, best)
    eroded = outline.eroded(settings.noise_m) if found.caged.any() else None
    if eroded is None:
        return Proof(loops=loops, gripper=gripper, outward=outward, limits=found, sure=nothing)
    proof = _pick(_openings(caging_of(eroded, settings), points, aside), best)
    return Proof(
        loops=loops,
        gripper=gripper,
        outward=outward,
        limits=found,
        sure=np.where(found.caged & proof.caged, proof.escape, np.nan),
    )


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


def _forgiven(proof: Proof, hands: Hands) -> dict[int, Tolerance]:
    """The tolerances of the hands that are caged.

    Closing surely ends in the grasp's basin from the opening of the approach on or, if that is beyond, the basin's.
    """
    caged = np.flatnonzero(proof.limits.caged)
    if len(caged) == 0:
        return {}
    hands, merge = hands.select(caged), proof.limits.merge[caged]
    if proof.outward:
        begin = np.minimum(np.maximum(hands.opening, merge), hands.width)
    else:
        begin = np.maximum(np.minimum(hands.opening, merge), hands.width)
    figures = tolerances(proof.loops, hands, sweeps(hands, begin, proof.gripper, outward=proof.outward))
    return dict(zip(caged.tolist(), figures, strict=True))


def _cage(proof: Proof, hands: Hands, k: int, forgiven: Tolerance | None, *, guaranteed: bool) -> Cage:
    found, outward = proof.limits, proof.outward
    sign = -1.0 if outward else 1.0
    escape, merge, width, opening = (float(each[k]) for each in (found.escape, found.merge, hands.width, hands.opening))
    if not found.meets[k]:
        return _uncaged(f"nothing of the object lies {'outside' if outward else 'between'} the fingers")
    if not found.caged[k]:
        if not outward and found.bottom[k] == 0:
            return _uncaged("closing, the fingers slip off")
        side = "below" if outward else "above"
        return _uncaged(f"escapes at {escape:.4f} m, not {side} the {found.opening[k]:.4f} m of the grasp itself")
    ends = {
        "opening": escape,
        "basin_opening": merge,
        "guaranteed_opening": float(proof.sure[k]) if guaranteed else np.nan,
    }
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
