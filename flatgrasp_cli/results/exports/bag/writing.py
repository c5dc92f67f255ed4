"""A bag in any of ROS's containers, written by rosbags: whole in the end, or not there."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.results.exports.bag.messages import Messages
from flatgrasp_cli.results.exports.bag.topics import TF_STATIC, TYPES, messages_of

if TYPE_CHECKING:
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.results.saved import SavedDocument

ROS1 = "noetic"
OLD_METADATA = ("dashing", "eloquent", "foxy", "galactic", "humble", "iron")
"""Distributions whose rosbag2 does not read version 9 of a bag's metadata."""
TF_TYPE, TF_DEFINITION = "tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms"
SECOND_NS = 10**9
FOREVER = QosTime(2147483647, 4294967295)
KEPT = Qos(
    history=QosHistory.KEEP_LAST,
    depth=1,
    reliability=QosReliability.RELIABLE,
    durability=QosDurability.TRANSIENT_LOCAL,
    deadline=FOREVER,
    lifespan=FOREVER,
    liveliness=QosLiveliness.AUTOMATIC,
    liveliness_lease_duration=FOREVER,
    avoid_ros_namespace_conventions=False,
)
"""Of topics whose last message whoever comes later gets, too."""


class Bag:
    """Takes plans and writes them as messages; made by `Bag.open`."""

    def __init__(self, path: Path, writer: Any, distro: str) -> None:
        self._path, self._writer, self._ros1 = path, writer, distro == ROS1
        self._store = get_typestore(
            getattr(Stores, f"ROS1_{distro.upper()}" if self._ros1 else f"ROS2_{distro.upper()}")
        )
        if self._ros1:  # rosbags' definitions of ROS 1 leave tf2_msgs out
            self._store.register(get_types_from_msg(TF_DEFINITION, TF_TYPE))
        self._connections: dict[str, Any] = {}
        self._frames = 0

    @classmethod
    @contextmanager
    def open(cls, path: Path, distro: str) -> Iterator[Bag]:
        """A bag: by its suffix an MCAP file or a ROS 1 bag, else the folder of a rosbag2 with SQLite.

        `distro` is the ROS distribution whose definitions of messages it has: `noetic` for a .bag, only. One
        that nothing was added to is not written.

        Raises
        ------
        UsageError
            If it cannot be written, or is there already.
        """
        if path.exists():
            raise UsageError(f"{path}: is there already; choose another name for the bag, or remove it")
        draft = path.with_name(f".{path.name}.part")
        with ExitStack() as stack:
            stack.callback(shutil.rmtree, draft, ignore_errors=True)
            with _written(path):
                shutil.rmtree(draft, ignore_errors=True)
                draft.mkdir(parents=True)
                made, writer = _writer(draft / path.name, distro)
                writer.__enter__()
            bag = cls(path, writer, distro)
            try:
                yield bag
            except BaseException as error:
                writer.__exit__(type(error), error, error.__traceback__)
                raise
            with _written(path):
                writer.__exit__(None, None, None)
                if bag._frames:
                    made.rename(path)

    def add(self, document: SavedDocument, text: str, cloud: Cloud | None) -> None:
        """Write a frame: its document, also as the `text` that it was read from, and its cloud if that is there.

        One whose time is not known is given its number in seconds since 1970: players want messages in some order.
        Players go by the time when a recording took a message down, which need not be the message's own.
        """
        self._frames += 1
        stamp_ns = document.source.stamp_ns or self._frames * SECOND_NS
        logged_ns = (cloud.source.logged_ns if cloud else None) or stamp_ns
        messages = Messages(self._store, stamp_ns, document.frame_id)
        serialize = self._store.serialize_ros1 if self._ros1 else self._store.serialize_cdr
        with _written(self._path):
            for topic, message in messages_of(document, text, cloud, messages).items():
                self._writer.write(self._connection(topic), logged_ns, serialize(message, TYPES[topic]))

    def _connection(self, topic: str) -> Any:
        if topic not in self._connections:
            kept: dict[str, Any] = {"latching": 1} if self._ros1 else {"offered_qos_profiles": [KEPT]}
            self._connections[topic] = self._writer.add_connection(
                topic, TYPES[topic], typestore=self._store, **(kept if topic == TF_STATIC else {})
            )
        return self._connections[topic]


def _writer(path: Path, distro: str) -> tuple[Path, Any]:
    """A writer for a bag that is named `path`, and the file or folder that it makes."""
    if path.suffix == ".bag":
        return path, rosbag1.Writer(path)
    version: Literal[8, 9] = 8 if distro in OLD_METADATA else 9
    if path.suffix == ".mcap":
        folder = path.with_suffix("")
        writer = rosbag2.Writer(folder, version=version, storage_plugin=rosbag2.StoragePlugin.MCAP)
        writer.set_compression(rosbag2.CompressionMode.STORAGE, rosbag2.CompressionFormat.ZSTD)
        return folder / path.name, writer
    return path, rosbag2.Writer(path, version=version, storage_plugin=rosbag2.StoragePlugin.SQLITE3)


@contextmanager
def _written(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"{path}: the bag cannot be written: {reason}; make room, or choose another place") from error
