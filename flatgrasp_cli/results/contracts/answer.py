"""What `serve` takes and gives: a request in a line, an answer in a line."""

from __future__ import annotations

from typing import Any, Literal, NotRequired

from flatgrasp_cli.results.contracts.base import Part
from flatgrasp_cli.results.contracts.plan import Document

SCHEMA_ID: Literal["flatgrasp.answer/1"] = "flatgrasp.answer/1"
ErrorKind = Literal["request", "options", "source", "failure"]


class RequestDocument(Part):
    """What to plan on: `source` or `data`, one of them."""

    id: NotRequired[str | int | None]
    """What the answer is to be recognised by: text, or a whole number of any meaning."""
    source: NotRequired[str]
    """A path or URL, as `plan` takes it; paths are relative to the folder that `serve` was started in."""
    data: NotRequired[str]
    """The whole content of a file (PCD, PLY, a recording), in base64."""
    options: NotRequired[dict[str, Any]]
    """Options of `plan` by their names, `_` for hyphens; they beat those that `serve` was started with."""


class ErrorPart(Part):
    """Why a request was not carried out."""

    kind: ErrorKind
    """What is wrong: the request itself, its options or a profile, its source, or the program."""
    text: str
    """What, where, and what to do."""


class AnswerDocument(Part):
    """The answer to one request."""

    schema: Literal["flatgrasp.answer/1"]
    """Which contract this is."""
    id: str | int | None
    """The text or number of the request; null where that has none, or cannot be read."""
    status: Literal["ok", "no_grasp", "error"]
    """Whether there is a grasp in every frame."""
    documents: list[Document]
    """What `plan` says of each frame, in their order: one of a file, of a recording as many as the options choose."""
    warnings: list[str]
    """What was left out of a damaged source, a sentence each; what had to be assumed is in the documents."""
    error: ErrorPart | None
    """Why there are no documents, or no more of them; null if nothing was wrong."""
