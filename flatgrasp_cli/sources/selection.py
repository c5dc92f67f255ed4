"""Which frames of a recording are wanted, and the words for that on a command line."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import UTC, datetime
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, Literal, get_args

from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.profiles import CameraPose
    from flatgrasp_cli.recordings.messages.camera_info import CameraInfo

DepthAxes = Literal["optical", "body"]
NS = 1_000_000_000
UNIX_S = 100_000_000
"""No recording is this many seconds long: a greater number is Unix time."""


def _check_count(name: str, value: int | None) -> None:
    if value is not None and (value < 1 or value != int(value)):
        raise ValueError(f"{name} is a whole number, one or more, not {value}")


@dataclass(frozen=True, slots=True)
class Moment:
    """A time: `ns` after the recording's start, or, if `absolute`, after 1970."""

    ns: int
    absolute: bool

    def after(self, start_ns: int) -> int:
        """The time in nanoseconds since 1970, of a recording that starts at `start_ns`."""
        return self.ns if self.absolute else start_ns + self.ns


@dataclass(frozen=True, slots=True)
class Every:
    """Every n-th frame, or the first in each period; `ValueError` if either is less than one."""

    frames: int = 1
    period_ns: int | None = None

    def __post_init__(self) -> None:
        """Check what was given."""
        _check_count("frames", self.frames)
        _check_count("period_ns", self.period_ns)


@dataclass(frozen=True, slots=True)
class Selection:
    """Which frames of a source are wanted, in which frame of reference, and what has to be said of them for that.

    Raises
    ------
    ValueError
        If a value is out of its range, or `at` is given with what chooses other frames.
    """

    topic: str | None = None
    """Of a recording; None: the only one with clouds."""
    start: Moment | None = None
    """Frames lie in start ≤ t < end."""
    end: Moment | None = None
    at: Moment | None = None
    """Only the first frame at or after this time."""
    every: Every = Every()
    count: int | None = None
    """At most so many frames."""
    base_frame: str | None = None
    """The frame to bring clouds into; None: they stay in their own."""
    sensor_frame: str | None = None
    """A recording's frame of the sensor that saw them."""
    colors: bool = False
    """Whether clouds come with the colours that they have."""
    strict: bool = False
    """Whether the first problem ends the reading with an error."""
    intrinsics: CameraInfo | None = None
    """Of the camera that took depth images; None: as a recording says."""
    depth_unit_m: float | None = None
    """Metres in one count of depth; None: as the images say."""
    depth_axes: DepthAxes | None = None
    """Whether the frame that depth images are stamped with is an optical one (x right, y down, z forward) or a body's
    (x forward, z up); None: as its name and the transforms tell."""
    # the last two are not in words: a batch begun before goes on only with the same words, and its manifest holds the
    # pose by itself
    camera_pose: CameraPose | None = field(default=None, repr=False)
    """Of the clouds' own frame in `base_frame`; None: as a recording's transforms tell."""
    typed: frozenset[str] = field(default=frozenset(), repr=False)
    """Which of these were typed for just these sources, by their options' names: of one that is nothing to a source
    there is a warning. Defaults from a file, and what a batch of all kinds of sources is given, are not meant so."""

    def __post_init__(self) -> None:
        """Check what was given."""
        _check_count("count", self.count)
        if self.at is not None and (self.start, self.end, self.every, self.count) != (None, None, Every(), None):
            raise ValueError("at names one frame; leave out start, end, every and count")
        if self.depth_unit_m is not None and not 0 < self.depth_unit_m <= 1:  # false for NaN, too
            raise ValueError(f"depth_unit_m is metres in one count, more than 0 and at most 1, not {self.depth_unit_m}")
        if self.depth_axes not in (None, *get_args(DepthAxes)):
            raise ValueError(f"depth_axes are {' or '.join(get_args(DepthAxes))}, not {self.depth_axes!r}")

    @property
    def needs_transforms(self) -> bool:
        """Whether only transforms tell where the clouds or their sensor are."""
        return self.sensor_frame is not None or (self.base_frame is not None and self.camera_pose is None)


EVERYTHING = Selection()


def parse_moment(text: str) -> Moment:
    """Read seconds from the recording's start, Unix seconds, or an ISO 8601 time, in UTC if it names no zone.

    Raises
    ------
    UsageError
        If it is none of these.
    """
    seconds = _seconds(text)
    if seconds is not None:
        return Moment(int(seconds * NS), seconds >= UNIX_S)
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        raise UsageError(f"{text!r} is no time: give seconds from the start, or e.g. 2026-11-23T14:05:00") from None
    since = (time if time.tzinfo else time.replace(tzinfo=UTC)) - datetime.fromtimestamp(0, UTC)
    return Moment((since.days * 86_400 + since.seconds) * NS + since.microseconds * 1000, absolute=True)


def parse_every(text: str) -> Every:
    """Read "5", frames, or "0.5s", seconds.

    Raises
    ------
    UsageError
        If it is neither, or not positive.
    """
    period = _seconds(text[:-1]) if text.endswith("s") else None
    if period is not None and period * NS >= 1:
        return Every(period_ns=int(period * NS))
    if re.fullmatch(r"0*[1-9]\d{0,17}", text):  # what counts messages is no longer than 64 bits
        return Every(frames=int(text))
    raise UsageError(f"--every {text}: give a number of frames, as 5, or of seconds, as 0.5s")


def _seconds(text: str) -> Decimal | None:
    """The number of seconds, exact to the nanosecond, 0 or more; None if it is none."""
    try:
        value = Decimal(text)
    except InvalidOperation:
        return None
    return value if value.is_finite() and 0 <= value < 2**63 // NS else None
