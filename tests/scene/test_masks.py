"""The extent of what a mask marks."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.geometry.polygon import signed_area
from flatgrasp_cli.scene.masks import hull_of, span_of


def test_the_hull_goes_around_the_middles_of_the_outermost_cells() -> None:
    mask = np.zeros((9, 7), dtype=np.bool_)
    mask[[1, 1, 4, 6, 3], [2, 5, 3, 2, 2]] = True
    assert sorted(hull_of(mask).tolist()) == [[1, 2], [1, 5], [6, 2]]
    assert signed_area(hull_of(mask)) == 0.5 * 3 * 5
    assert span_of(mask).tolist() == [5, 3]


@pytest.mark.parametrize("cells", [0, 1, 4])
def test_cells_on_a_line_have_none(cells: int) -> None:
    mask = np.arange(9) < cells * np.ones((1, 1))
    assert hull_of(mask).shape == (0, 2)
