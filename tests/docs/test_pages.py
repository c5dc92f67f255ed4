"""The documentation's pages say of the program what is so: tables list what there is, and nothing else."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import flow
import numpy as np
import pytest
import reference

from flatgrasp_cli import errors
from flatgrasp_cli.interrupts import INTERRUPTED
from flatgrasp_cli.profiles import list_profiles
from flatgrasp_cli.profiles.uncertainty import Uncertainty
from flatgrasp_cli.ranking import CAUSES
from flatgrasp_cli.results.contracts import json_schema
from flatgrasp_cli.robot.reach import LIMITS
from flatgrasp_cli.simulation.samples import SAMPLES
from tests.package_trees import FILES, PACKAGE, tree

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md"))
CODED = {"Rejection", "Stage", "_nothing", "at_most", "count", "nothing"}
"""Functions and classes that are given a stage's name."""


def cells(page: str, section: str, column: int = 0) -> list[list[str]]:
    """What is between backticks in a column of a section's table, row by row."""
    text = (DOCS / page).read_text(encoding="utf-8")
    table = text.partition(f"# {section}\n")[2].partition("\n#")[0]
    rows = [line.split("|") for line in table.splitlines() if line.startswith("|")][2:]
    return [re.findall(r"`([^`]+)`", row[1 + column]) for row in rows]


def listed(page: str, section: str) -> list[str]:
    """The codes in the first column of a section's table."""
    return [code for row in cells(page, section) for code in row]


def calls() -> Iterator[tuple[str, list[ast.expr]]]:
    """The name of what is called, and its positional arguments, everywhere in the package."""
    for path in FILES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name):
                yield node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id, node.args


def constants() -> dict[str, str]:
    """The package's named strings."""
    return {
        node.targets[0].id: node.value.value
        for path in FILES
        for node in tree(path).body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    }


def test_every_stage_is_listed_once() -> None:
    words = {
        argument.value
        for name, arguments in calls()
        for argument in arguments[:2]
        if name in CODED and isinstance(argument, ast.Constant) and isinstance(argument.value, str)
    }
    stages = {word for word in words if re.fullmatch(r"[a-z_]{3,}", word)}
    assert "force_balance" in stages
    assert sorted(listed("stages.md", "Stages")) == sorted(stages)


def test_every_warning_is_listed_once() -> None:
    named, codes = constants(), set()
    for name, arguments in calls():
        code = arguments[0] if name in {"Assumption", "CloudWarning"} else None
        if isinstance(code, ast.Name | ast.Constant):
            codes.add(named[code.id] if isinstance(code, ast.Name) else str(code.value))
    assert "sensor_assumed" in codes
    assert sorted(listed("stages.md", "Warnings")) == sorted(codes)


def test_every_way_to_fail_is_listed_in_its_order() -> None:
    assert tuple(listed("method.md", "What a grasp fails by")) == CAUSES


def test_every_error_is_listed_with_what_is_usual() -> None:
    usual = asdict(Uncertainty())
    comments = reference._comments(reference.CONFIGS / "planner" / "default.yaml")
    for name, value in usual.items():
        figures = " to ".join(f"{figure:g}" for figure in np.atleast_1d(value))
        assert comments["uncertainty", name].startswith(f"usually {figures}:")
    assert listed("method.md", "What is not known") == [f"uncertainty.{name}" for name in usual if name != "samples"]


def test_every_limit_of_an_arm_is_listed_in_its_order() -> None:
    assert tuple(listed("stages.md", "What stops a robot")) == LIMITS


def test_exit_codes_are_those_of_the_errors() -> None:
    text = (DOCS / "exit_codes.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \|.*\| ([^|]*)\|$", text, flags=re.MULTILINE)
    said = {name: int(code) for code, names in rows for name in re.findall(r"`(\w+)`", names)}
    classes = [thing for thing in vars(errors).values() if isinstance(thing, type)]
    there = {cls.__name__: cls.exit_code for cls in classes if issubclass(cls, errors.FlatgraspError)}
    assert said.pop("KeyboardInterrupt") == INTERRUPTED
    assert there.pop("FlatgraspError") == errors.UsageError.exit_code
    assert said == there
    assert [code for code, _ in rows] == ["0", "1", "2", "3", "130"]


