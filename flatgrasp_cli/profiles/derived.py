"""The lengths of a planner profile that follow from others where they are null."""

from __future__ import annotations

from typing import Any

from flatgrasp_cli.profiles.uncertainty import Uncertainty

OF_OUTLINE = (
    ("silhouette", "tolerance_m", 0.5),
    ("hand", "clearance_m", 2.0),
    ("hand", "contact_tolerance_m", 2.0),
    ("caging", "tolerance_m", 1.0),
    ("caging", "noise_m", 1.5),
)
"""Lengths that follow from how well the outline is known, where they are null, in standard deviations of it: one is in
the noise, and beyond two hardly anything is."""


def derived(data: dict[str, Any]) -> dict[str, Any]:
    """A planner profile's text with a number for each length that is null and follows from others."""
    data = {key: dict(value) if isinstance(value, dict) else value for key, value in data.items()}
    # a section that is none is reported as that, and not by the lengths of others that follow from it
    uncertainty, caging, depth = (_section(data, name) for name in ("uncertainty", "caging", "depth"))
    outline_m = _number(uncertainty.get("outline_m"), Uncertainty().outline_m)
    for section, key, ratio in OF_OUTLINE:
        _fill(_section(data, section), key, ratio * outline_m)
    _fill(caging, "told_apart_m", 2 * _number(caging.get("noise_m"), outline_m))
    _fill(depth, "palm_clearance_m", _number(depth.get("table_clearance_m"), outline_m))
    return data


def _section(data: dict[str, Any], name: str) -> dict[str, Any]:
    section = data.get(name)
    return section if isinstance(section, dict) else {}


def _number(value: Any, otherwise: float) -> float:
    """A value that may be anything, if it is a number: what is none is reported where it stands."""
    return float(value) if isinstance(value, int | float) else otherwise


def _fill(section: dict[str, Any], key: str, value: float) -> None:
    """Give a key of a section a value, if it is there and null."""
    if key in section and section[key] is None:
        section[key] = value
