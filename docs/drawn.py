"""What the pictures in docs/ show, as plain values in `drawn.json`: so a test can tell when the program draws others.

Pixels would not do: fonts and renderers differ from one machine to the next. Nor would all that is drawn: where labels
and their leaders find room depends on fonts, too. So it is the words, the limits of the panels, and all that has a name
in the legend.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.results.figures import style
from flatgrasp_cli.whole_files import write_text

RECORD = Path(__file__).resolve().parent / "drawn.json"
DECIMALS = 3
"""Of a share of a panel: finer than a pixel."""

Shown = dict[str, Any]


@contextmanager
def recorded() -> Iterator[dict[str, Shown]]:
    """What is shown by each figure that becomes a PNG meanwhile, by the digest of that."""
    encoded, found = style._encoded, dict[str, Shown]()

    def encode_and_record(figure: Figure) -> bytes:
        content = encoded(figure)
        found[hashlib.sha256(content).hexdigest()] = shown(figure)
        return content

    with patch.object(style, "_encoded", encode_and_record):
        yield found


def digest(picture: Path) -> str:
    """What tells a picture from all others."""
    return hashlib.sha256(picture.read_bytes()).hexdigest()


def read() -> dict[str, Shown]:
    """The record: of each picture by its name, the digest of its file and what it shows."""
    found: dict[str, Shown] = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    return found


def keep(folder: Path, found: dict[str, Shown]) -> None:
    """Write into the record what those pictures of a folder show that have just been drawn."""
    record = read()
    for picture in sorted(folder.glob("*.png")):
        if (code := digest(picture)) in found:
            record[picture.name] = {"sha256": code, "shows": found[code]}
    text = json.dumps(dict(sorted(record.items())), indent=1, ensure_ascii=False)
    write_text(RECORD, [text, "\n"])


def shown(figure: Figure) -> Shown:
    """The words on a figure, and what its panels show."""
    return {
        "words": " ".join(text.get_text() for text in figure.texts),
        "legend": [text.get_text() for legend in figure.legends for text in legend.get_texts()],
        "panels": [_panel(axes) for axes in figure.axes],
    }


def _panel(axes: Axes) -> Shown:
    """A panel's words and limits, and each thing in it that has a name, in the order of drawing."""
    legend = axes.get_legend()
    things = (*axes.lines, *axes.collections, *axes.patches, *axes.images)
    return {
        "words": " ".join([axes.get_title(loc="left"), axes.get_xlabel(), axes.get_ylabel()]),
        "legend": [text.get_text() for text in legend.get_texts()] if legend else [],
        "limits": [float(f"{value:.3g}") for value in (*axes.get_xlim(), *axes.get_ylim())],
        "labels": [text.get_text() for text in axes.texts if text.get_text()],
        "things": [_thing(thing, axes) for thing in things if _named(thing)],
    }


def _named(thing: Artist) -> bool:
    """Whether a thing is in the legend: Matplotlib's own names for others begin with an underscore."""
    name = str(thing.get_label())
    return name != "" and not name.startswith("_")


def _thing(thing: Artist, axes: Axes) -> Shown:
    return {"name": str(thing.get_label()), "color": _color(thing), "extent": _extent(thing, axes)}


def _color(thing: Artist) -> str | None:
    """The first colour of a thing's line or face."""
    if isinstance(thing, Line2D):
        return to_hex(thing.get_color())
    if not isinstance(thing, Collection | Patch):
        return None
    colors = [np.atleast_2d(colors) for colors in (thing.get_facecolor(), thing.get_edgecolor()) if len(colors)]
    return to_hex(np.vstack(colors)[0]) if colors else None


def _extent(thing: Artist, axes: Axes) -> list[float] | None:
    """The least and the greatest x and y of a thing in a plane, shares of its panel; None in space or of nothing."""
    points = np.empty((0, 2)) if axes.name == "3d" else _points(thing)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        return None
    corners = axes.transData.transform([points.min(axis=0), points.max(axis=0)])
    shares = axes.transAxes.inverted().transform(corners)
    return [round(float(share), DECIMALS) + 0.0 for share in shares.ravel()]


def _points(thing: Artist) -> FloatArray:
    """Points (n, 2) that a thing is drawn through."""
    points: Any = np.empty((0, 2))
    if isinstance(thing, Line2D):
        points = thing.get_xydata()
    elif isinstance(thing, Patch):
        points = thing.get_patch_transform().transform(thing.get_path().vertices)
    elif isinstance(thing, Collection):
        offsets = np.ma.getdata(thing.get_offsets())
        paths = np.vstack([np.empty((0, 2)), *(path.vertices for path in thing.get_paths())])
        points = offsets if np.any(offsets) else paths
    return np.asarray(points, dtype=np.float64)
