"""Beyond the paper: what makes one grasp better than another, besides its gravity distance."""

from flatgrasp_cli.ranking.cost import grasp_cost

__all__ = ["grasp_cost"]
