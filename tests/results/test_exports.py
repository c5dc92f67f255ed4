"""Grasps in other programs' formats: read back as those programs read them, they give the fingertips' poses."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from flatgrasp_cli import load_gripper
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles import Gripper, list_profiles
from flatgrasp_cli.results.document import to_document, to_json
from flatgrasp_cli.results.exports import exported
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp
from tests.conftest import SAMPLES, Run, planned_sample

EXACT = 1e-9
GRIPPERS = ("franka_hand", "robotiq_2f_85", "pr2")
"""Whose own links close along y, x and y and approach along z, z and x."""


def saved(name: str = "franka_hand", **changes: Any) -> SavedDocument:
    """The document of the table's scene."""
    document = to_document(planned_sample("table_scene", name))
    return SavedDocument.model_validate_json(to_json(document | changes))


def without_probability(document: SavedDocument) -> SavedDocument:
    """As a method that knows no hand has it."""
    values = json.loads(document.model_dump_json(by_alias=True))
    for item in values["objects"]:
        for grasp in item["grasps"]:
            grasp["success"] = None
    return SavedDocument.model_validate_json(json.dumps(values))


def grasps_of(document: SavedDocument) -> list[SavedGrasp]:
    found = [grasp for _, grasp in document.grasps]
    assert len(found) > 3
    return found


