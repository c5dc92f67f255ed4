"""§III.B.3 to B.5: what the hand itself asks of a grasp — range, flatness under the pads, room for fingers and palm."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.chain import Chain, closed_chain, slopes
from flatgrasp_cli.geometry.polygon import cross, dot, left_normal
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, Silhouette
from flatgrasp_cli.planner.funnel import Funnel
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings

SINK_M = 0.002
"""A pad may come to rest this far, and half its width, below the highest point of its stretch of boundary."""
MAX_CELLS = 20_000
"""Pairs × edges worked on at once: as much as stays in a processor's cache."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """How the hand fits p pairs, in frames at the contacts' midpoint with y along the closing axis.

    `pads` (2, p) is how far each jaw's pad stands from the origin, on the −y and on the +y side; `room` (2, p) the free
    length behind each pad, infinite where nothing stands there.
    """

    pads: FloatArray
    room: FloatArray

    def select(self, keep: IntArray) -> Fit:
        """The rows that `keep` names."""
        return Fit(self.pads[:, keep], self.room[:, keep])

    def beyond(self, hidden: FloatArray, gripper: Gripper, settings: HandSettings) -> Fit:
        """The same with each pad `hidden` (2, p) farther out, as far as the hand opens: it is a guess."""
        spare = np.maximum(gripper.max_opening_m - 2 * settings.clearance_m - self.width, 0.0)
        total = hidden.sum(axis=0)
        hidden = hidden * np.minimum(1.0, spare / np.where(total > 0, total, 1.0))
        return Fit(self.pads + hidden, np.maximum(self.room - hidden, 0.0))

    @property
    def width(self) -> FloatArray:
        """The object's width between the pads (p,)."""
        return np.asarray(self.pads.sum(axis=0))


def closing_axes(fingers: FingerCandidates, pairs: GraspCandidates, method: str) -> GraspCandidates:
    """The pairs with the axis to close along: (n_i − n_j), on which both pads lie flush, or the line of contacts."""
    if method == "contacts":
        return pairs
    axis = fingers.direction.take(pairs.i, axis=0) - fingers.direction.take(pairs.j, axis=0)
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    return replace(pairs, axis=np.where(length > 1e-9, axis / np.maximum(length, 1e-9), pairs.axis))


def on_pads(fingers: FingerCandidates, pairs: GraspCandidates, gripper: Gripper, funnel: Funnel) -> GraspCandidates:
    """The pairs whose contacts both lie under the pads: on the bisector they lie aside, each its own way."""
    apart = fingers.contact.take(pairs.j, axis=0) - fingers.contact.take(pairs.i, axis=0)
    aside = 0.5 * np.abs(cross(pairs.axis, apart))
    beside_pad = (aside - _half_widths(gripper)).max(axis=0)
    kept = funnel.at_most(
        "pads", pairs, beside_pad, 0.0, lambda value: f"in the best pair a contact lies {value:.3f} m beside its pad"
    )
    return pairs.select(kept)


def in_range(
    fingers: FingerCandidates, pairs: GraspCandidates, gripper: Gripper, settings: HandSettings, funnel: Funnel
) -> GraspCandidates:
    """§III.B.3: the pairs that the hand can span, with its clearance on both sides."""
    width = extents(fingers, pairs).sum(axis=0) if settings.width == "extent" else pairs.distance
    width = np.where(width < gripper.min_opening_m, np.inf, width)

    def miss(value: float) -> str:
        if not np.isfinite(value):
            return f"every graspable width is below the gripper's smallest opening {gripper.min_opening_m:.4f} m"
        clear = f" with {settings.clearance_m:.3f} m clearance a side" if settings.clearance_m > 0 else ""
        return f"narrowest graspable width {value:.3f} m, gripper opens {gripper.max_opening_m:.3f} m{clear}"

    limit = gripper.max_opening_m - 2 * settings.clearance_m
    return pairs.select(funnel.at_most("grasping_range", pairs, width, limit, miss))


def flat(fingers: FingerCandidates, pairs: GraspCandidates, settings: HandSettings, funnel: Funnel) -> GraspCandidates:
    """§III.B.4: the pairs whose boundary strays little from the pads.

    Held against the sum of both sides in metres where such a limit is set, else against a share of the finger's width.
    """
    v_i, v_j = fingers.variance[pairs.i], fingers.variance[pairs.j]
    if settings.variance_max is not None:
        limit, values, unit = settings.variance_max, v_i + v_j, " m"
    else:
        limit, unit = settings.variance_max_share, " of the finger's width"
        values = np.maximum(v_i / fingers.width[pairs.i], v_j / fingers.width[pairs.j])
    kept = funnel.at_most(
        "variance",
        pairs,
        values,
        limit,
        lambda value: f"flattest pair of finger places strays {value:.3f}{unit} from the pads, allowed {limit:.3f}",
    )
    return pairs.select(kept)


