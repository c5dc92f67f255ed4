"""What is released: a typed interface, versions from tags, and checks that are the same everywhere."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from mypy import api

import flatgrasp_cli

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
USER = """
import numpy as np

from flatgrasp_cli import Cloud, Grasp, Plan, Selection, __version__, load_gripper, load_robot, load_settings, plan
from flatgrasp_cli import read_clouds, to_document

def best(path: str) -> Grasp | None:
    for cloud in read_clouds(path, 1.0, Selection(count=1)):
        result: Plan = plan(cloud, load_gripper("pr2"), load_settings(), top=3, robot=load_robot("ur5e"))
        document: dict[str, object] = to_document(result)
        print(document["status"], __version__)
        return result.best
    return plan(Cloud(np.zeros((10, 3))), load_gripper("pr2")).best

grasp = best("cloud.pcd")
if grasp is not None:
    width: float = grasp.width_m
    x: float = float(grasp.position[0])
"""
WRONG = """
from flatgrasp_cli import load_gripper, plan, read_clouds
for cloud in read_clouds("cloud.pcd"):
    print(plan(cloud, load_gripper("pr2")).best.width_m)
    plan(cloud, "pr2")
    load_gripper(3)
"""
INTERFACE = """
[mypy]
[mypy-matplotlib.*,rich.*]
follow_imports = skip
"""
"""What draws and prints is no part of the interface, and reading its types would take as long as all the rest."""


def checked(script: str, folder: Path) -> list[str]:
    """What mypy says of a user's script, strictly, line by line."""
    path = folder / "user.py"
    path.write_text(script, encoding="utf-8")
    config = folder / "mypy.ini"
    config.write_text(INTERFACE, encoding="utf-8")
    arguments = [
        "--strict",
        "--config-file",
        str(config),
        "--follow-imports=silent",
        "--cache-dir",
        str(folder / "cache"),
    ]
    out, err, _ = api.run([*arguments, "--no-error-summary", str(path)])
    assert err == ""
    return [line.partition(".py:")[2] for line in out.splitlines() if ": error:" in line]


def test_the_public_interface_is_typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert Path(flatgrasp_cli.__file__).with_name("py.typed").exists()
    monkeypatch.setenv("MYPYPATH", str(ROOT))
    assert checked(USER, tmp_path) == []
    wrong = checked(WRONG, tmp_path)
    assert [line.partition(":")[0] for line in wrong] == ["4", "5", "6"]
    assert 'has no attribute "width_m"' in wrong[0]


def test_the_version_is_that_of_the_newest_tag() -> None:
    assert PROJECT["project"]["dynamic"] == ["version"]
    assert PROJECT["tool"]["hatch"]["version"]["source"] == "vcs"
    assert re.fullmatch(r"\d+\.\d+.*", flatgrasp_cli.__version__)
    done = subprocess.run(
        [sys.executable, "-m", "flatgrasp_cli", "--version"], capture_output=True, check=True, text=True
    )
    assert done.stdout == f"flatgrasp {flatgrasp_cli.__version__} (compiled)\n"


def test_a_tree_that_was_not_installed_has_a_version_too(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "flatgrasp_cli", tmp_path / "flatgrasp_cli")
    missing = (
        "from importlib import metadata\n"
        "def missing(name): raise metadata.PackageNotFoundError(name)\n"
        "metadata.version = missing\n"
        "import flatgrasp_cli; print(flatgrasp_cli.__version__)"
    )
    done = subprocess.run([sys.executable, "-c", missing], capture_output=True, check=True, text=True, cwd=tmp_path)
    assert done.stdout == "0+source\n"


def workflow(name: str) -> dict[str, Any]:
    text = (ROOT / ".github" / "workflows" / name).read_text(encoding="utf-8")
    loaded: dict[str, Any] = yaml.safe_load(text)
    return loaded


def commands(job: dict[str, Any]) -> list[str]:
    return [step["run"] for step in job["steps"] if "run" in step]


def test_ci_does_on_every_system_what_the_machine_checks() -> None:
    jobs = workflow("ci.yml")["jobs"]
    assert commands(jobs["unix"]) == [".ci/run"]
    assert {os.partition("-")[0] for os in jobs["unix"]["strategy"]["matrix"]["os"]} == {"ubuntu", "macos"}
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    lines = [line.strip() for line in script.splitlines()]
    checks = [line for line in lines if re.match(r"(ruff|mypy|lint-imports|sphinx-build)\b", line)]
    assert len(checks) == 5
    on_windows = [line.replace("build/docs", '"$work/docs"') for line in commands(jobs["windows"])]
    assert [line for line in checks if line not in on_windows] == []
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(line in readme for line in on_windows if line.startswith(("pytest", "flatgrasp plan")))


def test_every_python_that_ci_tries_is_one_that_the_project_takes() -> None:
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    tried = workflow("ci.yml")["jobs"]["unix"]["strategy"]["matrix"]["python"]
    assert oldest in tried
    assert workflow("release.yml")["jobs"]["try"]["strategy"]["matrix"]["python"] == tried


def test_nothing_is_published_that_was_not_checked() -> None:
    jobs = workflow("release.yml")["jobs"]
    assert jobs["ci"]["uses"] == "./.github/workflows/ci.yml"
    assert set(jobs["publish"]["needs"]) == {"ci", "build", "try"}
    assert jobs["try"]["needs"] == "wheels"


def test_wheels_are_built_on_the_systems_and_for_the_pythons_that_ci_tries() -> None:
    systems = set(workflow("release.yml")["jobs"]["wheels"]["strategy"]["matrix"]["os"])
    assert systems == {"ubuntu-latest", "ubuntu-24.04-arm", "macos-latest", "windows-latest"}
    tried = workflow("ci.yml")["jobs"]["unix"]["strategy"]["matrix"]["python"]
    built = PROJECT["tool"]["cibuildwheel"]["build"]
    assert built == [f"cp{version.replace('.', '')}-*" for version in tried]


def test_a_commit_is_checked_by_what_ci_checks() -> None:
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"][0]["hooks"]
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert [hook["id"] for hook in hooks if hook["name"] not in script] == []
