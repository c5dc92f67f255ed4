"""Does a process that stays lose a request, or grow? Requests to `flatgrasp serve`, every tenth of them malformed.

    python benchmarks/serve_requests.py [--count 1000]

Prints the memory along the way, and how long an answer takes beside the planning in it, the median of all.
"""

from __future__ import annotations

import argparse
import base64
import json
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import IO, Any

SAMPLES = Path(__file__).resolve().parent.parent / "sample_data"
NAMES = ("pan", "hammer", "teddy_bear", "pistol")
MALFORMED = ("{", "[]", '{"id": 1}', '{"id": 1, "source": "nowhere.pcd"}', '{"id": 1, "data": "@"}', "[" * 100_000)
FIRST = 5
"""Answers that still wait for libraries to load."""


def line(number: int) -> str:
    """A request: every tenth is malformed, every third of the others brings its cloud along."""
    if number % 10 == 7:
        return MALFORMED[number // 10 % len(MALFORMED)]
    path = SAMPLES / f"{NAMES[number % len(NAMES)]}.pcd"
    if number % 3 == 0:
        return json.dumps({"id": number, "data": base64.b64encode(path.read_bytes()).decode()})
    return json.dumps({"id": number, "source": str(path)})


def memory_mib(process: int) -> float:
    """Resident memory of a process, where the system tells."""
    status = Path(f"/proc/{process}/status")
    rows = status.read_text(encoding="utf-8").splitlines() if status.exists() else []
    return next((int(row.split()[1]) / 1024 for row in rows if row.startswith("VmRSS")), float("nan"))


def asked(ask: IO[bytes], said: IO[bytes], text: str) -> tuple[dict[str, Any], float]:
    """The answer to a line, and the milliseconds that it took."""
    began = time.perf_counter()
    ask.write(f"{text}\n".encode())
    ask.flush()
    answer: dict[str, Any] = json.loads(said.readline())
    return answer, 1e3 * (time.perf_counter() - began)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    count = parser.parse_args().count
    command = [sys.executable, "-m", "flatgrasp_cli", "serve", "--gripper", "pr2"]
    lost, shares = 0, []
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as server:  # noqa: S603
        assert server.stdin is not None  # noqa: S101 (a pipe was asked for)
        assert server.stdout is not None  # noqa: S101
        for number in range(count):
            answer, took_ms = asked(server.stdin, server.stdout, line(number))
            if number % 10 == 7:
                lost += answer["status"] != "error"
                continue
            lost += (answer["id"], answer["status"]) != (number, "ok")
            if number >= FIRST:
                shares.append(took_ms / answer["documents"][0]["timing_ms"]["total"])
            if number % max(count // 5, 1) == 0 or number == count - 1:
                print(f"{number + 1:6} requests: {memory_mib(server.pid):6.1f} MiB")
        server.stdin.close()
    print(f"{lost} lost; an answer takes {median(shares):.2f} times the planning in it")


if __name__ == "__main__":
    main()
