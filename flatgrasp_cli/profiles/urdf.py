"""What a URDF says of joints: enough for an arm's chain and a gripper's fingers, no more.

Read by hand, for it is six attributes of an element: the libraries that read all of a URDF bring graphics along.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flatgrasp_cli.errors import ProfileError

MAX_BYTES = 20_000_000
TURNING = ("revolute", "continuous")
FLANGES = ("tool0", "flange", "link_eef", "end_effector_link", "panda_link8", "fr3_link8", "fer_link8")
"""What makers call the frame that a hand is mounted to."""
ENDLESS = (-math.tau, math.tau)
"""Limits of a joint that turns without end, radians: one turn either way."""


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that follows another: its value is `multiplier` times the other's, and `offset`."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between two links; limits in radians or metres, speeds and efforts as its kind has them."""

    name: str
    kind: str
    parent: str
    child: str
    xyz: tuple[float, ...]
    rpy: tuple[float, ...]
    axis: tuple[float, ...]
    limits: tuple[float, float]
    velocity: float
    effort: float
    mimic: Mimic | None


@dataclass(frozen=True, slots=True)
class Urdf:
    """A robot's links, as elements by name, and its joints by the link that each carries."""

    path: Path
    name: str
    links: dict[str, ET.Element]
    joints: dict[str, Joint]

    def chain_to(self, link: str, base: str | None = None) -> list[Joint]:
        """The joints from `base`, or else the root, to a link."""
        found: list[Joint] = []
        while link != base and link in self.joints:
            found.append(self.joints[link])
            link = self.joints[link].parent
            if len(found) > len(self.joints):
                raise ProfileError(f"{self.path}: its joints go round in a circle at link {link!r}")
        if base is not None and link != base:
            raise ProfileError(f"{self.path}: link {base!r} is not on the way to the flange")
        return found[::-1]


def read_urdf(path: Path) -> Urdf:
    """Read a URDF.

    Raises
    ------
    ProfileError
        If it cannot be read, or is none.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise ProfileError(f"{path}: cannot read the URDF: {error.strerror}") from error
    if len(content) > MAX_BYTES:
        raise ProfileError(f"{path}: more than {MAX_BYTES} bytes are too many for a URDF")
    if re.search(rb"<!(DOCTYPE|ENTITY)", content):
        raise ProfileError(f"{path}: defines entities, which no URDF needs; remove its DOCTYPE")
    try:
        root = ET.fromstring(content)  # noqa: S314 (see above)
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ProfileError(f"{path}: is no XML: {error}") from error
    if root.tag != "robot":
        raise ProfileError(f"{path}: is no URDF: its element is <{root.tag}>, not <robot>")
    if b"xacro:" in content.replace(b"xmlns:xacro", b""):
        raise ProfileError(f"{path}: is a xacro; make a URDF of it: xacro {path.name} > robot.urdf")
    links = {str(each.get("name")): each for each in root.iter("link") if each.get("name")}
    joints = [_joint(path, each) for each in root.findall("joint")]
    for each in joints:
        if each.parent not in links or each.child not in links:
            raise ProfileError(f"{path}: joint {each.name!r}: one of its links is not there")
    return Urdf(path, root.get("name") or path.stem, links, {each.child: each for each in joints})


def _joint(path: Path, element: ET.Element) -> Joint:
    name, kind = element.get("name", "?"), element.get("type", "?")
    place, axis, limit, mimic = (element.find(tag) for tag in ("origin", "axis", "limit", "mimic"))
    try:
        limits = (_number(limit, "lower"), _number(limit, "upper"))
        return Joint(
            name=name,
            kind=kind,
            parent=_link(element, "parent"),
            child=_link(element, "child"),
            xyz=_three(place, "xyz", "0 0 0"),
            rpy=_three(place, "rpy", "0 0 0"),
            axis=_unit(_three(axis, "xyz", "1 0 0")) if kind not in ("fixed", "floating") else (0.0, 0.0, 1.0),
            limits=ENDLESS if kind == "continuous" else limits,
            velocity=_number(limit, "velocity"),
            effort=_number(limit, "effort"),
            mimic=None
            if mimic is None
            else Mimic(mimic.get("joint", "?"), _number(mimic, "multiplier", 1.0), _number(mimic, "offset")),
        )
    except ValueError as error:
        raise ProfileError(f"{path}: joint {name!r}: {error}") from error


def _link(element: ET.Element, tag: str) -> str:
    found = element.find(tag)
    if found is None or not found.get("link"):
        raise ValueError(f"names no {tag}")
    return str(found.get("link"))


def three_of(element: ET.Element | None, key: str) -> tuple[float, ...]:
    """Three numbers of an element's attribute; zeros where it is not there."""
    return _three(element, key, "0 0 0")


