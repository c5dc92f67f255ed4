"""Decoders from the message definitions that a recording carries: one type store for each definition.

A recording may hold two types of one name, and a definition that cannot be parsed; so nothing is shared between them.
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from flatgrasp_cli.recordings.containers.bounded import UNREADABLE, inflate_message, reason
from flatgrasp_cli.recordings.containers.definition_checks import DefinitionError, check_types, needed_types
from flatgrasp_cli.recordings.containers.sniff import ZSTD_MAGIC

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


MAX_SEQUENCE = 2**31
MAX_DEFINITION_BYTES = 2**22
SEPARATOR = "=" * 80 + "\n"
IMAGE_TYPE = "sensor_msgs/msg/Image"
DEPTH_UNITS = struct.Struct("<f")
"""RealSense's SDK, since 2.48, writes after an image the metres in a count of depth, which no definition names."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel of a recording: what is needed to decode its messages.

    `schema_encoding` is ros1msg, ros2msg, ros2idl, protobuf, jsonschema or "" for none; `distro` the ROS 2 distribution
    that wrote the file, for messages that come without a definition.
    """

    topic: str
    type: str
    encoding: str
    schema_encoding: str = ""
    schema: bytes = b""
    distro: str = ""


def ros_type(name: str) -> str:
    """A type's name as ROS 2 writes it: "sensor_msgs/PointCloud2" → "sensor_msgs/msg/PointCloud2"."""
    parts = name.replace("::", "/").split("/")
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else "/".join(parts)


@lru_cache(maxsize=16)  # a batch opens a recording once for each slice
def decoder_of(channel: Channel) -> Callable[[bytes], Any]:
    """A function from a message's bytes to an object with the definition's fields.

    Raises
    ------
    DefinitionError
        If there can be none.
    """
    try:
        if channel.encoding == "json":
            return _decode_json
        if channel.encoding == "protobuf":
            from flatgrasp_cli.recordings.containers.protobuf import protobuf_decoder

            return protobuf_decoder(channel.type, channel.schema)
        if channel.encoding in ("cdr", "ros1"):
            return _ros_decoder(channel)
    except ImportError as error:
        raise DefinitionError(f"{error.name} is not installed; pip install {error.name}") from error
    except UNREADABLE as error:
        raise DefinitionError(f"the definition of {channel.type} cannot be used ({reason(error)})") from error
    raise DefinitionError(f"the encoding {channel.encoding!r} is not supported")


def _decode_json(data: bytes) -> Any:
    return json.loads(data, object_hook=lambda fields: SimpleNamespace(**fields))


def _ros_decoder(channel: Channel) -> Callable[[bytes], Any]:
    from rosbags.serde import SerdeError

    store = _typestore(channel)
    name = channel.type
    store.get_msgdef(name)

    def decode(data: bytes) -> Any:
        try:
            if channel.encoding == "ros1":
                return _with_depth_units(store, data) if name == IMAGE_TYPE else store.deserialize_ros1(data, name)
            # rosbag2 may compress each message; no CDR begins with these bytes
            return store.deserialize_cdr(inflate_message(data) if data.startswith(ZSTD_MAGIC) else data, name)
        except SerdeError as error:
            raise ValueError(reason(error)) from error

    return decode


def _with_depth_units(store: Typestore, data: bytes) -> Any:
    """An image of ROS 1; `depth_units` is what RealSense's SDK writes after it, and is not there without."""
    from rosbags.serde import SerdeError

    try:
        return store.deserialize_ros1(data, IMAGE_TYPE)
    except SerdeError as error:
        try:
            image: Any = store.deserialize_ros1(data[: -DEPTH_UNITS.size], IMAGE_TYPE)
        except SerdeError:
            raise error from None
        fields = {name: value for name, value in vars(image).items() if not name.startswith("__")}
        return SimpleNamespace(**fields, depth_units=DEPTH_UNITS.unpack(data[-DEPTH_UNITS.size :])[0])


def _typestore(channel: Channel) -> Typestore:
    from rosbags.typesys import Stores, TypesysError, get_typestore
    from rosbags.typesys.store import Typestore

    known = get_typestore(_standard_store(channel))
    if not channel.schema.strip() and channel.type in known.fielddefs:
        types = dict(known.fielddefs)
    elif not channel.schema_encoding:
        raise DefinitionError(f"the recording carries no definition of {channel.type}")
    else:
        try:
            types = _parsed(channel)
        except TypesysError as error:
            raise DefinitionError(f"the definition of {channel.type} cannot be parsed") from error
        types = {**get_typestore(Stores.EMPTY).fielddefs, **types}
    types = needed_types(channel.type, types, dict(known.fielddefs))
    check_types(types, empty=int(channel.encoding == "cdr"))
    store = Typestore(max_sequence_length=MAX_SEQUENCE)
    try:
        store.register(types)
    except TypesysError as error:
        raise DefinitionError(f"the definition of {channel.type} cannot be used ({reason(error)})") from error
    return store


def _standard_store(channel: Channel) -> Any:
    from rosbags.typesys import Stores

    if channel.encoding == "ros1":
        return Stores.ROS1_NOETIC
    try:
        return Stores(f"ros2_{channel.distro}")
    except ValueError:
        return Stores.LATEST


def _parsed(channel: Channel) -> Any:
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if len(channel.schema) > MAX_DEFINITION_BYTES:
        raise DefinitionError(f"the definition of {channel.type} is larger than {MAX_DEFINITION_BYTES} bytes")
    text = channel.schema.decode(errors="replace").replace("\r\n", "\n").replace("\0", "")
    if channel.schema_encoding != "ros2idl":
        return get_types_from_msg(text, channel.type)
    # rosbags' parser takes time that is exponential in the depth of parentheses: 2 need more than 15 s
    bare = re.sub(r'"(?:[^"\\]|\\.)*"', '""', text)
    if re.search(r"=[^;,)]*\(", bare):
        raise DefinitionError(f"the definition of {channel.type} has a constant with parentheses")
    types: dict[str, Any] = {}
    if not text.startswith(SEPARATOR + "IDL: "):
        return get_types_from_idl(text)
    for part in text.split(SEPARATOR)[1:]:
        types.update(get_types_from_idl(part.partition("\n")[2]))
    return types
