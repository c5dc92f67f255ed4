"""The Asus Xtion PRO LIVE: depth images by ray casting, with its noise.

The noise is that measured by Nguyen, Izadi & Lovell (3DIMPVT 2012): along the ray it grows with distance and with the
angle to the surface, across it is some 0.8 pixels; disparity comes in eighths of a pixel (Khoshelham & Elberink 2012).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.simulation.solids import Mesh

ACROSS_PX = 0.8
"""How far a pixel's ray scatters across, pixels."""
DISPARITY_STEP_PX = 1 / 8
EDGE_M, EDGE_DROPOUT = 0.01, 0.4
"""Where depth jumps by more, part of the pixels see two surfaces and give nothing."""
GRAZING_DEG = 80.0
"""A surface met at a larger angle to its normal sends too little of the pattern back."""


@dataclass(frozen=True, slots=True)
class DepthCamera:
    """A depth camera: its image's width and height, focal length and centre in pixels, its baseline in metres."""

    width: int = 640
    height: int = 480
    focal_px: float = 570.34
    center_px: tuple[float, float] = (314.5, 235.5)
    baseline_m: float = 0.075

    def directions(self, scatter: FloatArray | None = None) -> FloatArray:
        """Directions (h, w, 3) of the pixels' rays, of unit z; each off by its scatter (h, w, 2) in pixels."""
        v, u = np.mgrid[0 : self.height, 0 : self.width].astype(np.float64)
        if scatter is not None:
            u, v = u + scatter[..., 0], v + scatter[..., 1]
        x, y = (u - self.center_px[0]) / self.focal_px, (v - self.center_px[1]) / self.focal_px
        return np.stack([x, y, np.ones_like(x)], axis=-1)


XTION = DepthCamera()


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """What rays meet: `depth` in units of their direction, infinite for none, and the `cosine` to the normal."""

    depth: FloatArray
    cosine: FloatArray


def scene_of(meshes: Sequence[Mesh]) -> Any:
    """Open3D's ray casting scene of meshes in the world, which it numbers in their order."""
    o3d = load_open3d()
    scene = o3d.t.geometry.RaycastingScene()
    for mesh in meshes:
        vertices, faces = mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)
        scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))
    return scene


def cast(scene: Any, at: Frame, directions: FloatArray) -> Hits:
    """What rays (…, 3) in the frame `at`, from its origin, meet in a scene."""
    turned = directions @ at.axes
    rays = np.concatenate([np.broadcast_to(at.origin, turned.shape), turned], axis=-1).astype(np.float32)
    found = scene.cast_rays(load_open3d().core.Tensor(rays))
    normals = found["primitive_normals"].numpy()
    cosine = np.abs((turned * normals).sum(axis=-1)) / np.linalg.norm(turned, axis=-1)
    depth = found["t_hit"].numpy().astype(np.float64)
    return Hits(depth, np.clip(cosine, 0.0, 1.0))


def seen(scene: Any, at: Frame, rng: np.random.Generator, camera: DepthCamera = XTION) -> FloatArray:
    """The organised cloud (h, w, 3) in the optical frame of a camera with the pose `at`; NaN where it sees nothing."""
    scatter = ACROSS_PX * rng.normal(size=(camera.height, camera.width, 2))
    hits = cast(scene, at, camera.directions(scatter))
    return camera.directions() * measured(hits, camera, rng)[..., None]


def measured(hits: Hits, camera: DepthCamera, rng: np.random.Generator) -> FloatArray:
    """What the sensor makes of true depths (h, w); NaN where it measures none."""
    depth, angle = hits.depth, np.arccos(hits.cosine)
    lost = ~np.isfinite(depth) | (angle > np.radians(GRAZING_DEG))
    lost |= _edges(depth) & (rng.random(depth.shape) < EDGE_DROPOUT)
    with np.errstate(invalid="ignore", divide="ignore"):  # of what is lost anyway
        noisy = depth + axial_sigma_m(depth, np.minimum(angle, np.radians(GRAZING_DEG))) * rng.normal(size=depth.shape)
        steps = camera.focal_px * camera.baseline_m / DISPARITY_STEP_PX
        return np.where(lost, np.nan, steps / np.round(steps / noisy))


def axial_sigma_m(depth: FloatArray, angle_rad: FloatArray) -> FloatArray:
    """Nguyen's standard deviation along the ray, in metres, at a depth in metres and an angle to the normal."""
    square = angle_rad**2 / (np.pi / 2 - angle_rad) ** 2
    return np.asarray(0.0012 + 0.0019 * (depth - 0.4) ** 2 + 0.0001 / np.sqrt(depth) * square)


def _edges(depth: FloatArray) -> BoolArray:
    """Pixels (h, w) beside a jump in depth."""
    near = np.where(np.isfinite(depth), depth, 1e3)
    edge = np.zeros(depth.shape, dtype=np.bool_)
    rows, columns = np.abs(np.diff(near, axis=0)) > EDGE_M, np.abs(np.diff(near, axis=1)) > EDGE_M
    edge[1:] |= rows
    edge[:-1] |= rows
    edge[:, 1:] |= columns
    edge[:, :-1] |= columns
    return edge
