"""§III.B.4: how far the boundary strays from the pads."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.profiles.settings import HandSettings


def flat(fingers: FingerCandidates, grasps: GraspCandidates, settings: HandSettings, funnel: Funnel) -> GraspCandidates:
    """The pairs whose boundary strays little from the pads.

    The limit is one in metres on the sum of both sides, if the settings have it, or else a share of the finger's width.
    """
    v_i, v_j = fingers.variance[grasps.i], fingers.variance[grasps.j]
    if settings.variance_max is not None:
        limit, values, unit = settings.variance_max, v_i + v_j, " m"
    else:
        limit, unit = settings.variance_max_share, " of the finger's width"
        values = np.maximum(v_i / fingers.width[grasps.i], v_j / fingers.width[grasps.j])
    kept = funnel.at_most(
        "variance",
        grasps,
        values,
        limit,
        lambda value: f"flattest pair of finger places strays {value:.3f}{unit} from the pads, allowed {limit:.3f}",
    )
    return grasps.select(kept)
