"""One cloud → one Plan: composes scene, method, proof and robot; what the command line and the Python API call.

`scenes` plans a cloud, `objects` each of its objects in the plane, and `lifting` brings the grasps into space; `doubts`
are what it warns of.
"""

from flatgrasp_cli.planning.lifting import plan_object
from flatgrasp_cli.planning.scenes import Plan, plan

__all__ = ["Plan", "plan", "plan_object"]
