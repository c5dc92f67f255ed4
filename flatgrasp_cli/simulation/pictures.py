"""A trial as the paper's figure 18 shows one, and as a film."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from flatgrasp_cli.geometry.arrays import ByteArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame, axes_from_quaternion
from flatgrasp_cli.model import ObjectPlan
from flatgrasp_cli.results.figures.close import draw_loops
from flatgrasp_cli.results.figures.page import Page, show
from flatgrasp_cli.results.figures.solid import draw_boxes, draw_on_cloud
from flatgrasp_cli.results.figures.style import BLUE, GREY, MM, PURPLE, RED, draw_segments, tick_labels
from flatgrasp_cli.results.view import view_of
from flatgrasp_cli.simulation.rendering import eye_on, picture
from flatgrasp_cli.simulation.snapshots import FRAME_S, Film, Snapshot, placed
from flatgrasp_cli.simulation.trial import Trial

PANEL_PX, FILM_PX, FINER = (460, 440), (480, 400), 2
"""Width and height of shaded pictures, and how much finer they are cast, so that edges are even."""
AROUND_M, ABOVE_M = 0.60, 0.34
"""Radius of the ball that holds arm and table where things lie, about a point so high over their middle."""
CLOSE_M, LIFTED_M = 0.22, 0.10
"""The same of a hand with what it holds, after the lift."""
ASIDE_RAD, ELEVATION_RAD = 0.9, 0.35
"""From where it is looked on: a little aside of the arm, or of the fingers' width, and from above."""
MARGIN_MM = 20.0


def trial_figure(trial: Trial, recorded: Film) -> Figure:
    """Set-up, bounding box, candidates and directions, final grasp, grasp area and execution: the paper's Fig. 18."""
    page = Page(f"{trial.object}: {trial.status.replace('_', ' ')}", 6, left_in=0.62)
    _draw_shot(page.panel("set-up"), recorded, recorded.snapshots[0], _from_aside(trial))
    item = next(iter(trial.plan.objects), None)
    for title, solid, draw in (
        ("bounding box", True, _draw_box),
        ("candidates and directions", False, _draw_directions),
        ("final grasp", False, _draw_final),
        ("grasp area on the cloud", True, _draw_area),
    ):
        axes: Any = page.panel(title, solid=solid)
        if item is None or not draw(axes, trial, item):
            axes.set_axis_off()
        elif solid:
            axes.set_zlabel("")  # there is no room for it beside the next panel
    _draw_shot(page.panel("execution"), recorded, recorded.snapshots[-1], _from_close(trial))
    return page.finish(_caption(trial))


def _caption(trial: Trial) -> list[tuple[str, str]]:
    """What happened, and by what hand, in words."""
    plan, done = trial.plan, trial.execution
    arm = "a floating hand" if plan.robot is None else plan.robot.name
    rows = [("Hand", f"{plan.gripper.description}, carried by {arm}")]
    if done is None:
        return [*rows, ("No grasp", str(trial.reason))]
    touched = "nothing was touched before the fingers closed" if done.clean else "something was touched before"
    rows.append(("Execution", f"{trial.reason or f'held, {MM * done.lifted_m:.0f} mm up, and shaken'}; {touched}"))
    return rows


def film(trials: Sequence[Trial]) -> bytes:
    """The executions of trials, one after the other, as an animated GIF."""
    from PIL import Image

    frames = [
        Image.fromarray(_shot(trial.film, moment, _from_aside(trial), FILM_PX, 1)).quantize(
            64, dither=Image.Dither.NONE
        )
        for trial in trials
        if trial.film is not None
        for moment in trial.film.snapshots
    ]
    content = io.BytesIO()
    frames[0].save(
        content, "GIF", save_all=True, append_images=frames[1:], duration=round(1000 * FRAME_S), loop=0, optimize=True
    )
    return content.getvalue()


def _draw_shot(axes: Any, recorded: Film, moment: Snapshot, eye: Frame) -> None:
    axes.imshow(_shot(recorded, moment, eye, PANEL_PX, FINER))
    axes.set_axis_off()


