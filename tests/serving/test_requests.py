"""What is a request, what is none, and why."""

from __future__ import annotations

import base64
import io
import json
import typing

import pytest

from flatgrasp_cli.results.contracts.answer import RequestDocument
from flatgrasp_cli.serving import requests_in
from flatgrasp_cli.serving.requests import INLINE, KEYS, RequestError, parse_request

WRONG = {
    "nothing": (b"{", None, "no line of JSON"),
    "no-text": (b"\xff\xfe", None, "no line of JSON"),
    "nan": (b'{"id": NaN, "source": "a.pcd"}', None, "NaN"),
    "too-many-digits": (b'{"id": ' + b"9" * 5000 + b"}", None, "no line of JSON"),
    "deep": (b"[" * 100_000, None, "nested"),
    "list": (b"[1]", None, "list"),
    "id-is-a-list": (b'{"id": [1], "source": "a.pcd"}', None, "id"),
    "id-is-no-word": (b'{"id": true, "source": "a.pcd"}', None, "id"),
    "no-source": (b'{"id": 1}', 1, "give source"),
    "both": (b'{"id": 1, "source": "a.pcd", "data": ""}', 1, "give source"),
    "unknown-key": (b'{"id": "b", "sources": "a.pcd"}', "b", "did you mean 'source'"),
    "source-is-a-number": (b'{"id": 1, "source": 7}', 1, "source"),
    "source-is-the-stream": (b'{"id": 1, "source": "-"}', 1, "data"),
    "source-has-a-zero": (b'{"id": 1, "source": "a\\u0000.pcd"}', 1, "source"),
    "no-base64": (b'{"id": 1, "data": "@@"}', 1, "base64"),
    "no-base64-either": (b'{"id": 1, "data": "\xc3\xa9"}', 1, "base64"),
    "data-is-a-list": (b'{"id": 1, "data": [1]}', 1, "base64"),
    "options-are-a-list": (b'{"id": 1, "source": "a.pcd", "options": ["-g"]}', 1, "options"),
    "too-long": (None, None, "64 MiB"),
}


@pytest.mark.parametrize(("line", "id_", "word"), WRONG.values(), ids=WRONG)
def test_what_is_no_request_says_why_and_keeps_its_id(line: bytes | None, id_: str | int | None, word: str) -> None:
    with pytest.raises(RequestError, match=word) as caught:
        parse_request(line)
    assert caught.value.id == id_
    assert len(str(caught.value)) < 200


def test_a_request_names_a_source_or_brings_it_along() -> None:
    named = parse_request(b'{"id": "a", "source": "a.pcd", "options": {"top": 3}}\n')
    assert (named.id, named.source, named.content, named.options) == ("a", "a.pcd", None, {"top": 3})
    brought = parse_request(json.dumps({"data": base64.b64encode(b"PCD").decode()}).encode())
    assert (brought.id, brought.source, brought.content, brought.options) == (None, INLINE, b"PCD", {})


def test_its_keys_are_those_of_the_contract() -> None:
    assert set(typing.get_type_hints(RequestDocument)) == set(KEYS)


def test_lines_that_are_too_long_are_skipped_whole() -> None:
    stream = io.BytesIO(b"12345678\n" + b"9" * 5_000_000 + b"\n\n  \r\n1234\n" + b"8" * 9)
    assert list(requests_in(stream, longest=8)) == [b"12345678\n", None, b"1234\n", None]


def test_the_last_line_needs_no_end() -> None:
    assert list(requests_in(io.BytesIO(b"1\n2"))) == [b"1\n", b"2"]
