"""Makes messages of one ROS distribution, whose definitions differ: what is not given is zero, empty or false."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.interfaces import Nodetype

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Pose

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

IDENTITY = Pose(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))


class Messages:
    """Makes messages with the definitions of a type store; all in one frame, at one time."""

    def __init__(self, store: Typestore, stamp_ns: int, frame_id: str) -> None:
        self._store = store
        self._frame_id = frame_id
        self._seconds, self._nanoseconds = divmod(stamp_ns, 10**9)

    def make(self, name: str, /, **given: Any) -> Any:
        """A message of a type, e.g. std_msgs/msg/String."""
        fields = dict(self._store.fielddefs[name][1])
        values = {key: given[key] if key in given else self._nothing(*of) for key, of in fields.items()}
        return self._store.types[name](**values)

    def _nothing(self, kind: Nodetype, of: Any) -> Any:
        """The value of a field that nothing is said about."""
        if kind == Nodetype.NAME:
            return self.make(of)
        if kind == Nodetype.BASE:
            return {"string": "", "bool": False}.get(of[0], 0)
        (element, name), count = of
        if element == Nodetype.BASE and name[0] != "string":
            return np.zeros(count if kind == Nodetype.ARRAY else 0, dtype=name[0])
        return []

    @property
    def header(self) -> Any:
        """The header of all messages."""
        stamp = self.make("builtin_interfaces/msg/Time", sec=self._seconds, nanosec=self._nanoseconds)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=self._frame_id)

    def point(self, position: FloatArray) -> Any:
        """A place (3,)."""
        return self.make("geometry_msgs/msg/Point", **_xyz(position))

    def vector(self, vector: FloatArray) -> Any:
        """A vector (3,)."""
        return self.make("geometry_msgs/msg/Vector3", **_xyz(vector))

    def pose(self, pose: Pose) -> Any:
        """A pose."""
        return self.make(
            "geometry_msgs/msg/Pose", position=self.point(pose.position), orientation=self._quaternion(pose.orientation)
        )

    def transform(self, child: str, pose: Pose) -> Any:
        """Where the frame `child` is."""
        transform = self.make(
            "geometry_msgs/msg/Transform",
            translation=self.vector(pose.position),
            rotation=self._quaternion(pose.orientation),
        )
        return self.make(
            "geometry_msgs/msg/TransformStamped", header=self.header, child_frame_id=child, transform=transform
        )

    def color(self, red: float, green: float, blue: float, alpha: float) -> Any:
        """A colour, from 0 to 1."""
        return self.make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=alpha)

    def _quaternion(self, quaternion: FloatArray) -> Any:
        values = dict(zip("xyzw", quaternion.tolist(), strict=True))
        return self.make("geometry_msgs/msg/Quaternion", **values)


def _xyz(vector: FloatArray) -> dict[str, float]:
    return dict(zip("xyz", np.asarray(vector, dtype=np.float64).tolist(), strict=True))
