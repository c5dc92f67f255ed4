"""Robot profiles that leave joints to a URDF: `urdf: {file: arm.urdf, base: LINK, tip: LINK}`."""

from __future__ import annotations

import reprlib
from pathlib import Path
from typing import Any

from flatgrasp_cli.errors import ProfileError

KEYS = ("file", "base", "tip")
RADIUS_M = 0.06
"""Of links, where nobody says how thick they are: a UR5's elbow and shoulder."""
LOCKED_VALUES = 12
ASSUMED: dict[str, Any] = {
    "links": dict.fromkeys(("shoulder_m", "upper_arm_m", "elbow_m", "forearm_m", "wrist_m"), RADIUS_M),
    "reach": {"steps": 5, "max_step_deg": 20.0, "min_manipulability_share": 0.04},
}
"""What no URDF says, as the shipped profiles have it."""


def resolved(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """A robot's profile with what its URDF says, and what has to be assumed, for the keys that it does not have.

    Raises
    ------
    ProfileError
        If the URDF cannot be read, or is not that of an arm.
    """
    if data.get("profile") != "robot" or "urdf" not in data:
        return data
    from flatgrasp_cli.profiles.urdf import read_urdf, robot_values

    own = dict(data)
    of = own.pop("urdf")
    if not isinstance(of, dict) or "file" not in of or not set(of) <= set(KEYS):
        raise ProfileError(f"{path}: urdf: {reprlib.repr(of)}: give it as {{file: arm.urdf, base: LINK, tip: LINK}}")
    if not all(isinstance(value, str) for value in of.values()):
        raise ProfileError(f"{path}: urdf: {reprlib.repr(of)}: file, base and tip are names")
    values = robot_values(read_urdf(path.parent / of["file"]), of.get("base"), of.get("tip"))
    lower, upper = (values["joints"][key] for key in ("lower_deg", "upper_deg"))
    middle = tuple(0.5 * (low + high) for low, high in zip(lower, upper, strict=True))
    reach = {"reference_deg": middle, **ASSUMED["reach"]}
    if len(lower) == 7 and "lock" not in own:
        values["lock"] = {"values": LOCKED_VALUES}
    own_reach = own.get("reach")
    if isinstance(own_reach, dict):
        own["reach"] = {**reach, **own_reach}
    return {"links": ASSUMED["links"], "reach": reach, **values, **own}
