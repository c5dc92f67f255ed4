"""How probably a grasp holds, in words."""

from __future__ import annotations

from flatgrasp_cli.model import Grasp

IN_WORDS = {
    "lands_on_object": "coming down on the object",
    "stopped_short": "what stands beside it, or is not seen",
    "closes_beside": "closing beside it",
    "slips": "slipping out",
    "too_heavy": "its weight",
    "turns": "turning about the pads",
}
LEAST = 0.005
"""Chances that would be written as 0 % are not."""


def holds_in_words(grasp: Grasp) -> list[str]:
    """That a grasp holds with some probability, and what it loses most by; nothing where that is not known."""
    success = grasp.success
    if success is None:
        return []
    lost = sorted(success.causes.items(), key=lambda item: -item[1])
    ways = [f"{100 * chance:.0f} % to {IN_WORDS[cause]}" for cause, chance in lost if chance >= LEAST]
    return [f"it holds with {100 * success.probability:.0f} %" + (f", and loses {', '.join(ways)}" if ways else "")]
