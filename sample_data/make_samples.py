"""Makes the clouds of this folder: the paper's objects, modelled from primitives and seen by a simulated Asus Xtion.

    python sample_data/make_samples.py [OUT_DIR]

Objects lie on a table (z = 0, metres, true scale). The camera is the Xtion PRO LIVE: 640 × 480, f = 570 px; depth
noise after Nguyen, Izadi & Lovell (3DIMPVT 2012), disparity in eighths of a pixel, dropouts at depth edges and grazing
angles. Only the object's points are kept, in the optical frame (x right, y down, z forward): the viewpoint is the
origin. `pan_on_table.pcd` and `table_scene.pcd`, four objects seen from 40°, keep the table.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.open3d_door import load_open3d

Array = NDArray[np.float64]
o3d = load_open3d()

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 570.0, 0.075
DISPARITY_STEP = 1 / 8
EDGE_M, EDGE_DROPOUT, GRAZING_DEG = 0.01, 0.4, 80.0


# --- primitives, placed with their axis along x, y or z ---------------------------------------------------------------


def placed(mesh: Any, at: tuple[float, float, float], turn_deg: tuple[float, float, float] = (0, 0, 0)) -> Any:
    """The mesh turned about x, y, z and moved."""
    rotation = o3d.geometry.get_rotation_matrix_from_xyz(np.radians(turn_deg))
    return mesh.rotate(rotation, center=(0, 0, 0)).translate(at)


def box(size: tuple[float, float, float], at: tuple[float, float, float], yaw_deg: float = 0) -> Any:
    """A box around `at`."""
    mesh = o3d.geometry.TriangleMesh.create_box(*size).translate([-s / 2 for s in size])
    return placed(mesh, at, (0, 0, yaw_deg))


def ellipsoid(radii: tuple[float, float, float], at: tuple[float, float, float], yaw_deg: float = 0) -> Any:
    """An ellipsoid around `at`."""
    mesh = o3d.geometry.TriangleMesh.create_sphere(1.0, 40)
    mesh.vertices = o3d.utility.Vector3dVector(np.asarray(mesh.vertices) * radii)
    return placed(mesh, at, (0, 0, yaw_deg))


def rod(
    radius: float,
    length: float,
    at: tuple[float, float, float],
    yaw_deg: float = 0,
    flat: float = 1.0,
) -> Any:
    """A cylinder lying along x, turned by yaw; `flat` scales its height."""
    mesh = placed(o3d.geometry.TriangleMesh.create_cylinder(radius, length, 40), (0, 0, 0), (0, 90, 0))
    mesh.vertices = o3d.utility.Vector3dVector(np.asarray(mesh.vertices) * (1, 1, flat))
    return placed(mesh, at, (0, 0, yaw_deg))


def ring(radius: float, thickness: float, at: tuple[float, float, float]) -> Any:
    """A torus lying flat: `radius` to the middle of its tube."""
    return placed(o3d.geometry.TriangleMesh.create_torus(radius, thickness, 60, 20), at)


def lathe(
    profile: list[tuple[float, float]], at: tuple[float, float, float], turn_deg: tuple[float, float, float]
) -> Any:
    """The surface that a profile of (radius, height) points sweeps around z."""
    segments = 60
    angles = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    rings = [np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(segments, h)]) for r, h in profile]
    a, b = np.arange(segments), (np.arange(segments) + 1) % segments
    quads = [
        np.column_stack([k + a, k + b, k + segments + b, k + segments + a])
        for k in range(0, segments * (len(profile) - 1), segments)
    ]
    faces = np.vstack([np.vstack([q[:, [0, 1, 2]], q[:, [0, 2, 3]]]) for q in quads])
    mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(np.vstack(rings)), o3d.utility.Vector3iVector(faces))
    return placed(mesh, at, turn_deg)


# --- the paper's objects ----------------------------------------------------------------------------------------------


def teddy_bear() -> list[Any]:
    """A bear 26 cm tall on its back."""
    return [
        ellipsoid((0.048, 0.058, 0.035), (0, 0, 0.035)),
        ellipsoid((0.040, 0.037, 0.034), (0, 0.085, 0.034)),
        ellipsoid((0.016, 0.014, 0.009), (0, 0.080, 0.068)),
        *(ellipsoid((0.015, 0.015, 0.010), (s * 0.032, 0.116, 0.034)) for s in (-1, 1)),
        *(ellipsoid((0.045, 0.017, 0.017), (s * 0.070, 0.030, 0.030), s * 20) for s in (-1, 1)),
        *(ellipsoid((0.020, 0.052, 0.020), (s * 0.036, -0.085, 0.026), s * 14) for s in (-1, 1)),
    ]


def electric_drill() -> list[Any]:
    """A cordless drill on its side."""
    return [
        rod(0.029, 0.150, (0, 0, 0.030)),
        rod(0.021, 0.030, (0.090, 0, 0.030)),
        rod(0.014, 0.030, (0.118, 0, 0.030)),
        rod(0.003, 0.060, (0.160, 0, 0.030)),
        box((0.040, 0.125, 0.034), (-0.040, -0.075, 0.030), -10),
        box((0.090, 0.045, 0.058), (-0.040, -0.150, 0.030), 0),
    ]


def pistol() -> list[Any]:
    """A pistol on its side, with a trigger guard."""
    return [
        box((0.190, 0.030, 0.026), (0, 0, 0.015)),
        box((0.120, 0.020, 0.022), (0.030, -0.020, 0.015)),
        box((0.044, 0.105, 0.028), (-0.075, -0.060, 0.015), -14),
        ring(0.020, 0.004, (-0.022, -0.045, 0.015)),
        box((0.006, 0.020, 0.006), (-0.022, -0.036, 0.015), 15),
    ]


def spray_bottle() -> list[Any]:
    """A trigger spray bottle on its side."""
    body = [(0.0, 0.0), (0.034, 0.0), (0.036, 0.005), (0.036, 0.110), (0.030, 0.130), (0.014, 0.150), (0.013, 0.170)]
    return [
        lathe(body, (-0.090, 0, 0.036), (0, 90, 0)),
        box((0.030, 0.030, 0.028), (0.093, 0, 0.036)),
        box((0.026, 0.085, 0.026), (0.118, -0.015, 0.036)),
        rod(0.008, 0.016, (0.118, -0.062, 0.036), 90),
        box((0.050, 0.010, 0.014), (0.085, -0.040, 0.036), 25),
    ]


def pan() -> list[Any]:
    """A frying pan of 20 cm with a hanging hole in its handle."""
    wall = [(0.0, 0.004), (0.080, 0.004), (0.097, 0.040), (0.100, 0.040), (0.083, 0.0), (0.0, 0.0)]
    return [
        lathe(wall, (0, 0, 0), (0, 0, 0)),
        box((0.130, 0.024, 0.012), (0.160, 0, 0.036)),
        ring(0.018, 0.007, (0.243, 0, 0.036)),
    ]


def hammer() -> list[Any]:
    """A claw hammer."""
    return [
        rod(0.016, 0.250, (-0.020, 0, 0.014), 0, 0.8),
        box((0.030, 0.070, 0.028), (0.115, 0.005, 0.014)),
        rod(0.015, 0.030, (0.115, -0.045, 0.015), 90),
        *(box((0.011, 0.055, 0.016), (0.115 + s * 0.010, 0.063, 0.014), s * 8) for s in (-1, 1)),
    ]


def juice_box() -> list[Any]:
    """A 0.2 l juice box with its straw."""
    return [box((0.118, 0.048, 0.038), (0, 0, 0.019)), rod(0.003, 0.045, (0.070, 0.012, 0.030), 20)]


OBJECTS: dict[str, Callable[[], list[Any]]] = {
    make.__name__: make for make in (teddy_bear, electric_drill, pistol, spray_bottle, pan, hammer, juice_box)
}


def moved(meshes: list[Any], x: float, y: float, yaw_deg: float) -> list[Any]:
    """The meshes of one object turned on the table and moved."""
    rotation = o3d.geometry.get_rotation_matrix_from_xyz((0.0, 0.0, np.radians(yaw_deg)))
    return [mesh.rotate(rotation, center=(0, 0, 0)).translate((x, y, 0.0)) for mesh in meshes]


def table_scene() -> list[Any]:
    """Hammer, juice box, spray bottle and a pen of 8 mm, apart from each other."""
    pen = [rod(0.004, 0.14, (0, 0, 0.004))]
    return [
        *moved(hammer(), 0.02, 0.14, 10),
        *moved(juice_box(), -0.16, -0.02, 30),
        *moved(spray_bottle(), 0.06, -0.10, 100),
        *moved(pen, -0.03, 0.0, -50),
    ]


# --- the camera -------------------------------------------------------------------------------------------------------


def camera_pose(distance_m: float, tilt_deg: float, azimuth_deg: float) -> Array:
    """World-to-camera matrix of a camera that looks at the table's middle."""
    tilt, azimuth = np.radians([tilt_deg, azimuth_deg])
    eye = distance_m * np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
    forward = -eye / distance_m
    right = np.cross(forward, [np.sin(azimuth), -np.cos(azimuth), 0.0])
    right = np.cross(forward, right)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, -rotation @ eye
    return matrix


