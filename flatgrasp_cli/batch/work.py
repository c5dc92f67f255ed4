"""What a worker does: plan the frames of one slice, and give back text that can be written as it is."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from flatgrasp_cli.batch.slices import Slice
from flatgrasp_cli.errors import FigureError, FlatgraspError, NoFramesError
from flatgrasp_cli.job import Job, collected_warnings
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.document import to_document, to_json
from flatgrasp_cli.results.view import normal_of, view_of

LOGGER = logging.getLogger(__name__)
_PLANNED = count()
"""Numbers the frames that this process plans: the first waits for libraries to load."""


@dataclass(frozen=True, slots=True)
class PlannedFrame:
    """One frame: its document as a line of JSON, what tables and reports need of it, and its pictures as PNG."""

    document: str
    record: dict[str, Any]
    pictures: dict[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Done:
    """What came of a slice; `error` says why the rest of it is missing, `empty` why it has no frames."""

    slice: Slice
    frames: list[PlannedFrame]
    warnings: list[str]
    error: str | None = None
    empty: str | None = None


def work(job: Job, piece: Slice, plots: bool) -> Done:
    """Plan all frames of a slice."""
    frames: list[PlannedFrame] = []
    error = empty = None
    mine = replace(job, selection=piece.selection(job.selection))
    with collected_warnings() as warnings:
        try:
            for cloud, read_ms in mine.clouds(piece.input.source, colors=plots):
                plan = mine.plan(cloud)
                frames.append(_planned(plan, read_ms, plots))
                lines = [f"{piece.input.called}: {warning.text}" for warning in plan.warnings]
                warnings += [line for line in lines if line not in warnings]
        except NoFramesError as nothing:
            empty = str(nothing)
        except FlatgraspError as problem:
            error = str(problem)
    return Done(slice=piece, frames=frames, warnings=warnings, error=error, empty=empty)


def _planned(plan: Plan, read_ms: float, plots: bool) -> PlannedFrame:
    document = to_document(plan, read_ms)
    return PlannedFrame(to_json(document), _record(plan, document), _pictures(plan) if plots else {})


def _record(plan: Plan, document: dict[str, Any]) -> dict[str, Any]:
    """What the table and the report need of a frame."""
    source = document["source"]
    return {
        **{key: source[key] for key in ("topic", "stamp_ns", "frame_id", "points")},
        "status": document["status"],
        "reason": document["reason"],
        "stage": None if plan.best or not plan.objects else plan.objects[0].funnel[-1].stage,
        "timing_ms": {**document["timing_ms"], "first": next(_PLANNED) == 0},
        "objects": [_object_record(item) for item in document["objects"]],
        "sketch": _sketch(plan),
    }


def _object_record(item: dict[str, Any]) -> dict[str, Any]:
    best, miss = item["grasps"][0] if item["grasps"] else None, item["nearest_miss"]
    record = {"id": item["id"], "points": item["points"], "status": item["status"], "reason": item["reason"]}
    record["stage"] = miss and miss["stage"]
    if best is not None:
        record |= {"pose": best["pose"], "width_m": best["width_m"], "opening_m": best["opening_m"]}
        record |= {"success": best["success"], "metrics": best["metrics"]}
    return record


def _sketch(plan: Plan) -> list[dict[str, Any]]:
    """Silhouette and contacts of each object in whole millimetres, as pictures have them, for a small drawing."""
    view = view_of(plan, normal_of(plan))
    things = []
    for item in plan.objects:
        silhouette = item.silhouette
        if silhouette is not None and silhouette.loops:
            loops = [view.of_plane(silhouette.frame, loop).round().astype(int).tolist() for loop in silhouette.loops]
            ends = view.of_world(item.grasps[0].contacts) if item.grasps else np.empty((0, 2))
            things.append({"id": item.object.id, "loops": loops, "contacts": ends.round().astype(int).tolist()})
    return things


def _pictures(plan: Plan) -> dict[str, bytes]:
    from flatgrasp_cli.results.figures import arm_figure, as_png, final_figure

    drawings: dict[str, Callable[[Plan], Any]] = {"grasps": final_figure, "arm": arm_figure}
    pictures = {}
    for name, draw in drawings.items():
        try:
            content = as_png(partial(draw, plan))
        except FigureError as error:
            LOGGER.warning("%s: %s", plan.cloud.source, error)
            continue
        if content is not None:
            pictures[name] = content
    return pictures
