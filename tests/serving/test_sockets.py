"""Clients of a socket come, go, and break off; the others get their answers."""

from __future__ import annotations

import json
import re
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.serving import parse_place
from tests.cli.command_line import COMMAND
from tests.plates import slab, write_pcd

PATIENCE_S = 60


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """Of a server that listens."""
    command = [*COMMAND, "serve", "--listen", "127.0.0.1:0", "--gripper", "pr2"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        said = re.fullmatch(r"flatgrasp: listening on 127\.0\.0\.1:(\d+)\n", server.stderr.readline())
        assert said is not None
        yield int(said[1])
        assert server.poll() is None
        server.terminate()


@pytest.fixture
def plate(tmp_path: Path) -> str:
    return str(write_pcd(tmp_path / "plate.pcd", slab(120, 40, points=1000)))


def connected(port: int) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)


def asked(client: socket.socket, line: str) -> Any:
    with client.makefile("rw", encoding="utf-8") as lines:
        print(line, file=lines, flush=True)
        return json.loads(lines.readline())


def request(id_: int, source: str) -> str:
    return json.dumps({"id": id_, "source": source})


def test_clients_are_answered_side_by_side(port: int, plate: str) -> None:
    with connected(port) as one, connected(port) as other:
        assert asked(other, request(2, plate))["id"] == 2
        assert asked(one, request(1, plate))["status"] == "ok"
        assert asked(other, "nonsense")["error"]["kind"] == "request"
        assert asked(other, request(3, plate))["status"] == "ok"


def test_a_client_that_goes_away_stops_nothing(port: int, plate: str) -> None:
    with connected(port) as half:
        half.sendall(b'{"id": 1, "sou')
    with connected(port) as deaf:
        deaf.sendall(request(1, plate).encode() + b"\n")
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # its end is a reset
    with connected(port) as client:
        assert asked(client, request(2, plate))["status"] == "ok"


def test_one_that_has_said_all_still_hears_all(port: int, plate: str) -> None:
    with connected(port) as client:
        client.sendall((request(1, plate) + "\n" + request(2, plate)).encode())
        client.shutdown(socket.SHUT_WR)
        with client.makefile(encoding="utf-8") as lines:
            assert [json.loads(line)["id"] for line in lines] == [1, 2]


def test_a_place_that_is_taken_is_said(port: int) -> None:
    done = subprocess.run(
        [*COMMAND, "serve", "--listen", f"127.0.0.1:{port}"], capture_output=True, check=False, text=True
    )
    # a system that lets two processes listen in one place would not get here
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"flatgrasp: --listen 127.0.0.1:{port}: cannot listen there")


@pytest.mark.parametrize(
    ("text", "loopback"), [("127.0.0.1:1", True), ("localhost:0", True), ("0.0.0.0:5", False), ("192.0.2.1:5", False)]
)
def test_a_place_knows_who_reaches_it(text: str, loopback: bool) -> None:
    assert parse_place(text).loopback is loopback


@pytest.mark.parametrize("text", ["127.0.0.1", ":5555", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:65536", "a b:1", ""])
def test_what_is_no_place_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="--listen"):
        parse_place(text)
