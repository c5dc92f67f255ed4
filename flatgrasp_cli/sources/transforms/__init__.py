"""A recording's transforms: the pose of any frame in any other, at a time."""

from flatgrasp_cli.sources.transforms.buffer import TransformBuffer
from flatgrasp_cli.sources.transforms.recorded import TRANSFORM_TYPES, RecordedTransforms
from flatgrasp_cli.sources.transforms.routes import MissingTransform

__all__ = ["TRANSFORM_TYPES", "MissingTransform", "RecordedTransforms", "TransformBuffer"]