def check(grasp: SavedGrasp, position: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
    """Hold a fingertip pose that was read back against the document's."""
    turn = Rotation.from_quat(grasp.pose.orientation).as_matrix()
    assert position == pytest.approx(np.array(grasp.pose.position), abs=EXACT)
    assert np.column_stack([x, y, z]) == pytest.approx(turn, abs=EXACT)


@pytest.mark.parametrize("name", GRIPPERS)
def test_isaac_gives_the_fingertips_poses_back(name: str) -> None:
    document, gripper = saved(name), load_gripper(name)
    read = yaml.safe_load(exported("isaac", [document]))
    assert (read["format"], read["format_version"]) == ("isaac_grasp", 1.0)
    assert (read["object_frame"], read["gripper_frame"]) == ("cloud", gripper.base_link)
    for grasp, entry in zip(grasps_of(document), read["grasps"].values(), strict=True):
        link = Rotation.from_quat([*entry["orientation"]["xyz"], entry["orientation"]["w"]]).as_matrix()
        y = link[:, "xyz".index(gripper.base_link_closes)]
        z = link[:, "xyz".index(gripper.base_link_approaches)]
        reach = gripper.palm_offset_m + gripper.finger_length_m
        reach += gripper.tip_advance_m * (1 - grasp.width_m / gripper.max_opening_m)
        check(grasp, np.array(entry["position"]) + reach * z, np.cross(y, z), y, z)
        assert 0 < entry["confidence"] <= 1


def test_isaac_moves_each_of_frankas_fingers_half_of_the_way() -> None:
    document = saved()
    for grasp, entry in zip(
        grasps_of(document), yaml.safe_load(exported("isaac", [document]))["grasps"].values(), strict=True
    ):
        assert entry["cspace_position"] == {"panda_finger_joint1": pytest.approx(grasp.width_m / 2)}
        assert entry["pregrasp_cspace_position"] == {"panda_finger_joint1": pytest.approx(grasp.opening_m / 2)}


def test_graspnet_gives_the_fingertips_poses_back() -> None:
    document = saved()
    rows = np.load(io.BytesIO(exported("graspnet", [document])))
    assert (rows.dtype, rows.shape[1]) == (np.float64, 17)
    for grasp, row in zip(grasps_of(document), rows, strict=True):
        turn = row[4:13].reshape(3, 3)  # approaches along x, closes along y
        check(grasp, row[13:16] + row[3] * turn[:, 0], -turn[:, 2], turn[:, 1], turn[:, 0])
        assert row[1:4].tolist() == [grasp.opening_m, document.gripper.finger_width_m, 0.02]
    assert rows[:, 16].tolist() == [item.id for item, _ in document.grasps]


@pytest.mark.parametrize("name", GRIPPERS)
def test_moveit_gives_the_fingertips_poses_back(name: str) -> None:
    document, gripper = saved(name), load_gripper(name)
    for grasp, message in zip(grasps_of(document), yaml.safe_load(exported("moveit", [document])), strict=True):
        pose = message["grasp_pose"]["pose"]
        flange = Rotation.from_quat([pose["orientation"][axis] for axis in "xyzw"])
        tips = (flange * Rotation.from_euler("z", gripper.mounted_deg, degrees=True)).as_matrix()
        position = np.array([pose["position"][axis] for axis in "xyz"])
        check(grasp, position + gripper.tool_length_m(grasp.width_m) * tips[:, 2], *tips.T)
        before = np.array(grasp.pose.position) - np.array(grasp.pre_grasp.position)
        approach = message["pre_grasp_approach"]
        assert approach["direction"]["vector"] == {"x": 0.0, "y": 0.0, "z": 1.0}
        assert before == pytest.approx(approach["desired_distance"] * tips[:, 2], abs=1e-8)
        assert 0 <= approach["min_distance"] < approach["desired_distance"]
        retreat = message["post_grasp_retreat"]
        way = retreat["desired_distance"] * np.array([retreat["direction"]["vector"][axis] for axis in "xyz"])
        assert np.array(grasp.pose.position) + way == pytest.approx(np.array(grasp.lift.position), abs=EXACT)


def test_moveit_goes_back_as_it_came_from_aslant() -> None:
    """The document lifts it back and then up; of the way straight there nothing is known."""
    document = saved()
    straight = document.objects[0].grasps[0]
    tips, before = np.array(straight.pose.position), np.array(straight.pre_grasp.position)
    aslant = before + np.linalg.norm(before - tips) * Rotation.from_quat(straight.pose.orientation).as_matrix()[:, 0]
    lift = straight.lift.model_copy(update={"position": tuple(aslant.tolist())})
    item = document.objects[0].model_copy(update={"grasps": [straight.model_copy(update={"lift": lift})]})
    (message,) = yaml.safe_load(exported("moveit", [document.model_copy(update={"objects": [item]})]))
    retreat = message["post_grasp_retreat"]
    way = retreat["desired_distance"] * np.array([retreat["direction"]["vector"][axis] for axis in "xyz"])
    assert tips + way == pytest.approx(before, abs=EXACT)


@pytest.mark.parametrize("stays", [("lift",), ("pre_grasp",), ("pre_grasp", "lift")])
def test_moveit_has_a_direction_also_for_a_way_of_no_length(stays: tuple[str, ...]) -> None:
    document = saved()
    grasp = document.objects[0].grasps[0]
    still = grasp.model_copy(update=dict.fromkeys(stays, grasp.pose))
    item = document.objects[0].model_copy(update={"grasps": [still]})
    (message,) = yaml.safe_load(exported("moveit", [document.model_copy(update={"objects": [item]})]))
    retreat = message["post_grasp_retreat"]
    vector = np.array([retreat["direction"]["vector"][axis] for axis in "xyz"])
    assert np.linalg.norm(vector) == pytest.approx(1.0)
    if "lift" in stays:
        back = -Rotation.from_quat(grasp.pose.orientation).as_matrix()[:, 2]
        assert retreat["desired_distance"] == 0.0
        assert vector == pytest.approx(back, abs=EXACT)
    assert (message["pre_grasp_approach"]["desired_distance"] == 0.0) == ("pre_grasp" in stays)


def test_moveit_has_the_flange_turned_as_the_joint_angles_have_it() -> None:
    document = saved()
    straight = document.objects[0].grasps[0]
    reach = {"ok": True, "joints_rad": None, "twin": True}
    twin = straight.model_copy(
        update={"reach": type(straight).model_validate(json.loads(straight.model_dump_json()) | {"reach": reach}).reach}
    )
    turned = document.model_copy(
        update={"objects": [document.objects[0].model_copy(update={"grasps": [straight, twin]})]}
    )
    one, other = yaml.safe_load(exported("moveit", [turned]))
    q, p = (Rotation.from_quat([m["grasp_pose"]["pose"]["orientation"][a] for a in "xyzw"]) for m in (one, other))
    assert (q.inv() * p).magnitude() == pytest.approx(np.pi)
    assert one["grasp_pose"]["pose"]["position"] == other["grasp_pose"]["pose"]["position"]


def test_the_table_has_all_three_poses_and_numbers_to_the_last_digit() -> None:
    document = saved()
    rows = list(csv.DictReader(io.StringIO(exported("csv", [document, document]).decode())))
    assert len(rows) == 2 * len(grasps_of(document))
    for grasp, row in zip(grasps_of(document), rows, strict=False):
        for pose, prefix in ((grasp.pose, ""), (grasp.pre_grasp, "pre_grasp_"), (grasp.lift, "lift_")):
            assert tuple(float(row[f"{prefix}{axis}_m"]) for axis in "xyz") == pose.position
            assert tuple(float(row[f"{prefix}q{axis}"]) for axis in "xyzw") == pose.orientation
        assert float(row["gravity_distance_m"]) == grasp.metrics["gravity_distance_m"]
        assert float(row["probability"]) == grasp.probability
        assert row["cost_m"] == ""


READERS: dict[str, Callable[[bytes], list[float]]] = {
    "isaac": lambda content: [entry["confidence"] for entry in yaml.safe_load(content)["grasps"].values()],
    "graspnet": lambda content: np.load(io.BytesIO(content))[:, 0].tolist(),
    "moveit": lambda content: [message["grasp_quality"] for message in yaml.safe_load(content)],
}


@pytest.mark.parametrize("name", READERS)
def test_the_score_is_the_probability_or_else_keeps_the_order(name: str) -> None:
    document = saved()
    assert READERS[name](exported(name, [document])) == [grasp.probability for grasp in grasps_of(document)]
    untold = without_probability(document)
    assert READERS[name](exported(name, [untold])) == [1 / grasp.rank for grasp in grasps_of(untold)]
    assert {row["probability"] for row in csv.DictReader(io.StringIO(exported("csv", [untold]).decode()))} == {""}


@pytest.mark.parametrize("name", ["isaac", "moveit"])
def test_a_profile_that_lacks_joints_is_told_so(name: str) -> None:
    with pytest.raises(ProfileError, match=rf"gripper 'lacquey': its profile has no .*, which {name} needs"):
        exported(name, [saved("lacquey")])
    assert len(exported("graspnet", [saved("lacquey")])) > 0


def test_documents_of_other_versions_are_read() -> None:
    values = to_document(planned_sample("table_scene", "franka_hand"))
    gripper = {key: value for key, value in values["gripper"].items() if "joint" not in key and "base" not in key}
    document = saved(gripper=gripper | {"a_later_key": [1]}, a_later_key=2)
    assert document.gripper.joint_names is None
    assert document.gripper.jaws == ((0.0,), (0.0,))


FORWARD: dict[str, Callable[[float], float]] = {
    # opening in mm at a joint's position: the chain from the knuckle to the pad in each URDF
    "robotiq_2f_85": lambda q: 85.0 - 2 * (37.1575 * (1 - np.cos(q)) + 43.4217 * np.sin(q)),
    "robotiq_2f_140": lambda q: (
        2 * (30.601 - 27.2203 - 3.75 + 99.9754 * np.sin(0.725 - q) - 2.2185 * np.cos(0.725 - q))
    ),
    "xarm_gripper": lambda q: 89.0 - 2 * (35.465 * (1 - np.cos(q)) + 42.039 * np.sin(q)),
    "onrobot_rg2": lambda q: 2 * (17.178 + 39.592 * np.cos(q) - 38.177 * np.sin(q)) - 37.969,
    "franka_hand": lambda q: 2000 * q,
    "pr2": lambda q: 1000 * q,
}


@pytest.mark.parametrize("name", FORWARD)
def test_shipped_joint_positions_make_the_opening(name: str) -> None:
    from flatgrasp_cli.results.exports.hands import joints_at

    gripper = load_gripper(name)
    for opening in np.linspace(gripper.min_opening_m + 0.002, gripper.max_opening_m, 40):
        (position,) = joints_at(gripper, float(opening), "a test").values()
        assert FORWARD[name](position) == pytest.approx(1000 * opening, abs=0.3)


def test_all_shipped_grippers_but_the_adaptive_one_have_joints() -> None:
    lacking = [name for name in list_profiles("gripper") if load_gripper(name).joint_names is None]
    assert lacking == ["lacquey"]
    assert all(load_gripper(name).base_link for name in list_profiles("gripper") if name not in lacking)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"joint_names": ("a",)}, "belong together"),
        ({"joint_names": ("a",), "joints_at_opening": ((0.0, 1.0), (0.1, 1.0, 2.0))}, "an opening and 1 positions"),
        ({"joint_names": ("a",), "joints_at_opening": ((0.1, 1.0), (0.1, 2.0))}, "rising order"),
        ({"base_link_closes": "-x"}, "two different axes"),
    ],
)
def test_a_profile_with_wrong_joints_is_refused(changes: dict[str, Any], words: str, pr2: Gripper) -> None:
    given = pr2.model_dump() | {"joint_names": None, "joints_at_opening": None} | changes
    with pytest.raises(ValueError, match=words):
        Gripper.model_validate(given)


