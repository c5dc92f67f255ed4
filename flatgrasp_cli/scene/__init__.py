"""A cloud → the plane that objects stand on, and the objects."""

from flatgrasp_cli.scene.segmentation import segment
from flatgrasp_cli.scene.strays import without_far_strays, without_repeats

__all__ = ["segment", "without_far_strays", "without_repeats"]
