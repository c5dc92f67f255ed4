"""The best grasps as a table for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flatgrasp_cli.geometry.frames import axes_from_quaternion
from flatgrasp_cli.planning import Plan

if TYPE_CHECKING:
    from rich.table import Table

ROWS = 5


def grasp_table(plan: Plan) -> Table:
    """The best grasps of each object: a rich table."""
    from rich.table import Table

    table = Table(title=f"{_title(plan)} · {plan.gripper.name}", title_justify="left", caption_justify="left")
    for heading in ("object", "rank", "width\nmm", "opening\nmm", "force balance\n°", "needs\nfriction"):
        table.add_column(heading, justify="right")
    for heading in ("gravity\nmm", "position x y z\nm", "approach\n"):
        table.add_column(heading, justify="right")
    for item in plan.objects:
        for grasp in item.grasps[:ROWS]:
            approach = axes_from_quaternion(grasp.orientation)[2]
            table.add_row(
                str(item.object.id),
                str(grasp.rank),
                f"{1e3 * grasp.width_m:.1f}",
                f"{1e3 * grasp.opening_m:.1f}",
                f"{grasp.force_balance_deg:.1f}",
                f"{grasp.required_friction:.2f}",
                f"{1e3 * grasp.gravity_distance_m:.1f}",
                " ".join(f"{value:.3f}" for value in grasp.position),
                " ".join(f"{value:.2f}" for value in approach),
            )
        table.add_section()
    table.caption = "\n".join(
        f"object {item.object.id}: no grasp: {item.rejection.reason}" for item in plan.objects if item.rejection
    )
    return table


def _title(plan: Plan) -> str:
    if plan.scene.support is None:
        return str(plan.cloud.source)
    count = len(plan.objects)
    return f"{plan.cloud.source} · {count} object{'s'[: count != 1]} on a support plane"


def refusal(plan: Plan) -> str:
    """Why there is no grasp, in one line: the reason and the stage that kept nothing."""
    stage = f" (stage {plan.objects[0].funnel[-1].stage})" if plan.objects else ""
    return f"no grasp: {plan.reason}{stage}"
