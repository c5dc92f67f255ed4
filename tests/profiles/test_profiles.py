"""Profiles: what ships is sound, and faults are named with file, key, value and cure."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from flatgrasp_cli import load_gripper, load_robot, load_settings
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.profiles import Gripper, list_profiles, load_profile, profile_path
from flatgrasp_cli.profiles.loading import problems_in
from tests.robot.arms import rows

GOOD = profile_path("gripper", "pr2").read_text(encoding="utf-8")


def test_all_that_the_readme_promises_ship() -> None:
    assert list_profiles("gripper") == [
        "franka_hand",
        "lacquey",
        "onrobot_rg2",
        "pr2",
        "robotiq_2f_140",
        "robotiq_2f_85",
        "wsg_50",
        "xarm_gripper",
    ]
    others = ["franka_fr3", "kinova_gen3", "kinova_gen3_6dof", "xarm6"]
    assert list_profiles("robot") == sorted([*others, "ur10", "ur10e", "ur3", "ur3e", "ur5", "ur5e"])
    assert list_profiles("planner") == ["allen", "default", "paper"]


@pytest.mark.parametrize("kind", ["gripper", "robot", "planner"])
def test_every_shipped_profile_loads_under_its_own_name(kind: str) -> None:
    for name in list_profiles(kind):
        assert getattr(load_profile(profile_path(kind, name)), "name") == name  # noqa: B009


def test_robots_are_data_of_six_joints() -> None:
    assert rows(load_robot("ur5")).a_m[1:3] == (-0.425, -0.39225)
    assert rows(load_robot("ur5e")).d_m[0] == 0.1625


def test_a_profile_is_frozen() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        load_gripper("pr2").max_opening_m = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("lacquey", "lacquey: thumb and finger pair"),
        ("pr2", "pr2: two fingers on an arc"),
        ("wsg_50", "wsg_50: two parallel fingers"),
    ],
)
def test_grippers_describe_themselves(name: str, words: str) -> None:
    assert load_gripper(name).description == words


def test_jaws_of_more_fingers_are_counted() -> None:
    hand = load_gripper("lacquey").model_copy(update={"jaws": ((-0.02, 0.0, 0.02), (-0.01, 0.01))})
    assert hand.description == "lacquey: finger pair and 3 fingers"


def test_jaw_widths_of_a_thumb_and_a_pair() -> None:
    hand = load_gripper("lacquey")
    assert hand.jaw_width_m(0) == pytest.approx(0.010)
    assert hand.jaw_width_m(1) == pytest.approx(0.0502)
    assert not hand.symmetric
    assert load_gripper("pr2").symmetric


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("max_opening_m: -0.09", ["max_opening_m", "-0.09", "greater than or equal to 0.0001"]),
        ("max_opening_m: 90", ["max_opening_m", "90", "less than or equal to 10"]),
        ("max_opening_m: wide", ["max_opening_m", "'wide'", "number"]),
        ("max_opening_m: .nan", ["max_opening_m", "nan", "finite"]),
        ("max_openin_m: 0.09", ["max_openin_m", "unknown key", "'max_opening_m'"]),
        ("kind: magnetic", ["kind", "'magnetic'", "'parallel'", "'arc'", "'underactuated'"]),
        ("min_opening_m: 0.2\nmax_opening_m: 0.1", ["min_opening_m 0.2", "below", "max_opening_m 0.1"]),
        ("name: a\nname: b", ["given twice", "'name'"]),
        ("name: [", ["not valid YAML", "profile.yaml:"]),
        ("finger_thickness_m: 1e-100", ["finger_thickness_m", "1e-100", "0.0001"]),
        ("finger_width_m: true", ["finger_width_m", "True", "number"]),
        ("finger_width_m: '0.01'", ["finger_width_m", "'0.01'", "number"]),
        ("min_opening_m: 0.0899999\nmax_opening_m: 0.09", ["0.001 m more", "0.0899999"]),
        ("jaws: [[0.0], [1.0e+9]]", ["jaws.1.0", "less than or equal to 10"]),
        ("jaws: [[false], [0.0]]", ["jaws.0.0", "False", "number"]),
        (f"palm_m: {'9' * 5000}", ["profile.yaml", "4300 digits"]),
        ("palm_m: &a [*a]", ["profile.yaml:", "aliases are not allowed"]),
        ("a: &a [x, x]\nb: &b [*a, *a]\npalm_m: [*b, *b]", ["aliases are not allowed"]),
        (f"palm_m: {'[' * 30}{']' * 30}", ["more than 20 levels"]),
        ("palm_m:\t0.1\n\tname: x", ["not valid YAML"]),
        (f"palm_m: {'x' * 5000}", ["palm_m", "number"]),
    ],
    ids=lambda each: each[:30] if isinstance(each, str) else "",
)
def test_a_fault_is_named_with_file_key_value_and_cure(line: str, words: list[str], tmp_path: Path) -> None:
    keys = [each.split(":")[0] for each in line.splitlines()]
    kept = [row for row in GOOD.splitlines() if row.split(":")[0] not in keys]
    path = tmp_path / "profile.yaml"
    path.write_text("\n".join([*kept, line]) + "\n", encoding="utf-8")
    with pytest.raises(ProfileError) as caught:
        load_gripper(str(path))
    text = str(caught.value)
    assert str(path) in text
    assert len(text.splitlines()) <= 2
    for word in words:
        assert word in text


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"name: \xff", "UTF-8"),
        (b"name: x\x00", "not valid YAML"),
        (b"a: 1\n" * 1_000_000, "too many"),
        (b"- a", "this is tuple"),
        (b"", "missing|not a kind"),
        (b"2001-02-30: a", "not valid YAML"),
    ],
)
def test_what_is_no_profile_is_refused(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "profile.yaml"
    path.write_bytes(content)
    for load in (load_gripper, load_robot, load_settings):
        with pytest.raises(ProfileError, match=words) as caught:
            load(str(path))
        assert len(str(caught.value)) < 300
    with pytest.raises(ProfileError, match=words):
        problems_in(path)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a file without an end")
def test_a_file_without_an_end(tmp_path: Path) -> None:
    path = tmp_path / "zero.yaml"
    path.symlink_to("/dev/zero")
    with pytest.raises(ProfileError, match="too many"):
        load_gripper(str(path))


def test_a_robot_is_not_a_gripper() -> None:
    with pytest.raises(ProfileError, match=r"'robot'.*'gripper'"):
        load_gripper(str(profile_path("robot", "ur5")))


def test_an_unknown_name_suggests_the_near_one() -> None:
    with pytest.raises(ProfileError, match="'laquey'; did you mean 'lacquey'"):
        load_gripper("laquey")


def test_a_missing_file_says_so() -> None:
    with pytest.raises(ProfileError, match=r"nowhere\.yaml.*No such file"):
        load_gripper("nowhere.yaml")


def test_check_lists_every_fault(tmp_path: Path) -> None:
    path = tmp_path / "two.yaml"
    path.write_text(
        GOOD.replace("max_opening_m: 0.090", "max_opening_m: -1").replace("palm_m", "plam_m"), encoding="utf-8"
    )
    problems = problems_in(path)
    assert len(problems) == 3  # wrong, unknown, and missing
    assert problems_in(profile_path("gripper", "pr2")) == []


def test_the_command_line_beats_the_file() -> None:
    settings = load_settings("default", ("fingers.step_m=4e-3", "balance.friction=0.3"))
    assert settings.fingers.step_m == 0.004
    assert settings.balance.friction == 0.3


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("fingers.stepm=1", "'step_m'"),
        ("finger.step_m=1", "'fingers'"),
        ("fingers.step_m=-1", "greater than or equal to 0.0005"),
        ("fingers.step_m", "section.key=value"),
        ("seed.x=1", "not a section"),
        ("fingers.step_m=true", "valid number"),
        ("fingers.rays=1.5", "valid integer"),
        ("silhouette.inner_loops=1", "boolean"),
        ("scene.crop=[1,2]", "scene.crop"),
        ("scene.up=[.nan,0,1]", "finite"),
        ("scene.up=[1.0e-300,0,0]", "must not be zero"),
        ("fingers.step_m=" + "[" * 100, "not a YAML value"),
    ],
)
def test_a_wrong_override_says_what_is_allowed(override: str, words: str) -> None:
    with pytest.raises(ProfileError) as caught:
        load_settings("default", (override,))
    assert words in str(caught.value)
    assert override.partition("=")[0] in str(caught.value)


def test_thresholds_follow_from_friction() -> None:
    """k = 0.5 leaves γ half of the friction cone: 2·0.5·atan 0.5 = 26.57°; torque is held against μ itself."""
    hand: Gripper = load_gripper("pr2")
    resolved = load_settings().resolve(hand).balance
    assert resolved.friction == 0.5
    assert resolved.force_balance_max_deg == pytest.approx(26.565, abs=1e-3)
    assert resolved.torque_max == 0.5
    other = load_settings("default", ("balance.torque=normalised",)).resolve(hand).balance
    assert other.torque_max == pytest.approx(0.2236, abs=1e-3)  # sin(φ − γ/2)·cos(γ/2) at φ = γ = 26.57°


class TestDerivedLengths:
    """What is null in a profile follows from how well the outline is known, or from the length beside it."""

    def test_they_are_those_of_an_xtion(self) -> None:
        settings = load_settings()
        assert settings.hand.clearance_m == settings.hand.contact_tolerance_m == 0.002
        assert (settings.silhouette.tolerance_m, settings.caging.tolerance_m) == (0.0005, 0.001)
        assert (settings.caging.noise_m, settings.caging.told_apart_m) == (0.0015, 0.003)
        assert settings.depth.palm_clearance_m == settings.depth.table_clearance_m

    def test_a_worse_sensor_changes_all_of_them(self) -> None:
        settings = load_settings("default", ("uncertainty.outline_m=0.003",))
        assert settings.hand.clearance_m == pytest.approx(0.006)
        assert settings.caging.told_apart_m == pytest.approx(0.009)

    def test_what_is_stated_stays(self) -> None:
        stated = ("uncertainty.outline_m=0.003", "hand.clearance_m=0.001", "caging.noise_m=0.004")
        settings = load_settings("default", stated)
        assert settings.hand.clearance_m == 0.001
        assert settings.caging.told_apart_m == pytest.approx(0.008)

    def test_a_wrong_one_is_named_where_it_stands(self) -> None:
        with pytest.raises(ProfileError, match=r"uncertainty\.outline_m: 'wide': must be a valid number$"):
            load_settings("default", ("uncertainty.outline_m=wide",))
        with pytest.raises(ProfileError, match=r"uncertainty\.density_kg_m3: .*the least density comes first"):
            load_settings("default", ("uncertainty.density_kg_m3=[500,200]",))


class TestWords:
    """Nothing of the library that judges profiles shows in what people read."""

    @pytest.mark.parametrize(
        ("override", "words"),
        [
            ("fingers=3", "fingers: 3: must be keys with values (step, step_m, "),
            ("uncertainty=3", "uncertainty: 3: must be keys with values ("),
            ("depth=4", "depth: 4: must be keys with values ("),
            ("scene.crop=[0,1]", "scene.crop: (0, 1): needs 6 values"),
            ("scene.crop=[0,1,0,1,0,1,5]", "takes 6 values at most"),
            ("scene.select=[1]", "scene.select: (1,): must be 'all', 'nearest' or 'largest', or needs 2 values"),
        ],
    )
    def test_of_a_wrong_override_one_line_says_what_is_wanted(self, override: str, words: str) -> None:
        with pytest.raises(ProfileError) as caught:
            load_settings("default", (override,))
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_further_faults_of_overrides_are_in_no_file(self, tmp_path: Path) -> None:
        with pytest.raises(ProfileError, match=r"\n\(and 1 more\)$"):
            load_settings("default", ("fingers=3", "depth=4"))
        path = tmp_path / "own.yaml"
        path.write_text("profile: planner\nextends: default\nname: own\nfingers: 3\ndepth: 4\n", encoding="utf-8")
        with pytest.raises(ProfileError) as caught:
            load_settings(str(path))
        assert str(caught.value).endswith(f"(and 1 more; `flatgrasp profiles check {path}` lists all)")
