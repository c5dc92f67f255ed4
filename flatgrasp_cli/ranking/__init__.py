"""Beyond the paper: how probable it is that a grasp holds, and in which order grasps come.

`errors` says what may be off, `closing` and `lifting` what a hand then comes to, `success` how often it holds, `order`
which grasp is best, and `variety` which of them differ.
"""

from flatgrasp_cli.ranking.order import TIE, best_first, by_probability
from flatgrasp_cli.ranking.success import CAUSES, Situation
from flatgrasp_cli.ranking.variety import differing

__all__ = ["CAUSES", "TIE", "Situation", "best_first", "by_probability", "differing"]
