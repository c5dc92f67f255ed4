"""A cloud → the plane that objects stand on, and the objects."""

from flatgrasp_cli.scene.segmentation import segment

__all__ = ["segment"]
