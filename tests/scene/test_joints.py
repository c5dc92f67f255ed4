"""Which pieces hold together, by images of heights that are known to the millimetre."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.scene.parting.joints import held_together
from flatgrasp_cli.scene.parting.view_grid import ViewGrid
from tests.conftest import MM

SIDE = 20
"""Of the two pieces of an image, in cells."""
LEAST_M, DROP_M = 12 * MM, 5 * MM


def side_by_side(height: FloatArray, beside_mm: float, nearer: int = 0) -> tuple[ViewGrid, IntArray]:
    """An image from straight above of a piece with that `height` (20, 20), and of a level one to its right.

    So many cells along its upper side show something that is 20 cm nearer.
    """
    heights, names = np.full((2 * SIDE, 3 * SIDE), np.nan), np.zeros((2 * SIDE, 3 * SIDE), dtype=np.intp)
    left, right = (slice(SIDE // 2, SIDE // 2 + SIDE),) * 2, (slice(SIDE // 2, SIDE // 2 + SIDE), slice(30, 50))
    heights[left], heights[right] = height, beside_mm * MM
    names[left], names[right] = 1, 2
    heights[SIDE // 2 - 1, SIDE // 2 : SIDE // 2 + nearer] = 300 * MM
    names[SIDE // 2 - 1, SIDE // 2 : SIDE // 2 + nearer] = 3
    rows, columns = np.indices(heights.shape) * MM
    grid = ViewGrid(
        x=rows,
        y=columns,
        depth=1.0 - heights,
        height=heights,
        known=np.isfinite(heights),
        cell=np.arange(heights.size),
        point_depth=1.0 - heights.ravel(),
        cell_m=1 * MM,
        jump_m=10 * MM,
    )
    return grid, names


@pytest.mark.parametrize(("odd_share", "lies_on_it"), [(0.04, True), (0.06, False)])
def test_a_twentieth_of_a_piece_may_be_what_is_behind_it(odd_share: float, lies_on_it: bool) -> None:
    """A piece 100 mm up lies on what is 98 mm high beside it, but hangs from that if it goes down to 80 mm itself."""
    height = np.full((SIDE, SIDE), 100 * MM)
    height.T.flat[: round(odd_share * height.size)] = 80 * MM
    grid, names = side_by_side(height, beside_mm=98)
    found = held_together(grid, names, LEAST_M, DROP_M)
    assert (len(np.unique(found[grid.known])) == 2) == lies_on_it


@pytest.mark.parametrize(("nearer", "hangs"), [(4, True), (16, False)])
def test_a_piece_hangs_if_nine_tenths_of_its_edge_were_seen(nearer: int, hangs: bool) -> None:
    """Of 80 steps out of a piece that ends 80 mm up, beside one of 88 mm, some lead to what hides its edge."""
    grid, names = side_by_side(np.full((SIDE, SIDE), 80 * MM), beside_mm=88, nearer=nearer)
    found = held_together(grid, names, LEAST_M, DROP_M)
    one, other = found[SIDE, SIDE // 2 + 1], found[SIDE, 30 + 1]
    assert (one == other) == hangs