def capture(
    meshes: list[Any], pose: Array, rng: np.random.Generator, focal_scale: float = 1.0
) -> tuple[Array, NDArray[np.bool_]]:
    """Organised cloud (h, w, 3) in the optical frame, NaN where nothing returned, and which pixels show the object."""
    width, height, focal = int(WIDTH * focal_scale), int(HEIGHT * focal_scale), FOCAL_PX * focal_scale
    scene = o3d.t.geometry.RaycastingScene()
    table = box((2.0, 2.0, 0.02), (0, 0, -0.01))
    ids = [scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(mesh)) for mesh in (table, *meshes)]
    intrinsics = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    rays = scene.create_rays_pinhole(o3d.core.Tensor(intrinsics), o3d.core.Tensor(pose), width, height)
    hits = scene.cast_rays(rays)
    depth = hits["t_hit"].numpy().astype(np.float64)  # rays have unit z in the optical frame
    direction = rays.numpy()[..., 3:]
    cosine = np.abs((direction * hits["primitive_normals"].numpy()).sum(-1)) / np.linalg.norm(direction, axis=-1)
    noisy = measured(depth, np.arccos(np.clip(cosine, 0, 1)), focal, rng)
    v, u = np.mgrid[0:height, 0:width]
    x, y = (u - intrinsics[0, 2]) / focal, (v - intrinsics[1, 2]) / focal
    return np.stack([x * noisy, y * noisy, noisy], axis=-1), hits["geometry_ids"].numpy() != ids[0]


