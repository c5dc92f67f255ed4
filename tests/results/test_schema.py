"""The JSON Schema tells what each property is, and in what unit."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

from flatgrasp_cli.results.contracts import json_schema

SCHEMA = json_schema()
UNIT_OF_NAME = {
    "_deg_s": "degrees a second",
    "_nm": "newton metres",
    "_deg": "degrees",
    "_rad": "radians",
    "_ns": "nanoseconds",
    "_ms": "milliseconds",
    "_kg": "kilograms",
    "_n": "newtons",
    "_m": "metres",
}
"""The longest endings first."""
UNITS = re.compile(
    r"\b(metres?|millimetres?|degrees|radians|newtons|kilograms|(milli|nano)seconds|m³"
    r"|share|ratio|coefficients?|times|numbers?|unit vectors?|vector of any length|unit quaternion)\b",
    re.IGNORECASE,
)
"""Units, and what numbers without a unit are."""


def properties() -> Iterator[tuple[str, dict[str, Any]]]:
    for name, definition in (("Document", SCHEMA), *SCHEMA["$defs"].items()):
        for key, value in definition.get("properties", {}).items():
            yield f"{name}.{key}", value


def is_number(part: dict[str, Any]) -> bool:
    """Whether a property is a number, or may be, or holds numbers."""
    inner = [*part.get("anyOf", []), *part.get("prefixItems", [])]
    inner += [part["items"]] if isinstance(part.get("items"), dict) else []
    return part.get("type") in ("number", "integer") or any(map(is_number, inner))


PROPERTIES = dict(properties())
NUMBERS = {name: value for name, value in PROPERTIES.items() if is_number(value)}


def test_it_is_walked_to_its_end() -> None:
    assert len(PROPERTIES) > 250
    assert {"Document.frame_id", "GraspPart.flange", "JointLimits.max_effort_nm", "ReachSettings.steps"} <= set(
        PROPERTIES
    )
    assert {"SilhouettePart.loops", "SensorPart.position", "SceneSettings.select", "Gripper.jaws"} <= set(NUMBERS)
    assert not {"CagePart.guaranteed", "WarningPart.text", "GraspPart.pose"} & set(NUMBERS)


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


def test_every_definition_is_described() -> None:
    assert [name for name, part in SCHEMA["$defs"].items() if not part.get("description")] == []


def test_planning_does_not_pay_for_descriptions() -> None:
    """They are read from the source, which only `flatgrasp schema` needs."""
    code = "import flatgrasp_cli.results.document, json, sys; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert "flatgrasp_cli.results.contracts.descriptions" not in json.loads(done.stdout)
