"""How probably a grasp holds, in words."""

from __future__ import annotations

from flatgrasp_cli.model import Grasp

IN_WORDS = {
    "lands_on_object": "a finger comes down on it",
    "stopped_short": "the hand is stopped, or unseen space is occupied",
    "closes_beside": "the fingers close beside it",
    "slips": "it slips out",
    "too_heavy": "it is too heavy",
    "turns": "it turns about the pads",
}
LEAST = 0.005
"""Chances that would be written as 0 % are not."""


def holds_in_words(grasp: Grasp) -> list[str]:
    """How probably a grasp holds, and what happens otherwise; nothing where that is not known."""
    success = grasp.success
    if success is None:
        return []
    lost = sorted(success.causes.items(), key=lambda item: -item[1])
    ways = [f"in {100 * chance:.0f} % {IN_WORDS[cause]}" for cause, chance in lost if chance >= LEAST]
    return [f"it holds with a probability of {100 * success.probability:.0f} %", *ways]
