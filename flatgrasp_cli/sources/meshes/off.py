"""Geomview's Object File Format, OFF, in text."""

from __future__ import annotations

import re
from array import array
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.meshes.mesh import Polygons
from flatgrasp_cli.sources.meshes.text import floats, integers, malformed, words_of

BEGINNING = re.compile(rb"(\s|#[^\r\n]*[\r\n])*(ST)?C?N?OFF(?=\s|\d)")
MAGIC = re.compile(rb"(ST)?C?N?OFF")


def is_off(head: bytes) -> bool:
    """Whether a file that begins so is an OFF file of points in three dimensions."""
    return BEGINNING.match(head) is not None


def read_off(file: BinaryIO, name: str) -> Polygons:
    """Read the surface of an OFF file, or its vertices if it has no faces.

    The counts may follow the magic on its line, even without a space, as in files of ModelNet.
    """
    lines = words_of(file)
    number, words = next(lines)
    counts = [word for word in (MAGIC.sub(b"", words[0], count=1), *words[1:]) if word]
    if [word.upper() for word in counts] == [b"BINARY"]:
        raise SourceError(f"{name}: is a binary OFF file; save it as text")
    line = (number, counts) if counts else next(lines, (number, []))
    n_vertices, n_faces = (*integers(line[1][:2], line, name), -1, -1)[:2]
    if min(n_vertices, n_faces) < 0:
        raise malformed(line, name)
    coordinates, corners, sizes = array("d"), array("q"), array("q")
    for line in lines:
        if len(coordinates) < 3 * n_vertices:
            if len(line[1]) < 3:
                raise malformed(line, name)
            coordinates.extend(floats(line[1][:3], line, name))
        elif len(sizes) < n_faces:
            (size,) = integers(line[1][:1], line, name)
            indices = integers(line[1][1 : 1 + max(size, 0)], line, name)  # colours may follow
            if len(indices) != size:
                raise malformed(line, name)
            corners.extend(indices)
            sizes.append(size)
    vertices = np.array(coordinates, dtype=np.float64).reshape(-1, 3)
    if (len(vertices), len(sizes)) != (n_vertices, n_faces):
        raise SourceError(
            f"{name}: the header declares {n_vertices} vertices and {n_faces} faces, the file has {len(vertices)} and "
            f"{len(sizes)}; it is truncated"
        )
    return Polygons(vertices, np.array(corners, dtype=np.int64), np.array(sizes, dtype=np.intp))
