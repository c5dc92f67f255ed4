"""Whether the kernels are compiled, and from the sources that lie beside them."""

from __future__ import annotations

import zlib
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

SUFFIX = EXTENSION_SUFFIXES[0]
SHARED = "_shared"
"""The extension with what Cython's array types need, once for all kernels: in each it would be most of what is
compiled."""


def kernels(folder: Path) -> list[Path]:
    """The sources in `folder` that are compiled, sorted."""
    return sorted(path for path in folder.glob("*.py") if not path.name.startswith("_"))


def receipt(folder: Path) -> Path:
    """The file in `folder` that says what this Python's extensions were compiled from."""
    return folder / f"compiled{SUFFIX}.txt"


def digest(folder: Path) -> str:
    """A checksum of all the sources in `folder`."""
    checksum = 0
    for path in kernels(folder):
        # as text: a checkout on Windows has other ends of lines
        checksum = zlib.crc32(f"{path.name}\n{path.read_text(encoding='utf-8')}".encode(), checksum)
    return f"{checksum:08x}"


def are_compiled(folder: Path) -> bool:
    """Whether the kernels in `folder` are compiled for this Python.

    Raises
    ------
    ImportError
        Some of them are, or from other sources than those in `folder`.
    """
    names = [SHARED, *(path.stem for path in kernels(folder))]
    compiled = [folder.joinpath(name + SUFFIX).exists() for name in names]
    if not any(compiled):
        return False
    if not all(compiled) or not receipt(folder).exists() or receipt(folder).read_text() != digest(folder):
        raise ImportError(f"the kernels in {folder} have changed since they were compiled")
    return True
