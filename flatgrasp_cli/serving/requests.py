"""A line → a request, or an error that says what is wrong with it."""

from __future__ import annotations

import base64
import binascii
import json
from dataclasses import dataclass, field
from typing import Any, NoReturn

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.profiles.faults import suggestion
from flatgrasp_cli.serving.lines import LONGEST_REQUEST

INLINE = "inline"
"""What a source is called that came with its request."""
KEYS = ("id", "source", "data", "options")


class RequestError(UsageError):
    """A line that is no request; `id` is its request's where that could be read."""

    def __init__(self, text: str, id_: str | int | None = None) -> None:
        super().__init__(text)
        self.id = id_


@dataclass(frozen=True, slots=True)
class Request:
    """What to plan on, and how: `source` is a path or a URL, or what `content` is called where that came along."""

    id: str | int | None
    source: str
    content: bytes | None = None
    options: dict[str, Any] = field(default_factory=dict)


def parse_request(line: bytes | None) -> Request:
    """The request of a line; None is one that was too long.

    Raises
    ------
    RequestError
        If it is none.
    """
    if line is None:
        raise RequestError(f"is longer than {LONGEST_REQUEST >> 20} MiB; write the cloud to a file, and name that")
    values = _object(line)
    id_ = values.get("id")
    if isinstance(id_, bool) or not isinstance(id_, str | int | None):
        raise RequestError("id: is neither text nor a whole number")
    try:
        return _request(id_, values)
    except UsageError as error:
        raise RequestError(str(error), id_) from error


def _object(line: bytes) -> dict[str, Any]:
    try:
        values = json.loads(line.decode("utf-8-sig"), parse_constant=_no_number)
    except RecursionError:
        raise RequestError("is nested too deeply for a request") from None
    except ValueError as error:  # of the text, its encoding, or a number with too many digits
        raise RequestError(f"is no line of JSON: {error}") from error
    if not isinstance(values, dict):
        raise RequestError(f'is no JSON object like {{"id": 1, "source": "cloud.pcd"}}, but {type(values).__name__}')
    return values


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number in JSON")


def _request(id_: str | int | None, values: dict[str, Any]) -> Request:
    for key in values:
        if key not in KEYS:
            raise UsageError(f"{key}: unknown key{suggestion(key, list(KEYS))} (allowed: {', '.join(KEYS)})")
    source, data, options = values.get("source"), values.get("data"), values.get("options") or {}
    if (source is None) == (data is None):
        raise UsageError("give source, a path or URL, or data, a file's content in base64: one of them")
    if not isinstance(options, dict):
        raise UsageError('options: are no JSON object like {"gripper": "pr2"}')
    if data is not None:
        return Request(id_, INLINE, _decoded(data), options)
    if not isinstance(source, str) or source in ("", "-") or "\0" in source:
        raise UsageError("source: is no path or URL; a cloud that is no file goes into data, in base64")
    return Request(id_, source, None, options)


def _decoded(data: Any) -> bytes:
    if not isinstance(data, str):
        raise UsageError("data: is no text in base64")
    try:
        return base64.b64decode(data, validate=True)
    except (binascii.Error, ValueError) as error:
        raise UsageError(f"data: is not base64: {error}") from error
