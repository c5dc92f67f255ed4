"""Protobuf messages from the FileDescriptorSet that an MCAP schema holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from google.protobuf import (  # type: ignore[import-untyped,unused-ignore]
    descriptor_pb2,
    descriptor_pool,
    duration_pb2,
    message,
    message_factory,
    timestamp_pb2,
)

MAX_FILES = 1000


def protobuf_decoder(name: str, schema: bytes) -> Callable[[bytes], Any]:
    """A decoder for the message type `name` of a serialised FileDescriptorSet.

    Raises
    ------
    ValueError
        If the set cannot be parsed, is not closed, or lacks the type.
    """
    try:
        files = descriptor_pb2.FileDescriptorSet.FromString(schema).file
    except message.DecodeError as error:
        raise ValueError("its FileDescriptorSet cannot be parsed") from error
    if len(files) > MAX_FILES:
        raise ValueError("too many files")
    pool = descriptor_pool.DescriptorPool()
    ahead = {file.name: file for file in files}
    for standard in (timestamp_pb2, duration_pb2):
        file = descriptor_pb2.FileDescriptorProto()
        standard.DESCRIPTOR.CopyToProto(file)
        ahead.setdefault(file.name, file)
    added: set[str] = set()
    while ready := [file for file in ahead.values() if added.issuperset(file.dependency)]:
        for file in ready:
            pool.AddSerializedFile(ahead.pop(file.name).SerializeToString())
            added.add(file.name)
    try:
        kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
    except KeyError as error:
        raise ValueError("the schema lacks it or a file that it imports") from error

    def decode(data: bytes) -> Any:
        try:
            return kind.FromString(data)
        except message.DecodeError as error:
            raise ValueError("no valid protobuf") from error

    return decode
