"""What `--intrinsics` names: four numbers, or a file with a camera's calibration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.recordings.messages.camera_info import CameraInfo

MAX_BYTES = 1_000_000
WANTED = "give fx,fy,cx,cy in pixels, or a file: a ROS camera_info (YAML) or Open3D's PinholeCameraIntrinsic (JSON)"
ANY_SIZE = (0, 0)


def parse_intrinsics(text: str) -> CameraInfo:
    """Read "fx,fy,cx,cy" for images of any size, or the camera_info YAML or Open3D JSON file of that name.

    Raises
    ------
    UsageError
        If it is none of these, or describes no camera.
    """
    numbers = _four_numbers(text)
    try:
        info = _pinhole(numbers, ANY_SIZE) if numbers else _from_file(text)
        _check(info)
    except (TypeError, ValueError, OverflowError, RecursionError, LookupError) as error:
        raise UsageError(f"--intrinsics {text}: is no calibration: {error}; {WANTED}") from error
    return info


def _four_numbers(text: str) -> tuple[float, ...] | None:
    """Fx, fy, cx and cy; None if the text is the name of a file."""
    words = text.split(",")
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        return None
    if len(numbers) != 4 and not Path(text).is_file():
        raise UsageError(f"--intrinsics {text}: has {len(numbers)} numbers; {WANTED}")
    return numbers if len(numbers) == 4 else None


def _from_file(text: str) -> CameraInfo:
    path = Path(text)
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise UsageError(f"--intrinsics {text}: cannot be read: {reason}; {WANTED}") from error
    if len(content) > MAX_BYTES:
        raise UsageError(f"--intrinsics {text}: is too large for a calibration; {WANTED}")
    try:  # JSON is YAML; `ros2 topic echo` ends each message with a line that begins another document
        values = next(iter(yaml.safe_load_all(content.decode("utf-8-sig"))), None)
    except yaml.YAMLError as error:
        line = getattr(error, "problem_mark", None)
        where = f" in line {line.line + 1}" if line else ""
        raise ValueError(f"the file is neither YAML nor JSON{where}") from error
    if not isinstance(values, Mapping):
        raise TypeError("the file holds no keys with values")
    values = values.get("intrinsic", values)  # Open3D's PinholeCameraParameters
    if "intrinsic_matrix" in values:
        return _from_open3d(values)
    return _from_camera_info(values)


def _from_open3d(values: Mapping[str, Any]) -> CameraInfo:
    """Open3D writes the matrix column by column; others write its rows, which their place of the zeros tells."""
    m = _numbers(values["intrinsic_matrix"], "intrinsic_matrix")
    if len(m) != 9:
        raise ValueError(f"intrinsic_matrix has {len(m)} numbers, it needs 9")
    if (m[6], m[7]) == (0.0, 0.0):
        m = (m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8])
    return _pinhole((m[0], m[4], m[6], m[7]), (_size(values, "width"), _size(values, "height")))


def _from_camera_info(values: Mapping[str, Any]) -> CameraInfo:
    """A camera_info as camera_calibration saves it, or a message as rostopic (K, D, P) or ros2 (k, d, p) print it."""
    k = _entry(values, "camera_matrix", "k", "K")
    if k is None:
        raise LookupError("it has neither camera_matrix nor k nor intrinsic_matrix")
    d = _entry(values, "distortion_coefficients", "d", "D") or ()
    p = _entry(values, "projection_matrix", "p", "P") or ()
    roi = values.get("roi") or {}
    binning = (_size(values, "binning_x") or 1, _size(values, "binning_y") or 1)
    width = _size(roi, "width") or _size(values, "image_width", "width")
    height = _size(roi, "height") or _size(values, "image_height", "height")
    return CameraInfo(
        size=(width // binning[0], height // binning[1]),
        k=k,
        d=d,
        p=p,
        model=str(values.get("distortion_model") or values.get("camera_model") or "plumb_bob"),
        binning=binning,
        offset=(_size(roi, "x_offset"), _size(roi, "y_offset")),
    )


def _pinhole(numbers: tuple[float, ...], size: tuple[int, int]) -> CameraInfo:
    fx, fy, cx, cy = numbers
    k = (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
    return CameraInfo(size=size, k=k, d=(), p=(), model="plumb_bob", binning=(1, 1), offset=(0, 0))


def _entry(values: Mapping[str, Any], *names: str) -> tuple[float, ...] | None:
    """The numbers under the first of the names that is there, itself a list or a matrix with `data`."""
    for name in names:
        entry = values.get(name)
        if isinstance(entry, Mapping):
            entry = entry.get("data")
        if entry is not None:
            return _numbers(entry, name)
    return None


def _numbers(entry: Any, name: str) -> tuple[float, ...]:
    if not isinstance(entry, list):
        raise TypeError(f"{name} is no list of numbers")
    flat = [number for row in entry for number in (row if isinstance(row, list) else [row])]
    if any(isinstance(number, bool | list) for number in flat):
        raise TypeError(f"{name} is no list of numbers")
    return tuple(float(number) for number in flat)


def _size(values: Mapping[str, Any], *names: str) -> int:
    """The first of the entries that is there, 0 if none is."""
    size = int(next((values[name] for name in names if values.get(name) is not None), 0))
    if size < 0:
        raise ValueError(f"{names[0]} is negative")
    return size


def _check(info: CameraInfo) -> None:
    if len(info.k) != 9:
        raise ValueError(f"the camera matrix has {len(info.k)} numbers, it needs 9")
    if not all(map(math.isfinite, (*info.k, *info.d, *info.p))):
        raise ValueError("a number in it is not finite")
    if info.k[0] <= 0 or info.k[4] <= 0:
        raise ValueError(f"the focal lengths are {info.k[0]:g} and {info.k[4]:g}, they must be positive")