def operable(
    outline: Silhouette,
    fingers: FingerCandidates,
    pairs: GraspCandidates,
    hand: tuple[Gripper, HandSettings],
    funnel: Funnel,
) -> tuple[GraspCandidates, Fit]:
    """§III.B.5: the pairs at which the fingers have room beside the object, and how the hand fits them."""
    gripper, settings = hand
    fit_of = swept_fit if settings.operability == "swept" else eq2_fit
    fit = fit_of(outline, fingers, pairs, gripper, settings.contact_tolerance_m)
    fit = fit.beyond(np.stack([fingers.hidden[pairs.i], fingers.hidden[pairs.j]]), gripper, settings)
    need = gripper.finger_thickness_m + settings.clearance_m
    # B.3 judged by each candidate's own stretch of boundary; the exact width may still differ.
    fits = (fit.width >= gripper.min_opening_m) & (fit.width <= gripper.max_opening_m - 2 * settings.clearance_m)
    shortage = np.where(fits, need - fit.room.min(axis=0), np.inf)

    def miss(value: float) -> str:
        if not np.isfinite(value):
            return f"between the pads every pair is wider than the gripper opens, {gripper.max_opening_m:.3f} m"
        return f"most room behind a pad {max(need - value, 0.0):.3f} m, the finger needs {need:.3f} m"

    kept = funnel.at_most("operability", pairs, shortage, 0.0, miss)
    return pairs.select(kept), fit.select(kept)


def clear_of_palm(
    outline: Silhouette,
    fingers: FingerCandidates,
    pairs: GraspCandidates,
    fit: Fit,
    gripper: Gripper,
    funnel: Funnel,
) -> tuple[GraspCandidates, Fit]:
    """The pairs at which an object seen alone stays out of the palm, with the fingertips' ends in the main plane."""
    above = float(outline.heights.max())
    kept = funnel.at_most(
        "palm",
        pairs,
        palm_intrusion(outline, centers(fingers, pairs, fit), pairs.axis, gripper),
        0.0,
        lambda _: (
            f"the object stands {above:.3f} m above the fingertips, fingers are {gripper.finger_length_m:.3f} m long"
        ),
    )
    return pairs.select(kept), fit.select(kept)


def centers(fingers: FingerCandidates, pairs: GraspCandidates, fit: Fit) -> FloatArray:
    """Where the hand's approach axis meets the main plane (p, 2): between the contacts, midway between the pads."""
    shift = 0.5 * (fit.pads[1] - fit.pads[0])
    return np.asarray(_middles(fingers, pairs) + shift[:, None] * pairs.axis)


def extents(fingers: FingerCandidates, pairs: GraspCandidates) -> FloatArray:
    """How far (2, p) each candidate's stretch of boundary reaches out along −axis and along +axis, metres.

    Their sum is the width that the jaws must really clear; the distance of the contacts can be less.
    """
    middle = dot(_middles(fingers, pairs), pairs.axis)
    x, y = np.ascontiguousarray(fingers.arcs.T)  # (k, m) each: reductions run fast over a long last axis
    along_x, along_y = pairs.axis.T
    low, high = (x.take(k, axis=1) * along_x + y.take(k, axis=1) * along_y for k in (pairs.i, pairs.j))
    return np.stack([middle - low.min(axis=0), high.max(axis=0) - middle])


def swept_fit(
    silhouette: Silhouette, fingers: FingerCandidates, pairs: GraspCandidates, gripper: Gripper, tolerance_m: float
) -> Fit:
    """§III.B.5, exact: where the pads come to rest, and how far each finger could back off, against the whole outline.

    Each finger sweeps a strip of its width along the closing axis. Boundary up to `tolerance_m` beyond the candidate's
    own reach is what the pad rests on; the next boundary outward ends the room, and boundary that runs on past the
    tolerance without a gap leaves none.
    """
    points, breaks = closed_chain(silhouette.loops)
    level = extents(fingers, pairs) + tolerance_m
    pads, room = np.empty((2, len(pairs))), np.empty((2, len(pairs)))
    for part in _chunks(len(pairs), len(points)):
        axis, middle = pairs.axis[part], _middles(fingers, pairs)[part]
        x, y = _to_hand(points, middle, left_normal(axis), axis)
        outline = Chain(x, y, slopes(x, y), breaks)
        for side, seen in ((0, outline.flipped()), (1, outline)):
            pads[side, part], room[side, part] = _jaw_fit(
                seen, level[side, part], gripper.jaws[side], gripper.finger_width_m
            )
    sunk = level - pads > SINK_M + _half_widths(gripper)  # it rests on something else than its candidate
    return Fit(pads, np.where(sunk, 0.0, room))


