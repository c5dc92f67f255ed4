"""The only door to MuJoCo, which is an extra."""

from __future__ import annotations

from functools import cache
from types import ModuleType

from flatgrasp_cli.errors import UsageError

EXTRA = "pip install 'flatgrasp[simulate]'"


@cache
def load_mujoco() -> ModuleType:
    """Import MuJoCo (a third of a second).

    Raises
    ------
    UsageError
        If it is not installed.
    """
    try:
        import mujoco
    except ImportError as error:
        raise UsageError(f"simulating needs {error.name}, which is not installed: {EXTRA}") from error
    mujoco.set_mju_user_warning(_ignore)  # it would write them into a file in the current folder
    module: ModuleType = mujoco
    return module


def _ignore(_text: str) -> None:
    """Nothing: what goes wrong is counted in MuJoCo's data, and asked for there."""
