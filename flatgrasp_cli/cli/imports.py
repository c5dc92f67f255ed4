"""Large packages, imported in less time than by a plain import."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module


@contextmanager
def importing() -> Iterator[None]:
    """Leave out the search for garbage while modules are imported, which make none, and among them later on.

    It takes a tenth to a fifth of the time.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if enabled:
            gc.enable()


def import_figures() -> None:
    """Import matplotlib, and what draws with it, in 60 % of the time.

    As it is imported, matplotlib writes a docstring and a signature for the method `set` of each kind of artist, which
    a process that only draws never shows. Should it name its method for that otherwise one day, it writes them again.
    """
    with importing():
        from matplotlib.artist import Artist

        Artist._update_set_signature_and_docstring = classmethod(lambda _cls: None)  # type: ignore[attr-defined]
        import_module("flatgrasp_cli.results.figures")
