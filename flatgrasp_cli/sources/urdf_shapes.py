"""The shapes of a URDF's links as points of their surfaces: boxes, cylinders, spheres and meshes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles.urdf import Urdf, three_of

APART_M = 0.002
"""How far points of a surface lie apart at most."""
ROUND = 48
"""Points around a cylinder; a sphere has as many times a half."""


def points_of(urdf: Urdf, link: str) -> FloatArray:
    """Points (n, 3) on a link's shapes in its own frame: those that collide, or else those that are seen.

    Raises
    ------
    ProfileError
        If a shape cannot be read.
    """
    element = urdf.links[link]
    shapes = element.findall("collision") or element.findall("visual")
    found = [_placed(urdf, link, each) for each in shapes]
    return np.vstack([np.empty((0, 3)), *found])


def _placed(urdf: Urdf, link: str, shape: Element) -> FloatArray:
    origin, geometry = shape.find("origin"), shape.find("geometry")
    try:
        turn, place = Rotation.from_euler("xyz", three_of(origin, "rpy")), np.array(three_of(origin, "xyz"))
        found = [points for each in (geometry if geometry is not None else ()) for points in _points(urdf, each)]
    except ValueError as error:
        raise ProfileError(f"{urdf.path}: link {link!r}: a shape: {error}") from error
    return np.vstack([np.empty((0, 3)), *(turn.apply(points) + place for points in found)])


def _points(urdf: Urdf, shape: Element) -> Iterator[FloatArray]:
    if shape.tag == "box":
        yield _box(np.array([float(each) for each in shape.get("size", "").split()]))
    elif shape.tag == "cylinder":
        yield _cylinder(float(shape.get("radius", "")), float(shape.get("length", "")))
    elif shape.tag == "sphere":
        yield _sphere(float(shape.get("radius", "")))
    elif shape.tag == "mesh":
        scale = np.array([float(each) for each in shape.get("scale", "1 1 1").split()])
        yield _mesh(urdf, shape.get("filename", ""), scale)


def _box(size: FloatArray) -> FloatArray:
    if size.shape != (3,):
        raise ValueError("a box has three sizes")
    counts = np.maximum(np.ceil(size / APART_M).astype(int), 1) + 1
    counts = np.minimum(counts, 200)
    sides = [np.linspace(-0.5 * side, 0.5 * side, count) for side, count in zip(size, counts, strict=True)]
    grid = np.stack(np.meshgrid(*(side[[0, -1]] for side in sides), indexing="ij"), axis=-1).reshape(-1, 3)
    faces = [grid]
    for axis in range(3):
        others = [sides[k] if k != axis else sides[k][[0, -1]] for k in range(3)]
        faces.append(np.stack(np.meshgrid(*others, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.vstack(faces)


def _cylinder(radius: float, length: float) -> FloatArray:
    around = 2 * np.pi * np.arange(ROUND) / ROUND
    along = np.linspace(-0.5 * length, 0.5 * length, min(int(length / APART_M), 200) + 2)
    angle, z = (each.ravel() for each in np.meshgrid(around, along))
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def _sphere(radius: float) -> FloatArray:
    around, down = 2 * np.pi * np.arange(ROUND) / ROUND, np.pi * np.arange(ROUND // 2 + 1) / (ROUND // 2)
    a, b = (each.ravel() for each in np.meshgrid(around, down))
    return radius * np.column_stack([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), np.cos(b)])


def _mesh(urdf: Urdf, name: str, scale: FloatArray) -> FloatArray:
    """Vertices of a mesh, and points on its larger triangles."""
    from flatgrasp_cli.errors import SourceError
    from flatgrasp_cli.sources.files import read_surface

    path = _file(urdf, name)
    try:
        vertices, triangles = read_surface(path, str(path))
    except SourceError as error:
        raise ProfileError(f"{urdf.path}: {error}") from error
    vertices = vertices * scale
    corners = vertices[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    found = [vertices]
    for parts in range(2, 21):  # a triangle of four centimetres or more gets no more
        mine = corners[np.clip(np.ceil(longest / APART_M), 1, 20) == parts]
        a, b = (each.ravel() for each in np.meshgrid(*[np.arange(parts + 1) / parts] * 2))
        inside = a + b <= 1 + 1e-9
        weights = np.column_stack([1 - a - b, a, b])[inside]
        found.append((weights @ mine).reshape(-1, 3))
    return np.vstack(found)


def _file(urdf: Urdf, name: str) -> Path:
    """A mesh's file: `package://NAME/…` is looked for in the folders above the URDF."""
    relative = name.removeprefix("file://")
    if not name.startswith("package://"):
        path = urdf.path.parent / relative
        if path.is_file():
            return path
        raise ProfileError(f"{urdf.path}: mesh {name}: there is no such file")
    whole = name.removeprefix("package://")
    within = whole.partition("/")[2]
    for folder in urdf.path.resolve().parents:
        for place in (folder / whole, folder / within):
            if place.is_file():
                return place
    raise ProfileError(f"{urdf.path}: mesh {name}: not found in the folders above the URDF; put its package there")