def test_export_writes_a_file_for_each_frame_and_one_table(run: Run, tmp_path: Path) -> None:
    planned = run(
        "plan", SAMPLES / "pan_ros2", "--json", "-g", "franka_hand", "--top", "2", "--set", "variety.apart_m=0"
    )
    assert planned.code == 0
    lines = tmp_path / "pan.jsonl"
    lines.write_text(planned.out, encoding="utf-8")
    done = run("export", lines, "--format", "isaac", "--out", tmp_path / "out")
    assert (done.code, done.out) == (0, "")
    stamps = [json.loads(line)["source"]["stamp_ns"] for line in planned.out.splitlines()]
    names = [f"pan.{stamp // 10**9}.{stamp % 10**9:09d}.isaac.yaml" for stamp in stamps]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == names
    assert run("export", "-", "--format", "csv", stdin=planned.out.encode()).code == 0
    assert len(Path("stdin.grasps.csv").read_text(encoding="utf-8").splitlines()) == 1 + 3 * 2


def test_export_says_what_it_cannot_read_or_write(run: Run, tmp_path: Path) -> None:
    (tmp_path / "no.json").write_text('{"schema": "flatgrasp.cage/1"}', encoding="utf-8")
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    for name, words in (("no.json", "is no plan"), ("bytes.json", "no text in UTF-8"), ("gone.json", "cannot be read")):
        done = run("export", tmp_path / name, "--format", "csv")
        assert (done.code, done.out) == (3, "")
        assert words in done.err
        assert len(done.err.splitlines()) <= 2


def test_a_frame_without_grasps_makes_an_empty_file(run: Run, tmp_path: Path) -> None:
    plan = to_document(planned_sample("table_scene", "franka_hand"))
    objects = [item | {"grasps": [], "status": "no_grasp", "reason": "none"} for item in plan["objects"]]
    path = tmp_path / "none.grasps.json"
    path.write_text(to_json(plan | {"status": "no_grasp", "objects": objects}, indent=2), encoding="utf-8")
    for name, content in (("isaac", "grasps: {}"), ("moveit", "[]"), ("csv", "source,")):
        done = run("export", path, "--format", name)
        assert (done.code, "1 frame without a grasp" in done.err) == (1, True)
        (written,) = Path().glob(f"none.*{name.replace('csv', 'grasps.csv')}*")
        assert content in written.read_text(encoding="utf-8")
    assert run("export", path, "--format", "graspnet").code == 1
    assert np.load("none.graspnet.npy").shape == (0, 17)
