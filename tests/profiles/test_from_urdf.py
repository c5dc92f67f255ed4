"""A gripper's URDF → a profile: dimensions that were put in come out."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from flatgrasp_cli import load_gripper
from tests.conftest import Run

Make = Callable[[str], tuple[dict[str, Any], str, str]]


def shape(inner: str, xyz: str = "0 0 0") -> str:
    return f'<collision><origin xyz="{xyz}"/><geometry>{inner}</geometry></collision>'


def link(name: str, *shapes: str) -> str:
    return f'<link name="{name}">{"".join(shapes)}</link>'


def joint(name: str, kind: str, child: str, xyz: str, axis: str, within: str) -> str:
    """A joint of the palm, with its limit and what else is `within`."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="palm"/><child link="{child}"/><origin xyz="{xyz}"/>'
        f'<axis xyz="{axis}"/>{within}</joint>'
    )


FINGER = '<box size="0.018 0.012 0.05"/>'
SLIDE = '<limit lower="0" upper="0.04" effort="70" velocity="1"/>'


def sliding(palm: str = '<box size="0.06 0.2 0.06"/>', more: str = "") -> str:
    """Fingers of 18 × 12 × 50 mm whose pads meet when closed, on a palm that ends at 66 mm."""
    return (
        f'<robot name="a hand">{link("palm", shape(palm, "0 0 0.036"))}'
        f"{link('left', shape(FINGER, '0 0.006 0.025'))}{link('right', shape(FINGER, '0 -0.006 0.025'))}"
        f"{joint('l', 'prismatic', 'left', '0 0 0.066', '0 1 0', SLIDE)}"
        + joint("r", "prismatic", "right", "0 0 0.066", "0 -1 0", SLIDE + '<mimic joint="l"/>')
        + f"{more}</robot>"
    )


def turning() -> str:
    """Bars of 100 mm that turn about pivots 20 mm from the middle, from upright to 30 degrees outward."""
    bar = shape('<box size="0.02 0.01 0.1"/>', "0 0 0.05")
    limit = f'<limit lower="0" upper="{math.pi / 6}" effort="5" velocity="1"/>'
    palm = shape('<cylinder radius="0.03" length="0.1"/>', "0 0 -0.05")
    return (
        f'<robot name="arc">{link("palm", palm)}'
        f"{link('left', bar)}{link('right', bar)}"
        f"{joint('l', 'revolute', 'left', '0 0.02 0', '-1 0 0', limit)}"
        + joint("r", "revolute", "right", "0 -0.02 0", "1 0 0", limit + '<mimic joint="l" multiplier="1"/>')
        + "</robot>"
    )


@pytest.fixture
def made(run: Run) -> Make:
    """The profile's values of a URDF, and its text."""

    def make(text: str) -> tuple[dict[str, Any], str, str]:
        Path("hand.urdf").write_text(text, encoding="utf-8")
        done = run("profiles", "from-urdf", "hand.urdf")
        assert done.code == 0, done.err
        return yaml.safe_load(done.out), done.out, done.err

    return make


def test_sliding_fingers_are_measured(made: Make, run: Run) -> None:
    values, text, said = made(sliding())
    assert said == ""
    expected = {
        "min_opening_m": 0.0,
        "max_opening_m": 0.08,
        "finger_width_m": 0.018,
        "finger_thickness_m": 0.012,
        "finger_length_m": 0.05,
        "tip_advance_m": 0.0,
        "palm_offset_m": 0.066,
        "hand_width_m": 0.06,
        "palm_m": 0.2,
        "max_force_n": 70.0,
        "mounted_deg": 0,
    }
    assert {key: values[key] for key in expected} == pytest.approx(expected, abs=1e-4)
    assert (values["name"], values["kind"]) == ("a_hand", "parallel")
    assert text.count("not in the URDF") == 2
    Path("mine.yaml").write_text(text, encoding="utf-8")
    assert run("profiles", "check", "mine.yaml").code == 0
    assert load_gripper("mine.yaml").max_opening_m == 0.08


def test_turning_fingers_come_out_as_they_close(made: Make) -> None:
    values, text, _ = made(turning())
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    along = 0.1 - 0.02 / c  # where the pad is 20 mm below its end, the inner corner
    assert values["kind"] == "arc"
    assert values["min_opening_m"] == pytest.approx(2 * (0.02 - 0.005), abs=1e-4)
    assert values["max_opening_m"] == pytest.approx(2 * (0.02 + along * s - 0.005 * c), abs=2.5e-3)
    assert values["tip_advance_m"] == pytest.approx(0.1 - (0.1 * c + 0.005 * s), abs=1e-4)
    assert values["max_force_n"] is None
    assert "not known where fingers turn" in text


def test_meshes_are_measured_in_their_scale(made: Make) -> None:
    corners = np.array([[x, y, z] for x in (-9, 9) for y in (-6, 6) for z in (-25, 25)])
    faces = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
    Path("meshes").mkdir()
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    Path("meshes/finger.obj").write_text(vertices + faces, encoding="utf-8")
    mesh = '<mesh filename="package://my_hand/meshes/finger.obj" scale="0.001 0.001 0.001"/>'
    values, _, _ = made(sliding().replace(FINGER, mesh))
    assert values["finger_width_m"] == pytest.approx(0.018, abs=1e-4)
    assert values["max_opening_m"] == pytest.approx(0.08, abs=1e-4)


def test_a_palm_without_shapes_is_asked_for(made: Make, run: Run) -> None:
    values, text, said = made(sliding().replace(shape('<box size="0.06 0.2 0.06"/>', "0 0 0.036"), ""))
    assert (values["palm_m"], values["finger_length_m"], values["hand_width_m"]) == (None, None, None)
    assert "put them in for null" in said
    Path("mine.yaml").write_text(text, encoding="utf-8")
    checked = run("profiles", "check", "mine.yaml")
    assert checked.code == 2
    assert "palm_m" in checked.err


WRONG = {
    "nothing-moves": (sliding().replace("prismatic", "fixed"), "two fingers"),
    "one-finger": (sliding().replace(link("right", shape(FINGER, "0 -0.006 0.025")), link("right")), "two fingers"),
    "together": (sliding().replace('axis xyz="0 -1 0"', 'axis xyz="0 1 0"'), "toward each other"),
    "mimics-nobody": (sliding().replace('mimic joint="l"', 'mimic joint="k"'), "'k'"),
    "no-mesh": (sliding().replace(FINGER, '<mesh filename="finger.stl"/>'), "no such file"),
    "no-package": (sliding().replace(FINGER, '<mesh filename="package://a/b.stl"/>'), "not found"),
    "no-size": (sliding().replace('<box size="0.018 0.012 0.05"/>', '<box size="1 2"/>'), "three sizes"),
    "no-file": (None, "cannot read"),
}


@pytest.mark.parametrize(("text", "word"), WRONG.values(), ids=WRONG)
def test_what_is_no_gripper_is_refused(text: str | None, word: str, run: Run) -> None:
    if text is not None:
        Path("hand.urdf").write_text(text, encoding="utf-8")
    done = run("profiles", "from-urdf", "hand.urdf")
    assert (done.code, done.out) == (2, "")
    assert word in done.err
    assert len(done.err.splitlines()) <= 2
