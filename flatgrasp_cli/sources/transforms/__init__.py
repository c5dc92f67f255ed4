"""A recording's transforms: the pose of any frame in any other, at a time."""

from flatgrasp_cli.sources.transforms.buffer import Route, TransformBuffer
from flatgrasp_cli.sources.transforms.routes import REMEDY, MissingTransform

__all__ = ["REMEDY", "MissingTransform", "Route", "TransformBuffer"]
