"""The method of Lei & Wisse 2016, one module a section; `pipeline` reads like its section III.

A.1 main_plane, A.2 silhouette, A.3 fingers, B.1–B.2 balance, B.3 grasping_range, B.4 variance, B.5 operability,
C gravity; `contacts` tells where the pads of a final grasp touch.
"""

from flatgrasp_cli.planner.pipeline import final, section_three

__all__ = ["final", "section_three"]
