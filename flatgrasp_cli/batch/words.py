"""What the stages of the method mean for whoever reads a report."""

from __future__ import annotations

WORDS = {
    "scene": "no object was found",
    "main_plane": "too few points for a plane",
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
    "seen": "sides that were not seen",
    "operability": "no room for the fingers",
    "depth": "the fingers do not get deep enough",
    "palm": "the palm would collide",
    "cage": "no grasp is a cage",
    "reach": "out of the robot's reach",
}


def in_words(stage: str) -> str:
    """Why nothing was left after a stage."""
    return WORDS.get(stage, f"nothing left after {stage.replace('_', ' ')}")
