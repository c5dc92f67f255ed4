"""What a batch was asked for: a folder goes on only with the same."""

from __future__ import annotations

import json
from typing import Any

from flatgrasp_cli import __version__
from flatgrasp_cli.job import Job
from flatgrasp_cli.results.contracts.batch import SCHEMA_ID


def manifest_of(job: Job, plots: bool) -> dict[str, Any]:
    """Everything that decides a batch's answers but its sources."""
    return {
        "schema": SCHEMA_ID,
        "version": __version__,
        "gripper": job.gripper.model_dump(mode="json"),
        "settings": job.settings.model_dump(mode="json"),
        "robot": job.workcell.robot and job.workcell.robot.model_dump(mode="json"),
        "camera": job.workcell.camera and job.workcell.camera.model_dump(mode="json"),
        "base_frame": job.workcell.base_frame,
        "selection": repr(job.selection),
        "sensor": job.sensor and repr(job.sensor),
        "scale": job.scale,
        "top": job.top,
        "plots": plots,
    }


def difference(before: str, now: str) -> str:
    """Which entries of two manifests differ."""
    try:
        old, new = json.loads(before), json.loads(now)
        return "other " + ", ".join(sorted(key for key in {*old, *new} if old.get(key) != new.get(key)))
    except (ValueError, AttributeError):
        return "its manifest is damaged"
