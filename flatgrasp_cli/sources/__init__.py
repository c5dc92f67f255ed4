"""Anything recorded → an iterator of `Cloud`, one frame in memory at a time."""

from flatgrasp_cli.sources.open import read_clouds, read_content
from flatgrasp_cli.sources.selection import EVERYTHING, Selection

__all__ = ["EVERYTHING", "Selection", "read_clouds", "read_content"]
