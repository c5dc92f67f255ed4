"""Polygons from files and standard input: what is none is refused in words, and none takes without end."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.profiles import PlannerSettings
from flatgrasp_cli.proof.caging import immobilising_grasps
from flatgrasp_cli.sources.polygon import MAX_CORNERS, read_polygon
from tests.conftest import SAMPLES, Run

NOTCHED = [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]]


def star(corners: int) -> list[tuple[float, float]]:
    """As many teeth as corners allow, all alike."""
    angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    radius = 1 + 0.1 * (np.arange(corners) % 2)
    return list(zip((radius * np.cos(angle)).tolist(), (radius * np.sin(angle)).tolist(), strict=True))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("5", "valid array"),
        ("null", "valid array"),
        ('"x"', "valid array"),
        ("{}", "valid array"),
        ("", "Invalid JSON"),
        ("[]", "at least 3"),
        ("[[[]]]", "loop 0, corner 0"),
        ("[[0,0],[[1,1]],[2,2]]", "corner 1, coordinate 0"),
        ("[[[0,0],[1,0],[1,1]],5]", "1: must be a valid array"),
        ("[[0,0,0],[1,0,0],[1,1,0]]", "corner 0"),
        ("[[true,false],[true,true],[false,true]]", "valid number"),
        ('[["0","0"],["1","0"],["1","1"]]', "valid number"),
        ("[[NaN,0],[1,0],[1,1]]", "finite"),
        ("[[-Infinity,0],[1,0],[1,1]]", "finite"),
        ("[[0,0],[1e308,0],[1e308,1e308]]", "less than or equal to 1000000000"),
        (f"[[0,0],[{'9' * 5000},0],[1,1]]", "out of range"),
        ("[[0,0],[1e-310,0],[1e-310,1e-310]]", "too small"),
        ("[[5e8,0],[500000001,0],[500000001,1]]", "too small"),
        ("[[0,0],[1,0],[1,1e-300],[0,1e-300]]", "three corners that lie apart"),
        ("[[1,1],[1,1],[1,1]]", "too small"),
        ("[[0,0],[1,1],[2,2]]", "no simple polygon"),
        ("[[0,0],[1,1],[1,0],[0,1]]", "self-intersection at 0.5 0.5"),
        ("[" * 1000 + "]" * 1000, "recursion"),
        ("[" * 1_000_000, "recursion"),
        (json.dumps(star(MAX_CORNERS + 1)), "at most 20000"),
        (json.dumps([star(1000)] * 21), "21000 corners"),
        (json.dumps([star(4)] * 101), "at most 100"),
        ("[[0, 0], [1, 0]]", "must have at least 3 items, not 2"),
        (" " * 10_000_001, "too large"),
    ],
    ids=lambda each: each[:25],
)
def test_what_is_no_polygon_is_refused_at_once(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "polygon.json"
    path.write_text(text, encoding="utf-8")
    began = time.monotonic()
    with pytest.raises(SourceError) as caught:
        read_polygon(str(path))
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 400
    assert time.monotonic() - began < 10


@pytest.mark.parametrize(
    "text", ["0,0\n1\n2,2\n", "nan,0\n1,0\n1,1\n", "0,0\n1e400,0\n1,1\n", "a,b\nc,d\n", "\x00\x01"]
)
def test_csv_that_is_no_polygon(text: str, tmp_path: Path) -> None:
    path = tmp_path / "polygon.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SourceError, match="is no polygon"):
        read_polygon(str(path))


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a file without an end")
def test_a_file_without_an_end(tmp_path: Path) -> None:
    path = tmp_path / "zero.json"
    path.symlink_to("/dev/zero")
    with pytest.raises(SourceError, match="too large"):
        read_polygon(str(path))


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(NOTCHED),
        json.dumps([*NOTCHED, NOTCHED[0]]),
        json.dumps([each for each in NOTCHED for _ in range(2)]),
        json.dumps([NOTCHED]),
        "\ufeff" + json.dumps(NOTCHED),
        "x;y\n" + "\n".join(f"{x};{y}" for x, y in NOTCHED),
    ],
    ids=["plain", "closed", "doubled", "nested", "byte order mark", "csv"],
)
def test_a_polygon_is_read_however_it_is_written(text: str, tmp_path: Path) -> None:
    path = tmp_path / "polygon.txt"
    path.write_text(text, encoding="utf-8")
    (loop,) = read_polygon(str(path))
    assert loop.tolist() == NOTCHED


@pytest.mark.parametrize(
    "text", [json.dumps(NOTCHED), "x,y\n0,0\n4,0\n4,4\n2,1\n0,4\n", "\ufeff 0;0\n4;0\n4;4\n2;1\n0;4"]
)
def test_standard_input_may_be_a_polygon(text: str, run: Run) -> None:
    done = run("cage", "-", "--json", stdin=text.encode())
    document = json.loads(done.out)
    assert (done.code, done.err, document["source"], document["object"]) == (0, "", "stdin", None)
    assert document["grasps"][0]["width_m"] == pytest.approx(1.0, abs=1e-9)


def test_standard_input_that_is_no_polygon_is_a_cloud_or_refused(run: Run) -> None:
    done = run("cage", "-", "--json", stdin=(SAMPLES / "hammer.pcd").read_bytes())
    assert json.loads(done.out)["object"] == 0
    for content, words in ((b"[[0,0],[1,0]]", "flatgrasp: stdin: is no polygon: "), (b"", "the file is empty")):
        done = run("cage", "-", stdin=content)
        assert (done.code, done.out) == (3, "")
        assert words in done.err


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e8])
def test_cages_do_not_depend_on_the_unit(scale: float, tmp_path: Path, defaults: PlannerSettings) -> None:
    path = tmp_path / "polygon.json"
    path.write_text(json.dumps((scale * np.array(NOTCHED)).tolist()), encoding="utf-8")
    exact = {"tolerance_m": 0.0, "noise_m": 0.0, "told_apart_m": 0.0, "max_vertices": 1000}
    (found,) = immobilising_grasps(read_polygon(str(path)), defaults.caging.model_copy(update=exact))
    assert found.width_m / scale == pytest.approx(1.0, abs=1e-9)  # from the tip of the notch to the base


def test_edges_that_are_parallel_but_for_a_subnormal(defaults: PlannerSettings) -> None:
    loop = np.array(NOTCHED, dtype=np.float64)
    loop[1, 1] = 1e-310
    exact = defaults.caging.model_copy(update={"tolerance_m": 0.0, "told_apart_m": 0.0})
    (found,) = immobilising_grasps((loop,), exact)
    assert found.width_m == pytest.approx(1.0)


def test_thousands_of_grasps_take_seconds(defaults: PlannerSettings) -> None:
    exact = defaults.caging.model_copy(update={"tolerance_m": 0.0, "told_apart_m": 0.0, "max_vertices": 1000})
    began = time.monotonic()
    found = immobilising_grasps((np.array(star(300)),), exact)
    assert len(found) > 5000
    assert time.monotonic() - began < 10  # each on its own would take a minute
