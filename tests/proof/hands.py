"""Settings and hands of caging proofs, and the certificates that they get."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cage
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging import Hands, prove

seeds = st.integers(0, 2**32 - 1)
CM = 1e-2
EXACT = 1e-9


def caging_settings(**changes: object) -> CagingSettings:
    values = {"closing": "inward", "tolerance_m": 0.0, "max_vertices": 300, "noise_m": 0.001, "told_apart_m": 1e-6}
    chosen = {"certify": True, "require": False, "mass_kg": None, "considered": 60}
    return CagingSettings.model_validate(chosen | values | changes)


def gripper(**changes: object) -> Gripper:
    values = {
        "name": "test",
        "kind": "parallel",
        "max_opening_m": 0.1,
        "finger_width_m": 0.005,
        "finger_thickness_m": 0.004,
        "finger_length_m": 0.05,
        "hand_width_m": 0.02,
        "palm_m": 0.05,
    }
    return Gripper.model_validate(values | changes)


def certify(loops: list[FloatArray], hands: Hands, hand: Gripper, settings: CagingSettings) -> tuple[Cage, ...]:
    """The certificates of the hands as they come."""
    return prove(loops, hands, hand, settings).cages(hands)


def hands_at(contacts: FloatArray, opening: FloatArray) -> Hands:
    """Hands that close along the line of their two `contacts` (k, 2, 2) until they touch both."""
    apart = contacts[:, 1] - contacts[:, 0]
    width = np.linalg.norm(apart, axis=1)
    return Hands(contacts.mean(axis=1), apart / width[:, None], width, opening)


def beam_hand(opening: float = 2.2 * CM) -> Hands:
    return hands_at(CM * np.array([[[0.0, -0.5], [0.0, 0.5]]]), np.array([opening]))
