"""The version, as it was installed: looking it up takes a while, so it is not done before somebody asks."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("flatgrasp")
except PackageNotFoundError:
    __version__ = "0+source"  # a tree that was never installed
