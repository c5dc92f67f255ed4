"""Shaded pictures of a scene by ray casting, which needs neither OpenGL nor a display."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.simulation.camera import scene_of
from flatgrasp_cli.simulation.parts import Kind
from flatgrasp_cli.simulation.solids import Mesh

COLORS = {
    Kind.TABLE: (0.80, 0.77, 0.72),
    Kind.THING: (0.84, 0.37, 0.00),
    Kind.FINGER: (0.18, 0.20, 0.24),
    Kind.PALM: (0.42, 0.46, 0.52),
    Kind.ARM: (0.34, 0.70, 0.91),
    Kind.CAMERA: (0.10, 0.10, 0.10),
}
SKY = (1.0, 1.0, 1.0)
LIGHT = np.array([0.35, -0.25, 0.90]) / np.linalg.norm([0.35, -0.25, 0.90])
"""The way to the light, from above and a little aside, so that shadows show what is up in the air."""
AMBIENT, SHADOW = 0.45, 0.55
"""Light from everywhere as a share of all, and what is left of the rest in a shadow."""
OFF_M = 1e-4
"""How far off its surface a ray to the light begins, or it would meet that."""
FIELD_DEG = 40.0


def picture(meshes: Sequence[Mesh], kinds: Sequence[Kind], eye: Frame, size: tuple[int, int]) -> ByteArray:
    """A picture (h, w, 3) of meshes by what they are; the eye looks along its z axis, with y down; `size` is w, h."""
    scene, (width, height) = scene_of(meshes), size
    focal = 0.5 * min(width, height) / np.tan(np.radians(FIELD_DEG) / 2)
    v, u = np.mgrid[0:height, 0:width].astype(np.float64)
    rays = np.stack([u - 0.5 * (width - 1), v - 0.5 * (height - 1), np.full(u.shape, focal)], axis=-1) @ eye.axes
    found = _cast(scene, np.broadcast_to(eye.origin, rays.shape), rays)
    hit = np.isfinite(found["t_hit"].numpy())
    normals = found["primitive_normals"].numpy().astype(np.float64)
    normals *= -np.sign(np.einsum("...k,...k->...", normals, rays))[..., None]  # toward the eye
    depth = np.where(hit, found["t_hit"].numpy(), 0.0)[..., None]
    dark = _in_shadow(scene, eye.origin + depth * rays + OFF_M * normals)
    lit = np.maximum(normals @ LIGHT, 0.0) * np.where(dark, SHADOW, 1.0)
    colors = np.array([*(COLORS[kind] for kind in kinds), SKY])
    base = colors[np.where(hit, found["geometry_ids"].numpy(), len(kinds)).astype(np.intp)]
    shade = np.where(hit, AMBIENT + (1 - AMBIENT) * lit, 1.0)
    return np.asarray(np.clip(255 * base * shade[..., None], 0, 255)).astype(np.uint8)


def _cast(scene: Any, origins: FloatArray, directions: FloatArray) -> Any:
    rays = np.concatenate([origins, directions], axis=-1).astype(np.float32)
    return scene.cast_rays(load_open3d().core.Tensor(rays))


def _in_shadow(scene: Any, places: FloatArray) -> BoolArray:
    """Whether something is between places (…, 3) and the light."""
    rays = np.concatenate([places, np.broadcast_to(LIGHT, places.shape)], axis=-1).astype(np.float32)
    return np.asarray(scene.test_occlusions(load_open3d().core.Tensor(rays)).numpy())


def eye_on(middle: FloatArray, radius_m: float, azimuth_rad: float, elevation_rad: float) -> Frame:
    """An eye that has a ball in full view, from an azimuth and an elevation; its image is upright."""
    out = np.array([np.cos(azimuth_rad), np.sin(azimuth_rad), 0.0])
    away = np.cos(elevation_rad) * out + np.sin(elevation_rad) * np.array([0.0, 0.0, 1.0])
    distance = radius_m / np.sin(np.radians(FIELD_DEG) / 2)
    right = np.array([-out[1], out[0], 0.0])
    return Frame(middle + distance * away, np.stack([right, np.cross(-away, right), -away]))
