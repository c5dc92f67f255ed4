"""The page's text. Names come from files and recordings, so that none is trusted: they are data, never markup."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html import escape
from importlib import resources
from itertools import chain, islice

from flatgrasp_cli.geometry.sampling import one_a_cell
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.results.page.library import three_js
from flatgrasp_cli.results.page.packing import packed
from flatgrasp_cli.results.page.scene import scene_of
from flatgrasp_cli.results.saved import SavedDocument

VOXEL_M = 0.003
"""Of several frames' clouds one point is kept in each cube of so many metres, for a browser has all of them at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One frame: its document, and its cloud, None where that is not there any more."""

    document: SavedDocument
    cloud: Cloud | None


def page(frames: Iterable[Frame], title: str) -> Iterator[str]:
    """Yield the page piece by piece, with the clouds in it; one frame is in memory at a time."""
    scripts = (three_js(), _own_script())
    yield f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>\n'
    yield f'<meta http-equiv="Content-Security-Policy" content="{_policy(scripts)}">\n'
    yield f'<meta name="viewport" content="width=device-width"><style>{_shipped("viewer.css")}</style></head><body>\n'
    yield _shipped("viewer.html")
    scenes = []
    for number, (frame, thinned) in enumerate(_thinned(iter(frames))):
        cloud = None if thinned is None else packed(thinned.points, thinned.colors)
        scenes.append(scene_of(frame.document, frame.cloud, cloud))
        if cloud is not None:
            yield f'<script type="application/octet-stream" id="cloud-{number}">{cloud.data}</script>\n'
    yield f'<script type="application/json" id="scenes">{_inert(json.dumps(scenes, allow_nan=False))}</script>\n'
    for script in scripts:
        yield f"<script>{script}</script>\n"
    yield "</body></html>\n"


def _thinned(frames: Iterator[Frame]) -> Iterator[tuple[Frame, Cloud | None]]:
    """Each frame with its cloud as the page has it: a single one whole, several thinned."""
    first = list(islice(frames, 2))
    for frame in chain(first, frames):
        cloud = frame.cloud
        if cloud is not None and len(first) > 1:
            keep = one_a_cell(cloud.points, VOXEL_M)
            colors = None if cloud.colors is None else cloud.colors[keep]
            yield frame, Cloud(cloud.points[keep], colors=colors)
        else:
            yield frame, cloud


def _policy(scripts: tuple[str, ...]) -> str:
    """What a browser lets the page do: run these scripts and no others, and ask nobody for anything."""
    hashes = (base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts)
    allowed = " ".join(f"'sha256-{digest}'" for digest in hashes)
    return f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'"


def _inert(text: str) -> str:
    """JSON in which nothing can end the element that it stands in."""
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _own_script() -> str:
    """The page's own script: the files of the folder as one function, in the order of their names."""
    files = sorted(resources.files(__package__).joinpath("script").iterdir(), key=lambda file: file.name)
    parts = "\n".join(file.read_text(encoding="utf-8") for file in files)
    return f'(function () {{\n"use strict";\n{parts}}})();'


def _shipped(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
