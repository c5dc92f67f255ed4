"""§III.B.1 and B.2: force balance and torque balance of pairs of finger candidates.

With e the unit vector from contact i to contact j and n the inward directions, a_i = ∠(e, n_i) and a_j = ∠(e, −n_j) are
signed angles. The paper's force balance is γ = |a_i − a_j|, its torque balance follows ā = (a_i + a_j)/2, and Nguyen's
two-finger force closure, max(|a_i|, |a_j|) < atan(μ), is γ/2 + |ā| < atan(μ): one friction coefficient sets both.
"""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.funnel import Funnel
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray, true_entries
from flatgrasp_cli.geometry.polygon import cross, dot
from flatgrasp_cli.model import FingerCandidates, GraspCandidates
from flatgrasp_cli.planner.fingers import EITHER_JAW
from flatgrasp_cli.profiles.settings import BalanceSettings


def opposing_candidates(fingers: FingerCandidates) -> tuple[IntArray, IntArray]:
    """Indices of the candidates for jaw 0 (m,) and for jaw 1 (k,): the rows and columns of the pair matrices."""
    rows, columns = np.flatnonzero(fingers.jaw != 1), np.flatnonzero(fingers.jaw != 0)
    return rows, columns


def force_balance(fingers: FingerCandidates) -> FloatArray:
    """γ (m, k) in degrees of every candidate for jaw 0 with every candidate for jaw 1.

    It is 0 when their directions are opposed and 180 when they are equal: the resultant of two unit forces is
    2·sin(γ/2), the height in the paper's Fig. 13.
    """
    rows, columns = opposing_candidates(fingers)
    cosine = -fingers.direction[rows] @ fingers.direction[columns].T
    return np.asarray(np.degrees(np.arccos(cosine.clip(-1.0, 1.0))))


def distinct(fingers: FingerCandidates, rows: IntArray, columns: IntArray) -> BoolArray:
    """Matrix (m, k) of the pairs that count: each thumb with each finger pair, of equal fingers each two only once."""
    either = (fingers.jaw[rows][:, None] == EITHER_JAW) & (fingers.jaw[columns] == EITHER_JAW)
    return np.asarray(~either | (rows[:, None] < columns))


def facing(fingers: FingerCandidates, rows: IntArray, columns: IntArray) -> BoolArray:
    """Matrix (m, k) of the pairs that press toward each other: n_i·e > 0 and n_j·(−e) > 0.

    The paper has no such test. Without it the two inner sides of a gap look perfectly balanced, yet they push apart.
    """
    c_i, n_i = fingers.contact[rows], fingers.direction[rows]
    c_j, n_j = fingers.contact[columns], fingers.direction[columns]
    return np.asarray((n_i @ c_j.T > dot(n_i, c_i)[:, None]) & (c_i @ n_j.T > dot(n_j, c_j)))


def weigh(fingers: FingerCandidates, i: IntArray, j: IntArray, gamma_deg: FloatArray) -> GraspCandidates:
    """Torque arm and required friction of pairs i, j (p,), whose force balance is `gamma_deg` (p,).

    The arm is the torque of the two unit forces about the midpoint, (d/2)·|sin a_i + sin a_j|, in metres; required
    friction is tan(max(|a_i|, |a_j|)), infinite where a finger would have to pull.
    """
    c_i, c_j = fingers.contact.take(i, axis=0), fingers.contact.take(j, axis=0)
    apart = c_j - c_i
    distance = np.hypot(apart[:, 0], apart[:, 1])
    e = apart / np.where(distance > 0, distance, 1.0)[:, None]
    n_i, n_j = fingers.direction.take(i, axis=0), fingers.direction.take(j, axis=0)
    sines = np.stack([cross(e, n_i), -cross(e, n_j)])
    cosines = np.stack([dot(e, n_i), -dot(e, n_j)])
    tangents = np.where(cosines > 0, np.abs(sines) / np.where(cosines > 0, cosines, 1.0), np.inf)
    return GraspCandidates(
        i=i,
        j=j,
        middle=0.5 * (c_i + c_j),
        axis=e,
        distance=distance,
        force_balance_deg=gamma_deg,
        torque_arm_m=0.5 * distance * np.abs(sines.sum(axis=0)),
        required_friction=tangents.max(axis=0),
    )


def force_balanced(
    fingers: FingerCandidates, gamma_deg: FloatArray, limits: BalanceSettings, funnel: Funnel
) -> GraspCandidates:
    """§III.B.1: the pairs that face each other and whose γ, out of the matrix `gamma_deg` (m, k), is small enough."""
    rows, columns = opposing_candidates(fingers)
    allowed = distinct(fingers, rows, columns)
    funnel.count("pairs", int(allowed.sum()), "there is no finger candidate for each of the jaws")
    if limits.facing:
        allowed &= facing(fingers, rows, columns)
        funnel.count("facing", int(allowed.sum()), "no two finger candidates press toward each other")
    limit = limits.force_balance_max_deg or 180.0
    smallest = float(gamma_deg.min(where=allowed, initial=np.inf))
    row, column = true_entries(allowed & (gamma_deg <= max(limit, smallest)))  # the survivors, or else the nearest miss
    pairs = weigh(fingers, rows[row], columns[column], gamma_deg[row, column])
    kept = funnel.at_most(
        "force_balance",
        pairs,
        pairs.force_balance_deg,
        limit,
        lambda value: f"best force balance γ {value:.1f}°, allowed {limit:.1f}°",
    )
    return pairs.select(kept)


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
