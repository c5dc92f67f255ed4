"""three.js, as the package trimesh ships it in the page of its own viewer.

Of what comes in Python packages it is the smallest that draws 300,000 points in their colours: plotly is eight times as
large and takes each colour as text, k3d and viser bring programs of their own around it.
"""

from __future__ import annotations

import zipfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from flatgrasp_cli.errors import UsageError

PLACE, NAME = ("resources", "templates", "viewer.zip"), "viewer.html.template"
BEGIN, END = "<script>", "</script>"
EXTRAS = "\n(function(){"
"""What begins behind the library: controls, a loader, and the viewer that trimesh has made of them."""
MARK = "Three.js Authors"


@cache
def three_js() -> str:
    """The library's source, which defines `THREE`; raises `UsageError` if the package has none."""
    try:
        with zipfile.ZipFile(_package().joinpath(*PLACE)) as archive:
            text = archive.read(NAME).decode()
    except (OSError, KeyError, zipfile.BadZipFile) as error:
        raise UsageError("a page needs three.js of the package trimesh; `pip install 'trimesh>=5,<6'`") from error
    script = text.partition(BEGIN)[2].partition(END)[0].replace("\r\n", "\n").partition(EXTRAS)[0]
    if MARK not in script:
        raise UsageError("the installed trimesh has no three.js in its viewer; `pip install 'trimesh>=5,<6'`")
    return script


def _package() -> Path:
    """The package's folder, found without importing it, which would take a third of a second."""
    found = find_spec("trimesh")
    if found is None or not found.submodule_search_locations:
        raise FileNotFoundError
    return Path(found.submodule_search_locations[0])
