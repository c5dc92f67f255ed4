"""A trial as the JSON document of contract `flatgrasp.trial/1`."""

from __future__ import annotations

from typing import Any

from flatgrasp_cli.results.contracts.trial import SCHEMA_ID, ConditionsPart, TrialDocument
from flatgrasp_cli.results.grasps import grasp_part, pose_part
from flatgrasp_cli.results.numbers import number
from flatgrasp_cli.simulation.trial import Conditions, Trial


def trial_document(trial: Trial, conditions: Conditions, cloud: str | None = None) -> dict[str, Any]:
    """A trial as a JSON-ready document; `cloud` is the file that keeps what the camera saw."""
    plan, done = trial.plan, trial.execution
    document = TrialDocument(
        schema=SCHEMA_ID,
        object=trial.object,
        trial=trial.number,
        attempt=trial.attempt,
        status=trial.status,
        clean=None if done is None else done.clean,
        reason=trial.reason,
        lifted_m=None if done is None else number(done.lifted_m),
        pushed_m=None if done is None else number(done.pushed_m),
        object_pose=pose_part(trial.place),
        camera_pose=pose_part(trial.camera),
        frame_id=plan.cloud.frame_name,
        grasp=None if plan.best is None else grasp_part(plan.best, plan.gripper),
        conditions=_conditions(trial, conditions),
        cloud=cloud,
    )
    return dict(document)


def _conditions(trial: Trial, conditions: Conditions) -> ConditionsPart:
    return ConditionsPart(
        gripper=trial.plan.gripper.name,
        robot=None if trial.plan.robot is None else trial.plan.robot.name,
        seed=conditions.seed,
        friction=number(conditions.friction),
        force_n=number(conditions.force_n),
        force_from=conditions.force_from,
        mass_kg=number(trial.mass_kg),
        sensor_tilt_deg=number(conditions.tilt_deg),
        miss_m=number(conditions.miss_m),
        miss_deg=number(conditions.miss_deg),
    )
