"""The centre of projection of an organised cloud: its pixels and points tell where the camera was, in any frame.

A pinhole camera maps points X to pixels x by a matrix P (3, 4): x ~ P (X, 1). Each point gives two linear equations for
P (the direct linear transform; Hartley & Zisserman, Multiple View Geometry, 2nd ed., §7.1), and the centre is what P
maps to nothing. Noise of the depth lies along the rays, so it changes neither P nor the centre.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import spread_indices
from flatgrasp_cli.model import ImageGrid

SAMPLE = 600
"""Points that the equations are made of, spread over the image; half of them check the other half."""
LEAST = 60
MOST_OFF_PX = 1.0
"""Root mean square of the distance between pixels and reprojected points: merged or re-ordered clouds have far more."""
MOST_APART_SHARE = 0.02
"""The two halves' centres agree within this share of the distance to the points: 2 cm at 1 m."""


def center_of_projection(points: FloatArray, pixels: ImageGrid, rng: np.random.Generator) -> FloatArray | None:
    """Where the camera (3,) was that saw `points` (n, 3) in `pixels`; None if no one pinhole camera saw them so."""
    if len(points) < LEAST:
        return None
    chosen = rng.permutation(spread_indices(len(points), SAMPLE))
    rows, columns = np.divmod(np.flatnonzero(pixels.filled)[chosen], pixels.shape[1])
    image, seen = np.column_stack([columns, rows]).astype(np.float64), points[chosen]
    half = len(chosen) // 2
    one = _camera(seen[:half], image[:half], seen[half:], image[half:])
    other = _camera(seen[half:], image[half:], seen[:half], image[:half])
    if one is None or other is None:
        return None
    center = 0.5 * (one + other)
    distance = float(np.median(np.linalg.norm(seen - center, axis=1)))
    return center if np.linalg.norm(one - other) < MOST_APART_SHARE * distance else None


def _camera(points: FloatArray, image: FloatArray, tested: FloatArray, tested_image: FloatArray) -> FloatArray | None:
    """The centre (3,) of the camera that maps `points` to `image`, if it maps the `tested` ones right, too."""
    middle, spread = points.mean(axis=0), points.std()
    if spread == 0:
        return None
    center_px, spread_px = image.mean(axis=0), image.std()
    near = np.column_stack([(points - middle) / spread, np.ones(len(points))])
    u, v = ((image - center_px) / spread_px).T
    nothing = np.zeros_like(near)
    equations = np.concatenate(
        [np.hstack([near, nothing, -u[:, None] * near]), np.hstack([nothing, near, -v[:, None] * near])]
    )
    matrix = np.linalg.svd(equations, full_matrices=False)[2][-1].reshape(3, 4)
    x, y, depth = matrix @ np.column_stack([(tested - middle) / spread, np.ones(len(tested))]).T
    if not (depth.min() > 0 or depth.max() < 0):  # some would lie behind the camera
        return None
    off = spread_px * np.column_stack([x / depth, y / depth]) + center_px - tested_image
    if not np.sqrt((off**2).sum(axis=1).mean()) < MOST_OFF_PX:
        return None
    place = np.linalg.svd(matrix)[2][-1]
    if abs(place[3]) < 1e-9 * np.linalg.norm(place):
        return None  # a parallel projection has no centre
    return np.asarray(middle + spread * place[:3] / place[3])
