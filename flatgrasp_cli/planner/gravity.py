"""§III.C: gravity."""

from __future__ import annotations

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.extents import mean_of
from flatgrasp_cli.geometry.polygon import area_centroid, cross, share_inside, signed_area
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, GravityCenter, PlaneShape, Silhouette
from flatgrasp_cli.profiles.settings import GravitySettings


def gravity_center(whole: Silhouette, settings: GravitySettings) -> GravityCenter:
    """The object's centre of gravity in the plane, from the silhouette of the whole object.

    `area`: the centroid of the silhouette, as if the object were a plate; `points`: the mean of the visible points,
    which depends on their density.
    """
    points = mean_of(whole.points)
    return GravityCenter(area_centroid(whole.loops) if whole.loops else points, points, settings.center)


def weighed(fingers: FingerCandidates, grasps: GraspCandidates, shape: PlaneShape) -> GraspCandidates:
    """The pairs with their gravity distance."""
    return grasps.having(gravity_distance=gravity_distance(fingers, grasps, shape.gravity_center.place))


def gravity_distance(fingers: FingerCandidates, grasps: GraspCandidates, center: FloatArray) -> FloatArray:
    """Distance (p,) of the centre of gravity to each grasping line, the one through both contacts, in metres."""
    contact = fingers.contact.take(grasps.i, axis=0)
    along = (fingers.contact.take(grasps.j, axis=0) - contact) / grasps.distance[:, None]
    return np.abs(cross(along, center - contact))


def inside_share(fingers: FingerCandidates, grasps: GraspCandidates, silhouette: Silhouette) -> FloatArray:
    """The share (p,) of each grasping line, from contact to contact, that lies inside the object."""
    return share_inside(silhouette.loops, fingers.contact[grasps.i], fingers.contact[grasps.j])


def volume_m3(whole: Silhouette) -> float:
    """What lies under the visible surface, cubic metres: the silhouette's area times the mean height of its points."""
    floor = min(0.0, float(whole.heights.min(initial=0.0)))
    area = sum(signed_area(loop) for loop in whole.loops)
    return max(area * float(np.mean(whole.heights - floor)), 0.0) if len(whole.heights) else 0.0
