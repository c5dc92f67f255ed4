"""§III.B.1 and B.2: force balance and torque balance of pairs of finger candidates.

With e the unit vector from contact i to contact j and n the inward directions, a_i = ∠(e, n_i) and a_j = ∠(e, −n_j) are
signed angles. The paper's force balance is γ = |a_i − a_j|, its torque balance follows ā = (a_i + a_j)/2, and Nguyen's
two-finger force closure, max(|a_i|, |a_j|) < atan(μ), is γ/2 + |ā| < atan(μ): one friction coefficient sets both.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import FloatArray, IntArray
from flatgrasp_cli.kernels import pairs as kernels
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.profiles.settings import BalanceSettings


def force_balance(fingers: FingerCandidates) -> FloatArray:
    """γ (m, k) in degrees of every candidate for jaw 0 with every candidate for jaw 1: the paper's Fig. 13.

    It is 0 when their directions are opposed and 180 when they are equal: the resultant of two unit forces is
    2·sin(γ/2), the height in the figure.
    """
    cosine = -fingers.direction[fingers.jaw != 1] @ fingers.direction[fingers.jaw != 0].T
    return np.asarray(np.degrees(np.arccos(cosine.clip(-1.0, 1.0))))


def weigh(fingers: FingerCandidates, pairs: IntArray) -> GraspCandidates:
    """Force balance, torque arm and required friction of `pairs` (2, p).

    The arm is the torque of the two unit forces about the midpoint, (d/2)·|sin a_i + sin a_j|, in metres; required
    friction is tan(max(|a_i|, |a_j|)), infinite where a finger would have to pull.
    """
    found = kernels.weighed(fingers.contact, fingers.direction, pairs)
    distance, gamma_deg, arm_m, friction = found[4:]
    return GraspCandidates(
        i=pairs[0],
        j=pairs[1],
        middle=np.ascontiguousarray(found[:2].T),
        axis=np.ascontiguousarray(found[2:4].T),
        distance=distance,
        force_balance_deg=gamma_deg,
        torque_arm_m=arm_m,
        required_friction=friction,
    )


def force_balanced(fingers: FingerCandidates, limits: BalanceSettings, funnel: Funnel) -> GraspCandidates:
    """§III.B.1: the pairs that face each other and whose γ is small enough.

    Facing, n_i·e > 0 and n_j·(−e) > 0, is not in the paper. Without it the two inner sides of a gap look perfectly
    balanced, yet they push apart. A thumb is paired with each finger pair, of equal fingers each two only once.
    """
    limit, counts = limits.force_balance_max_deg or 180.0, np.zeros(2, dtype=np.intp)
    pairs = kernels.balanced(fingers.contact, fingers.direction, fingers.jaw, limits.facing, limit, counts)
    count, facing = counts.tolist()
    funnel.count("pairs", count, "there is no finger candidate for each of the jaws")
    if limits.facing:
        funnel.count("facing", facing, "no two finger candidates press toward each other")
    grasps = weigh(fingers, pairs)
    kept = funnel.at_most(
        "force_balance",
        grasps,
        grasps.force_balance_deg,
        limit,
        lambda value: f"best force balance γ {value:.1f}°, allowed {limit:.1f}°",
    )
    return grasps.select(kept)


def torque_balanced(pairs: GraspCandidates, limits: BalanceSettings, funnel: Funnel) -> GraspCandidates:
    """§III.B.2: the pairs whose torque is below the threshold."""
    limit = limits.torque_max or np.inf
    values, what = {
        "friction": (pairs.required_friction, "required friction"),
        "arm": (pairs.torque_arm_m, "torque arm (m)"),
        "normalised": (_share(pairs.torque_arm_m, pairs.distance), "torque arm over distance"),
    }[limits.torque]
    kept = funnel.at_most(
        "torque_balance", pairs, values, limit, lambda value: f"smallest {what} {value:.3f}, allowed {limit:.3f}"
    )
    return pairs.select(kept)


def _share(part: FloatArray, whole: FloatArray) -> FloatArray:
    """`part` / `whole` (p,); infinite where the whole is 0, as the distance of contacts that coincide is."""
    return np.asarray(np.divide(part, whole, out=np.full(len(part), np.inf), where=whole > 0))
