"""Our grasps beside those of two point fingers, on the same outline: the paper's figure 21."""

from __future__ import annotations

from matplotlib.figure import Figure

from flatgrasp_cli.model import Grasp, ObjectPlan
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.results.figures.hand import draw_hand
from flatgrasp_cli.results.figures.style import BLUE, GREY, MM, draw_outline, new_figure, plane_axes

SHOWN = 5


def comparison_figure(
    ours: ObjectPlan, theirs: tuple[Grasp, ...], verdicts: list[str | None], gripper: Gripper, title: str
) -> Figure:
    """Left our best grasp with its hand, right the point fingers' grasps: blue those that the hand can carry out."""
    figure = new_figure(14.0, 6.5)
    left = plane_axes(figure, f"{title}: Lei & Wisse", 121)
    right = plane_axes(figure, "two point fingers (Allen et al.)", 122)
    outline = ours.trace.silhouette
    if outline is None:
        return figure
    for axes in (left, right):
        draw_outline(axes, outline)
    for grasp in ours.grasps[:1]:
        draw_hand(left, grasp, outline.frame, gripper)
    words = []
    for grasp, verdict in zip(theirs, verdicts, strict=True):
        contacts = MM * outline.frame.to_local(grasp.contacts)[:, :2]
        right.plot(contacts[:, 0], contacts[:, 1], "o-", color=BLUE if verdict is None else GREY, lw=1.2, ms=4)
        right.annotate(str(grasp.rank), tuple(contacts[0]), fontsize=9, xytext=(3, 3), textcoords="offset points")
        words.append(f"{grasp.rank}: {verdict or 'can be carried out'}")
    figure.supxlabel("\n".join(words[:SHOWN]), fontsize=8, x=0.52, ha="left")
    return figure
