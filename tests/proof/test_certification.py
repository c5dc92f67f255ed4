"""Certificates in plans: what cages and force closure say of real grasps, the options, `cage` and `compare`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from flatgrasp_cli import load_settings, plan, read_clouds
from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.model import Cloud, Grasp
from flatgrasp_cli.planning import answers, search
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.proof import certified, forgiven_m, is_caged
from flatgrasp_cli.results.figures.cage import way_out
from flatgrasp_cli.sources.polygon import read_polygon
from tests.conftest import EACH, MM, SAMPLES, Run, cloud_of, rectangle, sampled
from tests.plates import write_pcd

IBEAM = [[-2, -1.5], [-0.75, -1.5], [-0.75, -0.5], [0.75, -0.5], [0.75, -1.5], [2, -1.5]]
IBEAM = [*IBEAM, *[[-x, -y] for x, y in IBEAM]]
"""Neck 1, notches 1 deep, flanges 1.25: 1 wide, and out over the lower of w + 2h and √(f² + (w + h)²)."""
ESCAPE = float(np.hypot(1.25, 2.0))


@pytest.fixture(scope="module")
def pan() -> Cloud:
    (cloud,) = read_clouds(SAMPLES / "pan.pcd")
    return cloud


@pytest.fixture(scope="module")
def dumbbell() -> Cloud:
    """A bar of 30 mm between two plates of 80 mm: fingers at the bar cage it."""
    shape = shapely.union_all(
        [shapely.box(-40, -15, 40, 15), shapely.box(-70, -40, -40, 40), shapely.box(40, -40, 70, 40)]
    )
    return cloud_of(sampled(shape))


def best(cloud: Cloud, gripper: Gripper, *overrides: str) -> Grasp:
    found = plan(cloud, gripper, load_settings("default", overrides)).best
    assert found is not None
    return found


def test_a_grasp_between_two_plates_is_a_cage(dumbbell: Cloud, pr2: Gripper) -> None:
    grasp = best(dumbbell, pr2)
    assert grasp.width_m == pytest.approx(0.030, abs=2e-3)
    assert grasp.cage is not None
    assert grasp.cage.squeezing
    # neck 30, notches 25 deep, plates 30 thick: out over the lower of 30 + 2 · 25 and √(30² + (30 + 25)²)
    escape = MM * np.hypot(30, 55)
    assert grasp.cage.opening_max_m == pytest.approx(escape, abs=3e-3)
    assert grasp.cage.margin_m == pytest.approx(escape - 0.030, abs=4e-3)
    assert grasp.cage.closes_into_m == pytest.approx(0.030, abs=2e-3)
    assert grasp.cage.guaranteed
    assert grasp.cage.tolerance is not None
    assert 0.005 < grasp.cage.tolerance.position_m < 0.040


def test_a_convex_outline_cages_nothing_and_says_so(pr2: Gripper) -> None:
    cloud = cloud_of(sampled(rectangle(120, 40)))
    grasp = best(cloud, pr2)
    assert grasp.cage is not None
    assert not grasp.cage.squeezing
    assert grasp.cage.reason
    result = plan(cloud, pr2, load_settings("default", ("caging.require=true",)))
    assert result.best is None
    assert result.objects[0].funnel[-1].stage == "cage"
    assert "is a cage" in str(result.reason)


def test_preferred_cages_come_first(pr2: Gripper) -> None:
    (drill,) = read_clouds(SAMPLES / "electric_drill.pcd")
    by_success, by_cage = best(drill, pr2), best(drill, pr2, "ranking.prefer=cage")
    assert is_caged(by_cage.cage)
    assert by_cage.cage is not None
    assert by_cage.cage.tolerance is not None
    if is_caged(by_success.cage):
        assert by_success.cage is not None
        assert by_success.cage.tolerance is not None
        assert by_cage.cage.tolerance.position_m >= by_success.cage.tolerance.position_m
    required = plan(drill, pr2, load_settings("default", ("caging.require=true",)))
    assert required.objects[0].grasps
    for grasp in required.objects[0].grasps:
        assert is_caged(grasp.cage)
        assert grasp.cage is not None
        assert grasp.opening_m <= (grasp.cage.basin_opening_max_m or np.inf)  # nothing can go wrong from there on


@pytest.mark.parametrize("name", ["electric_drill", "pan"])
def test_a_hand_comes_with_room_and_into_the_basin(name: str, pr2: Gripper) -> None:
    """A basin too narrow to come into is no cage, and no reason to come with less room than the fingers need."""
    (cloud,) = read_clouds(SAMPLES / f"{name}.pcd")
    clearance = load_settings().hand.clearance_m
    grasps = [
        grasp for item in plan(cloud, pr2, load_settings("default", EACH), top=60).objects for grasp in item.grasps
    ]
    assert any(is_caged(grasp.cage) for grasp in grasps)
    for grasp in grasps:
        assert grasp.opening_m >= grasp.width_m + 2 * clearance - 1e-9
        if is_caged(grasp.cage) and grasp.cage is not None and grasp.cage.basin_opening_max_m is not None:
            assert grasp.opening_m < grasp.cage.basin_opening_max_m


def test_force_closure_of_flush_pads(pr2: Gripper) -> None:
    grasp = best(cloud_of(sampled(rectangle(120, 40))), pr2)
    assert grasp.closure is not None
    assert 0 < grasp.closure.epsilon_points < grasp.closure.epsilon_pads
    assert grasp.closure.friction_margin == pytest.approx(pr2.pad_friction - grasp.required_friction)


def test_lifting_is_judged_where_mass_and_force_are_known(pr2: Gripper) -> None:
    cloud = cloud_of(sampled(rectangle(120, 40)))
    hand = pr2.model_copy(update={"max_force_n": 20.0})
    closure = best(cloud, hand, "caging.mass_kg=0.5", "balance.friction=0.5").closure
    assert closure is not None
    assert closure.lift_weight == pytest.approx(2 * 0.5 * 20 / (0.5 * 9.80665))
    assert closure.lift_torque is not None
    assert closure.lift_torque > 1
    stated = best(cloud, hand, "caging.mass_kg=0.5", "balance.friction=0.5", "uncertainty.force_n=10").closure
    assert stated is not None
    assert stated.lift_weight == pytest.approx(2 * 0.5 * 10 / (0.5 * 9.80665))
    unknown = best(cloud, pr2, "caging.mass_kg=0.5").closure
    assert unknown is not None
    assert (unknown.lift_weight, unknown.lift_torque) == (None, None)


def test_the_paper_proves_nothing(dumbbell: Cloud, pr2: Gripper) -> None:
    found = plan(dumbbell, pr2, load_settings("paper"))
    assert all(grasp.cage is None for item in found.objects for grasp in item.grasps)


def test_point_fingers_are_a_method(dumbbell: Cloud, pr2: Gripper) -> None:
    grasp = plan(dumbbell, pr2, load_settings("allen")).best
    assert grasp is not None
    assert grasp.width_m == pytest.approx(0.030, abs=2e-3)
    assert np.linalg.norm(grasp.contacts[0] - grasp.contacts[1]) == pytest.approx(grasp.width_m, abs=1e-9)
    assert (grasp.force_balance_deg, grasp.required_friction) == (0.0, 0.0)
    nothing = plan(cloud_of(sampled(rectangle(120, 40))), pr2, load_settings("allen"))
    assert nothing.best is None


def test_cage_of_a_polygon(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "ibeam.json"
    path.write_text(json.dumps(IBEAM))
    done = run("cage", path, "--json", "--out", "out")
    assert done.code == 0
    document = json.loads(done.out)
    assert document["schema"] == "flatgrasp.cage/1"
    (grasp,) = document["grasps"]
    assert grasp["width_m"] == pytest.approx(1.0, abs=1e-9)
    assert grasp["cage"]["opening_max_m"] == pytest.approx(ESCAPE, abs=1e-9)
    np.testing.assert_allclose(sorted(grasp["contacts"]), [[0, -0.5], [0, 0.5]], atol=1e-9)
    assert (Path("out") / "ibeam.cage.png").stat().st_size > 10_000
    square = tmp_path / "square.csv"
    square.write_text("x,y\n0,0\n1,0\n1,1\n0,1\n")
    done = run("cage", square)
    assert done.code == 1
    assert "convex" in done.out


def test_cage_of_a_cloud(run: Run) -> None:
    done = run("cage", SAMPLES / "pan.pcd", "--json")
    assert done.code == 0
    document = json.loads(done.out)
    assert document["object"] == 0
    assert document["grasps"][0]["cage"]["opening_max_m"] > 0.04


@pytest.mark.parametrize(
    "text",
    [
        *("", "[]", "[[1,2],[3,4]]", "[[1,2],[3,4],[5,NaN]]", "{", "a,b\nc,d", "[[1,2,3],[1,2,3],[4,5,6]]"),
        *("[[0,0],[3,3],[3,0],[0,3]]", "[[0,0],[1,1],[2,2]]", "[[[0,0],[9,0],[9,9]],[[20,20],[21,20],[21,21]]]"),
    ],
)
def test_what_is_no_polygon(text: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(SourceError, match=r"bad\.json: is no "):
        read_polygon(str(path))


def test_polygons_are_turned(tmp_path: Path) -> None:
    path = tmp_path / "ring.json"
    path.write_text(json.dumps([[[0, 0], [0, 9], [9, 9], [9, 0], [0, 0]], [[3, 3], [6, 3], [6, 6], [3, 6]]]))
    outer, hole = read_polygon(str(path))
    assert outer.tolist() == [[9, 0], [9, 9], [0, 9], [0, 0]]
    assert hole.tolist() == [[3, 6], [6, 6], [6, 3], [3, 3]]


def test_compare_says_what_the_hand_cannot(run: Run) -> None:
    done = run("compare", SAMPLES / "pan.pcd", SAMPLES / "juice_box.pcd", "--json", "--gripper", "pr2", "--out", "out")
    assert done.code == 0
    pan, juice = (json.loads(line) for line in done.out.splitlines())
    assert pan["ours"]["caged"]
    reasons: list[Any] = [each["reason"] for each in pan["point_fingers"]]
    assert any(reason and "meets the object" in reason for reason in reasons)  # in the hanging hole, no finger fits
    assert [each["executable"] for each in pan["point_fingers"]] == [reason is None for reason in reasons]
    assert juice["ours"]["width_m"] > 0
    assert len(list(Path("out").glob("*.compare.png"))) == 2
    table = run("compare", SAMPLES / "pan.pcd", "--gripper", "pr2")
    assert "pan.pcd" in table.out


def test_the_way_out_is_the_lowest() -> None:
    height = np.full((6, 6), 9.0)
    height[1, 1:5] = 2.0
    height[4, 2:5] = 3.0
    height[1:5, 4] = [2.0, 5.0, 3.0, 3.0]
    np.fill_diagonal(height, 0.0)
    path = way_out(height, (1, 3))
    assert path[0].tolist() == [1, 3]
    assert path[-1][0] == path[-1][1]
    assert height[path[:, 0], path[:, 1]].max() == 2.0


def test_an_outline_that_touches_itself_has_grasps(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "pinched.json"
    path.write_text(json.dumps([[[0, 0], [4, 0], [4, 4], [0, 4]], [[0, 2], [1, 3], [2, 2], [1, 1]]]))
    done = run("cage", path, "--json")
    assert done.code == 0
    assert all(grasp["width_m"] > 0 for grasp in json.loads(done.out)["grasps"])


def test_points_without_an_outline(run: Run, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    blobs = [rng.normal((x, x, 0.0), 0.001, (100, 3)) for x in (0.0, 0.1)]
    path = write_pcd(tmp_path / "two.pcd", np.concatenate(blobs))
    cage, comparison = run("cage", path, "--json", "--out", "out"), run("compare", path, "--json", "--out", "out")
    assert (cage.code, comparison.code) == (1, 1)
    assert "the points lie in pieces more than about 20 mm apart" in json.loads(cage.out)["reason"]
    assert json.loads(comparison.out)["ours"] is None
    batch = run("batch", path, "--out", "results", "-j", "1")
    assert batch.code == 1
    assert Path("results/report.html").is_file()


def test_points_on_a_line_are_called_that(run: Run, tmp_path: Path) -> None:
    line = write_pcd(tmp_path / "line.pcd", np.linspace(1, 2, 50)[:, None] * [0.1, 0.0, 0.0])
    assert json.loads(run("cage", line, "--json").out)["reason"] == "all 50 points lie on a line"


@pytest.mark.parametrize("options", [("ranking.prefer=cage",), ("method=allen",)])
def test_the_best_of_all_slices_wins(options: tuple[str, ...], pr2: Gripper, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither what cages forgive nor the depth of the point fingers' cages has a most: no slice may be left out."""
    (cloud,) = read_clouds(SAMPLES / "pan_on_table.pcd")
    seen: list[answers.Answer] = []
    real = answers.answer_in

    def watched(*args: Any) -> answers.Answer:
        seen.append(real(*args))
        return seen[-1]

    monkeypatch.setattr(search, "answer_in", watched)
    winner = best(cloud, pr2, *options)
    found = [each.grasps for each in seen if each.grasps is not None]
    assert len(found) > 1
    if options == ("method=allen",):
        deepest = max(found, key=lambda grasps: float(grasps.merit[0]))
        assert winner.width_m == deepest.width[0]
        return
    settings = load_settings("default", options).resolve(pr2)
    forgiven = []
    for each in (answers.finished(each, pr2, settings) for each in seen):
        if each.grasps is not None and each.shape is not None:
            _, proved = certified(each.grasps, each.shape.silhouette, pr2, settings)
            forgiven += [forgiven_m(cage) for cage in proved.cages if is_caged(cage)]
    assert forgiven_m(winner.cage) == pytest.approx(max(forgiven))
