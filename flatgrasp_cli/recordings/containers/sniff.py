"""Which container a file is, from its first bytes; this loads no library."""

from __future__ import annotations

from pathlib import Path

MAGICS = {b"\x89MCAP0\r\n": "mcap", b"#ROSBAG V": "ros1", b"#ROSRECORD V": "ros1", b"SQLite format 3\0": "sqlite"}
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
SNIFFED_BYTES = 16


def kind_of(path: Path) -> str:
    """The container of a file, looking through zstd: "mcap", "ros1", "sqlite", or "" for none of them."""
    head = first_bytes(path)
    return next((kind for magic, kind in MAGICS.items() if head.startswith(magic)), "")


def first_bytes(path: Path) -> bytes:
    """The first bytes of a file, or of what a zstd file holds."""
    with path.open("rb") as file:
        head = file.read(SNIFFED_BYTES)
    if not head.startswith(ZSTD_MAGIC):
        return head
    from flatgrasp_cli.recordings.containers.bounded import first_inflated_bytes

    return first_inflated_bytes(path, SNIFFED_BYTES) or head
