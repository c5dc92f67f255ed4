"""The JSON Schemas tell what each property is, and in what unit."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli.results.contracts import KINDS, json_schema

SCHEMAS = {kind: json_schema(kind) for kind in KINDS}
UNIT_OF_NAME = {
    "_deg_s": "degrees a second",
    "_nm": "newton metres",
    "_deg": "degrees",
    "_rad": "radians",
    "_ns": "nanoseconds",
    "_ms": "milliseconds",
    "_hz": "a second",
    "_s": "seconds",
    "_kg": "kilograms",
    "_n": "newtons",
    "_m": "metres",
}
"""The longest endings first."""
UNITS = re.compile(
    r"\b(metres?|millimetres?|degrees|radians|newtons|kilograms|(milli|nano)?seconds|m³"
    r"|share|ratio|coefficients?|times|numbers?|unit vectors?|vector of any length|unit quaternion)\b",
    re.IGNORECASE,
)
"""Units, and what numbers without a unit are."""


def properties() -> Iterator[tuple[str, dict[str, Any]]]:
    """By kind, definition and key."""
    for kind, schema in SCHEMAS.items():
        for name, definition in ((schema["title"], schema), *schema.get("$defs", {}).items()):
            for key, value in definition.get("properties", {}).items():
                yield f"{kind}: {name}.{key}", value


def is_number(part: dict[str, Any]) -> bool:
    """Whether a property is a number, or may be, or holds numbers."""
    inner = [*part.get("anyOf", []), *part.get("prefixItems", [])]
    inner += [part[key] for key in ("items", "additionalProperties") if isinstance(part.get(key), dict)]
    return part.get("type") in ("number", "integer") or any(map(is_number, inner))


PROPERTIES = dict(properties())
NUMBERS = {name: value for name, value in PROPERTIES.items() if is_number(value)}


def test_it_is_walked_to_its_end() -> None:
    of_plan = {name.removeprefix("plan: ") for name in PROPERTIES if name.startswith("plan: ")}
    numbers = {name.removeprefix("plan: ") for name in NUMBERS if name.startswith("plan: ")}
    assert len(of_plan) > 250
    assert {"Document.frame_id", "GraspPart.flange", "JointLimits.max_effort_nm", "ReachSettings.steps"} <= of_plan
    assert {"SilhouettePart.loops", "SensorPart.position", "SceneSettings.select", "Gripper.jaws"} <= numbers
    assert not {"CagePart.guaranteed", "WarningPart.text", "GraspPart.pose"} & numbers
    assert {"inspect: TopicPart.rate_hz", "batch: InputPart.median_ms", "batch-record: SketchPart.loops"} <= set(
        NUMBERS
    )
    assert {"gripper: Gripper.jaws", "planner: SceneSettings.select", "camera-pose: CameraPose.position_m"} <= set(
        NUMBERS
    )


def test_every_property_is_described_in_a_sentence() -> None:
    texts = {name: value.get("description", "") for name, value in PROPERTIES.items()}
    assert {name: text for name, text in texts.items() if not re.fullmatch(r"\S.*\.", text)} == {}


def test_every_number_has_its_unit_or_is_said_to_have_none() -> None:
    texts = {name: value["description"] for name, value in NUMBERS.items()}
    assert {name: text for name, text in texts.items() if not UNITS.search(text)} == {}


def test_units_in_names_are_those_of_the_descriptions() -> None:
    for name, value in NUMBERS.items():
        unit = next((unit for ending, unit in UNIT_OF_NAME.items() if name.endswith(ending)), "")
        assert unit in value["description"], name


@pytest.mark.parametrize("kind", KINDS)
def test_every_definition_is_described(kind: str) -> None:
    schema = SCHEMAS[kind]
    Draft202012Validator.check_schema(schema)
    assert schema["description"]
    assert [name for name, part in schema.get("$defs", {}).items() if not part.get("description")] == []


@pytest.mark.parametrize("kind", [kind for kind, schema in SCHEMAS.items() if "schema" in schema["properties"]])
def test_a_document_that_names_its_contract_names_that_of_its_schema(kind: str) -> None:
    whole = kind.removesuffix("-manifest")  # a batch's manifest goes with its summary
    assert SCHEMAS[kind]["properties"]["schema"]["const"] == f"flatgrasp.{whole}/1"
    assert SCHEMAS[kind]["$id"] == f"flatgrasp.{kind}/1"
