"""RVL against an encoder written number by number, as the paper gives it."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flatgrasp_cli.geometry.arrays import ByteArray
from flatgrasp_cli.recordings.messages import MessageError
from flatgrasp_cli.recordings.messages.rvl import decode_rvl, rvl_size


def nibbles_of(number: int) -> list[int]:
    """Three bits a nibble, low bits first; the fourth bit says that more follow."""
    nibbles = []
    while True:
        nibbles.append((number & 7) | (8 if number > 7 else 0))
        number >>= 3
        if not number:
            return nibbles


def packed(numbers: list[int], width: int, height: int) -> bytes:
    nibbles = [nibble for number in numbers for nibble in nibbles_of(number)]
    nibbles += [0] * (-len(nibbles) % 8)
    words = [sum(n << 4 * (7 - k) for k, n in enumerate(nibbles[i : i + 8])) for i in range(0, len(nibbles), 8)]
    return struct.pack("<ii", width, height) + struct.pack(f"<{len(words)}I", *words)


def encode_rvl(image: Any) -> bytes:
    """The image (height, width) as compressedDepth writes it after its own header."""
    pixels = np.asarray(image).reshape(-1).tolist()
    numbers, at, before = [], 0, 0
    while at < len(pixels):
        begin = at
        while at < len(pixels) and pixels[at] == 0:
            at += 1
        middle = at
        while at < len(pixels) and pixels[at] != 0:
            at += 1
        numbers += [middle - begin, at - middle]
        for pixel in pixels[middle:at]:
            step = pixel - before
            numbers.append((step << 1) ^ (step >> 63))
            before = pixel
    return packed(numbers, *np.shape(image)[::-1])


def as_bytes(data: bytes) -> ByteArray:
    return np.frombuffer(data, np.uint8)


@given(
    arrays(np.uint16, st.tuples(st.integers(1, 7), st.integers(1, 9)), elements=st.sampled_from([0, 0, 1, 800, 65535]))
)
def test_what_was_encoded_comes_back(image: Any) -> None:
    np.testing.assert_array_equal(decode_rvl(as_bytes(encode_rvl(image))), image)


def test_a_scene_comes_back_and_the_size_is_told_before() -> None:
    rng = np.random.default_rng(0)
    image = (800 + np.arange(120)[:, None] + rng.integers(0, 5, (120, 160))).astype(np.uint16)
    image[rng.random(image.shape) < 0.2] = 0
    data = as_bytes(encode_rvl(image))
    assert rvl_size(data) == (160, 120)
    np.testing.assert_array_equal(decode_rvl(data), image)


def test_differences_are_taken_modulo_65536() -> None:
    """The paper's own code keeps depth in signed 16 bits: from 1 to 40000 is −25537 for it."""
    step = 40_000 - 65_536 - 1
    data = packed([0, 2, 2, (step << 1) ^ (step >> 63)], 2, 1)
    np.testing.assert_array_equal(decode_rvl(as_bytes(data)), [[1, 40_000]])


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"\0" * 7, "has 7 bytes, less than its header"),
        (struct.pack("<ii", -1, 4), "declares -1 × 4 pixels"),
        (struct.pack("<ii", 60_000, 60_000), "declares 60000 × 60000 pixels"),
        (struct.pack("<ii", 2, 2), "is cut off"),
        (packed([0, 4, 2, 2], 2, 2)[:-4], "is cut off"),
        (packed([0, 40], 8, 5), "is cut off"),
        (packed([3, 2, 1, 1], 2, 2), "its runs are not those of the image"),
        (packed([0, 0, 0, 0], 2, 2), "its runs are not those of the image"),
        (packed([0, 4, 2, 1, 2, 2], 2, 2), "a run of depth holds 0"),
        (struct.pack("<ii", 2, 2) + b"\xff" * 12 + bytes(4), "a number without end"),
    ],
)
def test_broken_rvl_says_how(data: bytes, text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode_rvl(as_bytes(data))
