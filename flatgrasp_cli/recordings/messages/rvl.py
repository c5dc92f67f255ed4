"""RVL, the lossless compression of 16-bit depth that compressedDepth offers beside PNG.

Wilson, "Fast lossless depth image compression", ISS 2017: runs of zeros and of others in turn, each other pixel as its
difference to the one before. All numbers are of variable length, three bits to a nibble whose fourth bit says that more
follow, low bits first; eight nibbles make a word of 32 bits, the first one highest.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.geometry.arrays import ByteArray
from flatgrasp_cli.recordings.messages.decoded import MessageError

SIZE = struct.Struct("<ii")
"""The columns and rows, which ROS puts before the words."""
MOST_PIXELS = 2**24
"""No depth camera has more; a run of zeros could claim any number in a few bytes."""
MOST_NIBBLES = 11
"""Of one number: 33 bits."""


def rvl_size(data: ByteArray) -> tuple[int, int]:
    """Width and height of the image.

    Raises
    ------
    MessageError
        If they are missing, or cannot be those of a depth image.
    """
    if len(data) < SIZE.size:
        raise MessageError(f"the RVL has {len(data)} bytes, less than its header")
    width, height = SIZE.unpack_from(data.data)
    if min(width, height) < 0 or width * height > MOST_PIXELS:
        raise MessageError(f"the RVL declares {width} × {height} pixels")
    return int(width), int(height)


def decode_rvl(data: ByteArray) -> NDArray[np.uint16]:
    """The image (height, width).

    Raises
    ------
    MessageError
        If it is cut off, or what comes out are not the pixels that it declares.
    """
    width, height = rvl_size(data)
    whole = min((len(data) - SIZE.size) // 4, width * height + 1)  # no pixel takes more than a word
    numbers = _numbers(data[SIZE.size :][: 4 * whole])
    is_difference, runs = _runs(numbers.tolist(), width * height)
    filled = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    zigzag = numbers[: len(is_difference)][is_difference]
    values = np.cumsum((zigzag >> 1) ^ -(zigzag & 1)).astype(np.uint16)  # modulo 65536, as the encoder's differences
    if not values.all():
        raise MessageError("the RVL is broken: a run of depth holds 0")
    image = np.zeros(width * height, np.uint16)
    image[filled] = values
    return image.reshape(height, width)


def _numbers(words: ByteArray) -> NDArray[np.int64]:
    """The numbers that the nibbles spell."""
    high_first = words.reshape(-1, 4)[:, ::-1].reshape(-1)  # words are little endian
    nibbles = np.empty(2 * len(high_first), np.int64)
    nibbles[::2], nibbles[1::2] = high_first >> 4, high_first & 15
    last = np.flatnonzero(nibbles < 8)
    if len(last) == 0:
        return np.empty(0, np.int64)
    first = np.concatenate([[0], last[:-1] + 1])
    lengths = last - first + 1
    if lengths.max() > MOST_NIBBLES:
        raise MessageError("the RVL is broken: a number without end")
    place = np.arange(last[-1] + 1) - np.repeat(first, lengths)
    return np.asarray(np.add.reduceat((nibbles[: last[-1] + 1] & 7) << 3 * place, first))


def _runs(numbers: list[Any], pixels: int) -> tuple[NDArray[np.bool_], list[int]]:
    """Which of the numbers are differences, and the lengths of the runs, of zeros and of others in turn."""
    runs: list[int] = []
    heads: list[int] = []
    at = done = 0
    while done < pixels:
        if at + 2 > len(numbers):
            raise MessageError("the RVL is cut off")
        zeros, others = numbers[at], numbers[at + 1]
        done += zeros + others
        if done > pixels or zeros + others == 0:
            raise MessageError("the RVL is broken: its runs are not those of the image")
        runs += (zeros, others)
        heads.append(at)
        at += 2 + others
    if at > len(numbers):
        raise MessageError("the RVL is cut off")
    is_difference = np.ones(at, np.bool_)
    is_difference[heads] = False
    is_difference[[head + 1 for head in heads]] = False
    return is_difference, runs
