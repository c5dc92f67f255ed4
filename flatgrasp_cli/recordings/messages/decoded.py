"""What every kind of message decodes to."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, ByteArray, FloatArray

LARGEST_NS = 2**63 - 1


class MessageError(ValueError):
    """A message that contradicts itself or is of a kind that is not read; the text says which and how."""


@dataclass(frozen=True, slots=True)
class Assumption:
    """What was taken for true where a message contradicts itself in a way that can be understood.

    `code` is stable, in snake_case; `text` is one sentence for people, the same for all messages that it holds for.
    """

    code: str
    text: str


ROW_STEP_IGNORED = Assumption(
    "row_step_ignored",
    "the bytes of a row that the messages declare (row_step) cannot be, and were ignored: the data is exactly that of "
    "width × height points, row by row",
)


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """The finite `points` (n, 3) of one message, in metres in `frame_id`.

    `shape` is the height and width that the message declares, `dropped` how many of those points are NaN, infinite or
    no data. `colors` (n, 3) are RGB. `stamp_ns` is the header's time, None when it is not set.
    """

    points: FloatArray
    colors: ByteArray | None
    dropped: int
    shape: tuple[int, int]
    frame_id: str
    stamp_ns: int | None
    viewpoint: FloatArray | None = None
    """Where the points were seen from, (3,), in `frame_id`; None where the message does not say."""
    from_camera: bool = False
    """Whether a camera at the frame's origin saw them, which looked along z with x to its right."""
    filled: BoolArray | None = None
    """Which pixels (height · width,) of an image of that shape they are, row by row; None where they are not those of
    one."""
    assumed_unit_m: float | None = None
    """The metres in one count of depth, where nothing but the image's encoding tells them; None where that is settled.
    """
    assumptions: tuple[Assumption, ...] = ()


class CloudDecoder(Protocol):
    """Decodes one kind of message; colours cost time and only pictures want them, so they come when asked for."""

    def __call__(self, message: Any, *, colors: bool = False) -> Decoded:
        """Decode `message`; raises `MessageError` when it contradicts itself."""
        ...


@contextmanager
def reading(kind: str) -> Iterator[None]:
    """Turns a field that is missing or of a wrong type, as any JSON message may have, into a `MessageError`."""
    try:
        yield
    except MessageError:
        raise
    except AttributeError as error:
        raise MessageError(f"is no {kind}: it has no field {error.name!r}") from error
    except (TypeError, ValueError, OverflowError) as error:
        raise MessageError(f"is no {kind}: {error}") from error


def stamp_ns(stamp: Any) -> int | None:
    """Nanoseconds of a ROS 1, ROS 2, JSON or protobuf time; None for 0, which means that nobody set it."""
    seconds = _first(stamp, "sec", "secs", "seconds")
    rest = _first(stamp, "nanosec", "nsec", "nsecs", "nanos")
    nanoseconds = seconds * 1_000_000_000 + rest
    if abs(nanoseconds) > LARGEST_NS:
        raise MessageError(f"its time, {seconds} s, is none")
    return nanoseconds or None


def unit_quaternion(quaternion: FloatArray) -> FloatArray | None:
    """The quaternion (4,) at norm 1; None if it is not finite, or 0."""
    largest = float(np.abs(quaternion).max())
    if not 0 < largest < np.inf:
        return None
    scaled = quaternion / largest  # so that its squares neither overflow nor vanish
    return np.asarray(scaled / np.linalg.norm(scaled))


def frame_name(name: str) -> str:
    """A frame's name without the leading slash that tf, though not tf2, wrote."""
    return name.lstrip("/")


def raw_bytes(data: Any) -> ByteArray:
    """Message data, an array or any buffer, as uint8 (n,) without copying it."""
    if isinstance(data, np.ndarray):
        return np.ascontiguousarray(data).reshape(-1).view(np.uint8)
    return np.frombuffer(data, np.uint8)


def _first(record: Any, *names: str) -> int:
    return next((int(getattr(record, name)) for name in names if hasattr(record, name)), 0)
