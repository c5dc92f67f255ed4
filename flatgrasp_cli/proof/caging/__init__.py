"""Two-finger caging: within which openings an object cannot get away, whatever it does and however it is pushed.

`prove` proves it for a hand's grasps, `immobilising_grasps` finds all grasps of an outline by it. An outline is made
ready (outline), its contact space cut into levels (contact_space for fingers that close, stretching for such that open)
and flooded (merge_tree); placements are then looked up (limits), as points on the hand's pads (hands), and their cage
says how far the hand may miss (tolerance).
"""

from flatgrasp_cli.proof.caging.certificate import Proof, prove
from flatgrasp_cli.proof.caging.hands import Hands
from flatgrasp_cli.proof.caging.immobilising import Immobilisation, immobilising_grasps

__all__ = ["Hands", "Immobilisation", "Proof", "immobilising_grasps", "prove"]
