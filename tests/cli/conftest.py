"""Clouds that the command line is given."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from tests.cli.command_line import called
from tests.plates import slab, write_pcd


@pytest.fixture(scope="session")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate of 120 × 40 × 10 mm, which every gripper can take across."""
    return write_pcd(tmp_path_factory.mktemp("clouds") / "plate.pcd", slab(120, 40))


@pytest.fixture(scope="session")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate of 300 × 300 mm, which no gripper can take."""
    return write_pcd(tmp_path_factory.mktemp("clouds") / "large.pcd", slab(300, 300, points=8000))


@pytest.fixture(scope="session")
def validator() -> Draft202012Validator:
    """Of documents against what `flatgrasp schema` prints."""
    code, printed = called("schema")
    assert code == 0
    schema = json.loads(printed)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)
