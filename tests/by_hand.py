"""Candidates, pairs and objects that were never measured: every number in them is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.height_map import HeightMap
from flatgrasp_cli.model import FingerCandidates, Floor, GraspCandidates, ObjectCloud, SupportPlane
from flatgrasp_cli.planner.fingers import EITHER_JAW

MM = 1e-3
TABLE_M = 0.3
WORLD = Frame(np.zeros(3), np.eye(3))
Relief = Callable[[FloatArray, FloatArray], FloatArray]
"""Heights (…) over places x and y (…), metres."""


def candidates(contacts: FloatArray, directions: FloatArray, jaws: list[int] | None = None) -> FingerCandidates:
    """Finger candidates 20 mm wide at `contacts` (n, 2) with inward unit `directions` (n, 2)."""
    n = len(contacts)
    half = 0.01 * np.column_stack([directions[:, 1], -directions[:, 0]])
    return FingerCandidates(
        loop=np.zeros(n, dtype=np.intp),
        start=contacts - half,
        end=contacts + half,
        contact=contacts,
        direction=directions,
        width=np.full(n, 0.02),
        jaw=np.array(jaws if jaws is not None else [EITHER_JAW] * n, dtype=np.intp),
        arcs=np.repeat(contacts[:, None], 3, axis=1),
        variance=np.zeros(n),
        arc_ratio=np.ones(n),
        hidden=np.zeros(n),
    )


def across(widths_m: Sequence[float] | FloatArray, **columns: Any) -> tuple[FingerCandidates, GraspCandidates]:
    """Perfect pairs about the origin that close along y on what is so wide, with other `columns` as given."""
    width = np.asarray(widths_m, dtype=np.float64)
    p = len(width)
    ends = np.column_stack([np.zeros(p), 0.5 * width])
    up = np.tile([0.0, 1.0], (p, 1))
    fingers = candidates(np.concatenate([-ends, ends]), np.concatenate([up, -up]))
    pairs = GraspCandidates(
        i=np.arange(p),
        j=np.arange(p) + p,
        middle=np.zeros((p, 2)),
        axis=up,
        distance=width,
        force_balance_deg=np.zeros(p),
        torque_arm_m=np.zeros(p),
        required_friction=np.zeros(p),
        pads=0.5 * np.column_stack([width, width]),
        room=np.full((p, 2), np.inf),
        gravity_distance=np.zeros(p),
        inside_share=np.ones(p),
    )
    return fingers, replace(pairs, **columns)


def on_table(
    relief: Relief, *, others: Relief | None = None, sensor: Sequence[float] = (0.0, 0.0, 1.0), pitch_m: float = 1 * MM
) -> ObjectCloud:
    """The object that stands out of a table of 30 cm, z = 0: the places where `relief` is higher than that.

    Points lie `pitch_m` apart, without noise. What `others` says to be higher than the table is in the object's way.
    """
    steps = pitch_m * (np.arange(round(TABLE_M / pitch_m)) - 0.5 * (round(TABLE_M / pitch_m) - 1))
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    own = relief(x, y)
    other = others(x, y) if others else np.zeros(len(x))
    points, beside = np.column_stack([x, y, own])[own > 0], np.column_stack([x, y, other])[(other > 0) & (own <= 0)]
    free = (own <= 0) & (other <= 0)
    viewpoint = np.array(sensor)
    return ObjectCloud(
        id=0,
        points=points,
        toward=viewpoint - points.mean(axis=0),
        viewpoint=viewpoint,
        support=SupportPlane(np.array([0.0, 0.0, 1.0]), 0.0, 0.5 * MM),
        obstacles=beside,
        floor=Floor(WORLD, HeightMap.of(np.column_stack([x, y, np.zeros(len(x))])[free], 2 * MM), pitch_m),
    )


def bar(length_m: float, width_m: float, height_m: float) -> Relief:
    """The relief of a bar along x about the origin."""
    return lambda x, y: np.where((np.abs(x) < 0.5 * length_m) & (np.abs(y) < 0.5 * width_m), height_m, 0.0)
