"""sensor_msgs/CameraInfo: which way each pixel of an image looks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.recordings.messages.decoded import MessageError, reading

FISHEYE = "equidistant"
COEFFICIENTS = {"plumb_bob": (4, 5), "rational_polynomial": (8, 12, 14), FISHEYE: (4,)}
"""Distortion models and how many coefficients each may have."""
SAME_MODEL = {"brown conrady": "plumb_bob", "kannala brandt4": FISHEYE}
"""What RealSense's SDK calls models of ROS; of Kannala and Brandt's four coefficients it writes a fifth, 0."""
NEVER_A_PINHOLE = frozenset({FISHEYE, "ftheta", "fisheye", "thin_prism_fisheye"})
"""Models that bend the picture even with all coefficients 0; of all others nothing is left then."""
NO_MODEL = frozenset({"", "none"})
ITERATIONS, PRECISION = 50, 1e-9
TOLERANCE_PX = 0.1
"""A ray that does not come back to its pixel within this is none: some distortions cannot be undone in the corners."""
CHECKED_AT_ONCE = 32_768


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """One camera's calibration. `size`, `offset` and `binning` are (x, y); `size` is that of the images it describes.

    `k` is the raw image's camera matrix (9,), `d` its distortion, `p` the rectified image's projection (12,), all for
    the full sensor: pixel u of an image is pixel u · binning + offset of the sensor.
    """

    size: tuple[int, int]
    k: tuple[float, ...]
    d: tuple[float, ...]
    p: tuple[float, ...]
    model: str
    binning: tuple[int, int]
    offset: tuple[int, int]

    def __post_init__(self) -> None:
        """Call the distortion model by ROS's name."""
        plain = self.model.strip().lower()
        object.__setattr__(self, "model", SAME_MODEL.get(plain.replace("_", " "), plain))
        if self.model == FISHEYE and self.d[4:] == (0.0,):
            object.__setattr__(self, "d", self.d[:4])

    @classmethod
    def from_message(cls, message: Any) -> CameraInfo:
        """Read a CameraInfo of ROS 2 (k, d, p) or of ROS 1 (K, D, P)."""
        with reading("CameraInfo"):
            roi = message.roi
            binning = (int(message.binning_x) or 1, int(message.binning_y) or 1)
            # a region of interest of all zeros is the whole sensor
            full = (int(roi.width) or int(message.width), int(roi.height) or int(message.height))
            k, d, p = (
                tuple(float(x) for x in getattr(message, name if hasattr(message, name) else name.upper()))
                for name in "kdp"
            )
            return cls(
                size=(full[0] // binning[0], full[1] // binning[1]),
                k=k,
                d=d,
                p=p,
                model=str(message.distortion_model),
                binning=binning,
                offset=(int(roi.x_offset), int(roi.y_offset)),
            )

    def check_size(self, width: int, height: int) -> None:
        """Raise `MessageError` unless images of this size are those that are described."""
        if (width, height) == self.size or 0 in self.size:
            return
        text = f"the image is {width} × {height}, but its CameraInfo is for {self.size[0]} × {self.size[1]}"
        ratios = {(a * self.binning[0]) / b for a, b in zip(self.size, (width, height), strict=True) if b}
        if len(ratios) == 1 and (ratio := ratios.pop()) > 1 and ratio.is_integer() and self.binning == (1, 1):
            text += f", {ratio:g} times as large, and names no binning"
        raise MessageError(f"{text}; give that of the image with --intrinsics")

    def rays(self, width: int, height: int, *, rectified: bool) -> FloatArray:
        """For each pixel, row by row, x and y (height · width, 2) at depth 1; NaN where the distortion has no inverse.

        A raw image is described by K and the distortion, a rectified one by P, which some cameras leave empty: they
        rectify in hardware, and K is the same. Where only P is given, the image must be rectified.
        """
        self.check_size(width, height)
        raw, projection = (_focal(self.k, 9, range(9)), _focal(self.p, 12, (0, 1, 2, 4, 5, 6, 8, 9, 10)))
        rectified = rectified or raw is None
        matrix = projection if rectified and projection is not None else raw
        if matrix is None:
            raise MessageError(
                "its CameraInfo has no focal length: the camera is not calibrated; give --intrinsics fx,fy,cx,cy"
            )
        grid = np.empty((height, width, 2))
        grid[..., 0] = np.arange(width, dtype=np.float64) * self.binning[0] + self.offset[0]
        grid[..., 1] = (np.arange(height, dtype=np.float64) * self.binning[1] + self.offset[1])[:, None]
        pixels: FloatArray = grid.reshape(-1, 2)
        if rectified or not self._is_distorted():
            return np.asarray((pixels - matrix[[2, 5]]) / matrix[[0, 4]])
        return self._undistorted(pixels, matrix.reshape(3, 3))

    def _is_distorted(self) -> bool:
        """Whether the lens is no pinhole: a fisheye lens never is one, not even with all coefficients 0."""
        if self.model in NO_MODEL or (self.model not in NEVER_A_PINHOLE and not any(self.d)):
            return False
        if self.model not in COEFFICIENTS:
            known = ", ".join(COEFFICIENTS)
            raise MessageError(
                f"the distortion model {self.model!r} of its CameraInfo is not known; known are {known}; "
                "if the image is rectified, or its distortion does not matter, give --intrinsics fx,fy,cx,cy"
            )
        if len(self.d) not in COEFFICIENTS[self.model] or not np.isfinite(self.d).all():
            wanted = " or ".join(map(str, COEFFICIENTS[self.model]))
            raise MessageError(f"its CameraInfo has distortion {list(self.d)}; {self.model} takes {wanted} numbers")
        return True

    def _undistorted(self, pixels: FloatArray, matrix: FloatArray) -> FloatArray:
        import cv2

        d = np.array(self.d)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, ITERATIONS, PRECISION)
        project: Callable[[FloatArray], Any]
        if self.model == FISHEYE:
            rays = cv2.fisheye.undistortPoints(pixels[:, None], matrix, d, criteria=criteria)

            def project(part: FloatArray) -> Any:
                return cv2.fisheye.distortPoints(part[:, None], matrix, d)
        else:
            rays = cv2.undistortPoints(pixels[:, None], matrix, d, criteria=criteria)

            def project(part: FloatArray) -> Any:
                ones = np.ones((len(part), 1))
                return cv2.projectPoints(np.hstack([part, ones]), np.zeros(3), np.zeros(3), matrix, d)[0]

        result = np.array(rays, dtype=np.float64).reshape(-1, 2)
        for start in range(0, len(result), CHECKED_AT_ONCE):  # OpenCV also computes 30 derivatives of each
            part = slice(start, start + CHECKED_AT_ONCE)
            error = np.abs(project(result[part]).reshape(-1, 2) - pixels[part]).max(axis=1)
            result[part][~(error < TOLERANCE_PX)] = np.nan
        return result


def _focal(values: tuple[float, ...], count: int, places: Iterable[int]) -> FloatArray | None:
    """The camera matrix (9,) at those places of `count` values; None if it has no focal length."""
    if len(values) != count:
        return None
    matrix = np.array([values[place] for place in places])
    return matrix if np.isfinite(matrix).all() and matrix[0] > 0 and matrix[4] > 0 else None
