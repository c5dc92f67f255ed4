"""A table with a row for each grasp of one frame or of many: metres and unit quaternions in the frame's `frame_id`."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Any

from flatgrasp_cli.results.contracts.grasps import MetricsPart
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp, SavedObject

POSES = {"pose": "", "pre_grasp": "pre_grasp_", "lift": "lift_"}
"""Poses of the fingertips, and what the names of their columns begin with."""
AXES = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
METRICS = tuple(MetricsPart.__annotations__)
COLUMNS = (
    *("source", "topic", "stamp_ns", "frame_id", "gripper", "object", "rank", "probability"),
    *(f"{prefix}{axis}" for prefix in POSES.values() for axis in AXES),
    *("opening_m", "width_m"),
    *METRICS,
)


def content(documents: Sequence[SavedDocument]) -> bytes:
    """The file of all frames; what is not known is empty."""
    file = io.StringIO(newline="")
    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(_row(document, item, grasp) for document in documents for item, grasp in document.grasps)
    return file.getvalue().encode()


def _row(document: SavedDocument, item: SavedObject, grasp: SavedGrasp) -> dict[str, Any]:
    source = document.source
    row: dict[str, Any] = {"source": source.path, "topic": source.topic, "stamp_ns": source.stamp_ns}
    row |= {"frame_id": document.frame_id, "gripper": document.gripper.name}
    row |= {"object": item.id, "rank": grasp.rank, "probability": grasp.probability}
    for name, prefix in POSES.items():
        pose = getattr(grasp, name)
        values = (*pose.position, *pose.orientation)
        row |= {f"{prefix}{axis}": value for axis, value in zip(AXES, values, strict=True)}
    row |= {"opening_m": grasp.opening_m, "width_m": grasp.width_m}
    return row | {name: grasp.metrics.get(name) for name in METRICS}
