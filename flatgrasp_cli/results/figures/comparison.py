"""Our grasps beside those of two point fingers, on the same silhouette: the paper's figure 21."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import ObjectPlan, Silhouette
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.cages import NO_HOLD
from flatgrasp_cli.results.figures.close import draw_close, draw_loops
from flatgrasp_cli.results.figures.labels import Label, put
from flatgrasp_cli.results.figures.page import Page
from flatgrasp_cli.results.figures.style import BLUE, GREY, MM, closed, counted, tick_labels
from flatgrasp_cli.results.view import View, view_of

CAN, CANNOT = "grasps that the hand can carry out", "grasps that the hand cannot carry out"


def comparison_figure(
    plan: Plan, ours: ObjectPlan, theirs: FloatArray, verdicts: Sequence[str | None], title: str
) -> Figure:
    """Left our best grasp with its hand, right the point fingers' grasps: blue those that the hand can carry out.

    `theirs` (k, 2, 2) are the contacts of the point fingers' grasps in the plane, best first; `verdicts` say why the
    hand cannot, or None.
    """
    silhouette = ours.silhouette
    assert silhouette is not None  # noqa: S101 - without one there is nothing to compare
    view = view_of(plan, silhouette.frame.axes[2])
    page = Page(f"{title} · {plan.gripper.description}", 2)
    left = page.panel(f"object {ours.object.id}, ours: Lei & Wisse")
    draw_close(left, plan, ours, view)
    right = page.panel(f"two point fingers (Allen et al.): {counted(len(theirs), 'grasp')}")
    right.set(xlim=left.get_xlim(), ylim=left.get_ylim(), aspect="equal")
    tick_labels(right, view)
    draw_loops(right, silhouette, view)
    _draw_theirs(right, silhouette, view, theirs, verdicts)
    return page.finish(_caption(ours, verdicts))


def _draw_theirs(
    axes: Axes, silhouette: Silhouette, view: View, theirs: FloatArray, verdicts: Sequence[str | None]
) -> None:
    """Each grasp as a line between its contacts, with its rank beside one of them."""
    labels, lines, named = [], [], set[str]()
    for rank, (found, verdict) in enumerate(zip(theirs, verdicts, strict=True), start=1):
        contacts = view.of_plane(silhouette.frame, found)
        color, name = (GREY, CANNOT) if verdict else (BLUE, CAN)
        axes.plot(*contacts.T, "o-", color=color, lw=1.2, ms=4, label=None if name in named else name)
        named.add(name)
        labels.append(Label(str(rank), _rim(contacts), {"fontsize": 9, "color": color, "fontweight": "bold"}))
        lines.append(np.linspace(contacts[0], contacts[1], 40))
    put(
        axes, labels, np.vstack([*(view.of_plane(silhouette.frame, closed(loop)) for loop in silhouette.loops), *lines])
    )


def _rim(contacts: FloatArray) -> FloatArray:
    """The contact (1, 2) that is further up, or to the right."""
    return contacts[[int(contacts[1].sum() > contacts[0].sum())]]


def _caption(ours: ObjectPlan, verdicts: Sequence[str | None]) -> list[tuple[str, str]]:
    """Ours in a line, and for each reason the point fingers' grasps that it holds for."""
    rejection = ours.rejection
    rows = [("Ours", f"no grasp: {rejection.reason}" if rejection else "no grasp")]
    if ours.grasps:
        best = ours.grasps[0]
        rows = [("Ours", f"the hand comes open {MM * best.opening_m:.1f} mm and closes to {MM * best.width_m:.1f} mm")]
    reasons: dict[str, list[str]] = {}
    for rank, verdict in enumerate(verdicts, start=1):
        reasons.setdefault(verdict or "the hand can carry out", []).append(str(rank))
    theirs = [f"{', '.join(ranks)}: {reason}" for reason, ranks in reasons.items()] or [f"none: {NO_HOLD}"]
    return [*rows, *(("Theirs", words) for words in theirs)]
