"""Depth images as files: every format gives the points that pinhole geometry says, and what is no depth is refused."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from flatgrasp_cli.errors import FlatgraspError, SourceError, UsageError
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.sources import Selection, read_clouds
from flatgrasp_cli.sources.intrinsics import parse_intrinsics
from flatgrasp_cli.sources.selection import Every, Moment
from tests.conftest import Run

Image = NDArray[Any]
FX, FY, CX, CY = 100.0, 200.0, 1.0, 0.5
NUMBERS = "100,200,1,0.5"
COUNTS: Image = np.array([[500, 0, 700, 800], [1000, 900, 60000, 600]], np.uint16)
"""Two rows of four pixels; 0 is no depth."""
POINTS = [  # x = (u − cx) / fx · z, y = (v − cy) / fy · z
    (-0.005, -0.00125, 0.5),
    (0.007, -0.00175, 0.7),
    (0.016, -0.002, 0.8),
    (-0.01, 0.0025, 1.0),
    (0.0, 0.00225, 0.9),
    (0.6, 0.15, 60.0),
    (0.012, 0.0015, 0.6),
]


def encoded(image: Image, suffix: str, *options: int) -> bytes:
    """An image as a file of that kind."""
    if suffix == ".npy":
        out = io.BytesIO()
        np.save(out, image)
        return out.getvalue()
    done, data = cv2.imencode(suffix, image, options)
    assert done
    return bytes(data.tobytes())


def metres(dtype: str) -> Image:
    """The same image in metres, NaN and infinite where there is none."""
    image = COUNTS.astype(dtype) * 0.001
    image[0, 1] = np.nan
    return image


PLAIN = (cv2.IMWRITE_TIFF_COMPRESSION, 1)
FILES: dict[str, bytes] = {
    "png": encoded(COUNTS, ".png"),
    "tiff": encoded(COUNTS, ".tiff"),
    "tiff-plain": encoded(COUNTS, ".tif", *PLAIN),
    "tiff-f4": encoded(metres("f4"), ".tiff", *PLAIN),
    "tiff-f8": encoded(metres("f8"), ".tiff", *PLAIN),
    "npy": encoded(COUNTS, ".npy"),
    "npy-i8": encoded(COUNTS.astype(np.int64), ".npy"),
    "npy-big-endian": encoded(COUNTS.astype(">u2"), ".npy"),
    "npy-fortran": encoded(np.asfortranarray(COUNTS), ".npy"),
    "npy-f4": encoded(metres("f4"), ".npy"),
    "npy-f8": encoded(metres("f8"), ".npy"),
}


def read(path: Path, content: bytes, **wanted: Any) -> Cloud:
    """The one cloud of a depth image, whose name has no suffix, for content alone must tell what it is."""
    path.write_bytes(content)
    selection = Selection(**{"intrinsics": parse_intrinsics(NUMBERS), **wanted})
    (cloud,) = read_clouds(path, selection=selection)
    return cloud


@pytest.mark.parametrize("content", FILES.values(), ids=FILES)
def test_every_format_gives_the_points_of_a_pinhole(content: bytes, tmp_path: Path) -> None:
    cloud = read(tmp_path / "image", content)
    np.testing.assert_allclose(cloud.points, POINTS, rtol=1e-6, atol=1e-9)
    assert cloud.dropped == 1
    assert cloud.sensor is not None
    assert cloud.sensor.known_from == "frame"
    np.testing.assert_array_equal(cloud.sensor.position, np.zeros(3))
    assert cloud.pixels is not None
    assert cloud.pixels.shape == (2, 4)
    assert cloud.pixels.filled.tolist() == [True, False, *[True] * 6]
    assert (cloud.source.path, cloud.source.topic, cloud.source.index) == (str(tmp_path / "image"), None, 0)


def test_the_depth_unit_is_metres_in_a_count(tmp_path: Path) -> None:
    cloud = read(tmp_path / "image", FILES["png"], depth_unit_m=0.0002)  # as TUM's data set has it
    np.testing.assert_allclose(cloud.points, 0.2 * np.array(POINTS), rtol=1e-12)
    cloud = read(tmp_path / "image", encoded(1000 * metres("f4"), ".npy"), depth_unit_m=0.001)
    np.testing.assert_allclose(cloud.points, POINTS, rtol=1e-6)


@pytest.mark.parametrize(("image", "warned"), [(COUNTS * 10, True), (COUNTS, False)], ids=["0.1 mm", "mm"])
def test_depth_that_cannot_be_in_millimetres_is_told(image: Image, warned: bool, tmp_path: Path) -> None:
    image = np.where(COUNTS == 60000, 0, image).astype(np.uint16)
    centred = parse_intrinsics("100,200,1.5,0.5")
    cloud = read(tmp_path / "image", encoded(image, ".png"), intrinsics=centred)
    assert [item.code for item in cloud.warnings] == ["depth_unit_assumed"] * warned
    assert read(tmp_path / "image", encoded(image, ".png"), intrinsics=centred, depth_unit_m=0.001).warnings == ()


def test_a_body_has_x_forward_and_z_up(tmp_path: Path) -> None:
    cloud = read(tmp_path / "image", FILES["png"], depth_axes="body")
    x, y, z = np.array(POINTS).T
    np.testing.assert_allclose(cloud.points, np.column_stack([z, -x, -y]), atol=1e-12)


ROWS = [[FX, 0.0, CX], [0.0, FY, CY], [0.0, 0.0, 1.0]]
FLAT = [number for row in ROWS for number in row]
SIZE = {"width": 4, "height": 2}
CALIBRATIONS: dict[str, str] = {
    "ros-1-file": yaml.safe_dump(
        {
            "image_width": 4,
            "image_height": 2,
            "camera_name": "c",
            "camera_matrix": {"rows": 3, "cols": 3, "data": FLAT},
            "distortion_model": "plumb_bob",
            "distortion_coefficients": {"rows": 1, "cols": 5, "data": [0.0] * 5},
            "projection_matrix": {"rows": 3, "cols": 4, "data": [1.0] * 12},
        }
    ),
    "ros-1-topic": yaml.safe_dump({**SIZE, "K": FLAT, "D": [], "P": [0.0] * 12}) + "---\n",
    "ros-2-topic": yaml.safe_dump(
        {"header": {"frame_id": "c"}, **SIZE, "k": FLAT, "d": [0.0] * 5, "roi": {"width": 0, "height": 0}}
    )
    + "---\n",
    "open3d": json.dumps({**SIZE, "intrinsic_matrix": np.array(ROWS).T.ravel().tolist()}),
    "open3d-parameters": json.dumps(
        {"extrinsic": [1.0], "intrinsic": {**SIZE, "intrinsic_matrix": np.array(ROWS).T.ravel().tolist()}}
    ),
}


@pytest.mark.parametrize("text", CALIBRATIONS.values(), ids=CALIBRATIONS)
def test_calibrations_in_files(text: str, tmp_path: Path) -> None:
    path = tmp_path / "calibration"
    path.write_text(text)
    cloud = read(tmp_path / "image", FILES["png"], intrinsics=parse_intrinsics(str(path)))
    np.testing.assert_allclose(cloud.points, POINTS, rtol=1e-12)


def test_a_calibrations_distortion_is_undone(tmp_path: Path) -> None:
    path = tmp_path / "calibration"
    path.write_text(yaml.safe_dump({**SIZE, "k": FLAT, "d": [0.5, 0.0, 0.0, 0.0], "distortion_model": "plumb_bob"}))
    cloud = read(tmp_path / "image", FILES["png"], intrinsics=parse_intrinsics(str(path)))
    rays = cloud.points[:, :2] / cloud.points[:, 2:]
    bent = rays * (1 + 0.5 * (rays**2).sum(axis=1, keepdims=True))  # the model's own way is the one without a search
    np.testing.assert_allclose(bent, np.array(POINTS)[:, :2] / np.array(POINTS)[:, 2:], atol=1e-7)


WRONG_INTRINSICS: dict[str, tuple[str, str]] = {
    "three-numbers": ("1,2,3", "3 numbers"),
    "nan": ("nan,1,1,1", "finite"),
    "negative": ("-1,1,1,1", "positive"),
    "no-file": ("nowhere.yaml", "No such file"),
}
WRONG_FILES: dict[str, tuple[str, str]] = {
    "no-yaml": ("a: [", "line"),
    "a-list": ("[1, 2, 3, 4]", "keys"),
    "no-matrix": ("width: 4", "camera_matrix"),
    "short-matrix": ("k: [1, 2, 3]", "needs 9"),
    "words": ("k: [a, b, c]", "calibration"),
    "cut-off-by-ros2": ("k: [1.0, '...']", "calibration"),
    "zero-focal-length": (f"k: {[0.0] * 9}", "positive"),
    "open3d-short": ('{"intrinsic_matrix": [1]}', "needs 9"),
    "nested": ("[" * 700, "calibration"),
}


@pytest.mark.parametrize(("text", "word"), WRONG_INTRINSICS.values(), ids=WRONG_INTRINSICS)
def test_wrong_intrinsics_are_wrong_usage(text: str, word: str) -> None:
    with pytest.raises(UsageError, match="--intrinsics") as caught:
        parse_intrinsics(text)
    assert word in str(caught.value)


@pytest.mark.parametrize(("text", "word"), WRONG_FILES.values(), ids=WRONG_FILES)
def test_wrong_calibrations_are_wrong_usage(text: str, word: str, tmp_path: Path) -> None:
    path = tmp_path / "calibration"
    path.write_text(text)
    with pytest.raises(UsageError, match="--intrinsics") as caught:
        parse_intrinsics(str(path))
    assert word in str(caught.value)


def tiff(**tags: int) -> bytes:
    """A TIFF that claims these tags and has no pixels."""
    numbers = {"width": 256, "height": 257, "bits": 258, "compression": 259, "samples": 277}
    entries = b"".join(struct.pack("<HHII", numbers[name], 4, 1, value) for name, value in tags.items())
    return b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4)


def claimed_npy(shape: tuple[int, ...]) -> bytes:
    """A .npy of which all but the header is missing."""
    out = io.BytesIO()
    header = {"descr": "<u2", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(out, header)
    return out.getvalue()


COLOURS = np.zeros((2, 4, 3), np.uint8)
NO_DEPTH: dict[str, tuple[bytes, str]] = {
    "png-8-bit": (encoded(COUNTS.astype(np.uint8), ".png"), "16 bits of grey"),
    "png-colour": (encoded(COLOURS, ".png"), "16 bits of grey"),
    "png-colour-16": (encoded(COLOURS.astype(np.uint16), ".png"), "16 bits of grey"),
    "png-cut": (FILES["png"][:-20], "cut off"),
    "jpeg": (encoded(COLOURS, ".jpg"), "JPEG"),
    "tiff-8-bit": (encoded(COUNTS.astype(np.uint8), ".tiff"), "8 bits"),
    "tiff-colour": (encoded(COLOURS, ".tiff"), "3 channels"),
    "tiff-cut": (FILES["tiff-plain"][:30], "cut off"),
    "tiff-no-pixels": (tiff(width=4, height=2, bits=16, compression=5), "broken"),
    "tiff-immense": (tiff(width=2**31, height=2**31, bits=64), "cannot hold"),
    "tiff-immense-packed": (tiff(width=60_000, height=60_000, bits=64, compression=8), "cannot hold"),
    "tiff-too-large": (tiff(width=10_000, height=10_000, bits=16, compression=8) + bytes(10**5), "more than"),
    "npy-colour": (encoded(COLOURS, ".npy"), "no depth"),
    "npy-8-bit": (encoded(COUNTS.astype(np.uint8), ".npy"), "no depth"),
    "npy-complex": (encoded(COUNTS.astype(np.complex64), ".npy"), "no depth"),
    "npy-points": (encoded(np.zeros((100, 3)), ".npy"), "list of points"),
    "npy-cut": (FILES["npy"][:-2], ".npy"),
    "npy-immense": (claimed_npy((10**9, 10**9)), ".npy"),
    "npy-magic-alone": (b"\x93NUMPY", ".npy"),
    "npy-header": (FILES["npy"].replace(b"}", b"("), ".npy"),
    "npy-objects": (encoded(np.array([[{}]]), ".npy"), ".npy"),
}


@pytest.mark.parametrize(("content", "word"), NO_DEPTH.values(), ids=NO_DEPTH)
def test_what_is_no_depth_is_refused(
    content: bytes, word: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SourceError) as caught:
        read(tmp_path / "image", content)
    assert word in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_intrinsics_of_another_size_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "calibration"
    path.write_text(yaml.safe_dump({"width": 640, "height": 480, "k": FLAT}))
    with pytest.raises(SourceError, match=r"4 × 2.*640 × 480"):
        read(tmp_path / "image", FILES["png"], intrinsics=parse_intrinsics(str(path)))


def test_a_depth_image_without_intrinsics_is_wrong_usage(tmp_path: Path, run: Run) -> None:
    path = tmp_path / "depth.png"
    path.write_bytes(FILES["png"])
    for command in ("plan", "inspect"):
        ended = run(command, path)
        assert ended.code == 2
        assert "--intrinsics" in ended.err
        assert str(path) in ended.err


def scene(tmp_path: Path, count: int = 1) -> Path:
    """A folder of images of a box of 60 × 30 mm, half a metre below a camera, that moves 10 mm from one to the next."""
    folder = tmp_path / "depth"
    folder.mkdir()
    for k in range(count):
        image = np.full((240, 320), 520, np.uint16)  # 1 mm a pixel at 0.5 m
        image[105:135, 130 + 10 * k : 190 + 10 * k] = 500
        (folder / f"{k:03}.png").write_bytes(encoded(image, ".png"))
    return folder


CAMERA = ("--intrinsics", "500,500,159.5,119.5")


def test_a_box_in_a_depth_image_is_grasped_through_its_middle(tmp_path: Path, run: Run) -> None:
    folder = scene(tmp_path)
    ended = run("plan", folder / "000.png", *CAMERA, "-g", "pr2", "--json")
    assert ended.code == 0, ended.err
    grasps = json.loads(ended.out)["objects"][0]["grasps"]
    assert sorted(grasp["width_m"] for grasp in grasps) == pytest.approx([0.030, 0.060], abs=0.002)
    for grasp in grasps:  # across and along hold alike
        assert grasp["success"]["probability"] > 0.99
        assert grasp["pose"]["position"][:2] == pytest.approx([0.0, 0.0], abs=0.01)


def test_standard_input_may_be_a_depth_image(tmp_path: Path, run: Run) -> None:
    content = (scene(tmp_path) / "000.png").read_bytes()
    assert run("plan", "-", *CAMERA, "-g", "pr2", "--json", stdin=content).code == 0


def test_a_folder_of_images_is_planned_one_by_one_under_names_of_their_own(tmp_path: Path, run: Run) -> None:
    folder = scene(tmp_path, 3)
    (folder / "notes.txt").write_text("recorded by a test")
    ended = run("plan", folder, *CAMERA, "-g", "pr2", "--out", tmp_path / "out", "--plots", "none")
    assert ended.code == 0, ended.err
    names = [f"depth.{k:03}.grasps.json" for k in range(3)]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == names
    documents = [json.loads((tmp_path / "out" / name).read_text()) for name in names]
    assert [item["source"]["index"] for item in documents] == [0, 1, 2]
    assert [item["source"]["path"] for item in documents] == [f"{folder}/{k:03}.png" for k in range(3)]
    x = [item["objects"][0]["grasps"][0]["pose"]["position"][0] for item in documents]
    assert np.diff(x) == pytest.approx([0.01, 0.01], abs=0.003)


def test_images_of_a_folder_are_chosen_by_number_not_by_time(tmp_path: Path) -> None:
    folder, camera = scene(tmp_path, 5), parse_intrinsics(CAMERA[1])
    chosen = list(read_clouds(folder, selection=Selection(intrinsics=camera, every=Every(frames=2), count=2)))
    assert [cloud.source.path[-7:] for cloud in chosen] == ["000.png", "002.png"]
    with pytest.raises(UsageError, match="--every N"):
        list(read_clouds(folder, selection=Selection(intrinsics=camera, at=Moment(0, absolute=False))))


def test_inspect_shows_depth_images(tmp_path: Path, run: Run) -> None:
    folder = scene(tmp_path, 2)
    for source, kind in ((folder / "000.png", "depth image"), (folder, "depth images")):
        ended = run("inspect", source, *CAMERA, "--json")
        summary = json.loads(ended.out)
        assert (ended.code, summary["container"]) == (0, kind)
        assert summary["clouds"][0]["shape"] == [240, 320]


def test_an_image_that_is_no_depth_stops_a_folder_and_is_named(tmp_path: Path) -> None:
    folder = scene(tmp_path, 2)
    (folder / "001.png").write_bytes(encoded(COLOURS, ".png"))
    with pytest.raises(FlatgraspError, match=r"001\.png: the PNG has 8 bits"):
        list(read_clouds(folder, selection=Selection(intrinsics=parse_intrinsics(CAMERA[1]))))


def test_the_last_count_is_no_reading(tmp_path: Path) -> None:
    raw = np.full((4, 5), 65_535, dtype=np.uint16)
    raw[1, 2] = 500
    np.save(tmp_path / "full.npy", raw)
    (cloud,) = read_clouds(tmp_path / "full.npy", selection=Selection(intrinsics=parse_intrinsics("500,500,2,1.5")))
    assert (len(cloud.points), cloud.dropped) == (1, 19)


@pytest.mark.parametrize("matrix", ["[500, 0, 2, 0, 600, 1.5, 0, 0, 1]", "[[500, 0, 2], [0, 600, 1.5], [0, 0, 1]]"])
def test_a_matrix_by_rows_is_told_by_its_zeros(matrix: str, tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text(f'{{"width": 5, "height": 4, "intrinsic_matrix": {matrix}}}')
    assert parse_intrinsics(str(path)).k == (500, 0, 2, 0, 600, 1.5, 0, 0, 1)


@pytest.mark.parametrize(
    ("camera", "size", "doubted"),
    [
        ("525,525,319.5,239.5", (640, 480), False),
        ("525,525,351,216", (640, 480), False),  # no camera's is farther aside: 5 % of each side
        ("525,525,239.5,239.5", (560, 480), False),  # without its first eighth
        ("262,262,160,120", (640, 480), True),  # of half the size
        ("262,262,176,132", (640, 480), True),  # and 5 % aside
        ("1050,1050,640,480", (640, 480), True),
        ("385,385,319.5,239.5", (848, 480), True),  # one of a RealSense's two usual sizes for the other
    ],
)
def test_a_principal_point_of_another_image_size_is_told(
    camera: str, size: tuple[int, int], doubted: bool, tmp_path: Path
) -> None:
    np.save(tmp_path / "image.npy", np.full(size[::-1], 500, dtype=np.uint16))
    (cloud,) = read_clouds(tmp_path / "image.npy", selection=Selection(intrinsics=parse_intrinsics(camera)))
    assert [warning.code for warning in cloud.warnings] == ["intrinsics_doubted"] * doubted


@pytest.mark.parametrize(
    ("more", "doubted"),
    [
        ("", True),
        ("binning_x: 2, binning_y: 2", False),  # whose matrix is that of all pixels
        ("roi: {x_offset: 100, width: 10, height: 8}", False),  # says itself why it does not look out of the middle
    ],
)
def test_a_file_that_says_what_the_image_shows_is_not_doubted(more: str, doubted: bool, tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    size = "width: 20, height: 16" if "binning" in more else "width: 10, height: 8"
    path.write_text(f"{{{size}, k: [500, 0, 9.5, 0, 500, 7.5, 0, 0, 1]{more and ', '}{more}}}")
    np.save(tmp_path / "image.npy", np.full((8, 10), 500, dtype=np.uint16))
    (cloud,) = read_clouds(tmp_path / "image.npy", selection=Selection(intrinsics=parse_intrinsics(str(path))))
    assert [warning.code for warning in cloud.warnings] == ["intrinsics_doubted"] * doubted
