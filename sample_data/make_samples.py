"""Makes the clouds of this folder: the solids of `flatgrasp_cli.simulation.samples`, seen by a simulated Asus Xtion.

    python sample_data/make_samples.py [OUT_DIR]

Objects lie on a table (z = 0, metres, true scale). The camera is the Xtion PRO LIVE: 640 × 480, f = 570 px; depth
noise after Nguyen, Izadi & Lovell (3DIMPVT 2012), disparity in eighths of a pixel, dropouts at depth edges and grazing
angles. Only the object's points are kept, in the optical frame (x right, y down, z forward): the viewpoint is the
origin. `pan_on_table.pcd` and `table_scene.pcd`, four objects seen from 40°, keep the table.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from flatgrasp_cli.open3d_door import load_open3d
from flatgrasp_cli.simulation.camera import scene_of
from flatgrasp_cli.simulation.samples import SAMPLES, hammer, juice_box, pan, spray_bottle
from flatgrasp_cli.simulation.solids import Solid, box, rod

Array = NDArray[np.float64]
o3d = load_open3d()

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 570.0, 0.075
DISPARITY_STEP = 1 / 8
EDGE_M, EDGE_DROPOUT, GRAZING_DEG = 0.01, 0.4, 80.0


def moved(solids: Sequence[Solid], x: float, y: float, yaw_deg: float) -> list[Solid]:
    """The solids of one object turned on the table and moved."""
    turn = Rotation.from_euler("z", yaw_deg, degrees=True)
    return [solid.moved(turn, (x, y, 0.0)) for solid in solids]


def table_scene() -> list[Solid]:
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
    solids: Sequence[Solid], pose: Array, rng: np.random.Generator, focal_scale: float = 1.0
) -> tuple[Array, NDArray[np.bool_]]:
    """Organised cloud (h, w, 3) in the optical frame, NaN where nothing returned, and which pixels show the object."""
    width, height, focal = int(WIDTH * focal_scale), int(HEIGHT * focal_scale), FOCAL_PX * focal_scale
    scene = scene_of([solid.surface for solid in (box((2.0, 2.0, 0.02), (0, 0, -0.01)), *solids)])
    intrinsics = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    rays = scene.create_rays_pinhole(o3d.core.Tensor(intrinsics), o3d.core.Tensor(pose), width, height)
    hits = scene.cast_rays(rays)
    depth = hits["t_hit"].numpy().astype(np.float64)  # rays have unit z in the optical frame
    direction = rays.numpy()[..., 3:]
    cosine = np.abs((direction * hits["primitive_normals"].numpy()).sum(-1)) / np.linalg.norm(direction, axis=-1)
    noisy = measured(depth, np.arccos(np.clip(cosine, 0, 1)), focal, rng)
    v, u = np.mgrid[0:height, 0:width]
    x, y = (u - intrinsics[0, 2]) / focal, (v - intrinsics[1, 2]) / focal
    return np.stack([x * noisy, y * noisy, noisy], axis=-1), hits["geometry_ids"].numpy() != 0


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
    for index, (name, sample) in enumerate(SAMPLES.items()):
        rng = np.random.default_rng([2016, index])
        distance = 1.0 if name == "pan" else 0.8
        cloud, is_object = capture(sample.solids(), camera_pose(distance, 15.0, 40.0 * index), rng)
        write(out / f"{name}.pcd", cloud[is_object & np.isfinite(cloud[..., 2])])
    rng = np.random.default_rng([2016, len(SAMPLES)])
    cloud, _ = capture(pan(), camera_pose(0.9, 20.0, 60.0), rng, focal_scale=0.5)  # the sensor's QVGA mode
    middle = cloud[60:180, 80:240].reshape(-1, 3)
    write(out / "pan_on_table.pcd", middle[np.isfinite(middle[:, 2])])
    cloud, _ = capture(table_scene(), camera_pose(0.9, 40.0, 100.0), rng, focal_scale=0.5)
    middle = cloud[40:210, 40:290].reshape(-1, 3)
    write(out / "table_scene.pcd", middle[np.isfinite(middle[:, 2])])


if __name__ == "__main__":
    main()
