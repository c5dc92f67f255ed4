"""Contact space of two point fingers that open outward, as in a notch or a hole: that of closing, upside down.

Moving both fingers straight apart takes any placement to one on the boundary, or away for good. σ being convex on each
rectangle, the part of it above a level always reaches a corner, so the nodes are pairs of vertices, and two of them
that share a side are joined where the least σ on that side lies above the level. Levels are −σ, so that flooding means
letting the fingers close. Vahedi & van der Stappen ("Caging polygons with two and three fingers", 2008) show that two
fingers at a fixed distance cage an object if and only if they do so closing or opening.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import IntArray, true_entries
from flatgrasp_cli.geometry.polygon import distance_to_segment
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.contact_space import SAME, Caging, Contacts
from flatgrasp_cli.proof.caging.merge_tree import ESCAPE, Landscape, Links, basins, merge_levels


def stretching(boundary: Boundary, told_apart: float) -> Caging:
    """Caging by fingers that open: escape is where one of them finds nothing outward."""
    distance, _ = boundary.feet()
    apart = boundary.start[:, None] - boundary.start
    birth = -np.hypot(apart[..., 0], apart[..., 1])
    land = Landscape(birth, -distance.T, boundary.follow, boundary.back)
    found = basins(land)
    first, second = true_entries((birth <= found.lowest[found.of_node]) & (birth < 0))  # both orders: each finger moves
    tunnels = _opening_tunnels(boundary, first, second, found.of_node)
    levels = merge_levels(found.lowest, [found.links, tunnels], max(told_apart, SAME * boundary.size))
    return Caging(
        boundary=boundary,
        land=land,
        basins=found,
        levels=levels,
        minima=Contacts(first, second, np.zeros(len(first))),
        stretching=True,
    )


def _opening_tunnels(boundary: Boundary, vertex: IntArray, other: IntArray, basin: IntArray) -> Links:
    """Ways of a finger off the boundary, straight away from the other one, to the next edge and on to its ends."""
    here, start, follow = basin[vertex, other], boundary.start, boundary.follow
    apart = start[vertex] - start[other]
    sigma = np.linalg.norm(apart, axis=1)
    outward = apart / sigma[:, None]
    opens = boundary.opens(vertex, outward)
    vertex, other, here = vertex[opens], other[opens], here[opens]
    sigma, outward = sigma[opens], outward[opens]
    way, hit = boundary.first_hits(start[vertex], outward, np.column_stack([vertex, boundary.back[vertex]]))
    free = np.isinf(way)
    parts = [(here[free], np.full(int(free.sum()), ESCAPE), -sigma[free])]
    landed = start[vertex] + np.where(free, 0.0, way)[:, None] * outward
    for end in (hit, follow[hit]):
        nearest = distance_to_segment(start[other], landed, start[end])
        level = -np.minimum(sigma, nearest)
        parts.append((here[~free], basin[end, other][~free], level[~free]))
    a, b, level = (np.concatenate(column) for column in zip(*parts, strict=True))
    return a, b, level
