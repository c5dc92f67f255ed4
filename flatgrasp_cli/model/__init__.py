"""The records that flow from a recording to a result. All are frozen; arrays in them are not written to.

Lengths are metres, angles in names ending `_deg` degrees. "Plane" coordinates (…, 2) are those of a silhouette's frame.
"""

from flatgrasp_cli.model.candidates import FingerCandidates, GraspCandidates, OpenHands
from flatgrasp_cli.model.clouds import (
    SENSOR_FROM_TF,
    UNNAMED_FRAME,
    UP_UNTOLD,
    Cloud,
    CloudWarning,
    ImageGrid,
    Source,
)
from flatgrasp_cli.model.grasps import Approach, Cage, Closure, Grasp, Reach, Success, Tolerance
from flatgrasp_cli.model.plans import ObjectPlan, Rejection, Stage, Trace
from flatgrasp_cli.model.poses import Pose, Poses, Way
from flatgrasp_cli.model.scenes import Floor, ObjectCloud, Scene, SupportPlane
from flatgrasp_cli.model.sensors import KnownFrom, Sensor
from flatgrasp_cli.model.shapes import GravityCenter, OrientedBox, PlaneShape, Silhouette, StepPoints

__all__ = [
    "SENSOR_FROM_TF",
    "UNNAMED_FRAME",
    "UP_UNTOLD",
    "Approach",
    "Cage",
    "Closure",
    "Cloud",
    "CloudWarning",
    "FingerCandidates",
    "Floor",
    "Grasp",
    "GraspCandidates",
    "GravityCenter",
    "ImageGrid",
    "KnownFrom",
    "ObjectCloud",
    "ObjectPlan",
    "OpenHands",
    "OrientedBox",
    "PlaneShape",
    "Pose",
    "Poses",
    "Reach",
    "Rejection",
    "Scene",
    "Sensor",
    "Silhouette",
    "Source",
    "Stage",
    "StepPoints",
    "Success",
    "SupportPlane",
    "Tolerance",
    "Trace",
    "Way",
]
