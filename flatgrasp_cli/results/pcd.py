"""An organised cloud as a PCD file, as a depth camera's driver writes it."""

from __future__ import annotations

from flatgrasp_cli.geometry.arrays import FloatArray


def organised_pcd(image: FloatArray) -> bytes:
    """A binary PCD file of points (h, w, 3) in the camera's optical frame, NaN where nothing was measured."""
    height, width, _ = image.shape
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {width * height}\nDATA binary\n"
    )
    return header.encode("ascii") + image.astype("<f4").tobytes()
