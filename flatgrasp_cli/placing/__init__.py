"""A cloud in the frame that was asked for: one door, whatever tells the way there.

That is the pose of the camera where it is stated, or a recording's own transforms. What was asked for is a `Workcell`.
"""

from flatgrasp_cli.placing.door import Lookup, Route, in_base_frame, placed
from flatgrasp_cli.placing.workcell import Workcell, workcell

__all__ = ["Lookup", "Route", "Workcell", "in_base_frame", "placed", "workcell"]
