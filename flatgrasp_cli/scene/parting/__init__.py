"""Things that touch, told apart: where a surface has a concave seam, a jump or a gap, one thing ends, another begins.

Local convexity as in Stein et al., "Object Partitioning using Local Convexity" (CVPR 2014): `view_grid` sorts points
into the cells of the sensor's image, `seams` tells which of them lie in a seam, and `pieces` are what seams leave.
"""

from flatgrasp_cli.scene.parting.pieces import Limits, Surface, pieces

__all__ = ["Limits", "Surface", "pieces"]
