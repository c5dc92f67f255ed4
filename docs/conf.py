"""Builds the documentation: `sphinx-build -W docs build/docs`, warnings being errors, without the network."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import flatgrasp_cli

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_extensions"))

import drawings  # noqa: E402 (after the path is set)
import reference  # noqa: E402

project = "flatgrasp"
author = "the flatgrasp authors"
copyright = author  # noqa: A001 (the name that Sphinx reads)
release = version = flatgrasp_cli.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3
exclude_patterns = ["held_rates.md", "calibration.md"]
"""Parts of the pages on the simulation and the method, made by benchmarks."""
default_role = "code"
"""Docstrings put code between single backticks."""

autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_class_signature = "separated"
autodoc_default_options = {"members": True, "undoc-members": False, "exclude-members": "__init__, __new__"}
napoleon_google_docstring = False
napoleon_use_rtype = False
python_maximum_signature_line_length = 100

html_theme = "furo"
html_title = f"flatgrasp {release}"
html_copy_source = False
html_show_sphinx = False


def setup(app: Sphinx) -> None:
    """Fill in what pages say of the program from the program itself, and draw what they show."""
    app.connect("source-read", _filled_in)
    app.connect("builder-inited", lambda _app: drawings.draw_all(HERE / "generated"))


def _filled_in(_app: Sphinx, _page: str, content: list[str]) -> None:
    content[0] = reference.filled_in(content[0])
