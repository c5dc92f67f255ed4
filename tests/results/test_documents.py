"""A real document of every kind, as the command line writes it, meets the schema that the command line prints."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator, ValidationError

from flatgrasp_cli.profiles import list_profiles, profile_path
from flatgrasp_cli.results.contracts import KINDS
from tests.conftest import SAMPLES, Run
from tests.plates import slab, write_pcd

Documents = list[Any]
RECORDING = SAMPLES / "pan_ros1.bag"


@dataclass(frozen=True)
class Tool:
    """The command line, and two plates: one of 120 × 40 × 10 mm, and one that no gripper can take."""

    run: Run
    plate: Path
    large: Path

    def lines(self, *arguments: str | Path) -> Documents:
        """The documents that a command prints."""
        return [
            json.loads(line, parse_constant=pytest.fail) for line in self.run(*arguments, "--json").out.splitlines()
        ]

    def profiles(self, kind: str) -> Documents:
        """The shipped profiles of a kind."""
        paths = [profile_path(kind, name) for name in list_profiles(kind)]
        return [yaml.safe_load(self.run("profiles", "show", path).out) for path in paths]

    def check(self, kind: str, documents: Documents) -> None:
        """Hold documents against what `flatgrasp schema` prints."""
        printed = self.run("schema", kind)
        assert (printed.code, printed.err) == (0, "")
        validator = Draft202012Validator(json.loads(printed.out))
        assert documents
        for document in documents:
            validator.validate(document)
            with pytest.raises(ValidationError):  # the schema does refuse
                validator.validate(document | {"another": 1})


@pytest.fixture
def tool(run: Run, tmp_path: Path) -> Tool:
    plate = write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=2000))
    return Tool(run, plate, write_pcd(tmp_path / "large.pcd", slab(300, 300, points=2000)))


def planned(tool: Tool) -> Documents:
    robot = ("--robot", "ur5", "--camera-pose", "0.4,0,0.2,0,0,0,1")
    return tool.lines("plan", tool.plate, tool.large) + tool.lines("plan", tool.plate, *robot)


def caged(tool: Tool) -> Documents:
    notched, convex = tool.plate.with_name("notched.json"), tool.plate.with_name("square.json")
    notched.write_text("[[0,0],[6,0],[6,2],[4,3],[6,4],[6,6],[0,6],[0,4],[2,3],[0,2]]", encoding="utf-8")
    convex.write_text("[[0,0],[1,0],[1,1],[0,1]]", encoding="utf-8")
    return [document for source in (notched, convex, SAMPLES / "pan.pcd") for document in tool.lines("cage", source)]


def inspected(tool: Tool) -> Documents:
    return tool.lines("inspect", tool.plate, SAMPLES / "pan_ros2", RECORDING, SAMPLES / "pan_foxglove.mcap")


REQUESTS: Documents = [
    {"id": 7, "source": str(SAMPLES / "pan.pcd"), "options": {"gripper": "pr2", "set": {"fingers": {"step_m": 0.006}}}},
    {"id": "two", "source": str(RECORDING), "options": {"count": 2}},
    {"id": None, "data": "aGVsbG8="},
]


def answered(tool: Tool) -> Documents:
    lines = b"".join(json.dumps(request).encode() + b"\n" for request in REQUESTS)
    done = tool.run("serve", stdin=lines + b"no request\n")
    assert done.code == 0
    return [json.loads(line, parse_constant=pytest.fail) for line in done.out.splitlines()]


MADE: dict[str, Callable[[Tool], Documents]] = {
    "plan": planned,
    "cage": caged,
    "compare": lambda tool: tool.lines("compare", tool.plate, tool.large, SAMPLES / "pan.pcd"),
    "inspect": inspected,
    "trial": lambda tool: tool.lines("simulate", "hammer", "juice_box", "--trials", "1", "--mu", "0.05"),
    "request": lambda _: REQUESTS,
    "answer": answered,
    "gripper": lambda tool: tool.profiles("gripper"),
    "robot": lambda tool: tool.profiles("robot"),
    "planner": lambda tool: tool.profiles("planner"),
    "camera-pose": lambda _: [{"position_m": [0.4, 0, 0.6], "orientation_xyzw": [1, 0, 0, 0]}],
}
OF_BATCH = ("batch", "batch-record", "batch-manifest")


def test_no_kind_is_left_out() -> None:
    assert {*MADE, *OF_BATCH} == set(KINDS)


@pytest.mark.parametrize("kind", MADE)
def test_real_documents_meet_their_schema(kind: str, tool: Tool) -> None:
    tool.check(kind, MADE[kind](tool))


@pytest.mark.usefixtures("blank_pictures")
def test_what_a_batch_writes_meets_its_schemas(tool: Tool) -> None:
    broken = tool.plate.with_name("broken.pcd")
    broken.write_bytes(b"VERSION 0.7\nFIELDS x y\n")
    sources = (tool.plate, tool.large, RECORDING, broken, "--count", "1")
    assert tool.run("batch", *sources, "--out", "out", "--jobs", "1", "--plots", "--quiet").code == 3
    out, state = Path("out"), Path("out/.flatgrasp")
    tool.check("batch", [json.loads((out / "summary.json").read_text(encoding="utf-8"))])
    tool.check("batch-manifest", [json.loads((state / "manifest.json").read_text(encoding="utf-8"))])
    done = [path.read_text(encoding="utf-8").splitlines()[1:] for path in (state / "done").rglob("*.jsonl")]
    tool.check("batch-record", [json.loads(line) for lines in done for line in lines])
    results = [path.read_text(encoding="utf-8").splitlines() for path in out.glob("*.jsonl")]
    tool.check("plan", [json.loads(line) for lines in results for line in lines])


def test_no_name_is_plan(run: Run) -> None:
    assert run("schema").out == run("schema", "plan").out


def test_help_lists_all_names(run: Run) -> None:
    done = run("schema", "--help")
    assert all(f"  {kind} " in done.out for kind in KINDS)
    assert max(map(len, done.out.splitlines())) <= 80
    assert run("schema", "nothing").code == 2


def test_a_planner_profile_may_leave_to_another_what_it_extends(run: Run) -> None:
    validator = Draft202012Validator(json.loads(run("schema", "planner").out))
    validator.validate({"profile": "planner", "name": "mine", "extends": "default", "fingers": {"step_m": 0.004}})
    with pytest.raises(ValidationError):
        validator.validate({"profile": "planner", "name": "mine", "extends": "default", "fingers": {"step": 4}})
    with pytest.raises(ValidationError):
        validator.validate({"profile": "planner", "name": "mine", "extends": "nothing"})
