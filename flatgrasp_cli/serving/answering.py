"""A request → its answer of contract `flatgrasp.answer/1`, whatever is wrong with it."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from typing import Any, Literal, cast

from flatgrasp_cli.errors import FlatgraspError, SourceError, UsageError
from flatgrasp_cli.job import Job, collected_warnings
from flatgrasp_cli.results.contracts.answer import SCHEMA_ID, AnswerDocument, ErrorKind, ErrorPart
from flatgrasp_cli.results.contracts.plan import Document
from flatgrasp_cli.results.document import to_document
from flatgrasp_cli.serving.requests import RequestError, parse_request

FRAMES_AT_MOST = 100
"""Of one request: their documents are in memory together, some 100 kB each."""
KINDS: tuple[tuple[type[FlatgraspError], ErrorKind], ...] = (
    (RequestError, "request"),
    (SourceError, "source"),
    (FlatgraspError, "options"),
)


class Answerer:
    """Answers requests one after the other, on whichever threads they come.

    `job_of` makes the job of a request's options; it keeps what it has loaded, or an answer waits for that.
    """

    def __init__(self, job_of: Callable[[dict[str, Any]], Job]) -> None:
        self._job_of = job_of
        self._planning = threading.Lock()

    def answer(self, line: bytes | None) -> str:
        """The answer to one line, as a line without its end; None is a line that was too long."""
        with self._planning, collected_warnings() as warnings:  # what is warned of meanwhile is of this request
            answer = self._answer(line)
            answer["warnings"] = list(dict.fromkeys(warnings))
        # in ASCII: an id may hold half a surrogate pair, which no encoding of Unicode has
        return json.dumps(answer, separators=(",", ":"), allow_nan=False)

    def _answer(self, line: bytes | None) -> AnswerDocument:
        id_: str | int | None = None
        documents: list[Document] = []
        error: ErrorPart | None = None
        try:
            request = parse_request(line)
            id_ = request.id
            self._plan(self._job_of(request.options), request.source, request.content, documents)
        except FlatgraspError as wrong:
            id_ = wrong.id if isinstance(wrong, RequestError) else id_
            error = _error(wrong)
        except Exception as fault:  # noqa: BLE001 (a fault of ours in one request must not cost the others theirs)
            error = ErrorPart(kind="failure", text=f"{type(fault).__name__}: {fault}; this is a bug, please report it")
        status: Literal["ok", "no_grasp"] = "ok" if all(each["status"] == "ok" for each in documents) else "no_grasp"
        return AnswerDocument(
            schema=SCHEMA_ID,
            id=id_,
            status="error" if error else status,
            documents=documents,
            warnings=[],
            error=error,
        )

    @staticmethod
    def _plan(job: Job, source: str, content: bytes | None, documents: list[Document]) -> None:
        """Append the documents of a source's frames, as long as there are not too many."""
        for cloud, read_ms in job.clouds(source, content):
            if len(documents) == FRAMES_AT_MOST:
                raise UsageError(
                    f"{source}: has more than the {FRAMES_AT_MOST} frames that are answered at once; choose some with "
                    "at, start, end, every or count, or plan all with `flatgrasp batch`"
                )
            documents.append(cast("Document", to_document(job.plan(cloud), read_ms)))


def _error(wrong: FlatgraspError) -> ErrorPart:
    return ErrorPart(kind=next(kind for cls, kind in KINDS if isinstance(wrong, cls)), text=str(wrong))