def measured(depth: Array, angle: Array, focal: float, rng: np.random.Generator) -> Array:
    """What the sensor makes of true depths (h, w) met at `angle` (h, w) to the normal."""
    steep = np.minimum(angle, np.radians(GRAZING_DEG))
    sigma = 0.0012 + 0.0019 * (depth - 0.4) ** 2 + 0.0001 / np.sqrt(depth) * steep**2 / (np.pi / 2 - steep) ** 2
    disparity = focal * BASELINE_M / (depth + 0.5 * sigma * rng.normal(size=depth.shape))
    result = focal * BASELINE_M / (np.round(disparity / DISPARITY_STEP) * DISPARITY_STEP)
    edge = np.zeros(depth.shape, dtype=np.bool_)
    for axis in (0, 1):
        jump = np.abs(np.diff(depth, axis=axis)) > EDGE_M
        edge |= np.pad(jump, [(0, 1) if k == axis else (0, 0) for k in (0, 1)])
        edge |= np.pad(jump, [(1, 0) if k == axis else (0, 0) for k in (0, 1)])
    lost = (edge & (rng.random(depth.shape) < EDGE_DROPOUT)) | (angle > np.radians(GRAZING_DEG)) | ~np.isfinite(depth)
    return np.where(lost, np.nan, result)


def write(path: Path, points: Array) -> None:
    """Write points (n, 3) as a plain binary PCD, which is read without Open3D."""
    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(points.astype(np.float32)))
    o3d.t.io.write_point_cloud(str(path), cloud)
    print(f"{path.name}: {len(points)} points, {path.stat().st_size / 1000:.0f} kB")


def main() -> None:
    """Make every sample."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    out.mkdir(parents=True, exist_ok=True)
    for index, (name, make) in enumerate(OBJECTS.items()):
        rng = np.random.default_rng([2016, index])
        distance = 1.0 if name == "pan" else 0.8
        cloud, is_object = capture(make(), camera_pose(distance, 15.0, 40.0 * index), rng)
        write(out / f"{name}.pcd", cloud[is_object & np.isfinite(cloud[..., 2])])
    rng = np.random.default_rng([2016, len(OBJECTS)])
    cloud, _ = capture(pan(), camera_pose(0.9, 20.0, 60.0), rng, focal_scale=0.5)  # the sensor's QVGA mode
    middle = cloud[60:180, 80:240].reshape(-1, 3)
    write(out / "pan_on_table.pcd", middle[np.isfinite(middle[:, 2])])
    cloud, _ = capture(table_scene(), camera_pose(0.9, 40.0, 100.0), rng, focal_scale=0.5)
    middle = cloud[40:210, 40:290].reshape(-1, 3)
    write(out / "table_scene.pcd", middle[np.isfinite(middle[:, 2])])


if __name__ == "__main__":
    main()