def _three(element: ET.Element | None, key: str, default: str) -> tuple[float, ...]:
    text = default if element is None else element.get(key, default)
    numbers = tuple(float(each) for each in text.split())
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"{key}={text!r}: three numbers are wanted")
    return numbers


def _unit(axis: tuple[float, ...]) -> tuple[float, ...]:
    length = math.hypot(*axis)
    if length == 0.0:
        raise ValueError("its axis is 0 0 0")
    return tuple(each / length for each in axis)


def _number(element: ET.Element | None, key: str, default: float = 0.0) -> float:
    value = float(default if element is None else element.get(key, default))
    if not math.isfinite(value):
        raise ValueError(f"{key}={value}: a number is wanted")
    return value


def flange_of(urdf: Urdf) -> str:
    """The link that a hand is mounted to: one that is called so, or what stands on the last turning joint alone.

    Raises
    ------
    ProfileError
        If that is not plain.
    """
    named = [link for link in urdf.links if link.rpartition("/")[2] in FLANGES]
    if len(named) == 1:
        return named[0]
    turning = {link: sum(each.kind in TURNING for each in urdf.chain_to(link)) for link in urdf.links}
    most = max(turning.values(), default=0)
    parents = {each.parent for each in urdf.joints.values()}
    ends = [link for link, count in turning.items() if count == most and link not in parents]
    if len(ends) == 1 and not named:
        return ends[0]
    raise ProfileError(
        f"{urdf.path}: which link is the flange? {', '.join(sorted(named or ends)[:8])}; write a robot profile with "
        f"urdf: {{file: {urdf.path.name}, tip: LINK}}"
    )


def robot_values(urdf: Urdf, base: str | None, tip: str | None) -> dict[str, Any]:
    """What a URDF says of an arm, as the keys of a robot's profile."""
    joints = urdf.chain_to(tip or flange_of(urdf), base)
    if tip is not None and tip not in urdf.links:
        raise ProfileError(f"{urdf.path}: has no link {tip!r}")
    if base is None and joints and joints[0].kind == "fixed" and joints[0].parent == "world":
        joints = joints[1:]
    moving = [each for each in joints if each.kind != "fixed"]
    if any(each.kind not in TURNING for each in moving) or len(moving) not in (6, 7):
        kinds = ", ".join(f"{each.name} ({each.kind})" for each in moving) or "none"
        raise ProfileError(f"{urdf.path}: six or seven turning joints are wanted up to the flange; there are: {kinds}")
    places = list(_places(joints))
    limits = [tuple(math.degrees(value) for value in each.limits) for each in moving]
    return {
        "name": urdf.name,
        "base_frame": joints[0].parent,
        "chain": {"joints": tuple(places[:-1]), "flange": places[-1]},
        "joints": {
            "lower_deg": tuple(low for low, _ in limits),
            "upper_deg": tuple(high for _, high in limits),
            "max_speed_deg_s": tuple(math.degrees(each.velocity) for each in moving),
            "max_effort_nm": tuple(each.effort for each in moving),
        },
        "reach_m": sum(math.hypot(*each["xyz_m"]) for each in places[2:]),
    }


def _places(joints: list[Joint]) -> Iterator[dict[str, Any]]:
    """The places of turning joints and of the flange, what is fixed between them made one with the next."""
    import numpy as np
    from scipy.spatial.transform import Rotation

    place, turn = np.zeros(3), Rotation.identity()
    for each in joints:
        place = place + turn.apply(each.xyz)
        turn = turn * Rotation.from_euler("xyz", each.rpy)
        if each.kind != "fixed":
            yield {"xyz_m": tuple(place.tolist()), "rpy_deg": _degrees(turn), "axis": each.axis}
            place, turn = np.zeros(3), Rotation.identity()
    yield {"xyz_m": tuple(place.tolist()), "rpy_deg": _degrees(turn)}


def _degrees(turn: Any) -> tuple[float, ...]:
    import warnings

    with warnings.catch_warnings():  # at a quarter turn about y many angles say the same, and one of them will do
        warnings.simplefilter("ignore")
        return tuple(turn.as_euler("xyz", degrees=True).tolist())
