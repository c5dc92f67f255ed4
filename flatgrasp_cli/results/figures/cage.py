"""Cages as pictures: where the fingers may be without the object getting away, and the contact space.

Contact space is sampled here, for the eye alone; the numbers are those of the exact certificates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.geometry.polygon import arc_positions, points_at
from flatgrasp_cli.planner.caging import Immobilisation
from flatgrasp_cli.results.figures.style import BLACK, BLUE, GREEN, RED, legend, new_figure

DRAWN = 50
"""Grasps that are drawn: more would hide the outline."""
SAMPLES = 240
LEVELS = 12


def cage_figure(loops: Sequence[FloatArray], found: Sequence[Immobilisation], title: str) -> Figure:
    """The outline with its grasps and the best one's caging set, beside the contact space of its outer loop.

    Of fingers that close. Lengths are in the outline's own unit.
    """
    figure = new_figure(14.0, 6.5)
    outline, contact_space = figure.add_subplot(121), figure.add_subplot(122)
    outline.set_title(title, loc="left", fontsize=11)
    outline.set_aspect("equal", adjustable="datalim")
    for loop in loops:
        closed = np.vstack([loop, loop[:1]])
        outline.plot(closed[:, 0], closed[:, 1], color=BLACK, lw=1.2)
    for k, one in enumerate(found[:DRAWN]):
        outline.plot(*one.contacts.T, "o-", color=RED if k == 0 else BLUE, lw=1.5 if k == 0 else 0.7, ms=4)
        outline.annotate(str(k + 1), tuple(one.contacts[0]), fontsize=9, xytext=(3, 3), textcoords="offset points")
    positions = np.linspace(0, float(arc_positions(loops[0])[-1]), SAMPLES, endpoint=False)
    samples = points_at(loops[0], positions)
    distance = np.linalg.norm(samples[:, None] - samples[None], axis=2)
    _draw_contact_space(contact_space, positions, distance)
    if found:
        _draw_cage(outline, contact_space, (positions, samples, distance), found[0])
        legend(outline)
    return figure


def _draw_contact_space(axes: Axes, positions: FloatArray, distance: FloatArray) -> None:
    axes.set_title("distance of the fingers at s₁ and s₂ along the outline", loc="left", fontsize=11)
    axes.set_aspect("equal")
    end = positions[-1]
    axes.imshow(distance, origin="lower", extent=(0, end, 0, end), cmap="Greys", alpha=0.7)
    axes.contour(positions, positions, distance, levels=LEVELS, colors=BLACK, linewidths=0.3)
    axes.set_xlabel("s₁")
    axes.set_ylabel("s₂")


def _draw_cage(
    outline: Axes, contact_space: Axes, sampled: tuple[FloatArray, FloatArray, FloatArray], best: Immobilisation
) -> None:
    """The component of contact space below the escape level around the best grasp, and the way out of it."""
    positions, samples, distance = sampled
    start = tuple(int(np.linalg.norm(samples - contact, axis=1).argmin()) for contact in best.contacts)
    contact_space.plot(positions[start[1]], positions[start[0]], "o", color=RED, label="the best grasp")
    level = np.inf
    if best.escape_m is not None:
        path = way_out(distance, start)
        worst = path[distance[path[:, 0], path[:, 1]].argmax()]
        level = float(distance[worst[0], worst[1]])  # of the samples: the exact one may lie beyond theirs
        contact_space.plot(positions[path[:, 1]], positions[path[:, 0]], color=RED, lw=0.8)
        contact_space.plot(positions[worst[1]], positions[worst[0]], "x", color=RED, label="where it gets away")
    inside = _component(distance, start, level)
    contact_space.contourf(positions, positions, inside.astype(float), levels=[0.5, 1.5], colors=[GREEN], alpha=0.35)
    for axis, color, name in ((1, GREEN, "finger 1 within the cage"), (0, BLUE, "finger 2 within the cage")):
        reach = samples[inside.any(axis=axis)]
        outline.plot(reach[:, 0], reach[:, 1], ".", color=color, ms=5, alpha=0.7, label=name)
    contact_space.legend(loc="upper left", fontsize=8)


def _component(distance: FloatArray, start: tuple[int, ...], level: float) -> IntArray:
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


def way_out(distance: FloatArray, start: tuple[int, ...]) -> IntArray:
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
