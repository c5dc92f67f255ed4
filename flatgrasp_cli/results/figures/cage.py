"""Cages as pictures: where the fingers may be without the object getting away, and the contact space.

Contact space is sampled here, for the eye alone; the numbers are those of the exact certificates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import arc_positions, points_at
from flatgrasp_cli.proof.caging import Immobilisation
from flatgrasp_cli.results.cages import NO_HOLD
from flatgrasp_cli.results.figures.labels import Label, put
from flatgrasp_cli.results.figures.page import Page, show
from flatgrasp_cli.results.figures.style import BLACK, BLUE, GREEN, MM, RED, SKY, closed, draw_scale

DRAWN = 50
"""Grasps that are drawn: more would hide the outline."""
LISTED = 6
"""Grasps that the caption tells of."""
AXES = ("u, along the main plane's longer side", "v, along its shorter side")
LINE_POINTS = 24
COLOR_BAR_IN = 0.85
MARGIN_SHARE = 0.1
SAMPLES = 240
LEVELS = 12


def cage_figure(loops: Sequence[FloatArray], found: Sequence[Immobilisation], title: str, *, in_metres: bool) -> Figure:
    """The outline with its grasps and the best one's caging set, beside the contact space of the loops it is on.

    Of fingers that close. Lengths are in metres, or in a unit of the polygon's own.
    """
    drawing = _Drawing(MM, "mm", ".1f") if in_metres else _Drawing(1.0, "the polygon's unit", ".4g")
    page = Page(title, 2, right_in=COLOR_BAR_IN)
    outline = page.panel("the outline, and grasps of two point fingers")
    loops = [drawing.scale * loop for loop in loops]
    shown = np.concatenate(loops)
    show(outline, shown, MARGIN_SHARE * float(np.ptp(shown, axis=0).max()))
    for name, axis in zip(AXES if in_metres else "xy", (outline.xaxis, outline.yaxis), strict=True):
        axis.set_label_text(f"{name} ({drawing.unit})", fontsize=9)
    for k, loop in enumerate(loops):
        outline.plot(*closed(loop).T, color=BLACK, lw=1.2, label="outline" if k == 0 else None)
    _draw_grasps(outline, [drawing.scale * one.contacts for one in found[:DRAWN]], shown)
    contacts = drawing.scale * found[0].contacts if found else loops[0][:1].repeat(2, axis=0)
    space = _ContactSpace.of(loops, contacts)
    contact_space = page.panel("contact space: how far apart the fingers are")
    _draw_contact_space(contact_space, space, drawing.unit)
    if found:
        _draw_cage(outline, contact_space, space, contacts, escapes=found[0].escape_m is not None)
    return page.finish(_caption(found, drawing))


@dataclass(frozen=True, slots=True)
class _Drawing:
    """Units of the drawing in one of the outline, what they are called, and the format of numbers in them."""

    scale: float
    unit: str
    digits: str


@dataclass(frozen=True, slots=True, eq=False)
class _ContactSpace:
    """Of each finger the loop that it is on, as places (n,) along it and points (n, 2) there; and how far apart (n, n).

    The two loops are the same but where a finger is in a hole.
    """

    positions: tuple[FloatArray, FloatArray]
    points: tuple[FloatArray, FloatArray]
    distance: FloatArray

    @classmethod
    def of(cls, loops: Sequence[FloatArray], contacts: FloatArray) -> _ContactSpace:
        """The contact space of fingers that touch the loops at `contacts` (2, 2)."""
        along = [np.linspace(0, float(arc_positions(loop)[-1]), SAMPLES, endpoint=False) for loop in loops]
        points = [points_at(loop, places) for loop, places in zip(loops, along, strict=True)]
        near = [[np.linalg.norm(sampled - contact, axis=1).min() for sampled in points] for contact in contacts]
        a, b = (int(np.argmin(each)) for each in near)
        distance = np.linalg.norm(points[a][:, None] - points[b][None], axis=2)
        return cls((along[a], along[b]), (points[a], points[b]), distance)

    def nearest(self, contacts: FloatArray) -> tuple[int, int]:
        """The cell of fingers at `contacts` (2, 2)."""
        i, j = (
            int(np.linalg.norm(points - contact, axis=1).argmin())
            for points, contact in zip(self.points, contacts, strict=True)
        )
        return i, j


def _draw_grasps(axes: Axes, contacts: list[FloatArray], shown: FloatArray) -> None:
    """Each grasp as a line between its contacts (2, 2), with its rank where it hides nothing."""
    for k, ends in reversed(list(enumerate(contacts))):
        name = {0: "grasp 1, the one that forgives most", 1: "other grasps"}.get(k)
        color, width = (BLUE, 0.9) if k else (RED, 2.0)
        axes.plot(*ends.T, "o-", ms=4, color=color, lw=width, label=name, zorder=5 if k else 6)
    lines = [np.linspace(ends[0], ends[1], LINE_POINTS) for ends in contacts]
    styles = [{"fontsize": 9, "fontweight": "bold", "color": BLUE if k else RED} for k in range(len(lines))]
    labels = [Label(str(k + 1), line, style) for k, (line, style) in enumerate(zip(lines, styles, strict=True))]
    put(axes, labels, np.vstack([shown, *lines]))


def _caption(found: Sequence[Immobilisation], drawing: _Drawing) -> list[tuple[str, str]]:
    """How wide each grasp is, and what becomes of it as the fingers open."""
    if not found:
        return [("No grasp", NO_HOLD)]

    def length(value: float) -> str:
        return f"{drawing.scale * value:{drawing.digits}} {drawing.unit}"

    def event(what: str, value: float | None) -> str:
        return f"never {what}" if value is None else f"{what} at {length(value)}"

    def words(one: Immobilisation) -> str:
        fates = event("becomes another grasp", one.basin_m), event("gets away", one.escape_m)
        return f"{length(one.width_m)} wide; as the fingers open, it {fates[0]}, and the object {fates[1]}"

    rows = [(f"Grasp {k + 1}", words(one)) for k, one in enumerate(found[:LISTED])]
    return rows if len(found) <= LISTED else [*rows, ("", f"and {len(found) - LISTED} more, which --json lists")]


def _draw_contact_space(axes: Axes, space: _ContactSpace, unit: str) -> None:
    """How far apart the fingers are; finger 1 goes to the right, finger 2 up."""
    x, y = space.positions
    axes.set_anchor("N")
    image = axes.imshow(space.distance.T, origin="lower", extent=(0, x[-1], 0, y[-1]), cmap="Greys", alpha=0.7)
    axes.set_aspect("equal" if x is y else "auto")
    draw_scale(axes, image, f"distance of the fingers ({unit})", left=1.04)
    axes.contour(x, y, space.distance.T, levels=LEVELS, colors=BLACK, linewidths=0.3)
    axes.plot([], [], color=BLACK, lw=0.5, label="lines of equal distance")
    axes.set_xlabel(f"s₁, finger 1 along the outline ({unit})", fontsize=9)
    axes.set_ylabel(f"s₂, finger 2 along {'the outline' if x is y else 'another loop of it'} ({unit})", fontsize=9)


def _draw_cage(
    outline: Axes, contact_space: Axes, space: _ContactSpace, contacts: FloatArray, *, escapes: bool
) -> None:
    """The component of contact space below the escape level around the best grasp, and the way out of it."""
    (x, y), distance, start = space.positions, space.distance, space.nearest(contacts)
    level = np.inf
    if escapes:
        path = way_out(distance, start)
        worst = path[distance[path[:, 0], path[:, 1]].argmax()]
        level = float(distance[worst[0], worst[1]])  # of the samples: the exact one may lie beyond theirs
        way = _broken(np.column_stack([x[path[:, 0]], y[path[:, 1]]]), x[-1] / 2)
        contact_space.plot(*way.T, color=RED, lw=0.9, label="the way out: fingers opened least")
        label = "where the object gets away"
        contact_space.plot(x[worst[0]], y[worst[1]], "x", color=RED, ms=9, mew=2, ls="none", label=label)
    contact_space.plot(x[start[0]], y[start[1]], "o", color=RED, ls="none", label="grasp 1")
    inside = _component(distance, start, level)
    contact_space.contourf(x, y, inside.T.astype(float), levels=[0.5, 1.5], colors=[GREEN], alpha=0.35)
    contact_space.add_patch(Rectangle((0, 0), 0, 0, fc=GREEN, alpha=0.35, label="the cage of grasp 1"))
    for axis, color, name in ((0, GREEN, "finger 1 within the cage"), (1, SKY, "finger 2 within the cage")):
        reach = space.points[axis][inside.any(axis=1 - axis)]
        outline.plot(reach[:, 0], reach[:, 1], ".", color=color, ms=6, alpha=0.7, label=name, zorder=3)


def _broken(way: FloatArray, most: float) -> FloatArray:
    """A way (k, 2), not drawn where it leaves at one edge to come in at the other: a step longer than `most`."""
    leaps = np.flatnonzero((np.abs(np.diff(way, axis=0)) > most).any(axis=1))
    return np.insert(way, leaps + 1, np.nan, axis=0)


def _component(distance: FloatArray, start: tuple[int, int], level: float) -> IntArray:
    """Cells (n, n) below `level` that hang together with `start`; both axes close on themselves."""
    from scipy.ndimage import label

    below = distance < level
    labels, count = label(below)
    merged = np.arange(count + 1)
    for a, b in ((labels[0], labels[-1]), (labels[:, 0], labels[:, -1])):
        for first, second in zip(a.ravel(), b.ravel(), strict=True):
            if first and second:
                merged[merged == merged[second]] = merged[first]
    here = merged[labels[start]]
    return np.asarray((merged[labels] == here) & below) if labels[start] else np.zeros_like(below)


def way_out(distance: FloatArray, start: tuple[int, int]) -> IntArray:
    """Cells (k, 2) of the way from `start` to where the fingers meet whose largest distance is the least.

    It is the way between the two in the minimum spanning tree of the grid.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    n = len(distance)
    cells = np.arange(n * n).reshape(n, n)
    flat = distance.ravel() + 1.0  # the tree takes a weight of 0 for no link
    pairs = [(cells, np.roll(cells, -1, axis=axis)) for axis in (0, 1)]
    a = np.concatenate([first.ravel() for first, _ in pairs])
    b = np.concatenate([second.ravel() for _, second in pairs])
    tree = minimum_spanning_tree(coo_array((np.maximum(flat[a], flat[b]), (a, b)), shape=(n * n, n * n)).tocsr())
    begin = int(cells[start])
    order, before = breadth_first_order(tree, begin, directed=False)
    meeting = next(int(cell) for cell in order if cell // n == cell % n)
    way = [meeting]
    while way[-1] != begin:
        way.append(int(before[way[-1]]))
    return np.column_stack(np.unravel_index(way[::-1], (n, n)))
