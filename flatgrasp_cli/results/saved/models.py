"""What is read of a document. Whatever else it says is left alone, so that one of a later version is read, too."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Pose
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.results.contracts.base import Number, Status, Vector2, Vector3, Vector4
from flatgrasp_cli.results.success import LEAST

UNIT = 1e-6
"""By how much the length of a quaternion may differ from 1: documents have nine decimals."""
Chance = Annotated[float, Field(ge=0, le=1)]
"""A probability."""


def _unit(quaternion: Vector4) -> Vector4:
    if abs(float(np.linalg.norm(quaternion)) - 1) > UNIT:
        raise ValueError("is no unit quaternion")
    return quaternion


def _of_this_version(profile: type[BaseModel]) -> BeforeValidator:
    """Leave out what a later version's profile says and this one does not know."""

    def known(values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        # profiles are strict, and lists are tuples to them only in JSON
        return profile.model_validate_json(
            json.dumps({key: values[key] for key in values if key in profile.model_fields})
        )

    return BeforeValidator(known)


class _Saved(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)


class SavedPose(_Saved):
    """A pose: metres, and a unit quaternion [x, y, z, w]."""

    position: Vector3
    orientation: Annotated[Vector4, AfterValidator(_unit)]

    @property
    def pose(self) -> Pose:
        """As the planner has it, before the quaternion was rounded to nine decimals: of length 1."""
        quaternion = np.array(self.orientation)
        return Pose(np.array(self.position), quaternion / np.linalg.norm(quaternion))


class SavedSuccess(_Saved):
    """How probable it is that the grasp holds, and what it fails by."""

    probability: Chance
    causes: dict[str, Chance] = Field(default_factory=dict)


class SavedJoints(_Saved):
    """An arm's joint angles along the way, radians."""

    pre_grasp: list[Number]
    grasp: list[Number]
    lift: list[Number]


class SavedReach(_Saved):
    """Whether the arm reaches the grasp; if the hand is turned into its `twin`, the flange is."""

    ok: bool
    joints_rad: SavedJoints | None
    twin: bool


class SavedGrasp(_Saved):
    """One grasp."""

    rank: int
    pose: SavedPose
    pre_grasp: SavedPose
    lift: SavedPose
    opening_m: Number
    width_m: Number
    contacts: tuple[Vector3, Vector3]
    metrics: dict[str, Number | None]
    success: SavedSuccess | None = None
    reach: SavedReach | None = None

    @property
    def probability(self) -> float | None:
        """How probable it is that it holds; None where the document does not say."""
        return None if self.success is None else self.success.probability

    @property
    def causes(self) -> list[tuple[str, float]]:
        """What would make it fail, and how probable each is, the likeliest first; none that would be 0 %."""
        causes = {} if self.success is None else self.success.causes
        return sorted(((key, share) for key, share in causes.items() if share >= LEAST), key=lambda cause: -cause[1])

    @property
    def score(self) -> float:
        """From 0 to 1, the better the larger: the probability, or where that is not known one over the rank.

        The latter keeps the order and means nothing else.
        """
        return 1 / self.rank if self.probability is None else self.probability


class SavedSilhouette(_Saved):
    """An outline: loops [u, v] in a plane."""

    origin: Vector3
    axes: tuple[Vector3, Vector3]
    loops: list[list[Vector2]]

    def in_space(self) -> list[FloatArray]:
        """The loops' points, each (n, 3)."""
        return [np.array(self.origin) + np.array(loop).reshape(-1, 2) @ np.array(self.axes) for loop in self.loops]


class SavedStage(_Saved):
    """How many candidates a stage kept."""

    stage: str
    kept: int


class SavedBox(_Saved):
    """A box square to the frame's axes."""

    min: Vector3
    max: Vector3


class SavedObject(_Saved):
    """One object."""

    id: int
    status: Status
    reason: str | None
    remedy: str | None = None
    silhouette: SavedSilhouette | None
    aabb: SavedBox | None = None
    funnel: list[SavedStage] = []
    grasps: list[SavedGrasp]


class SavedPlane(_Saved):
    """The support plane: normal · p = offset_m."""

    normal: Vector3
    offset_m: Number


class SavedSource(_Saved):
    """Where the frame came from."""

    path: str
    topic: str | None
    stamp_ns: int | None
    points: int
    index: int

    @property
    def name(self) -> str:
        """For people: the file, and the frame's time."""
        return self.path if self.stamp_ns is None else f"{self.path} at {self.stamp_ns / 1e9:.3f} s"


class SavedSensor(_Saved):
    """Where the sensor was, if that is known."""

    position: Vector3 | None


class SavedWarning(_Saved):
    """Something that had to be assumed."""

    text: str


class SavedDocument(_Saved):
    """The answer for one frame."""

    schema_id: Literal["flatgrasp.plan/1"] = Field(alias="schema")
    status: Status
    reason: str | None
    remedy: str | None = None
    source: SavedSource
    sensor: SavedSensor
    warnings: list[SavedWarning]
    frame_id: str
    gripper: Annotated[Gripper, _of_this_version(Gripper)]
    robot: Annotated[Robot, _of_this_version(Robot)] | None
    support_plane: SavedPlane | None
    objects: list[SavedObject]

    def is_of(self, cloud: Cloud) -> bool:
        """Whether it was made of a cloud: of that time, as many points, in the same frame, the objects among them."""
        source = self.source
        made_of = (source.stamp_ns, source.points, self.frame_id)
        if made_of != (cloud.source.stamp_ns, len(cloud.points), cloud.frame_name):
            return False
        boxes = (item.aabb for item in self.objects if item.aabb)
        return all(((box.min <= cloud.points) & (cloud.points <= box.max)).all(axis=1).any() for box in boxes)

    @property
    def grasps(self) -> Iterator[tuple[SavedObject, SavedGrasp]]:
        """Every grasp with its object, object after object, best first."""
        return ((item, grasp) for item in self.objects for grasp in item.grasps)
