"""Wrong usage ends with 2 and says what is right; profiles are shown and checked."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command_line import documents
from tests.conftest import Run

USAGE = {
    "no-source": (("plan",), "SOURCE"),
    "unknown-command": (("plam",), "plam"),
    "unknown-option": (("plan", "PLATE", "--griper", "pr2"), "--gripper"),
    "unknown-gripper": (("plan", "PLATE", "--gripper", "pr3"), "did you mean 'pr2'"),
    "unknown-method": (("plan", "PLATE", "--method", "papper"), "did you mean 'paper'"),
    "missing-gripper-file": (("plan", "PLATE", "--gripper", "mine.yaml"), "mine.yaml"),
    "set-unknown-key": (("plan", "PLATE", "--set", "fingers.stepp_m=0.004"), "did you mean 'step_m'"),
    "set-unknown-section": (("plan", "PLATE", "--set", "finger.step_m=0.004"), "did you mean 'fingers'"),
    "set-no-value": (("plan", "PLATE", "--set", "fingers.step_m"), "section.key=value"),
    "set-not-a-number": (("plan", "PLATE", "--set", "fingers.step_m=wide"), "wide"),
    "set-millimetres": (("plan", "PLATE", "--set", "fingers.step_m=400"), "400"),
    "set-nan": (("plan", "PLATE", "--set", "fingers.step_m=.nan"), "fingers.step_m"),
    "set-below-a-value": (("plan", "PLATE", "--set", "fingers.step_m.deep=1"), "fingers.step_m"),
    "set-not-yaml": (("plan", "PLATE", "--set", "fingers.step_m=[1"), "YAML"),
    "scale-zero": (("plan", "PLATE", "--scale", "0"), "--scale"),
    "scale-nan": (("plan", "PLATE", "--scale", "nan"), "--scale"),
    "scale-inf": (("plan", "PLATE", "--scale", "inf"), "--scale"),
    "sensor-out-of-this-world": (("plan", "PLATE", "--sensor", "1e300,0,0"), "--sensor"),
    "top-zero": (("plan", "PLATE", "--top", "0"), "--top"),
    "plots-unknown": (("plan", "PLATE", "--plots", "all"), "stages"),
    "out-is-a-file": (("plan", "PLATE", "--out", "PLATE"), "--out"),
    "out-below-a-file": (("plan", "PLATE", "--out", "PLATE/results"), "--out"),
    "profiles-unknown": (("profiles", "show", "pr3"), "pr2"),
    "profiles-missing": (("profiles", "check", "mine.yaml"), "mine.yaml"),
}


@pytest.mark.parametrize(("arguments", "word"), USAGE.values(), ids=USAGE)
def test_wrong_usage_is_exit_2_and_says_what_is_right(
    arguments: tuple[str, ...], word: str, plate: Path, run: Run
) -> None:
    done = run(*(each.replace("PLATE", str(plate)) for each in arguments))
    assert (done.code, done.out) == (2, "")
    assert word in done.err
    assert list(Path().iterdir()) == []


def test_a_fault_in_ones_own_gripper_is_named(plate: Path, run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    assert "max_opening_m: 0.090" in shown
    Path("mine.yaml").write_text(shown.replace("max_opening_m: 0.090", "max_opening_m: -0.090"), encoding="utf-8")
    done = run("plan", plate, "--gripper", "mine.yaml", "--json")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("flatgrasp: mine.yaml: max_opening_m: -0.09: ")
    assert len(done.err.splitlines()) == 1


def test_ones_own_gripper_is_used(plate: Path, run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    Path("mine.yaml").write_text(shown.replace("max_opening_m: 0.090", "max_opening_m: 0.030"), encoding="utf-8")
    done = run("plan", plate, "--gripper", "mine.yaml", "--json")
    assert done.code == 1
    assert documents(done.out)[0]["gripper"]["max_opening_m"] == 0.03


def test_profiles_list(run: Run) -> None:
    done = run("profiles", "list")
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert {"gripper\tlacquey", "gripper\tpr2", "robot\tur5", "planner\tdefault", "planner\tpaper"} <= set(lines)
    planners = [f"planner\t{name}" for name in ("allen", "default", "paper")]
    assert run("profiles", "list", "planner").out.splitlines() == planners


def test_every_profile_shown_passes_its_check(run: Run) -> None:
    files = []
    for line in run("profiles", "list").out.splitlines():
        kind, name = line.split("\t")
        files.append(f"{kind}-{name}.yaml")
        Path(files[-1]).write_text(run("profiles", "show", name).out, encoding="utf-8")
    done = run("profiles", "check", *files)
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines() == [f"{file}: ok" for file in files]


def test_profiles_check_lists_every_fault(run: Run) -> None:
    shown = run("profiles", "show", "pr2").out
    broken = shown.replace("max_opening_m: 0.090", "max_opening_m: wide").replace("palm_m", "plam_m")
    Path("broken.yaml").write_text(broken, encoding="utf-8")
    Path("good.yaml").write_text(shown, encoding="utf-8")
    done = run("profiles", "check", "broken.yaml", "good.yaml")
    assert (done.code, done.out) == (2, "good.yaml: ok\n")
    faults = done.err.splitlines()
    assert all(fault.startswith("broken.yaml: ") for fault in faults)
    assert [word in done.err for word in ("max_opening_m: 'wide'", "palm_m: missing", "did you mean 'palm_m'")] == [
        True,
        True,
        True,
    ]
    assert len(faults) == 3
