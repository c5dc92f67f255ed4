"""Two publishers of one transform that moves, stamped at different times: its samples go there and back by turns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flatgrasp_cli.sources.transforms.samples import Sample, apart

LEAST_APART = 0.01
"""Metres and radians: a coarse servo at rest goes back and forth by one count, of 0.005 rad."""
SMOOTH_SHARE = 0.1
"""Of the way between two publishers the largest step from one sample to the next that either takes by itself."""
LEAST_TURNS = 4
"""There and back, twice: what goes there and back once may be a tracker's mistake."""


def two_by_turns(samples: Sequence[Sample]) -> tuple[Sample, Sample] | None:
    """Two samples next to each other, of two publishers that take turns; None if one publisher can have sent all."""
    if len(samples) <= LEAST_TURNS:
        return None
    translations = np.array([sample.translation for sample in samples])
    quaternions = np.array([sample.quaternion for sample in samples])
    steps = apart(translations[1:], quaternions[1:], translations[:-1], quaternions[:-1])
    far = steps > steps.max() / 2.0
    if steps.max() < LEAST_APART or far.sum() < LEAST_TURNS:
        return None
    # each long step goes over to the other one
    other = np.concatenate([[False], np.cumsum(far) % 2 == 1])
    for own in (~other, other):
        place, turn = translations[own], quaternions[own]
        if apart(place[1:], turn[1:], place[:-1], turn[:-1]).max(initial=0.0) > SMOOTH_SHARE * steps.max():
            return None
    over = int(np.argmax(far))
    return samples[over], samples[over + 1]
