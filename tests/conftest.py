"""Clouds with known answers, and the command line called from a test."""

from __future__ import annotations

import gc
import io
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import shapely
from hypothesis import settings
from scipy.spatial.transform import Rotation

from flatgrasp_cli import Plan, plan, read_clouds
from flatgrasp_cli.cli import run as run_here
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import Cloud, Grasp, Source
from flatgrasp_cli.profiles import Gripper, PlannerSettings, load_gripper, load_settings

# the command is started many times, and compiled once whatever this environment says
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# machines are noisy: no test may fail for being slow, nor for its luck
settings.register_profile("no-clock", deadline=None, derandomize=True)
settings.load_profile("no-clock")

if os.name != "posix":  # they send signals, limit resources, make pipes and look at processes
    collect_ignore = ["batch/test_resuming.py", "cli/test_interrupt.py", "cli/test_outputs.py"]

EACH = ("variety.apart_m=0",)
"""The override that lists all grasps in their order, also those at about one place."""
SAMPLES = Path(__file__).resolve().parent.parent / "sample_data"
THICKNESS_M = 0.02
MM = 1e-3


def rectangle(width: float, height: float) -> shapely.Polygon:
    """A rectangle about the origin, in millimetres."""
    return shapely.box(-width / 2, -height / 2, width / 2, height / 2)


def disc(radius: float) -> shapely.Polygon:
    """A disc about the origin, in millimetres."""
    return shapely.Point(0, 0).buffer(radius, quad_segs=90)


I_BEAM = shapely.union_all(
    [shapely.box(-15, -20, 15, 20), shapely.box(-60, -50, 60, -20), shapely.box(-60, 20, 60, 50)]
)
L_SHAPE = shapely.union_all([shapely.box(0, 0, 30, 120), shapely.box(0, 0, 100, 30)])


def sampled(shape: shapely.Polygon, pitch_mm: float = 1.0, seed: int = 0) -> FloatArray:
    """Points (n, 3) in metres of a plate: a jittered grid inside `shape` (mm), and its boundary, at random heights."""
    rng = np.random.default_rng(seed)
    x0, y0, x1, y1 = shape.bounds
    x, y = np.meshgrid(np.arange(x0, x1, pitch_mm), np.arange(y0, y1, pitch_mm))
    grid = np.column_stack([x.ravel(), y.ravel()]) + rng.uniform(-0.3, 0.3, (x.size, 2)) * pitch_mm
    inside = grid[shapely.contains_xy(shape, grid)]
    edge = shapely.segmentize(shape.boundary, pitch_mm)
    flat = MM * np.vstack([inside, shapely.get_coordinates(edge)])
    return np.column_stack([flat, rng.uniform(-THICKNESS_M / 2, THICKNESS_M / 2, len(flat))])


def cloud_of(points: FloatArray, viewpoint: Sequence[float] = (0.0, 0.0, 1.0)) -> Cloud:
    """A cloud seen from above."""
    return Cloud(points, np.array(viewpoint), Source("test"))


@cache
def planned_sample(name: str, gripper: str = "pr2", method: str = "default") -> Plan:
    """The plan of a sample, made once for all tests that look at it."""
    return plan(next(read_clouds(SAMPLES / f"{name}.pcd")), load_gripper(gripper), load_settings(method))


def holds(grasp: Grasp) -> float:
    """How probable it is that a grasp holds."""
    assert grasp.success is not None
    return grasp.success.probability


def pytest_collection_finish() -> None:
    """Look for garbage less often, and not among the modules and tests: that would take a tenth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


@pytest.fixture(scope="session")
def pr2() -> Gripper:
    """The PR2's gripper: one finger a side, 90 mm."""
    return load_gripper("pr2")


@pytest.fixture(scope="session")
def lacquey() -> Gripper:
    """The paper's gripper: a thumb against a pair, 110 mm."""
    return load_gripper("lacquey")


@pytest.fixture(scope="session")
def defaults() -> PlannerSettings:
    """The default settings, unresolved."""
    return load_settings()


@dataclass(frozen=True)
class Box:
    """An upright box of `size` about `center`, turned by `yaw_deg` about the vertical; metres."""

    center: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw_deg: float = 0.0

    def hit(self, origin: FloatArray, rays: FloatArray) -> FloatArray:
        """How far (n,) along `rays` (n, 3) from `origin` the surface lies; infinite where they miss."""
        turn = Rotation.from_euler("z", -self.yaw_deg, degrees=True)
        start, along = turn.apply(origin - np.array(self.center)), turn.apply(rays)
        along = np.where(np.abs(along) < 1e-12, 1e-12, along)
        one, other = (-np.array(self.size) / 2 - start) / along, (np.array(self.size) / 2 - start) / along
        first, last = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
        return np.where((first <= last) & (first > 0), first, np.inf)