def keys(node: dict[str, Any], definitions: dict[str, Any], before: str = "") -> Iterator[str]:
    """Every key of documents, with those that lead to it: `objects[].grasps[].rank`."""
    options = node.get("anyOf", [node])
    for option in options:
        if "$ref" in option:
            yield from keys(definitions[option["$ref"].rpartition("/")[2]], definitions, before)
        elif option.get("type") == "array" and isinstance(option.get("items"), dict):
            yield from keys(option["items"], definitions, f"{before}[]")
        for name, value in option.get("properties", {}).items():
            key = f"{before}.{name}" if before else name
            yield key
            yield from keys(value, definitions, key)


@pytest.fixture(scope="module")
def of_documents() -> list[str]:
    schema = json_schema()
    return list(keys(schema, schema["$defs"]))


@pytest.fixture(scope="module")
def made_by() -> dict[str, str]:
    """Modules by the keys that the architecture page lists for them."""
    section = "Where does this line come from?"
    modules = [row[0] for row in cells("architecture.md", section, column=1)]
    return {key: module for row, module in zip(cells("architecture.md", section), modules, strict=True) for key in row}


def test_the_architecture_names_the_module_behind_every_key(of_documents: list[str], made_by: dict[str, str]) -> None:
    assert {"status", "objects[].funnel", "objects[].grasps[].cage.tolerance"} <= set(of_documents)
    structure = re.compile(r"\w+|objects\[\]\.\w+|objects\[\]\.grasps\[\]\.\w+|objects\[\]\.grasps\[\]\.metrics\.\w+")
    parents = {"objects[].grasps[].metrics"}  # each of which has a module of its own
    expected = {key for key in of_documents if structure.fullmatch(key)} - parents
    assert expected - set(made_by) == set()


def test_the_architecture_names_no_key_twice_nor_one_that_is_not_there(
    of_documents: list[str], made_by: dict[str, str]
) -> None:
    assert set(made_by) - set(of_documents) == set()
    assert len(made_by) == len(listed("architecture.md", "Where does this line come from?"))


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CONTRIBUTING.md"], ids=lambda page: page.name)
def test_every_module_that_a_page_names_is_there(page: Path) -> None:
    named = set(re.findall(r"`((?:\w+/)*\w+(?:\.py|/))`", page.read_text(encoding="utf-8")))
    assert {name for name in named if not any((top / name).exists() for top in (PACKAGE, ROOT))} == set()


def test_the_flow_shows_every_room_of_the_package() -> None:
    shown = [room.name for room in flow.ROOMS]
    packages = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    modules = {path.stem for path in PACKAGE.glob("*.py")}
    assert packages - set(shown) == set()
    assert set(shown) - packages - modules == set()
    assert (len(flow.PLACED), len(flow.PASSED)) == (len(flow.READING) - 1, len(flow.WORKING) - 1)


def test_the_held_rates_are_those_of_all_grippers_and_all_samples() -> None:
    text = (DOCS / "held_rates.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
    of_table = len(list_profiles("gripper")) + 2
    assert len(rows) == 2 * of_table  # for a hand that goes where it should, and for one that misses
    for table in (rows[:of_table], rows[of_table:]):
        assert table[0] == ["gripper", *(name.replace("_", " ") for name in SAMPLES)]
        assert [row[0].strip("`") for row in table[2:]] == list_profiles("gripper")
        assert all(re.match(r"\d+/10\b", cell) for row in table[2:] for cell in row[1:])


def test_what_pages_take_from_the_program_is_there() -> None:
    marks = [mark for page in PAGES for mark in reference.MARK.findall(page.read_text(encoding="utf-8"))]
    assert sorted(marks) == sorted(reference.PARTS)


def test_generated_parts_show_names_values_and_meaning() -> None:
    text = reference.filled_in("<!-- from the program: settings -->\n")
    assert "`balance.facing`: `true`, `false` with `--method paper`\n: Drop pairs that would push apart" in text
    assert "*the two fingers must press toward each other*" in text
    assert "One of `chord`, `arc_length`." in text
    profiles = reference.profiles()
    assert "`tip_advance_m`: `0.0`\n: How far the fingertips move away" in profiles
    assert "`dh.a_m`" in profiles
    assert "## flatgrasp profiles check\n\n```text\nUsage: flatgrasp profiles check " in reference.commands()
    assert ".. autofunction:: flatgrasp_cli.plan\n" in reference.api()
    assert ".. autoclass:: flatgrasp_cli.model.Reach\n" in reference.api()
    assert ".. autoclass:: flatgrasp_cli.Rejection\n" in reference.api()
