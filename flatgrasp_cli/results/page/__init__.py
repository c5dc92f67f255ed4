"""A page to look at plans in three dimensions: one file, offline, for any browser with WebGL.

It needs a library for that, three.js, which is read out of an installed package when a page is written.
"""

from flatgrasp_cli.results.page.writing import Frame, page

__all__ = ["Frame", "page"]
