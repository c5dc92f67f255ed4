"""Grasps of shapes whose chance to hold can be worked out by hand, and a slow way to find it for any."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import GraspCandidates, GravityCenter, OpenHands, OrientedBox, PlaneShape, Silhouette
from flatgrasp_cli.profiles import Gripper, PlannerSettings
from flatgrasp_cli.ranking import Situation
from flatgrasp_cli.ranking.success import PUSHED_ASIDE
from flatgrasp_cli.surroundings.below import Stops
from tests.by_hand import MM, WORLD, across

HAND = load_gripper("pr2").model_copy(update={"finger_width_m": 0.02, "finger_thickness_m": 0.01, "max_force_n": 40.0})
"""Fingers of 20 × 10 mm, which press with 40 N; friction 0.5."""
SURE = (
    *("position_m=0", "height_m=0", "yaw_deg=0", "friction_share=0", "outline_m=0", "center_share=0"),
    *("occupied_share=0", "density_kg_m3=[1,1]", "samples=512"),
)
"""Nothing may be off, and the object weighs next to nothing."""


def unsure(*changes: str) -> PlannerSettings:
    """Settings in which nothing is uncertain but what these `changes` of `uncertainty` say."""
    figures = (f"uncertainty.{change}" for change in (*SURE, *changes))
    return load_settings("default", ("hand.contact_tolerance_m=0.002", *figures))


@dataclass(frozen=True, slots=True)
class Around:
    """Surroundings in which hands are stopped at one height, and a share of their place was not seen."""

    height_m: float = -np.inf
    dark: float = 0.0
    level_m: float | None = None
    lowest_m: float = 0.0
    fall: tuple[float, float, float] = (0.0, 0.0, -1.0)

    @property
    def down(self) -> FloatArray:
        return np.array(self.fall)

    def stopped(self, hands: OpenHands, _gripper: Gripper, /) -> Stops:
        return Stops(np.full(hands.tip.shape, self.height_m), np.full(hands.tip.shape, self.dark))

    def __getattr__(self, name: str) -> Any:  # the method asks for more, ranking does not
        raise AssertionError(name)


def shape_of(region: shapely.Polygon, thick_m: float = 0.03) -> PlaneShape:
    """A plate of that outline, in millimetres."""
    rings = [np.asarray(ring.coords)[:-1] * MM for ring in (region.exterior, *region.interiors)]
    points = np.concatenate(rings)
    center = np.asarray(region.centroid.coords[0]) * MM
    size = np.array([*np.ptp(points, axis=0), thick_m])
    silhouette = Silhouette(WORLD, tuple(rings), points, np.full(len(points), thick_m), 0.003, 1.0)
    return PlaneShape(
        box=OrientedBox(WORLD, size, np.zeros((2, 3))),
        silhouette=silhouette,
        gravity_center=GravityCenter(center, center, "area"),
        volume_m3=region.area * MM**2 * thick_m,
    )


def situation(
    region: shapely.Polygon, settings: PlannerSettings, around: Any = None, hand: Gripper = HAND
) -> Situation:
    """What grasps of a plate are carried out on."""
    return Situation(shape_of(region), around or Around(), hand, settings.resolve(hand))


def grasp(width_mm: float, opening_mm: float, **columns: Any) -> GraspCandidates:
    """A grasp about the origin that closes along y, pads 20 mm high on the object, tips 5 mm high."""
    one = {
        "opening": opening_mm * MM,
        "tip": 5 * MM,
        "grip": 20 * MM,
        "lean": 0.0,
        "feet": np.full((1, 2, 2), 5 * MM),
        "hidden": np.zeros((1, 2)),
        "gravity_distance": 0.0,
    }
    table = {name: np.atleast_1d(value) for name, value in {**one, **columns}.items()}
    table["lean"] = np.atleast_2d(table["lean"])
    return across([width_mm * MM], **table)[1]


def chance(found: Situation, grasps: GraspCandidates) -> float:
    """How probably the first of the grasps holds."""
    return float(found.tried(grasps).probability[0])


def moved_along_x(grasps: GraspCandidates, by_mm: float) -> GraspCandidates:
    """The same grasps beside where they were."""
    return replace(grasps, middle=grasps.middle + np.array([by_mm * MM, 0.0]))


def by_monte_carlo(region: shapely.Polygon, opening_mm: float, settings: PlannerSettings, count: int) -> float:
    """How often the hand of `grasp` holds a plate, by plain sampling and by shapely: for convex regions.

    It stands free if the middle of neither fingertip overlaps the region. Closing, each pad comes to rest on the
    outermost point in its strip: on its face, or with an edge on a side whose slope friction has to hold.
    """
    rng, unsure_of = np.random.default_rng(1), settings.uncertainty.figures
    held = 0.0
    for _ in range(count):
        dx, dy = rng.normal(0, unsure_of.position_m, 2) / MM
        turn = rng.normal(0, unsure_of.yaw_deg)
        seen = shapely.affinity.rotate(shapely.affinity.translate(region, -dx, -dy), -turn, origin=(0, 0))
        friction = 0.5 * (1 + unsure_of.friction_share * rng.uniform(-1, 1))
        held += _holds(seen, opening_mm / 2, friction)
    return held / count


def _holds(seen: shapely.Polygon, face: float, friction: float) -> float:
    angles = []
    for sign in (1, -1):
        one = shapely.affinity.scale(seen, 1, sign, origin=(0, 0))
        if one.intersects(shapely.box(-5, face + 2.5, 5, face + 7.5)):
            return PUSHED_ASIDE
        under = one.intersection(shapely.box(-10, -1e3, 10, face + 2.5))
        if under.is_empty:
            return 0.0
        corners = shapely.get_coordinates(under)
        top = corners[corners[:, 1].argmax()]
        inner = one.intersection(shapely.box(-9.5, -1e3, 9.5, 1e3))
        on_edge = abs(abs(top[0]) - 10) < 1e-6
        drop = top[1] - shapely.get_coordinates(inner)[:, 1].max()
        angles.append(np.sign(top[0]) * np.arctan(drop / 0.5) if on_edge else 0.0)
    return 1.0 if np.tan(0.5 * abs(angles[0] + angles[1])) <= friction else 0.0
