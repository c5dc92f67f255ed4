"""The JSON Schemas tell what each property is, and in what unit."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from flatgrasp_cli.results.contracts import KINDS, json_schema

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


@cache
def schemas() -> dict[str, dict[str, Any]]:
    """Those of all kinds, made for the tests alone: whoever only lists the tests needs none."""
    return {kind: json_schema(kind) for kind in KINDS}


@cache
def properties() -> dict[str, dict[str, Any]]:
    """By kind, definition and key."""
    return dict(_properties())


def numbers() -> dict[str, dict[str, Any]]:
    return {name: value for name, value in properties().items() if is_number(value)}


def _properties() -> Iterator[tuple[str, dict[str, Any]]]:
    for kind, schema in schemas().items():
        for name, definition in ((schema["title"], schema), *schema.get("$defs", {}).items()):
            for key, value in definition.get("properties", {}).items():
                yield f"{kind}: {name}.{key}", value


def is_number(part: dict[str, Any]) -> bool:
    """Whether a property is a number, or may be, or holds numbers."""
    inner = [*part.get("anyOf", []), *part.get("prefixItems", [])]
    inner += [part[key] for key in ("items", "additionalProperties") if isinstance(part.get(key), dict)]
    return part.get("type") in ("number", "integer") or any(map(is_number, inner))


def test_it_is_walked_to_its_end() -> None:
    of_plan = {name.removeprefix("plan: ") for name in properties() if name.startswith("plan: ")}
    numbered = {name.removeprefix("plan: ") for name in numbers() if name.startswith("plan: ")}
    assert len(of_plan) > 250
    assert {"Document.frame_id", "GraspPart.flange", "JointLimits.max_effort_nm", "ReachSettings.steps"} <= of_plan
    assert {"SilhouettePart.loops", "SensorPart.position", "SceneSettings.select", "Gripper.jaws"} <= numbered
    assert not {"CagePart.guaranteed", "WarningPart.text", "GraspPart.pose"} & numbered
    assert {"inspect: TopicPart.rate_hz", "batch: InputPart.median_ms", "batch-record: SketchPart.loops"} <= set(
        numbers()
    )
    assert {"gripper: Gripper.jaws", "planner: SceneSettings.select", "camera-pose: CameraPose.position_m"} <= set(
        numbers()
    )


def test_every_property_is_described_in_a_sentence() -> None:
    texts = {name: value.get("description", "") for name, value in properties().items()}
    assert {name: text for name, text in texts.items() if not re.fullmatch(r"\S.*\.", text)} == {}


def test_every_number_has_its_unit_or_is_said_to_have_none() -> None:
    texts = {name: value["description"] for name, value in numbers().items()}
    assert {name: text for name, text in texts.items() if not UNITS.search(text)} == {}


def test_units_in_names_are_those_of_the_descriptions() -> None:
    for name, value in numbers().items():
        unit = next((unit for ending, unit in UNIT_OF_NAME.items() if name.endswith(ending)), "")
        assert unit in value["description"], name


@pytest.mark.parametrize("kind", KINDS)
def test_every_definition_is_described(kind: str) -> None:
    schema = schemas()[kind]
    Draft202012Validator.check_schema(schema)
    assert schema["description"]
    assert [name for name, part in schema.get("$defs", {}).items() if not part.get("description")] == []


def test_a_document_that_names_its_contract_names_that_of_its_schema() -> None:
    naming = {kind: schema for kind, schema in schemas().items() if "schema" in schema["properties"]}
    assert {"plan", "trial", "batch", "batch-manifest"} <= set(naming)
    for kind, schema in naming.items():
        whole = kind.removesuffix("-manifest")  # a batch's manifest goes with its summary
        assert schema["properties"]["schema"]["const"] == f"flatgrasp.{whole}/1"
        assert schema["$id"] == f"flatgrasp.{kind}/1"
