"""Anything recorded → an iterator of `Cloud`, one frame in memory at a time."""

from flatgrasp_cli.sources.open import read_clouds

__all__ = ["read_clouds"]
