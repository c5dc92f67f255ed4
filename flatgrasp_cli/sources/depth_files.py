"""Depth images as files: PNG of 16 bits, TIFF of 16 bits or floats, and numpy's .npy."""

from __future__ import annotations

import warnings
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.model import Cloud, CloudWarning, ImageGrid, Sensor, Source
from flatgrasp_cli.recordings.messages import MessageError
from flatgrasp_cli.recordings.messages.depth_image import MILLIMETRE, DepthImage
from flatgrasp_cli.recordings.messages.png import PNG_MAGIC, decode_png, png_size
from flatgrasp_cli.recordings.messages.principal_point import camera_doubt
from flatgrasp_cli.sources.depth_axes import in_body_axes
from flatgrasp_cli.sources.depth_unit import unit_warning
from flatgrasp_cli.sources.selection import Selection
from flatgrasp_cli.sources.text_lines import shown
from flatgrasp_cli.sources.tiff import MAGICS as TIFF_MAGICS
from flatgrasp_cli.sources.tiff import decode_tiff, tiff_size

NPY_MAGIC = b"\x93NUMPY"
MOST_PIXELS = 2**24
"""Sixteen million: no depth camera has more, and a point takes a hundred bytes on its way."""
POINT_COLUMNS = (3, 4, 6)
UNREADABLE = (ValueError, EOFError, OverflowError, MemoryError, SyntaxError, TypeError, TokenError)
"""What numpy raises where a header, which is Python, is none."""


def is_depth_file(head: bytes) -> bool:
    """Whether a file that begins so is an image or an array; whether that is depth, reading it tells."""
    return head.startswith((PNG_MAGIC, *TIFF_MAGICS, NPY_MAGIC))


class DepthFiles:
    """Reads depth images of one camera; the rays of its pixels are computed once for each size of image."""

    def __init__(self, selection: Selection, scale: float = 1.0) -> None:
        self._selection, self._scale = selection, scale
        self._shape: tuple[int, ...] = ()
        self._rays: FloatArray = np.empty((0, 2))

    def read(self, path: Path, source: Source) -> Cloud:
        """The points of the depth image at `path` in its camera's frame: x right, y down, z forward.

        Where the selection asks for a body's axes, x is forward and z up.

        Raises
        ------
        UsageError
            If the selection has no intrinsics.
        SourceError
            If the file is broken or no depth image, or the intrinsics are those of another size.
        """
        if self._selection.intrinsics is None:
            raise UsageError(
                f"{source.path}: a depth image needs its camera's --intrinsics fx,fy,cx,cy | FILE, and --depth-unit "
                "where a count is not a millimetre"
            )
        try:
            raw = _image(path)
            return self._cloud(raw, source)
        except MessageError as error:
            raise SourceError(f"{source.path}: {error}") from error

    def _cloud(self, raw: NDArray[Any], source: Source) -> Cloud:
        unit_m, stated_m = MILLIMETRE if raw.dtype.kind in "iu" else 1.0, self._selection.depth_unit_m
        depth, pixels = DepthImage(raw, unit_m).metres(stated_m)
        settled = stated_m is not None or self._scale != 1.0
        doubt = None if settled else unit_warning(depth, unit_m)
        points = np.empty((len(depth), 3))
        with np.errstate(over="ignore", invalid="ignore"):
            points[:, :2] = self._rays_of(raw.shape)[pixels]
            points[:, :2] *= depth[:, None]
            points[:, 2] = depth
            points *= self._scale
        filled: BoolArray = np.zeros(raw.size, dtype=np.bool_)
        filled[pixels] = True
        cloud = Cloud(
            points,
            source=source,
            dropped=raw.size - len(points),
            sensor=Sensor("frame", np.zeros(3)),
            pixels=ImageGrid((raw.shape[0], raw.shape[1]), filled) if min(raw.shape) > 1 else None,
            warnings=tuple(item for item in (doubt, self._camera_doubt(raw.shape)) if item is not None),
        )
        return in_body_axes(cloud) if self._selection.depth_axes == "body" else cloud

    def _camera_doubt(self, shape: tuple[int, ...]) -> CloudWarning | None:
        info = self._selection.intrinsics
        doubt = None if info is None else camera_doubt(info, shape[1], shape[0])
        return None if doubt is None else CloudWarning(doubt.code, doubt.text)

    def _rays_of(self, shape: tuple[int, ...]) -> FloatArray:
        info = self._selection.intrinsics
        if shape != self._shape and info is not None:
            self._rays, self._shape = info.rays(shape[1], shape[0], rectified=False), shape
        return self._rays


def _image(path: Path) -> NDArray[Any]:
    """The image (height, width), of integers or floats."""
    with path.open("rb") as file:
        magic = file.read(len(PNG_MAGIC))
    if magic.startswith(NPY_MAGIC):
        raw = _array(path)
        _check_size(raw.shape[1], raw.shape[0])
        return raw
    data = path.read_bytes()
    if magic == PNG_MAGIC:
        pixels = np.frombuffer(data, np.uint8)
        _check_size(*png_size(pixels))
        return decode_png(pixels)
    _check_size(*tiff_size(data))
    return decode_tiff(data)


def _check_size(width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise MessageError(f"the image has {width} × {height} pixels, more than {MOST_PIXELS}")


def _array(path: Path) -> NDArray[Any]:
    try:  # mapped, so that nothing is allocated for what a header claims
        with warnings.catch_warnings():  # of headers that Python 2 wrote
            warnings.simplefilter("ignore")
            raw = np.load(path, mmap_mode="r", allow_pickle=False)
    except UNREADABLE as error:
        raise MessageError(f"the .npy file is broken: {shown(str(error).partition(chr(10))[0])}") from error
    if raw.ndim != 2 or raw.dtype.kind not in "iuf" or raw.dtype.itemsize < 2:
        raise MessageError(
            f"an array {raw.shape} of {raw.dtype} is no depth image; that is (height, width) of integers of 16 or more "
            "bits, or of floats"
        )
    if raw.shape[1] in POINT_COLUMNS and raw.shape[0] > raw.shape[1]:
        raise MessageError(f"an array {raw.shape} is a list of points, no depth image; save it as PCD or PLY")
    return np.asarray(raw)
