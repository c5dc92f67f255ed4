"""Wavefront OBJ: vertices and faces. Materials, textures and normals are nothing to a gripper and never looked up."""

from __future__ import annotations

import re
from array import array
from typing import BinaryIO

import numpy as np

from flatgrasp_cli.sources.meshes.mesh import Polygons
from flatgrasp_cli.sources.meshes.text import floats, integers, malformed, words_of

COMMENTS = re.compile(rb"(\s|#[^\r\n]*[\r\n])*")
STATEMENT = re.compile(rb"(mtllib|usemtl|o|g|s|v|vn|vt)[ \t]+\S")
VERTEX = re.compile(rb"(^|[\r\n])[ \t]*v[ \t]+[-+.\d]")


def is_obj(head: bytes) -> bool:
    """Whether a file that begins so is an OBJ file; it has no magic, but begins with one of a few statements."""
    begin = COMMENTS.match(head)
    return begin is not None and bool(STATEMENT.match(head, begin.end())) and bool(VERTEX.search(head))


def read_obj(file: BinaryIO, name: str) -> Polygons:
    """Read the surface of an OBJ file, or its vertices if it has no faces."""
    coordinates, corners, sizes = array("d"), array("q"), array("q")
    for line in words_of(file):
        keyword, *words = line[1]
        if keyword == b"v":
            if len(words) < 3:
                raise malformed(line, name)
            coordinates.extend(floats(words[:3], line, name))
        elif keyword == b"f":
            indices = integers([word.partition(b"/")[0] for word in words], line, name)
            if len(indices) < 3 or 0 in indices:
                raise malformed(line, name)
            count = len(coordinates) // 3  # negative ones count back from the last vertex so far
            corners.extend([index - 1 if index > 0 else max(count + index, -1) for index in indices])
            sizes.append(len(indices))
    vertices = np.array(coordinates, dtype=np.float64).reshape(-1, 3)
    return Polygons(vertices, np.array(corners, dtype=np.int64), np.array(sizes, dtype=np.intp))
