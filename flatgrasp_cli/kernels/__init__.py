"""The planner's inner loops, compiled: arrays in, arrays out, one file a paragraph of the paper.

They are Python with Cython's types (its pure-Python mode). An installation compiles them, `hatch_build.py` does so
beside the sources of a checkout; where nothing did, the same files run as they are: the same answers, much slower.
What is inlined only reckons and raises nothing (`exceptval`): callers do not ask whether it did, which takes longer.
"""

from __future__ import annotations

import logging
from importlib.util import find_spec
from pathlib import Path

from flatgrasp_cli.errors import InstallationError
from flatgrasp_cli.kernels._freshness import are_compiled

REMEDY = "pip install -e . compiles them; so does python hatch_build.py, without installing"


def _state() -> str:
    try:
        compiled = are_compiled(Path(__file__).parent)
    except ImportError as error:
        raise InstallationError(f"{error}; {REMEDY}") from None
    if compiled:
        return "compiled"
    if find_spec("cython") is None:
        raise InstallationError(f"the kernels are not compiled, and without cython they cannot run; {REMEDY}")
    logging.getLogger(__name__).warning("the kernels are not compiled: planning is very slow; %s", REMEDY)
    return "interpreted"


STATE = _state()
"""How the kernels run: "compiled" or "interpreted"."""
