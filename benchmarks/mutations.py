"""Ways to damage a file that keep enough of it to get past the first check."""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Callable

NUMBERS = (
    *("0", "-0.0", "1", "-1", "255", "65536", "2147483647", "4294967295", "-9223372036854775808", "1e-100", "1e-310"),
    *("1e9", "1e30", "1e308", "1e400", "nan", "-inf", ".nan", "NaN", "true", "null", "''", "[]", "0x10", "9" * 5000),
)
NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")


def mutant(seeds: tuple[bytes, ...], *, text: bool, rng: random.Random) -> bytes:
    """One of the seeds with one to four mutations."""
    data = bytearray(rng.choice(seeds))
    ways = (number_swapped, number_swapped, line_moved, spliced, cut) if text else WAYS
    for _ in range(rng.choice((1, 1, 2, 4))):
        rng.choice(ways)(data, rng, seeds)
    return bytes(data)


def bits_flipped(data: bytearray, rng: random.Random, _seeds: tuple[bytes, ...]) -> None:
    """Up to sixteen bits."""
    for _ in range(min(len(data), rng.randint(1, 16))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def cut(data: bytearray, rng: random.Random, _seeds: tuple[bytes, ...]) -> None:
    """The end is missing."""
    del data[rng.randrange(len(data) + 1) :]


def spliced(data: bytearray, rng: random.Random, seeds: tuple[bytes, ...]) -> None:
    """A piece of a seed in place of another."""
    other = rng.choice(seeds)
    begin, size = rng.randrange(len(other)), rng.randint(1, 200)
    at = rng.randrange(len(data) + 1)
    data[at : at + rng.choice((0, size))] = other[begin : begin + size]


def number_swapped(data: bytearray, rng: random.Random, _seeds: tuple[bytes, ...]) -> None:
    """A number in the first four thousand bytes is another one."""
    places = list(NUMBER.finditer(bytes(data[:4000])))
    if places:
        place = rng.choice(places)
        data[place.start() : place.end()] = rng.choice(NUMBERS).encode()


def word_swapped(data: bytearray, rng: random.Random, _seeds: tuple[bytes, ...]) -> None:
    """Four or eight bytes are an extreme number."""
    word = rng.choice((b"\xff" * 4, b"\xff" * 8, b"\x00" * 8, struct.pack("<i", 2**31 - 1), struct.pack("<f", 1e38)))
    at = rng.randrange(len(data) + 1)
    data[at : at + len(word)] = word


def line_moved(data: bytearray, rng: random.Random, _seeds: tuple[bytes, ...]) -> None:
    """One of the first lines is elsewhere, or twice."""
    lines = bytes(data).split(b"\n")
    few = min(len(lines), 100)
    line = lines[rng.randrange(few)]
    if rng.random() < 0.5:
        lines.remove(line)
    lines.insert(rng.randrange(few), line)
    data[:] = b"\n".join(lines)


WAYS: tuple[Callable[[bytearray, random.Random, tuple[bytes, ...]], None], ...] = (
    *(bits_flipped, cut, spliced, number_swapped, word_swapped, line_moved),
)