def _half_widths(gripper: Gripper) -> FloatArray:
    return 0.5 * np.array([[gripper.jaw_width_m(0)], [gripper.jaw_width_m(1)]])


def _to_hand(
    points: FloatArray, origin: FloatArray, across: FloatArray, along: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """X and y (e, p) of plane points (e, 2) in p frames with x `across` and y `along` (p, 2) at `origin` (p, 2)."""
    return points @ across.T - dot(origin, across), points @ along.T - dot(origin, along)


def _chunks(pairs: int, others: int) -> Iterator[slice]:
    """Slices of the pairs whose product with the others stays within `MAX_CELLS`."""
    size = max(1, MAX_CELLS // max(1, others))
    return (slice(first, first + size) for first in range(0, pairs, size))


def _jaw_fit(
    outline: Chain, level: FloatArray, offsets: tuple[float, ...], finger_width: float
) -> tuple[FloatArray, FloatArray]:
    """Pad distance and room (p,) of a jaw with fingers at `offsets`, for an outline seen with +y out to that jaw.

    A pad may rest on boundary up to `level` (p,).
    """
    pad, obstacle = np.full(len(level), -np.inf), np.full(len(level), np.inf)
    for offset in offsets:
        meets, lowest, highest = outline.clipped(offset - finger_width / 2, offset + finger_width / 2)
        beyond = highest > level
        pad = np.maximum(pad, np.where(meets & ~beyond, highest, -np.inf).max(axis=0))
        obstacle = np.minimum(obstacle, np.where(meets & beyond, lowest, np.inf).min(axis=0))
        obstacle[(obstacle < level) | outline.holds(offset, level)] = -np.inf
    touches = np.isfinite(pad)
    pad = np.where(touches, pad, 0.0)
    return pad, np.where(touches, np.maximum(obstacle - pad, 0.0), 0.0)


def eq2_fit(
    silhouette: Silhouette, fingers: FingerCandidates, pairs: GraspCandidates, gripper: Gripper, tolerance_m: float
) -> Fit:
    """§III.B.5, eq. (2) as printed: no hull point with |x| ≤ w_h/2 and d/2 ≤ |y| ≤ w_o, d the contacts' distance.

    `tolerance_m` is added to d/2: the contacts themselves satisfy the printed inequality.
    """
    vertices = np.concatenate(silhouette.loops)
    half = 0.5 * pairs.distance
    free = np.empty((2, len(pairs)), dtype=np.bool_)
    middles, across = _middles(fingers, pairs), left_normal(pairs.axis)
    for part in _chunks(len(pairs), len(vertices)):
        x, y = _to_hand(vertices, middles[part], across[part], pairs.axis[part])
        in_strip = np.abs(x) <= 0.5 * gripper.hand_width_m
        begin = half[part] + tolerance_m
        for side, outward in ((0, -y), (1, y)):
            free[side, part] = ~(in_strip & (outward >= begin) & (outward <= gripper.max_opening_m)).any(axis=0)
    return Fit(np.stack([half, half]), np.where(free, np.inf, 0.0))


def openings(fit: Fit, gripper: Gripper, settings: HandSettings) -> FloatArray:
    """Opening (p,) to approach with: `preshape_m` of free space at each pad, less where the room or the hand ends."""
    spare = fit.room.min(axis=0) - gripper.finger_thickness_m
    return np.asarray(np.minimum(fit.width + 2 * np.minimum(spare, settings.preshape_m), gripper.max_opening_m))


def palm_intrusion(outline: Silhouette, hand_centers: FloatArray, axes: FloatArray, gripper: Gripper) -> FloatArray:
    """How far (p,) the object reaches into the palm of hands at `hand_centers` closing along `axes` (p, 2); 0 if not.

    The fingertips' ends lie in the main plane, so only points higher than the fingers are long can meet the palm.
    """
    intrusion = np.zeros(len(hand_centers))
    tall = outline.heights > gripper.finger_length_m
    if not tall.any():
        return intrusion
    points, excess = outline.points[tall], outline.heights[tall] - gripper.finger_length_m
    across = left_normal(axes)
    for part in _chunks(len(hand_centers), len(points)):
        x, y = _to_hand(points, hand_centers[part], across[part], axes[part])
        inside = (np.abs(x) <= 0.5 * gripper.hand_width_m) & (np.abs(y) <= 0.5 * gripper.palm_m)
        intrusion[part] = np.where(inside, excess[:, None], 0.0).max(axis=0)
    return intrusion


def _middles(fingers: FingerCandidates, pairs: GraspCandidates) -> FloatArray:
    return np.asarray(0.5 * (fingers.contact.take(pairs.i, axis=0) + fingers.contact.take(pairs.j, axis=0)))
