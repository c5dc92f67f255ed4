"""Points that were measured, and what is asked of all of them again and again."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.sampling import even_sample


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Points (n, 3) that are known to have been measured, all of them within a box with the `corners` (2, 3).

    `samples` are those that were taken of them, by size.
    """

    points: FloatArray
    corners: FloatArray
    samples: dict[int, FloatArray] = field(default_factory=dict)

    def sample(self, size: int) -> FloatArray:
        """An even sample (min(size, n), 3) of the points, which is taken once."""
        if size not in self.samples:
            self.samples[size] = even_sample(self.points, size)
            self.samples[size].flags.writeable = False
        return self.samples[size]


UNKNOWN = Measured(np.empty((0, 3)), np.array([[np.inf] * 3, [-np.inf] * 3]))
"""What is known of points that nobody looked through."""
