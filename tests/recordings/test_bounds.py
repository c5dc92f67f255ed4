"""No recording inflates beyond what it may: chunks, messages and files."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from backports import zstd
from mcap.writer import CompressionType

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers import bounded, is_recording, open_recording
from tests.recordings.containers import read
from tests.recordings.writing import (
    START_NS,
    write_mcap,
)


@pytest.mark.parametrize("declared", [10, 2**20, 2**33])
@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunks_inflate_to_what_they_declare_at_most(
    declared: int, compression: CompressionType, tmp_path: Path
) -> None:
    path = write_mcap(tmp_path / "a", count=1, compression=compression)
    data = bytearray(path.read_bytes())
    chunk = next(k for k in range(len(data)) if data[k] == 6 and data[k + 9 : k + 17] == struct.pack("<Q", START_NS))
    struct.pack_into("<Q", data, chunk + 25, declared)
    path.write_bytes(data)
    messages, problems = read(path)
    assert messages == []
    assert next(iter(problems)).startswith(f"chunk at byte {chunk} skipped: ")


def test_bomb_of_a_chunk_is_stopped_early() -> None:
    bomb = zstd.compress(bytes(2**28))
    content, fault = bounded.inflate("zstd", bomb, 1000)
    assert (len(content), fault) == (0, "inflates beyond its declared size")


def test_chunk_of_zeros_ends_at_once(tmp_path: Path) -> None:
    content = zstd.compress(bytes(2**28))
    head = struct.pack("<QQQII", START_NS, START_NS, 2**28, 0, 4) + b"zstd" + struct.pack("<Q", len(content))
    path = tmp_path / "a"
    magic = b"\x89MCAP0\r\n"
    path.write_bytes(magic + b"\x06" + struct.pack("<Q", len(head) + len(content)) + head + content)
    messages, problems = read(path)
    assert messages == []
    assert "chunk at byte 8 is damaged at byte 0 of its content" in problems


def test_messages_inflate_piece_by_piece_up_to_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "MESSAGE_PIECE_BYTES", 1000)
    monkeypatch.setattr(bounded, "MAX_CHUNK_BYTES", 100_000)
    content = np.random.default_rng(0).bytes(100_000)
    assert bounded.inflate_message(zstd.compress(content[:900])) == content[:900]
    assert bounded.inflate_message(zstd.compress(content)) == content
    for broken in (zstd.compress(content + b"!"), zstd.compress(content)[:-10], zstd.compress(bytes(10**7))):
        with pytest.raises(ValueError, match="cut short or too large"):
            bounded.inflate_message(broken)


def test_bomb_of_a_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "MIN_FILE_BYTES", 2**22)
    path = tmp_path / "a"
    path.write_bytes(zstd.compress(b"\x89MCAP0\r\n" + bytes(2**25)))
    assert is_recording(path)
    with pytest.raises(SourceError, match=r"^rec: the zstd file of \d+ bytes inflates to more than 4194304 bytes"):
        open_recording(path, "rec")
