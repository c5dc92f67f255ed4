"""The pieces of a mask that are broad somewhere."""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray
from flatgrasp_cli.kernels.flood import holding


def broad_pieces(mask: ByteArray, width: int) -> BoolArray:
    """The connected pieces (rows, columns) of a mask that hold a square of `width` cells, an odd number, whole."""
    count, labels = cv2.connectedComponents(mask, connectivity=8)
    core = cv2.erode(mask, np.ones((width, width), np.uint8))
    return holding(labels, core, count)
