"""A plan as pictures: the final grasp at a glance, the arm there, and one figure for each stage of the method."""

from flatgrasp_cli.results.figures.arm import arm_figure
from flatgrasp_cli.results.figures.final import final_figure
from flatgrasp_cli.results.figures.stages import stage_figures
from flatgrasp_cli.results.figures.style import as_png

__all__ = ["arm_figure", "as_png", "final_figure", "stage_figures"]
