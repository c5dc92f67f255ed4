"""A cloud → the plane that objects stand on, and the objects."""

from flatgrasp_cli.scene.segmentation import NO_PLANE, NOTHING_STANDS, segment
from flatgrasp_cli.scene.selection import NO_OBJECT_AT
from flatgrasp_cli.scene.strays import without_far_strays, without_repeats

__all__ = ["NOTHING_STANDS", "NO_OBJECT_AT", "NO_PLANE", "segment", "without_far_strays", "without_repeats"]
