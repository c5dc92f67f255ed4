"""Plates as point clouds in PCD files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray


def slab(width_mm: float, height_mm: float, thickness_mm: float = 10, points: int = 6000) -> FloatArray:
    """Random points (n, 3) in metres of a rectangular plate, and its corners."""
    rng = np.random.default_rng(5)
    half = 5e-4 * np.array([width_mm, height_mm, thickness_mm])
    corners = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), axis=-1).reshape(-1, 3)
    return np.vstack([rng.uniform(-half, half, (points, 3)), corners * half])


def write_pcd(path: Path, points: FloatArray, above: float = 1.0) -> Path:
    """Write points as a binary PCD file, seen from a metre above."""
    path.parent.mkdir(parents=True, exist_ok=True)
    header = (
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 {above} 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())
    return path
