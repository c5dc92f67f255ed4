"""The contracts: every kind of document that flatgrasp writes, with its schema id and its JSON Schema.

Adding a key to a document is fine; renaming one or changing its meaning makes a new schema id. This module imports no
model before one is asked for: the command line lists the kinds in its help.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

DIALECT = "https://json-schema.org/draft/2020-12/schema"
PROFILES = "flatgrasp_cli.profiles"


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of document: the `module` and the name of its `model`, and what it is, in a few words."""

    module: str
    model: str
    about: str


KINDS = {
    "plan": Kind(f"{__name__}.plan", "Document", "The answer for one frame, plan's or batch's."),
    "cage": Kind(f"{__name__}.cage", "CageDocument", "What cage says of one outline."),
    "compare": Kind(f"{__name__}.compare", "CompareDocument", "What compare says of one object."),
    "inspect": Kind(f"{__name__}.inspect", "InspectDocument", "What inspect says of one source."),
    "trial": Kind(f"{__name__}.trial", "TrialDocument", "What simulate says of one attempt to grasp."),
    "batch": Kind(f"{__name__}.batch", "BatchDocument", "A whole batch in numbers: its summary.json."),
    "batch-record": Kind(f"{__name__}.batch", "RecordDocument", "What a batch remembers of one frame."),
    "batch-manifest": Kind(f"{__name__}.batch", "ManifestDocument", "What the results of a batch were made with."),
    "request": Kind(f"{__name__}.answer", "RequestDocument", "What serve is asked in a line."),
    "answer": Kind(f"{__name__}.answer", "AnswerDocument", "What serve says to a request."),
    "gripper": Kind(PROFILES, "Gripper", "A gripper's profile."),
    "robot": Kind(PROFILES, "Robot", "A robot's profile."),
    "planner": Kind(PROFILES, "PlannerSettings", "A profile of planner settings."),
    "camera-pose": Kind(PROFILES, "CameraPose", "A file with the pose of a camera."),
}
"""By the name that `flatgrasp schema` knows each by."""


def schema_id(kind: str) -> str:
    """What documents of one of the `KINDS` say under `schema`, where they do."""
    return f"flatgrasp.{kind}/1"


def json_schema(kind: str = "plan") -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of one of the `KINDS`."""
    from importlib import import_module

    from flatgrasp_cli.results.contracts.descriptions import described, extendable

    of = KINDS[kind]
    is_profile = of.module == PROFILES
    schema = described(getattr(import_module(of.module), of.model), "validation" if is_profile else "serialization")
    if kind == "planner":
        schema = extendable(schema)
    return {"$schema": DIALECT, "$id": schema_id(kind), **schema}
