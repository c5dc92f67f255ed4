"""The best grasps as a table for a terminal: a line each, which fits 80 columns unless all is asked for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.profiles.robot import SIX
from flatgrasp_cli.results.remedies import remedy_of

if TYPE_CHECKING:
    from rich.table import Table

ROWS = 5
SHORT = ("object", "rank", "holds\n%", "width\nmm", "open\nmm", "position x y z\nm")
WIDE = (*SHORT, "needs\nμ", "force balance\n°", "gravity\nmm", "approach x y z\n")
JOINTS = "joints\n°"
OPEN = SHORT.index("open\nmm")
"""The column that makes room for a seventh joint."""


def headline(plan: Plan) -> str:
    """What was planned on and with which hand: the table's first line, and how many objects there are in a scene."""
    parts = [str(plan.cloud.source), plan.gripper.description]
    parts += [plan.robot.name] if plan.robot else []
    if plan.scene.support is None:
        return " · ".join(parts)
    count = len(plan.objects)
    return f"{' · '.join(parts)}\n{count} object{'' if count == 1 else 's'} on a support plane"


def grasp_table(plan: Plan, *, wide: bool = False) -> Table:
    """The best grasps of each object: a rich table, with joint angles at the grasp when there is a robot."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 0 if plan.robot else 1, 0, 0))
    left_out = {OPEN} if plan.robot and plan.robot.count > SIX and not wide else set()
    for k, heading in enumerate((*(WIDE if wide else SHORT), *((JOINTS,) if plan.robot else ()))):
        if k not in left_out:
            table.add_column(heading, justify="right", no_wrap=True)
    for item in plan.objects:
        for grasp in item.grasps[:ROWS]:
            cells = [str(item.object.id), *_short(grasp), *(_more(grasp) if wide else ())]
            cells += [_joints(grasp, 1 if wide else 0)] if plan.robot else []
            table.add_row(*(cell for k, cell in enumerate(cells) if k not in left_out))
        if item.grasps:
            table.add_section()
    return table


def _short(grasp: Grasp) -> tuple[str, ...]:
    return (
        str(grasp.rank),
        "" if grasp.success is None else f"{100 * grasp.success.probability:.0f}",
        f"{1e3 * grasp.width_m:.1f}",
        f"{1e3 * grasp.opening_m:.1f}",
        " ".join(f"{value:z6.3f}" for value in grasp.position),
    )


def _more(grasp: Grasp) -> tuple[str, ...]:
    approach = axes_from_quaternion(grasp.orientation)[2]
    return (
        f"{grasp.required_friction:.2f}",
        f"{grasp.force_balance_deg:.1f}",
        f"{1e3 * grasp.gravity_distance_m:.1f}",
        " ".join(f"{value:z5.2f}" for value in approach),
    )


def _joints(grasp: Grasp, decimals: int) -> str:
    """The arm's joint angles at the grasp in degrees, base to wrist."""
    if grasp.reach is None or grasp.reach.joints_rad is None:
        return ""
    width = len("-360") + (decimals + 1 if decimals else 0)
    return " ".join(f"{math.degrees(angle):z{width}.{decimals}f}" for angle in grasp.reach.joints_rad[1])


def refusals(plan: Plan) -> str:
    """Which objects have no grasp, why, and what would help; empty when all have one."""
    lines = []
    for item in plan.objects:
        if item.rejection is None:
            continue
        lines.append(f"object {item.object.id}: no grasp: {item.rejection.reason}")
        if remedy := remedy_of(plan, item):
            lines.append(f"  remedy: {remedy}")
    return "\n".join(lines)


def refusal(plan: Plan) -> list[str]:
    """Why there is no grasp, with the stage that kept nothing; in a second line what would help, if that is known."""
    stage = f" (stage {plan.objects[0].funnel[-1].stage})" if plan.objects else ""
    remedy = remedy_of(plan, plan.objects[0] if plan.objects else None)
    return [f"no grasp: {plan.reason}{stage}", *([f"remedy: {remedy}"] if remedy else [])]
