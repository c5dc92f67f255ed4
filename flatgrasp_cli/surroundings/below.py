"""Beyond the paper: what lies below the fingers and the palm of hands that come straight down."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from flatgrasp_cli.funnel import Miss
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.kernels import below as kernels
from flatgrasp_cli.kernels import palm
from flatgrasp_cli.model import GraspCandidates, OpenHands
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.settings import HandSettings
from flatgrasp_cli.surroundings.maps import MIN_CELL_M, NOISE_M


class Stops(NamedTuple):
    """What is in the way of open hands: `height` (k, s), metres, at which it stops their fingertips, −∞ if nothing.

    `dark` (k, s) is the share of the places of their fingertips that no ray reached.
    """

    height: FloatArray
    dark: FloatArray


def under_fingers(
    grasps: GraspCandidates,
    margins: FloatArray,
    rest: HeightMap,
    highest: HeightMap,
    gripper: Gripper,
    clearance_m: float,
) -> tuple[FloatArray, FloatArray]:
    """Highest point and length that no ray reached, metres, (MARGINS, p) each, below fingers `margins` beside the pads.

    Near the pads fingers can meet only the `rest`, farther out whatever is `highest`: within a cell, and how well a
    silhouette is known, what is seen of the object may be what the pads rest on.
    """
    cell = rest.cell_m
    reach = np.maximum(np.ceil((margins + gripper.finger_thickness_m) / cell).astype(np.intp) - 1, 0)
    at_contact = int(np.ceil(MIN_CELL_M / cell + 0.5))
    fingers = _places(gripper.jaws, gripper.finger_width_m + 2 * clearance_m, cell)
    found, hidden = kernels.under_fingers(
        grasps.hands, fingers, reach, at_contact, rest.heights, highest.heights, rest.grid
    )
    return found, hidden


def stops(hands: OpenHands, rest: HeightMap, coarse: HeightMap, gripper: Gripper) -> Stops:
    """What stops open hands that come down wherever they miss to: the `rest` their fingers, anything their palm.

    Of a fingertip only the middle counts, half its width by half its thickness: what it meets with its rim it pushes
    aside, or is pushed aside by.
    """
    cell, where = rest.cell_m, hands.rows
    fingers = _places(gripper.jaws, 0.5 * gripper.finger_width_m, cell)
    out = 0.5 * gripper.finger_thickness_m + _steps(0.5 * gripper.finger_thickness_m, cell)
    highest, dark = kernels.under_tips(where, fingers, out, rest.heights, rest.grid)
    long_m = gripper.finger_length_m
    lowest = float(hands.tip.min(initial=np.inf))
    palm = under_palm(where, 2 * where[:, 4][None], coarse, lowest + long_m, gripper)[0] - long_m
    shape = hands.tip.shape
    return Stops(np.maximum(highest, palm).reshape(shape), dark.reshape(shape))


def breadth_m(gripper: Gripper, openings: FloatArray) -> FloatArray:
    """The hand's size along the closing axis above its fingers (…), metres: the palm's or that of their roots."""
    return np.maximum(gripper.palm_m, openings + 2 * gripper.root_m)


def palm_room(
    grasps: GraspCandidates, chart: HeightMap, headroom: float, gripper: Gripper, settings: HandSettings
) -> FloatArray:
    """How far (p,) the palm may miss to its sides before it meets something: not at all, half the preshape, or all.

    What is more than `headroom` higher than the fingertips is in the palm's way.
    """
    room = np.zeros(len(grasps))
    if len(grasps) == 0:
        return room
    lowest, hands = float(grasps.tip.min()) + headroom, grasps.hands
    for miss_m in (0.5 * settings.preshape_m, settings.preshape_m):
        beside_m = miss_m + settings.clearance_m
        (met,) = under_palm(hands, grasps.opening[None], chart, lowest, gripper, beside_m)
        room = np.where(met <= grasps.tip + headroom, miss_m, room)
    return room


def under_palm(
    hands: FloatArray,
    openings: FloatArray,
    chart: HeightMap,
    least_m: float,
    gripper: Gripper,
    beside_m: float = 0.0,
) -> FloatArray:
    """Highest point (m, p) below the hand and `beside_m` around it, metres, if it is higher than `least_m`.

    What is lower is not in its way. The hand above its fingers is the palm and the fingers' roots, which lie farther
    out the wider the fingers are open: each of p `hands`, rows of centre and closing axis, has m `openings` (m, p).
    """
    beside_m += 0.5 * chart.cell_m
    across = 0.5 * gripper.hand_width_m + beside_m
    along = 0.5 * breadth_m(gripper, openings) + beside_m
    return palm.under_palm(hands, chart.heights, chart.tops, chart.grid, least_m, across, along)


@lru_cache(maxsize=64)
def _places(jaws: tuple[tuple[float, ...], ...], width_m: float, cell_m: float) -> FloatArray:
    """Jaw and offset across it (f, 2) of places, no more than a cell apart, all over fingers `width_m` wide."""
    steps = _steps(width_m, cell_m)
    return np.array([[jaw, at] for jaw in (0, 1) for offset in jaws[jaw] for at in (offset + steps).tolist()])


def _steps(size: float, cell_m: float) -> FloatArray:
    """Places from −size/2 to size/2, no more than a cell apart."""
    gaps = max(1, math.ceil(size / cell_m))
    return np.asarray(np.arange(gaps + 1) * (size / gaps) - 0.5 * size, dtype=np.float64)


def too_low(upright_m: float, need_m: float) -> Miss:
    """The refusal of pads that cannot hold enough, although nothing is in their way."""
    return Miss(
        f"the object is too low or too slanted: the pads find {1e3 * max(upright_m, 0.0):.1f} mm of upright side, "
        f"{1e3 * need_m:.1f} mm are needed",
        "low",
    )


def palm_meets(short_m: float, height_m: float, gripper: Gripper) -> Miss:
    """The refusal of a hand whose palm comes down on something high."""
    return Miss(
        f"the pads would end {1e3 * short_m:.1f} mm too high to grip: the palm comes down on what is "
        f"{1e3 * height_m:.0f} mm high, fingers are {1e3 * gripper.finger_length_m:.0f} mm long",
        "palm",
    )


def fingers_meet(short_m: float, height_m: float, others_m: float) -> Miss:
    """The refusal of fingers that come down on what is `height_m` high, `others_m` without the object's own points."""
    own = height_m - others_m > NOISE_M
    what = "the object itself, beside the pads" if own else "what stands beside it"
    return Miss(
        f"the pads would end {1e3 * short_m:.1f} mm too high to grip: the fingers come down on {what}, "
        f"{1e3 * height_m:.1f} mm high",
        "itself" if own else "neighbours",
    )
