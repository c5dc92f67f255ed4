"""The report of a batch in a browser: what each choice of its filters leaves to be seen."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from flatgrasp_cli.batch.report import Made, report
from flatgrasp_cli.batch.summary import InputSummary, batch_values
from flatgrasp_cli.profiles import load_gripper, load_settings

CHROMIUM = shutil.which("chromium")
CLICKS = """
<script>
const seen = kind => [...document.querySelectorAll(kind)].filter(each => each.checkVisibility());
const named = each => each.querySelector("h2, figcaption").firstChild.textContent.trim();
const found = {};
for (const one of document.querySelectorAll("[name=status]"))
  for (const other of document.querySelectorAll("[name=reason]")) {
    one.click();
    other.click();
    found[one.id + " " + other.id] = [seen("section"), seen("figure")].map(each => each.map(named));
  }
document.body.append(Object.assign(document.createElement("pre"), {id: "found", textContent: JSON.stringify(found)}));
</script>
</body>"""


GRASP: dict[str, Any] = {"pose": {}, "width_m": 0.03, "opening_m": 0.05, "success": {"probability": 0.97}}


def frame(*stages: str | None) -> dict[str, Any]:
    """A frame's record, of objects that were lost at a stage, or, for None, have a grasp."""
    things: list[dict[str, Any]] = [
        {"id": k, "status": "no_grasp", "stage": stage, "reason": f"lost at {stage}"}
        if stage
        else {"id": k, "status": "ok", "stage": None, **GRASP}
        for k, stage in enumerate(stages)
    ]
    status = "ok" if None in stages else "no_grasp"
    return {"status": status, "reason": None, "stamp_ns": None, "pictures": [], "objects": things, "sketch": []}


def source(name: str, *frames: tuple[int, dict[str, Any]], **more: Any) -> InputSummary:
    """An input and its numbered frames."""
    summary = InputSummary(name, name, more.get("error"), more.get("warnings", []))
    summary.frames, summary.shown = len(frames), list(frames)
    summary.grasped = sum(record["status"] == "ok" for _, record in frames)
    return summary


SOURCES = [
    source("broken", error="is no cloud"),
    source("wide", (1, frame("grasping_range"))),
    source("night", (2, frame("depth")), (3, frame(None)), (4, frame(None, "grasping_range"))),
    source("odd", (5, frame(None)), warnings=["the origin is assumed"]),
]
REASONS = ("grasping_range", "depth")
"""The commonest first."""


def page(folder: Path, end: str = "</body>") -> Path:
    made_with = {
        "gripper": load_gripper("pr2").model_dump(mode="json"),
        "settings": load_settings().model_dump(mode="json"),
        "robot": None,
        "base_frame": None,
        "version": "1",
        "plots": True,
    }
    made = Made(made_with, "today", folder, "grasps.parquet")
    path = folder / "report.html"
    text = "".join(report(SOURCES, batch_values(SOURCES), made))
    path.write_text(text.replace("</body>", end), encoding="utf-8")
    return path


@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_every_choice_shows_what_it_says(tmp_path: Path) -> None:
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    line = [str(CHROMIUM), *options, page(tmp_path, CLICKS).as_uri()]
    shown = subprocess.run(line, capture_output=True, text=True, check=True).stdout
    match = re.search(r'<pre id="found">(.*?)</pre>', shown)
    assert match is not None
    found = json.loads(unescape(match[1]))
    for status, reason in product(("every", "ok", "none", "odd"), ("any", *REASONS)):
        key = f"s-{status} r{'-any' if reason == 'any' else REASONS.index(reason)}"
        assert found.pop(key) == expected(status, reason), key
    assert found == {}


def expected(status: str, reason: str) -> list[list[str]]:
    """Sources and frames that should be seen, worked out one by one."""
    sources, frames = [], []
    for one in SOURCES:
        wanted = [
            f"#{index}"
            for index, record in one.shown
            if status not in {"ok", "none"} or (record["status"] == "ok") == (status == "ok")
            if reason == "any" or any(thing["stage"] == reason for thing in record["objects"])
        ]
        odd = bool(one.error or one.warnings)
        if status == "odd" and not odd:
            continue
        failed = one.error is not None and reason == "any" and status != "ok"
        sources += [one.source] if wanted or failed else []
        frames += wanted
    return [sources, frames]
