"""The two base frames of a UR arm."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray

HALF_TURN = np.array([-1.0, -1.0, 1.0])


def in_dh_base(base_frame: str, vectors: FloatArray) -> FloatArray:
    """Points, directions or the rows of axes (..., 3), given in `base_frame`, in the Denavit–Hartenberg base.

    The controller's `base` is that base; ROS's `base_link` is turned by 180° about z against it. A half turn undoes
    itself, so the same call turns vectors of the Denavit–Hartenberg base back into `base_frame`.
    """
    return vectors if base_frame == "base" else np.asarray(vectors * HALF_TURN)
