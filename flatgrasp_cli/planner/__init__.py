"""The method of Lei & Wisse 2016, one module a section; `pipeline` reads like its section III.

A.1 main_plane, A.2 silhouette, A.3 fingers, B.1–B.2 balance, B.3–B.5 hand, C gravity.
"""

from flatgrasp_cli.planner.pipeline import plan_object

__all__ = ["plan_object"]