def _shot(recorded: Film, moment: Snapshot, eye: Frame, size: tuple[int, int], finer: int) -> ByteArray:
    """A shaded picture (h, w, 3) of a moment, cast finer than it is and then averaged."""
    width, height = size
    cast = picture(
        placed(recorded.shapes, moment), [shape.kind for shape in recorded.shapes], eye, (finer * width, finer * height)
    )
    blocks = cast.reshape(height, finer, width, finer, 3)
    return np.asarray(blocks.mean(axis=(1, 3))).astype(np.uint8)


def _from_aside(trial: Trial) -> Frame:
    """An eye that has the table and the arm, if there is one, in view."""
    spot = trial.spot
    middle = 0.5 * spot + np.array([0.0, 0.0, ABOVE_M])
    return eye_on(middle, AROUND_M, float(np.arctan2(spot[1], spot[0])) + ASIDE_RAD, ELEVATION_RAD)


def _from_close(trial: Trial) -> Frame:
    """An eye that sees the fingers close; without a grasp the object."""
    if trial.tips is None:
        return eye_on(trial.place.position, CLOSE_M, ASIDE_RAD, ELEVATION_RAD)
    across = axes_from_quaternion(trial.tips.orientation)[0]
    middle = trial.tips.position + np.array([0.0, 0.0, LIFTED_M])
    return eye_on(middle, CLOSE_M, float(np.arctan2(across[1], across[0])) + 0.5 * ASIDE_RAD, ELEVATION_RAD)


def _draw_box(axes: Any, trial: Trial, item: ObjectPlan) -> bool:
    """Fig. 18's second column; whether there is one."""
    if item.box is None:
        return False
    draw_boxes(axes, trial.plan, item, item.box)
    return True


def _draw_directions(axes: Any, trial: Trial, item: ObjectPlan) -> bool:
    """Fig. 18's third column; whether there is one."""
    fingers = item.trace.fingers
    of = _outlined(axes, trial, item)
    if of is None or fingers is None:
        return False
    length = 0.05 * float(np.ptp(np.vstack([fingers.start, fingers.end]), axis=0).max())
    tips = fingers.contact + length * fingers.direction
    draw_segments(axes, of(fingers.start), of(fingers.end), colors=PURPLE, linewidths=1.2, label="finger candidates")
    draw_segments(axes, of(fingers.contact), of(tips), colors=BLUE, linewidths=0.7, label="grasping directions")
    return True


def _draw_final(axes: Any, trial: Trial, item: ObjectPlan) -> bool:
    """Fig. 18's fourth column: two bold red lines; whether there are any."""
    fingers = item.trace.fingers
    of = _outlined(axes, trial, item)
    if of is None or fingers is None or not item.grasps:
        return False
    chosen = list(item.grasps[0].fingers)
    draw_segments(
        axes, of(fingers.start[chosen]), of(fingers.end[chosen]), colors=RED, linewidths=4, label="final grasp"
    )
    axes.plot(*of(fingers.contact[chosen]).T, color=RED, lw=1.0)
    return True


def _draw_area(axes: Any, trial: Trial, item: ObjectPlan) -> bool:
    """Fig. 18's fifth column; whether there is one."""
    if item.silhouette is None or not item.grasps:
        return False
    draw_on_cloud(axes, trial.plan, item, item.silhouette)
    return True


def _outlined(axes: Any, trial: Trial, item: ObjectPlan) -> Any:
    """Draw an object's silhouette; what brings points of its plane into the drawing, None without one."""
    silhouette = item.silhouette
    if silhouette is None:
        return None
    view = view_of(trial.plan, silhouette.frame.axes[2])

    def of(points: FloatArray) -> FloatArray:
        return view.of_plane(silhouette.frame, points)

    draw_loops(axes, silhouette, view, GREY)
    show(axes, np.concatenate([of(loop) for loop in silhouette.loops]), MARGIN_MM)
    tick_labels(axes, view)
    return of
