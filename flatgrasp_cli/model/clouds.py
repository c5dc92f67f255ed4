"""What was recorded: a cloud, where it comes from, and where its sensor was."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray, IntArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.kernels.points import not_measured
from flatgrasp_cli.model.measured import UNKNOWN, Measured
from flatgrasp_cli.model.sensors import Sensor, place

LARGEST_COORDINATE_M = 1e4
"""What lies farther from the origin than 10 km was not measured by anything that looks at objects."""

UNNAMED_FRAME = "cloud"
"""What the frame of a cloud is called in results if its source names none, as most files do."""

SENSOR_FROM_TF = "sensor_from_tf"
"""Code of the warning that holds only while the sensor is where the transforms have it."""
UP_UNTOLD = "mesh_up_assumed"
"""Code of the warning that holds only while nobody says which way is up."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where a cloud was recorded: file, topic, time, and its place among the frames read.

    `logged_ns` is when the recording took it down, `stamp_ns` what the message says itself, where it does.
    """

    path: str = "array"
    topic: str | None = None
    stamp_ns: int | None = None
    index: int = 0
    logged_ns: int | None = None

    def __str__(self) -> str:
        return self.path if self.stamp_ns is None else f"{self.path} at {self.stamp_ns / 1e9:.3f} s"


@dataclass(frozen=True, slots=True)
class CloudWarning:
    """Something that had to be assumed of a cloud and can change the answer.

    `code` is stable, in snake_case; `text` is one sentence for people, which names the option that settles it and says
    the same for all frames of a source that it holds for.
    """

    code: str
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class ImageGrid:
    """The image that an organised cloud is: `shape` (height, width), and which pixels hold the cloud's points.

    `filled` (height · width,) marks them row by row, in the order of the points.
    """

    shape: tuple[int, int]
    filled: BoolArray

    def select(self, keep: BoolArray) -> ImageGrid:
        """The image of the points (n,) that `keep` names."""
        filled = self.filled.copy()
        filled[np.flatnonzero(filled)[~keep]] = False
        return ImageGrid(self.shape, filled)


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """One recorded frame: `points` (n, 3) in metres in `frame_id`.

    Points that were not measured (NaN, infinite, exactly 0 0 0, farther than 10 km, masked in a masked array) are taken
    out when a cloud is made, and counted in `dropped`. An array (height, width, 3) makes an organised cloud, whose
    points are the pixels of one image.

    >>> Cloud(np.array([[0.0, 0.1, 0.8], [np.nan, np.nan, np.nan]])).dropped
    1

    Raises
    ------
    ValueError
        If the points or a viewpoint have another shape, or a viewpoint is not finite.
    """

    points: FloatArray
    viewpoint: FloatArray | None = None
    """Where the sensor was, (3,), as whoever wrote the cloud states; believed if the cloud can be seen from there."""
    source: Source = field(default_factory=Source)
    frame_id: str = ""
    dropped: int = 0
    """Points of the recording that were not measured."""
    colors: ByteArray | None = None
    """RGB (n, 3) of the points, where the recording has colours and they were asked for."""
    sensor: Sensor | None = None
    """Where the sensor was, if that is known; None until `locate` finds it."""
    inverse_viewpoint: FloatArray | None = None
    """Where the sensor was, (3,), if the pose that the file states is meant the other way round."""
    pixels: ImageGrid | None = None
    """The image that the points are the pixels of, if they are those of one."""
    warnings: tuple[CloudWarning, ...] = ()
    measured: Measured = field(default=UNKNOWN, repr=False)
    """The `points` again, if all of them are known to have been measured: they are not looked through once more."""

    def __post_init__(self) -> None:
        """Check the shapes, and take out what was not measured."""
        points = np.asarray(self.points, dtype=np.float64)
        if isinstance(self.points, np.ma.MaskedArray):
            points = np.where(np.ma.getmaskarray(self.points), np.nan, points)
        if points.ndim == 3 and points.shape[2] == 3 and self.pixels is None:
            height, width, _ = points.shape
            object.__setattr__(self, "pixels", ImageGrid((height, width), np.ones(height * width, dtype=np.bool_)))
            points = points.reshape(-1, 3)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points of a cloud are an array (n, 3) or (height, width, 3), not {points.shape}")
        object.__setattr__(self, "points", points)
        for name in ("viewpoint", "inverse_viewpoint"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, place(getattr(self, name), f"the {name} of a cloud"))
        if points is self.measured.points:
            return
        corners = np.empty((2, 3))
        lost = not_measured(points, LARGEST_COORDINATE_M, corners)
        object.__setattr__(self, "measured", Measured(points, corners))
        if len(lost):
            rest = self.without(lost)
            for name in ("points", "dropped", "colors", "pixels", "measured"):
                object.__setattr__(self, name, getattr(rest, name))

    def sample(self, size: int) -> FloatArray:
        """An even sample (min(size, n), 3) of the points, which nobody may change."""
        return self.measured.sample(size)

    @property
    def frame_name(self) -> str:
        """What the cloud's frame is called in results: never empty."""
        return self.frame_id or UNNAMED_FRAME

    def without(self, lost: IntArray) -> Cloud:
        """The cloud without the points in the rows `lost` (k,), which count as dropped."""
        keep = np.ones(len(self.points), dtype=np.bool_)
        keep[lost] = False
        return replace(self.select(keep), dropped=self.dropped + len(lost))

    def select(self, keep: BoolArray) -> Cloud:
        """The points (n,) that `keep` names."""
        rows = np.flatnonzero(keep)  # a mask takes several times as long
        points = self.points.take(rows, axis=0)
        return replace(
            self,
            points=points,
            measured=Measured(points, self.measured.corners),
            colors=None if self.colors is None else self.colors.take(rows, axis=0),
            pixels=None if self.pixels is None else self.pixels.select(keep),
        )

    def in_frame(self, frame: Frame, frame_id: str) -> Cloud:
        """The cloud in the frame `frame_id`, in which its own frame has the pose `frame`."""
        stated, inverse = (
            None if place is None else frame.to_world(place) for place in (self.viewpoint, self.inverse_viewpoint)
        )
        return replace(
            self,
            points=frame.to_world(self.points),
            viewpoint=stated,
            inverse_viewpoint=inverse,
            sensor=self.sensor and self.sensor.in_frame(frame),
            frame_id=frame_id,
        )

    def warned(self, *warnings: CloudWarning) -> Cloud:
        """The cloud with further warnings, none of them twice."""
        return replace(self, warnings=tuple(dict.fromkeys((*self.warnings, *warnings)))) if warnings else self
