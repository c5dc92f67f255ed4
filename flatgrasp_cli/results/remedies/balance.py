"""What would help where forces, torques or the silhouette's shape leave no pair."""

from __future__ import annotations

import math

from flatgrasp_cli.model import ObjectPlan, Rejection
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.results.remedies.words import up

MOST_FRICTION = 1.5
"""No pad is believed to have more."""


def not_immobilised(_plan: Plan, _item: ObjectPlan, _rejection: Rejection) -> str:
    """Where two frictionless points hold nothing."""
    return "--method default counts on friction, too"


def force_unbalanced(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str | None:
    """The friction, or else the angle, from which the best pair would do."""
    balance, gamma, limit = plan.settings.balance, rejection.value, rejection.limit
    if gamma is None or limit is None:
        return None
    friction = balance.friction_with(plan.gripper)
    derived = math.degrees(2 * balance.force_share * math.atan(friction))
    if not math.isclose(limit, derived, rel_tol=1e-6):
        return f"--set balance.force_balance_max_deg={math.ceil(gamma)} allows it"
    half = math.radians(gamma) / (2 * balance.force_share)
    return _more_friction(math.tan(half), friction) if half < math.atan(MOST_FRICTION) else None


def torque_unbalanced(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str | None:
    """The friction, or else the torque, from which the best pair would do."""
    balance, value = plan.settings.balance, rejection.value
    if value is None:
        return None
    if balance.torque == "friction" and value <= MOST_FRICTION:
        return _more_friction(value, balance.friction_with(plan.gripper))
    return None if balance.torque == "friction" else f"--set balance.torque_max={up(value)} allows it"


def _more_friction(need: float, have: float) -> str:
    return f"pads with a friction of {up(need)} can hold it, {have:g} is assumed: --set balance.friction={up(need)}"


def beside_pads(_plan: Plan, _item: ObjectPlan, _rejection: Rejection) -> str:
    """Where contacts lie aside of the bisector that the hand closes along."""
    return "--set hand.closing_axis=contacts closes along the line of the contacts"


def not_flat(plan: Plan, _item: ObjectPlan, rejection: Rejection) -> str | None:
    """The limit that the flattest pair keeps."""
    if rejection.value is None:
        return None
    key = "variance_max_share" if plan.settings.hand.variance_max is None else "variance_max"
    digits = 2 if key == "variance_max_share" else 4
    value = up(rejection.value, digits)
    return f"--set hand.{key}={value} allows it" if key == "variance_max" or float(value) < 1 else None


def no_cage(_plan: Plan, _item: ObjectPlan, _rejection: Rejection) -> str:
    """Where grasps are many and cages none."""
    return "--prefer cage, instead of --require cage, ranks them by what their cage forgives and keeps the others"
