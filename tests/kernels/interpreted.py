"""The kernels as they are written, run by Python: what they are compiled to has to give the same."""

from __future__ import annotations

import importlib.util
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import flatgrasp_cli.kernels


def interpreted(name: str) -> ModuleType:
    """The kernel `name`, not compiled: Python checks every index of an array, unless it is negative."""
    path = Path(flatgrasp_cli.kernels.__file__).with_name(f"{name}.py")
    spec = importlib.util.spec_from_loader(name, SourceFileLoader(name, str(path)))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
