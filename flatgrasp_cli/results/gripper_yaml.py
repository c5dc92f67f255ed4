"""A measured hand as the YAML of a gripper profile, with what is not known said beside it."""

from __future__ import annotations

import re

from flatgrasp_cli.sources.gripper_urdf import Hand


def gripper_yaml(hand: Hand, source: str) -> str:
    """The profile's text; a number that the URDF does not tell is null, which no profile may have."""
    mounted = 90 if hand.closing[1] == "x" else 0
    lines = [
        f"# Measured on the shapes of {source}, whose fingers point along {hand.approach} and close along",
        f"# {hand.closing[1]} of its base. Not in a URDF: friction, and the adapter between flange and gripper.",
        "profile: gripper",
        f"name: {re.sub(r'[^A-Za-z0-9_.-]', '_', hand.name) or 'gripper'}",
        f"kind: {'parallel' if hand.parallel else 'arc'}",
        f"min_opening_m: {hand.min_opening:.4f}",
        f"max_opening_m: {hand.max_opening:.4f}",
        f"finger_width_m: {hand.finger_width:.4f}",
        f"finger_thickness_m: {hand.finger_thickness:.4f}    # of the last 20 mm",
        f"finger_length_m: {_number(hand.finger_length)}",
        f"tip_advance_m: {hand.tip_advance:.4f}",
        f"palm_offset_m: {_number(hand.palm_offset)}    # from the URDF's base; add the adapter's thickness",
        "adapter_m: 0.0    # not in the URDF",
        f"mounted_deg: {mounted}    # where the URDF's base is mounted straight to the flange",
        f"hand_width_m: {_number(hand.hand_width)}    # of all that does not move",
        f"palm_m: {_number(hand.palm)}    # of all that does not move",
        "pad_friction: 0.5    # not in the URDF: a usual assumption for rubber pads",
        f"max_force_n: {_number(hand.force_n)}    # "
        + ("the effort of the finger's joint" if hand.force_n else "not known where fingers turn"),
    ]
    return "\n".join(lines) + "\n"


def _number(value: float | None) -> str:
    return "null" if value is None else f"{value:.4f}"
