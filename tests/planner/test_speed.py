"""What was made fast gives what the slow way gives: single steps against their plain versions, grasps against both.

Times are not tested, benchmarks/ measures them; but what a plain `plan` leaves unloaded is.
"""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import shapely
from matplotlib import rc_context
from scipy.spatial import Delaunay, KDTree

from flatgrasp_cli import Plan, load_gripper, load_settings, plan
from flatgrasp_cli.geometry import spacing
from flatgrasp_cli.geometry.alpha_shape import alpha_region
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import Grasp
from flatgrasp_cli.planner import silhouette
from flatgrasp_cli.planning.search import Search
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.ranking import TIE
from flatgrasp_cli.results.figures import as_png, final_figure
from flatgrasp_cli.results.figures.style import DPI, TEXT
from flatgrasp_cli.surroundings import descent
from tests.conftest import (
    EACH,
    I_BEAM,
    L_SHAPE,
    MM,
    SAMPLES,
    TABLE,
    Box,
    Camera,
    Tube,
    cloud_of,
    holds,
    planned_sample,
    rectangle,
    sampled,
)

COMMAND = [sys.executable, "-m", "flatgrasp_cli", "plan"]
RECORDINGS = {"mcap", "rosbags", "lz4", "google.protobuf", "flatgrasp_cli.recordings.messages"}
DESCRIPTIONS = "flatgrasp_cli.results.contracts.descriptions"
"""Read from the source, which only `flatgrasp schema` needs."""
NOT_FOR_A_CLOUD = {"open3d", "scipy", "flatgrasp_cli.sources.meshes", DESCRIPTIONS, *RECORDINGS}
IMPORTS_FIGURES = """
import gc
from flatgrasp_cli.cli.imports import import_figures
import_figures()
assert gc.isenabled()
"""
"""Leaves the search for garbage as it was."""
ALONE = ("teddy_bear", "electric_drill", "pistol", "spray_bottle", "hammer", "juice_box", "pan")
SHAPES = {"rectangle": rectangle(120, 40), "L": L_SHAPE, "I-beam": I_BEAM}
SCENE = Camera(tilt_deg=30, pixels=(400, 300), focal=420.0).sees(
    TABLE,
    Box((-0.15, 0.05, 0.02), (0.10, 0.04, 0.04), 20),
    Tube((0.12, 0.08, 0.05), 0.033, 0.10),
    Tube((0.0, -0.1, 0.04), 0.04, 0.08, bore=0.036, floor=0.005),
)


def pose_error(one: Grasp, other: Grasp) -> tuple[float, float]:
    """Metres and degrees between two grasps, the hand's half turn allowed."""
    x, y, z, w = other.orientation
    same = max(abs(one.orientation @ other.orientation), abs(one.orientation @ np.array([y, -x, w, -z])))
    return float(np.linalg.norm(one.position - other.position)), float(np.degrees(2 * np.arccos(min(1.0, same))))


def grasps_of(result: Plan) -> list[Grasp]:
    """The best grasps, object by object, whatever their order of picking is."""
    return [item.grasps[0] for item in sorted(result.objects, key=lambda item: item.object.id) if item.grasps]


def by_triangles(points: FloatArray, alpha_m: float) -> Any:
    """The α-shape from a triangulation of all points: what `alpha_region` comes to without one."""
    corners = points[Delaunay(points).simplices]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    sides = np.array([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))])
    u, v = b - a, c - a
    radius = sides.prod(axis=0) / np.maximum(2 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), 1e-15)
    kept = (radius <= alpha_m) | (sides.max(axis=0) <= alpha_m)
    region = shapely.coverage_union_all(shapely.polygons(corners[kept]))
    return max(shapely.get_parts(region), key=lambda part: part.area)


@pytest.mark.parametrize("name", ALONE)
def test_the_outline_is_that_of_a_triangulation(name: str) -> None:
    """A quarter of a millimetre from it on average: less than the sensor's noise does to either."""
    outline = planned_sample(name).objects[0].silhouette
    assert outline is not None
    fast, slow = (make(outline.points, outline.alpha_m) for make in (alpha_region, by_triangles))
    assert fast.symmetric_difference(slow).area < 0.25 * MM * slow.length
    assert fast.centroid.distance(slow.centroid) < 1 * MM


def test_the_spacing_is_that_of_the_six_nearest_neighbours() -> None:
    points = np.random.default_rng(0).uniform(0, 0.1, (3000, 2))
    sample = points[spread_indices(len(points), spacing.SPACING_SAMPLES)]
    distances, _ = KDTree(points).query(sample, k=[spacing.NEIGHBOURS + 1])
    assert spacing.spacing(points) == pytest.approx(np.quantile(distances, spacing.SPACING_QUANTILE), rel=0.01)


def plain_palm(
    hands: FloatArray, openings: FloatArray, chart: HeightMap, least_m: float, gripper: Gripper
) -> FloatArray:
    """The highest cell under each hand at each of its openings, one by one, of all cells."""
    highest, center, axis = np.full(openings.shape, UNSEEN), hands[:, :2], hands[:, 2:4]
    cells = np.array(chart.higher_than(least_m)).reshape(-1, 3)
    for (m, k), opening in np.ndenumerate(openings):
        breadth = max(gripper.palm_m, opening + 2 * gripper.root_m)
        half = 0.5 * (np.array([gripper.hand_width_m, breadth]) + chart.cell_m)
        away = cells[:, :2] - center[k]
        under = (np.abs(away @ [-axis[k][1], axis[k][0]]) <= half[0]) & (np.abs(away @ axis[k]) <= half[1])
        highest[m, k] = cells[under, 2].max(initial=UNSEEN)
    return highest