@dataclass(frozen=True)
class Tube:
    """A round body about `axis` through `center`: solid, or with a bore of radius `bore` above a `floor`; metres."""

    center: tuple[float, float, float]
    radius: float
    length: float
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    bore: float = 0.0
    floor: float | None = None

    def hit(self, origin: FloatArray, rays: FloatArray) -> FloatArray:
        """How far (n,) along `rays` (n, 3) from `origin` the surface lies; infinite where they miss."""
        z = np.array(self.axis) / np.linalg.norm(self.axis)
        start, half = origin - np.array(self.center), 0.5 * self.length
        z0, dz = start @ z, rays @ z
        flat, across = start - z0 * z, rays - dz[:, None] * z
        nearest = np.full(len(rays), np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (across**2).sum(axis=1), across @ flat
            for radius in (self.radius, self.bore) if self.bore else (self.radius,):
                root = np.sqrt(b * b - a * (flat @ flat - radius**2))
                for t in ((-b - root) / a, (-b + root) / a):
                    nearest = np.where((t > 0) & (np.abs(z0 + t * dz) <= half), np.fmin(nearest, t), nearest)
            discs = [(-half, self.bore, self.radius), (half, self.bore, self.radius)]
            discs += [] if self.floor is None else [(self.floor - half, 0.0, self.bore)]
            for height, inner, outer in discs:
                t = (height - z0) / dz
                from_axis = np.linalg.norm(flat + t[:, None] * across, axis=1)
                nearest = np.where((t > 0) & (from_axis >= inner) & (from_axis <= outer), np.fmin(nearest, t), nearest)
        return nearest


Solid = Box | Tube
TABLE = Box((0.0, 0.0, -0.01), (0.9, 0.7, 0.02))
"""A table whose top is z = 0."""
FLOOR = Box((0.0, 0.0, -0.76), (6.0, 6.0, 0.02))
WALL = Box((0.0, 0.4, 0.3), (6.0, 0.02, 2.2))


@dataclass(frozen=True)
class Camera:
    """A depth camera `distance` metres from `target`, tilted from the vertical toward −y."""

    tilt_deg: float = 0.0
    distance: float = 0.8
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pixels: tuple[int, int] = (280, 210)
    focal: float = 400.0

    @property
    def frame(self) -> Frame:
        """The optical frame: x right, y down, z forward."""
        tilt = np.radians(self.tilt_deg)
        forward = np.array([0.0, np.sin(tilt), -np.cos(tilt)])
        right = np.array([1.0, 0.0, 0.0])
        return Frame(
            np.array(self.target) - self.distance * forward, np.stack([right, np.cross(forward, right), forward])
        )

    def sees(self, *solids: Solid, noise_m: float = 0.5e-3, seed: int = 0) -> Cloud:
        """The cloud in the world's frame; `noise_m` is that of the depth at 0.8 m, growing as its square."""
        return Cloud(_seen(self, solids, noise_m, seed).copy(), self.frame.origin, Source("test"))

    def rays(self) -> FloatArray:
        """Those of all pixels (n, 3) in the world's frame, as long as their depth is 1."""
        columns, rows = self.pixels
        u, v = np.meshgrid(np.arange(columns) - 0.5 * (columns - 1), np.arange(rows) - 0.5 * (rows - 1))
        local = np.column_stack([u.ravel(), v.ravel(), np.full(u.size, self.focal)]) / self.focal
        return local @ self.frame.axes


@lru_cache(maxsize=64)
def _seen(camera: Camera, solids: tuple[Solid, ...], noise_m: float, seed: int) -> FloatArray:
    """Points (n, 3), computed once for all tests that look at the same things."""
    rays, origin = camera.rays(), camera.frame.origin
    depth = np.min([solid.hit(origin, rays) for solid in solids], axis=0)
    rays, depth = rays[np.isfinite(depth)], depth[np.isfinite(depth)]
    depth += np.random.default_rng(seed).normal(0.0, noise_m, len(depth)) * (depth / 0.8) ** 2
    return np.asarray(origin + depth[:, None] * rays)


@pytest.fixture(scope="session", autouse=True)
def nobodys_defaults(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """No test reads the developer's own file of defaults or FLATGRASP_* variables."""
    with pytest.MonkeyPatch.context() as patch:
        home = str(tmp_path_factory.mktemp("home"))
        patch.setenv("HOME", home)
        patch.setenv("XDG_CONFIG_HOME", home)
        for name in [name for name in os.environ if name.startswith("FLATGRASP_")]:
            patch.delenv(name)
        yield


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures of nothing, for tests that look at which files are written and not at what is drawn."""
    from flatgrasp_cli.results.figures.style import new_figure

    for figure in ("final_figure", "stages._numbered", "comparison.comparison_figure", "cage.cage_figure"):
        monkeypatch.setattr(f"flatgrasp_cli.results.figures.{figure}", lambda *_, **__: new_figure(2, 1))


class Ended(NamedTuple):
    """How a run ended: its exit code and what it printed."""

    code: int
    out: str
    err: str


Run = Callable[..., Ended]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command line with arguments in an empty folder, perhaps with bytes on standard input."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)

    def call(*arguments: str | Path, stdin: bytes = b"", terminal: bool = False) -> Ended:
        given = io.TextIOWrapper(io.BufferedReader(io.BytesIO(stdin)))
        monkeypatch.setattr(given, "isatty", lambda: terminal)
        monkeypatch.setattr(sys, "argv", ["flatgrasp", *map(str, arguments)])
        monkeypatch.setattr(sys, "stdin", given)
        capsys.readouterr()
        code = run_here()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        return Ended(code, printed.out, printed.err)

    return call
