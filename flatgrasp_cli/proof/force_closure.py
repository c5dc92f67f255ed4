"""Force closure of two fingers in the plane: how large a push in the worst direction the grasp withstands.

Ferrari & Canny's ε ("Planning optimal grasps", ICRA 1992), L1: contact forces that sum to 1 reach the convex hull of
the primitive wrenches, those along the edges of the friction cones; ε is the radius of the largest ball about the
origin in it, 0 if the grasp is not force closed. In the plane a friction cone has just two edges and a wrench three
components, fx, fy and the torque about a reference point over a length, so ε is exact. Its sign does not depend on that
reference, its value does: here it is the outline's centre of area, and the length its largest radius from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import area_centroid, cross, left_normal
from flatgrasp_cli.kernels.wrenches import nearest_facets
from flatgrasp_cli.ranking.lifting import STANDARD_GRAVITY


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """What torques refer to: about `point` (2,), divided by `length_m` to become forces."""

    point: FloatArray
    length_m: float


def reference_of(loops: Sequence[FloatArray]) -> Reference:
    """The centre of the region's area and its largest radius from there."""
    center = area_centroid(loops)
    return Reference(center, float(np.linalg.norm(np.concatenate(loops) - center, axis=1).max()))


def contact_wrenches(points: FloatArray, normals: FloatArray, friction: float, reference: Reference) -> FloatArray:
    """Unit forces along both edges of the friction cone of each contact, with their torques: (k, 2·c, 3).

    `points` and unit inward `normals` are (k, c, 2), friction the Coulomb coefficient.
    """
    half = np.arctan(friction)
    aside = left_normal(normals.reshape(-1, 2)).reshape(normals.shape)
    forces = np.concatenate([np.cos(half) * normals + np.sin(half) * side * aside for side in (-1.0, 1.0)], axis=1)
    arms = np.tile(points - reference.point, (1, 2, 1)) / reference.length_m
    return np.concatenate([forces, cross(arms, forces)[..., None]], axis=2)


def ferrari_canny(wrenches: FloatArray) -> FloatArray:
    """ε (k,) of k sets of wrenches (k, w, 3), w ≥ 4: distance of the origin to the hull's nearest facet, 0 if outside.

    Facets are found among all triples. For the few wrenches of two fingers that is as exact as Qhull and faster.
    """
    found: FloatArray = nearest_facets(wrenches)
    return found


def point_quality(contacts: FloatArray, normals: FloatArray, friction: float, reference: Reference) -> FloatArray:
    """ε (k,) of fingers that touch in a point each: `contacts` and unit inward `normals` (k, 2, 2)."""
    return ferrari_canny(contact_wrenches(contacts, normals, friction, reference))


def pad_quality(
    contacts: FloatArray, normals: FloatArray, pad_widths: FloatArray, friction: float, reference: Reference
) -> FloatArray:
    """ε (k,) of pads flush with the outline, which press anywhere along `pad_widths` (k, 2), metres.

    Their forces are the positive combinations of those at their two ends, to either side of `contacts` (k, 2, 2).
    """
    aside = left_normal(normals.reshape(-1, 2)).reshape(normals.shape) * (0.5 * pad_widths[..., None])
    ends = np.concatenate([contacts - aside, contacts + aside], axis=1)
    return ferrari_canny(contact_wrenches(ends, np.tile(normals, (1, 2, 1)), friction, reference))


def friction_margin(required: FloatArray, friction: float) -> FloatArray:
    """Friction coefficient (k,) left beyond what the grasps need; negative for one that is not force closed."""
    return np.asarray(friction - required)


@dataclass(frozen=True, slots=True, eq=False)
class LiftMargins:
    """How many times the load the pads' friction bears, (k,): the weight, and its torque about the grasping line."""

    weight: FloatArray
    torque: FloatArray


def lift_margins(
    gravity_distance: FloatArray, mass_kg: float, force_n: float, friction: float, pad_radius_m: FloatArray
) -> LiftMargins:
    """Margins (k,) of lifting an object whose plane is level, above 1 where the grip holds.

    The two pads bear 2·μ·N ≥ m·g, and against turning about the line through both contacts, `gravity_distance` (k,)
    from the centre of gravity, 2·μ·N·(2/3)·r ≥ m·g·distance: soft fingers with an evenly pressed disc of radius r (k,).
    """
    weight, grip = mass_kg * STANDARD_GRAVITY, 2 * friction * force_n
    with np.errstate(divide="ignore"):
        torque = grip * (2 / 3) * pad_radius_m / (weight * gravity_distance)
    return LiftMargins(np.full(len(gravity_distance), grip / weight), torque)