def recorded(
    monkeypatch: pytest.MonkeyPatch, module: Any, name: str, slow: Callable[..., FloatArray]
) -> list[tuple[FloatArray, FloatArray]]:
    """What a function answers while scenes are planned, beside what its plain version answers."""
    answers: list[tuple[FloatArray, FloatArray]] = []
    fast = getattr(module, name)

    def both(*args: Any) -> FloatArray:
        answers.append((fast(*args), slow(*args)))
        return answers[-1][0]

    monkeypatch.setattr(module, name, both)
    return answers


def test_the_palm_meets_what_a_search_of_all_cells_finds(monkeypatch: pytest.MonkeyPatch, pr2: Gripper) -> None:
    answers = recorded(monkeypatch, descent, "under_palm", plain_palm)
    plan(SCENE, pr2, load_settings("default", ("fingers.step_m=0.008",)))
    assert any(np.isfinite(slow).any() for _, slow in answers)
    for fast, slow in answers:
        assert fast.tolist() == slow.tolist()


def test_slices_that_are_not_planned_would_not_have_won(monkeypatch: pytest.MonkeyPatch) -> None:
    """With every slice planned, however surely a lower one holds, the grasps hold no more probably."""
    hands = [load_gripper(name) for name in ("pr2", "lacquey")]
    few = [grasps_of(plan(SCENE, hand)) for hand in hands]

    monkeypatch.setattr(Search, "_is_sure", lambda *_: False)
    for hand, grasps in zip(hands, few, strict=True):
        every = grasps_of(plan(SCENE, hand))
        assert len(every) == len(grasps) > 0
        for one, other in zip(grasps, every, strict=True):
            assert holds(one) >= holds(other) - TIE


def both_ways(fast: Plan) -> tuple[Grasp, list[Grasp]]:
    """The best grasp of a plan, and the best ones with outlines from a triangulation of all points."""
    assert fast.best is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(silhouette, "alpha_region", by_triangles)
        return fast.best, list(
            plan(fast.cloud, fast.gripper, load_settings("default", EACH), top=1000).objects[0].grasps
        )


def nearest(grasp: Grasp, others: list[Grasp]) -> tuple[float, float]:
    """Metres and degrees to the nearest: step points begin where a loop does, and neighbours are about as good."""
    return min((pose_error(grasp, other) for other in others), key=lambda error: error[0] / MM + error[1])


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_the_grasp_of_a_plate_is_the_slow_ways(shape: shapely.Polygon, pr2: Gripper) -> None:
    fast, slow = both_ways(plan(cloud_of(sampled(shape)), pr2))
    metres, degrees = nearest(fast, slow)
    assert metres < 1 * MM
    assert degrees < 1
    assert holds(fast) == pytest.approx(holds(slow[0]), abs=2 * TIE)


@pytest.mark.parametrize("name", ALONE)
def test_the_grasp_of_a_noisy_object_is_among_the_slow_ways(name: str) -> None:
    metres, degrees = nearest(*both_ways(planned_sample(name)))
    assert metres < 2 * MM
    assert degrees < 1.5


def loaded_by(*arguments: str, first: str = "") -> set[str]:
    """What a process of the command has imported by its end; `first` is run before the command."""
    ends = "import sys; from flatgrasp_cli.cli import run; run(); sys.stderr.write('\\n' + '\\n'.join(sys.modules))"
    command = [sys.executable, "-c", f"{first}\n{ends}", *arguments]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    return set(done.stderr.splitlines())


def test_plan_loads_what_its_source_and_its_outputs_need_and_no_more(tmp_path: Path) -> None:
    sample = str(SAMPLES / "juice_box.pcd")
    json_only = loaded_by("plan", sample, "--json")
    assert {"numpy", "cv2", "flatgrasp_cli.sources.pcd_ply"} <= json_only
    assert json_only.isdisjoint({"matplotlib", "PIL", "rich", *NOT_FOR_A_CLOUD})
    with_picture = loaded_by("plan", sample, "--out", str(tmp_path), first=IMPORTS_FIGURES)
    assert {"matplotlib.figure", "rich.table"} <= with_picture
    assert with_picture.isdisjoint({"matplotlib.pyplot", *NOT_FOR_A_CLOUD})


def test_a_picture_has_the_pixels_that_savefig_writes(pr2: Gripper) -> None:
    figure = final_figure(plan(cloud_of(sampled(rectangle(120, 40))), pr2))
    ours, plain = as_png(lambda: figure), io.BytesIO()
    assert ours is not None
    with rc_context(TEXT):
        figure.savefig(plain, format="png", dpi=DPI)
    drawn, saved = (cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR) for png in (ours, plain.getvalue()))
    assert drawn is not None
    assert saved is not None
    assert np.array_equal(drawn, saved)
    assert len(ours) < len(plain.getvalue())


def test_the_number_of_threads_changes_no_byte(tmp_path: Path) -> None:
    cloud = str(SAMPLES / "table_scene.pcd")
    outputs = []
    for threads in ("1", "2"):
        names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")
        environment = {**os.environ, **dict.fromkeys(names, threads)}
        done = subprocess.run(
            [*COMMAND, cloud, "--json"], env=environment, capture_output=True, check=False, text=True, cwd=tmp_path
        )
        assert done.returncode in (0, 1), done.stderr
        outputs.append(done.stdout.split('"timing_ms"')[0])
    assert outputs[0] == outputs[1]
    assert len(outputs[0]) > 1000
