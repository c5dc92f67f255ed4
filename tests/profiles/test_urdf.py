"""What is taken from a URDF, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flatgrasp_cli import load_robot
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.robot.chain import Joints
from tests.conftest import Run
from tests.plates import slab, write_pcd
from tests.robot.arms import random_joints
from tests.robot.test_chains import joints_of

NAMES = ("one", "two", "three", "four", "five", "six")
XARM = (  # joints' places and limits, as their maker has them
    ("0 0 0.267", "0 0 0", -6.283185307179586, 6.283185307179586),
    ("0 0 0", "-1.5707963267948966 0 0", -2.0577, 2.0944),
    ("0.0535 -0.2845 0", "0 0 0", -3.927, 0.19198),
    ("0.0775 0.3425 0", "-1.5707963267948966 0 0", -6.283185307179586, 6.283185307179586),
    ("0 0 0", "1.5707963267948966 0 0", -1.69297, 3.141592653589793),
    ("0.076 0.097 0", "-1.5707963267948966 0 0", -6.283185307179586, 6.283185307179586),
)


def joint(name: str, kind: str, parent: str, child: str, inner: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inner}</joint>'


def xarm(more: str = "", fixed: str = "0 0 0", last: str = "revolute") -> str:
    """A URDF of an xArm 6, with a link `world` below it and a link `tool` on its last one."""
    parts = [joint("stand", "fixed", "world", "base")]
    before = "base"
    for name, (xyz, rpy, low, high) in zip(NAMES, XARM, strict=True):
        limit = f'<limit lower="{low}" upper="{high}" effort="50" velocity="3.14"/>'
        inner = f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/>{limit}'
        parts.append(joint(f"joint_{name}", last if name == "six" else "revolute", before, name, inner))
        before = name
    parts.append(joint("mount", "fixed", "six", "tool", f'<origin xyz="{fixed}" rpy="0 0 0"/>'))
    links = "".join(f'<link name="{name}"/>' for name in ("world", "base", *NAMES, "tool"))
    return f'<robot name="arm">{links}{"".join(parts)}{more}</robot>'


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(xarm(), encoding="utf-8")
    return path


def test_an_arm_is_that_of_its_profile(arm: Path) -> None:
    robot, shipped = load_robot(str(arm)), load_robot("xarm6")
    assert (robot.name, robot.base_frame, robot.count, robot.lock) == ("arm", "base", 6, None)
    angles = random_joints(20)
    ours, theirs = (joints_of(each).stance(angles) for each in (robot, shipped))
    np.testing.assert_allclose(ours.position, theirs.position, atol=1e-9)
    np.testing.assert_allclose(ours.axes_of_flange, theirs.axes_of_flange, atol=1e-9)
    assert robot.joints.upper_deg == pytest.approx(shipped.joints.upper_deg, abs=0.1)
    assert robot.joints.max_speed_deg_s[0] == pytest.approx(179.9, abs=0.1)
    assert robot.payload_kg is None


def test_fixed_joints_are_a_part_of_the_next_place(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(xarm(fixed="0 0 0.1"), encoding="utf-8")
    robot = load_robot(str(path))
    assert robot.chain is not None
    assert robot.chain.flange.xyz_m == (0.0, 0.0, 0.1)
    turned = joint("turn", "fixed", "six", "tool", '<origin xyz="0 0 0.1" rpy="0 1.5707963267948966 0"/>')
    path.write_text(xarm().replace(joint("mount", "fixed", "six", "tool", '<origin xyz="0 0 0" rpy="0 0 0"/>'), turned))
    chain = load_robot(str(path)).chain
    assert chain is not None
    np.testing.assert_allclose(
        Joints.of(chain).turn, joints_of(robot).turn @ [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-9
    )


def test_a_profile_says_what_the_urdf_does_not(arm: Path) -> None:
    profile = arm.with_name("mine.yaml")
    profile.write_text(
        "profile: robot\nname: mine\nurdf: {file: arm.urdf, base: base, tip: six}\n"
        "reach: {reference_deg: [0, -30, -60, 0, 90, 0], steps: 4}\npayload_kg: 5.0\n",
        encoding="utf-8",
    )
    robot = load_robot(str(profile))
    assert (robot.name, robot.payload_kg, robot.reach.steps, robot.reach.max_step_deg) == ("mine", 5.0, 4, 20.0)
    assert robot.reach.reference_deg[1] == -30.0


HAND = '<link name="a"/><link name="b"/>' + joint("fa", "fixed", "tool", "a") + joint("fb", "fixed", "tool", "b")
WRONG = {
    "no-xml": ("<robot", "no XML"),
    "another": ("<svg/>", "not <robot>"),
    "xacro": ('<robot xmlns:xacro="x"><xacro:arm/></robot>', "xacro arm.urdf > robot.urdf"),
    "entities": ('<!DOCTYPE robot [<!ENTITY a "b">]><robot/>', "entities"),
    "no-joints": ('<robot name="r"><link name="a"/></robot>', "six or seven"),
    "sliding": (xarm(last="prismatic"), "joint_six (prismatic)"),
    "two-ends": (xarm(HAND), "which link is the flange"),
    "no-link": (xarm().replace('<link name="four"/>', ""), "joint_four"),
    "no-number": (xarm().replace('xyz="0 0 0.267"', 'xyz="0 0 high"'), "joint_one"),
    "infinite": (xarm().replace('xyz="0 0 0.267"', 'xyz="0 0 inf"'), "joint_one"),
    "no-axis": (xarm().replace('axis xyz="0 0 1"', 'axis xyz="0 0 0"'), "axis"),
    "circle": (xarm(joint("back", "fixed", "tool", "world")), "circle"),
    "stiff": (xarm().replace('lower="-2.0577" upper="2.0944"', ""), "lower_deg"),
}


@pytest.mark.parametrize(("text", "word"), WRONG.values(), ids=WRONG)
def test_what_is_no_arm_is_refused_in_a_line_or_two(text: str, word: str, arm: Path) -> None:
    arm.write_text(text, encoding="utf-8")
    with pytest.raises(ProfileError) as caught:
        load_robot(str(arm))
    assert word in str(caught.value)
    assert str(caught.value).startswith(str(arm))
    assert len(str(caught.value).splitlines()) <= 2


@pytest.mark.parametrize(
    "urdf", ["arm.urdf", "{tip: six}", "{file: arm.urdf, top: six}", "{file: 3}", "{file: no.urdf}"]
)
def test_a_wrong_mention_of_a_urdf_is_refused(urdf: str, arm: Path) -> None:
    profile = arm.with_name("mine.yaml")
    profile.write_text(f"profile: robot\nname: mine\nurdf: {urdf}\n", encoding="utf-8")
    with pytest.raises(ProfileError, match="urdf"):
        load_robot(str(profile))


def test_a_known_name_of_a_flange_is_taken(arm: Path) -> None:
    arm.write_text(xarm(HAND).replace('"tool"', '"tool0"'), encoding="utf-8")
    assert load_robot(str(arm)).count == 6


def test_plan_asks_an_arm_of_a_urdf(arm: Path, tmp_path: Path, run: Run) -> None:
    pytest.importorskip("eaik")
    plate = write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=1000))
    done = run("plan", plate, "--json", "--gripper", "pr2", "--robot", arm, "--camera-pose", "0.4,0,0.2,0,0,0,1")
    assert "are assumed" in done.err
    assert "Traceback" not in done.err
    assert '"base_frame":"base"' in done.out
