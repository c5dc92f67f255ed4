"""What a parsed message definition must be for rosbags to make a decoder of it in bounded time and memory."""

from __future__ import annotations

from typing import Any

MAX_FIXED_OBJECTS = 10_000
"""Longest fixed-length array of strings or messages; rosbags writes a line of code for each element."""
FILLER = "structure_needs_at_least_one_member"
"""What rosbags puts into messages without fields."""


class DefinitionError(Exception):
    """A channel that cannot be decoded: its definition is missing, wrong or of a kind that is not supported."""


def needed_types(name: str, types: Any, known: Any) -> Any:
    """The type and all that it is made of; what the definition leaves out is taken from the standard messages."""
    found: dict[str, Any] = {}
    ahead = [name]
    while ahead:
        each = ahead.pop()
        if each in found:
            continue
        definition = types.get(each, known.get(each))
        if definition is None:
            raise DefinitionError(f"the definition of {name} lacks that of {each}")
        found[each] = definition
        ahead += [used for _, kind in definition[1] if (used := _named(kind)) is not None]
    return found


def _named(kind: Any) -> str | None:
    """The message type that a field is made of."""
    from rosbags.interfaces import Nodetype

    if kind[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        kind = kind[1][0]
    return str(kind[1]) if kind[0] == Nodetype.NAME else None


def check_types(types: Any, empty: int) -> None:
    """Refuse what would keep rosbags busy for ever: types within themselves, vast arrays, sequences of nothing.

    `empty` is the size of a message without fields: 1 in CDR, 0 in ROS 1.
    """
    from rosbags.interfaces import Nodetype

    sizes: dict[str, int] = {}

    def size(name: str, within: tuple[str, ...]) -> int:
        """Lower bound of a message's bytes."""
        if name in within or len(within) > 50:
            raise DefinitionError(f"the definition of {name} contains itself")
        if name not in sizes:
            fields = [field for field in types[name][1] if field[0] != FILLER]
            sizes[name] = sum(field(kind, (*within, name)) for _, kind in fields) if fields else empty
        return sizes[name]

    def field(kind: Any, within: tuple[str, ...]) -> int:
        if kind[0] == Nodetype.NAME:
            return size(kind[1], within)
        if kind[0] == Nodetype.BASE:
            return 1
        element, length = kind[1]
        least = field(element, within)
        plain = element[0] == Nodetype.BASE and element[1][0] != "string"
        if length < 0 or (kind[0] == Nodetype.ARRAY and not plain and length > MAX_FIXED_OBJECTS):
            raise DefinitionError(f"the definition of {within[-1]} has an array of {length} elements")
        if least == 0:
            raise DefinitionError(f"the definition of {within[-1]} has an array of empty messages")
        return length * least if kind[0] == Nodetype.ARRAY else 4

    for name in types:
        size(name, ())
