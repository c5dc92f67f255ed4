"""What came of objects, and what the stages of the method mean, for whoever reads a report."""

from __future__ import annotations

from typing import Any

WORDS = {
    "scene": "no object was found",
    "main_plane": "too few points for a plane",
    "approach": "no hand comes the way that was asked for",
    "silhouette": "too scattered or too small for an outline",
    "step_points": "outline too short for a finger",
    "finger_candidates": "no place for a finger on the outline",
    "grasping_direction": "no side from which a finger can press",
    "upright": "no steep side",
    "palm_room": "the palm has no room over it",
    "open_sides": "its only side is that of a hole that was not seen through",
    "immobilising": "no two points hold it",
    "pairs": "no two places for fingers",
    "facing": "no two sides face each other",
    "force_balance": "no two sides are parallel enough",
    "torque_balance": "no two sides are opposite enough",
    "pads": "no two sides that whole pads press on",
    "grasping_range": "too wide or too narrow for the gripper",
    "variance": "no sides that are even enough",
    "operability": "no room for the fingers",
    "depth": "the fingers do not get deep enough",
    "seen": "sides that were not seen",
    "palm": "the palm would collide",
    "cage": "no grasp is a cage",
    "reach": "out of the robot's reach",
}


def in_words(stage: str) -> str:
    """Why nothing was left after a stage."""
    return WORDS.get(stage, f"nothing left after {stage.replace('_', ' ')}")


def object_in_words(thing: dict[str, Any]) -> str:
    """An object of a record in a line: its best grasp, and how probably that holds, or why it has none."""
    if "pose" not in thing:
        return f"{thing['id']}: no grasp: {thing['reason'] or ''}"
    line = f"{thing['id']}: {1000 * thing['width_m']:.0f} mm wide, opens {1000 * thing['opening_m']:.0f} mm"
    return line + (f", holds with {100 * thing['success']['probability']:.0f} %" if thing["success"] else "")
