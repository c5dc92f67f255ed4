"""Depth images become the points that were recorded, and broken ones an error that says how."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.recordings.messages import (
    CameraInfo,
    DepthCameras,
    MessageError,
    is_depth,
    is_lossy_depth,
)
from tests.recordings.clouds import HEADER, INF, NAN, record
from tests.recordings.depth_images import (
    DEPTH_MM,
    HEIGHT,
    IMAGE,
    INFO,
    WIDTH,
    compressed,
    decode,
    expected,
    image,
    info,
    patched,
)
from tests.recordings.test_rvl import encode_rvl


@pytest.mark.parametrize("encoding", ["16UC1", "mono16", "32FC1"])
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 3])
def test_depth_images(encoding: str, big: bool, padding: int) -> None:
    raw = DEPTH_MM / 1000 if encoding == "32FC1" else DEPTH_MM
    decoded = decode(image(raw, encoding, big, padding))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-6)
    assert (decoded.dropped, decoded.shape, decoded.frame_id) == (0, (HEIGHT, WIDTH), "camera")


def test_no_depth_is_dropped() -> None:
    raw = DEPTH_MM / 1000
    raw[0, :4] = [0, NAN, INF, -1]
    decoded = decode(image(raw, "32FC1"))
    np.testing.assert_allclose(decoded.points, expected()[4:], rtol=1e-6)
    assert decoded.dropped == 4


def test_compressed_millimetres() -> None:
    depth = DEPTH_MM.copy()
    depth[2, 3] = 0
    for form in ("16UC1; compressedDepth png", "16UC1; compressedDepth"):
        decoded = decode(compressed(depth, form), topic=IMAGE + "/compressedDepth")
        np.testing.assert_allclose(decoded.points, expected(depth), rtol=1e-12)
        assert decoded.dropped == 1


def test_compressed_inverse_depth() -> None:
    raw = np.full((HEIGHT, WIDTH), 1100)
    raw[0, :3] = [0, 100, 600]  # no data, infinitely far, 2 m
    decoded = decode(compressed(raw, "32FC1; compressedDepth png", a=1000.0, b=100.0))
    np.testing.assert_allclose(decoded.points[:2, 2], [2.0, 1.0], rtol=1e-12)
    assert decoded.dropped == 2


@pytest.mark.parametrize(("encoding", "quantisation"), [("16UC1", (0.0, 0.0)), ("32FC1", (1000.0, 100.0))])
def test_compressed_as_rvl(encoding: str, quantisation: tuple[float, float]) -> None:
    raw = np.full((HEIGHT, WIDTH), 1100)
    raw[0, :2] = 0
    data = struct.pack("<iff", 0, *quantisation) + encode_rvl(raw)
    decoded = decode(record(header=HEADER, format=f"{encoding}; compressedDepth rvl", data=data))
    assert decoded.dropped == 2
    np.testing.assert_allclose(decoded.points[:, 2], 1.1 if encoding == "16UC1" else 1.0, rtol=1e-12)


def test_jpeg_is_refused_with_the_reason() -> None:
    jpeg = record(header=HEADER, format="16UC1; jpeg compressed mono8", data=b"\xff\xd8" + bytes(50))
    assert not is_depth(jpeg)
    assert is_lossy_depth(jpeg)
    with pytest.raises(MessageError, match=r"^is JPEG, which destroys depth: record the image raw"):
        decode(jpeg)
    with pytest.raises(MessageError, match="is no PNG but JPEG, which destroys depth"):
        decode(record(header=HEADER, format="16UC1; png compressed", data=jpeg.data))


def test_which_images_are_depth() -> None:
    assert is_depth(image())
    assert is_depth(image(encoding="32FC1"))
    assert is_depth(record(format="32FC1; compressedDepth png"))
    for colour in (
        record(encoding="rgb8"),
        record(format="rgb8; jpeg compressed bgr8"),
        record(format="jpeg"),
        record(),
    ):
        assert not is_depth(colour)


def bomb() -> Any:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    data[12 + 16 : 12 + 24] = struct.pack(">II", 60_000, 60_000)
    return patched(message, data=bytes(data))


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (patched(image(), data=bytes(10)), "data has 10 bytes, 8 × 6 pixels in rows of 16 bytes need 96"),
        (patched(image(padding=1), step=15), "step is 15, but 8 pixels of 2 bytes need 16"),
        (patched(image(), encoding="rgb8"), "has encoding 'rgb8', which is no depth"),
        (patched(compressed(DEPTH_MM), format="jpeg"), "has format 'jpeg', which is no depth"),
        (patched(compressed(DEPTH_MM), data=bytes(4)), "data has 4 bytes, less than the header"),
        (patched(compressed(DEPTH_MM), data=bytes(100)), "is no PNG"),
        (patched(compressed(DEPTH_MM), data=compressed(DEPTH_MM).data[:-20]), "the PNG is cut off"),
        (bomb(), "cannot hold 60000 × 60000 pixels"),
        (record(header=HEADER), "is no image: it has no field"),
    ],
)
def test_broken_images_say_how(message: Any, text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode(message)


@pytest.mark.parametrize("chunk", [b"IHDR", b"IDAT", b"IEND"])
def test_an_altered_png_is_an_error(chunk: bytes) -> None:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    data[bytes(data).index(chunk) + (16 if chunk == b"IHDR" else 4)] ^= 1
    with pytest.raises(MessageError, match=r"a checksum does not match"):
        decode(patched(message, data=bytes(data)))


def test_a_png_with_a_wrong_inside_is_an_error() -> None:
    message = compressed(DEPTH_MM)
    data = bytearray(message.data)
    begin = bytes(data).index(b"IDAT")
    (size,) = struct.unpack_from(">I", data, begin - 4)
    data[begin + 6 : begin + 10] = bytes(4)
    struct.pack_into(">I", data, begin + 4 + size, zlib.crc32(data[begin : begin + 4 + size]))
    with pytest.raises(MessageError, match=r"the PNG is broken$"):
        decode(patched(message, data=bytes(data)))


@pytest.mark.parametrize("step", [0, 8, 500])
def test_a_wrong_step_of_an_image_is_ignored_if_the_data_is_exact(step: int) -> None:
    decoded = decode(patched(image(), step=step))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-12)
    assert [item.code for item in decoded.assumptions] == ["row_step_ignored"]


def test_the_unit_that_is_stated_recorded_or_written_after_the_image() -> None:
    cameras = DepthCameras()
    cameras.add_info(INFO, info())
    tenth = record(data=np.float32(1e-4))
    far = patched(image(10 * DEPTH_MM), depth_units=0.0)  # an SDK's image that is no depth says 0
    assert cameras.decode(IMAGE, far).assumed_unit_m == 1e-3
    cameras.add_unit(tenth)
    decoded = cameras.decode(IMAGE, far)
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-6)
    assert decoded.assumed_unit_m is None
    with pytest.raises(MessageError, match="says that a count of depth is nan m"):
        cameras.add_unit(record(data=NAN))
    written = patched(far, depth_units=2e-4)
    np.testing.assert_allclose(cameras.decode(IMAGE, written).points, 2 * expected(), rtol=1e-6)
    stated = DepthCameras(CameraInfo.from_message(info()), 3e-4)
    np.testing.assert_allclose(stated.decode(IMAGE, written).points, 3 * expected(), rtol=1e-6)


def test_an_encoding_that_nobody_confirms_is_an_assumed_unit() -> None:
    assert decode(image()).assumed_unit_m == 1e-3
    assert decode(image(encoding="32FC1")).assumed_unit_m == 1.0
