"""Transforms that move and contradict each other: two for one time, and time that jumps back."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.sources.transforms import MissingTransform, TransformBuffer
from tests.recordings.writing import CLOUD_TYPE, POINTS, ROS2, START_NS, cloud_message, transform2, write_messages
from tests.sources.recordings import frames
from tests.sources.test_transforms import QUARTER_Z, S, codes, tf, transform

MS = S // 1000
Sent = tuple[int, int, float]
"""Log time, stamp and x of a camera in base_link."""


def sent(samples: Iterable[Sent], quaternion: Any = (0, 0, 0, 1)) -> TransformBuffer:
    buffer = TransformBuffer()
    for logged, stamp, x in samples:
        buffer.add(tf(transform("base", "camera", (x, 0, 0), quaternion, stamp)), logged_ns=logged)
    return buffer


def every_tenth(x: float, stamps: range = range(1, 20), late_ns: int = 0) -> list[Sent]:
    """A camera that stands at x, ten times a second."""
    return [(k * S // 10 + late_ns, k * S // 10, x) for k in stamps]


def check_whether_two(buffer: TransformBuffer, stamp: int, *, two: bool) -> None:
    """The camera is refused for being in two places, or nothing is said of it."""
    if two:
        with pytest.raises(MissingTransform, match="in two ways"):
            buffer.route("base", "camera", stamp)
    else:
        assert buffer.route("base", "camera", stamp).warnings == ()


# two for one time


@pytest.mark.parametrize("stamp", [S, S + S // 20])
@pytest.mark.parametrize("x", [3.0, 0.502])
def test_two_publishers_that_place_a_frame_differently_are_an_error(stamp: int, x: float) -> None:
    buffer = sent(sorted([*every_tenth(0.5), *every_tenth(x, late_ns=1000)]))
    with pytest.raises(MissingTransform) as caught:
        buffer.route("base", "camera", stamp)
    assert str(caught.value) == (
        "camera is given in base (moving) in two ways, which place it differently in base; "
        "--camera-pose states where the camera stands"
    )


def test_publishers_that_are_first_by_turns_are_none_the_less_two() -> None:
    samples = [(k * S + n, k * S, (0.0, 1.0)[(k + n) % 2]) for k in range(3) for n in range(2)]
    with pytest.raises(MissingTransform, match="in two ways"):
        sent(samples).route("base", "camera", S + S // 2)  # between 0 and 1 and between 1 and 0 is the same


def test_of_three_publishers_two_may_agree() -> None:
    three = [*every_tenth(0.5), *every_tenth(3.0, late_ns=1), *every_tenth(0.5 + 1e-5, late_ns=2)]
    with pytest.raises(MissingTransform, match="in two ways"):
        sent(sorted(three)).route("base", "camera", S)


def test_a_rotation_alone_is_a_contradiction_and_a_quaternions_sign_is_none() -> None:
    for second, clash in ((QUARTER_Z, True), ((0, 0, 0, -1), False)):
        buffer = sent(every_tenth(0.5, range(1, 11)))
        buffer.add(tf(transform("base", "camera", (0.5, 0, 0), second, S)), logged_ns=S)
        check_whether_two(buffer, S, two=clash)


def test_a_contradiction_above_the_common_frame_or_of_another_time_does_not_matter() -> None:
    buffer = sent(sorted([*every_tenth(0.5), (3 * S // 10 + 1, 3 * S // 10, 3.0)]))
    buffer.add(tf(transform("camera", "lens", (0, 0, 1))), static=True)
    assert buffer.route("camera", "lens", 3 * S // 10).warnings == ()
    assert buffer.route("base", "lens", S).frame.origin[0] == 0.5
    with pytest.raises(MissingTransform, match="in two ways"):
        buffer.route("base", "lens", 3 * S // 10)
    buffer.forget_before(S)
    assert buffer.route("base", "lens", S).frame.origin[0] == 0.5


@given(st.integers(0, 100), st.floats(0.2, 1.7), st.integers(0, 90))
def test_what_is_usual_is_told_nothing_of(seed: int, second: float, late_ms: int) -> None:
    random = np.random.default_rng(seed)
    truth = [(k * 20 * MS, k * 20 * MS, 0.1 * k) for k in range(100)]  # 50 Hz, 5 m/s
    again = [(logged + late_ms * MS, stamp, x + 1e-9 * random.normal()) for logged, stamp, x in truth]  # another node
    late = [(logged + int(random.integers(80)) * MS, stamp, x) for logged, stamp, x in again]  # out of order
    route = sent(sorted([*truth, *again, *late])).route("base", "camera", stamp := round(second * S), stamp + 5 * MS)
    assert route.frame.origin[0] == pytest.approx(5 * stamp / S, abs=1e-6)
    assert route.warnings == ()


def test_static_ones_that_are_latched_or_rounded_do_not_change() -> None:
    buffer = TransformBuffer()
    for k in range(20):
        message = tf(transform("base", "camera", (1 + 1e-9 * (k % 2), 0, 0)))
        buffer.add(message, static=True, logged_ns=k * S)
    assert codes(buffer.route("base", "camera", 9 * S)) == []
    buffer.add(tf(transform("base", "camera", (2, 0, 0))), static=True, logged_ns=0)  # at once with the first
    assert codes(buffer.route("base", "camera", 9 * S)) == ["transform_changed"]


@pytest.mark.parametrize(("aside", "two"), [(0.0, False), (0.050, False), (0.055, True)])
def test_samples_of_one_way_and_one_tick_are_one_publishers(aside: float, two: bool) -> None:
    """A clock that ticks ten times a second, a robot at 1 m/s, and 50 samples a second: the first of a tick counts."""
    buffer = TransformBuffer()
    for k in range(100):
        message = tf(transform("base", "camera", (0.02 * k, aside * (k % 5 == 4), 0), stamp_ns=k // 5 * S // 10))
        buffer.add(message, logged_ns=k * S // 50)
    for stamp in (S, S + S // 20, 19 * S // 10):
        if two:
            with pytest.raises(MissingTransform, match="in two ways"):
                buffer.route("base", "camera", stamp)
        else:
            route = buffer.route("base", "camera", stamp)
            assert (route.frame.origin[0], route.warnings) == (pytest.approx(stamp / S), ())


def test_noise_of_one_publisher_under_a_slow_clock_is_no_second_one() -> None:
    """It stands still, ten of its samples have one stamp, and noise goes there and back."""
    buffer = TransformBuffer()
    for k, noise in enumerate(np.random.default_rng(0).normal(0, 0.002, (200, 3))):
        message = tf(transform("base", "camera", noise, stamp_ns=k // 10 * S // 10))
        buffer.add(message, logged_ns=k * S // 100)
    for stamp in range(2 * S // 10, 18 * S // 10, 70 * MS):
        buffer.route("base", "camera", stamp)  # and no error


def test_a_clock_that_goes_back_a_little_for_a_while_is_one_publishers() -> None:
    """Its samples before and after that are one run, and the others lie in a gap of it."""
    times = [(k * S // 50, k * S // 50 - (150 * MS if 100 <= k < 150 else 0)) for k in range(300)]
    buffer = sent((logged, stamp, logged / S) for logged, stamp in times)
    for logged, stamp in times[5:-5]:
        assert codes(buffer.route("base", "camera", stamp, logged)) in ([], ["transform_time_jump"])


def test_what_is_held_on_to_at_the_end_is_no_witness_against_what_moves() -> None:
    """Two publishers that agree, one of which is late: its last sample is older than the other's."""
    early = [(k * S // 50 + 10 * MS, k * S // 50, k / 50) for k in range(100)]
    late = [(k * S // 50 + 155 * MS, k * S // 50 + 5 * MS, k / 50 + 0.005) for k in range(93)]
    buffer = sent(sorted([*early, *late]))
    for stamp in range(180 * S // 100, 198 * S // 100, 20 * MS):
        buffer.route("base", "camera", stamp, stamp + 20 * MS)  # and no error


def test_what_is_rounding() -> None:
    """Within ROUNDING, in metres and radians, a static transform is the same; of a quaternion the half angle counts."""
    half = 0.4e-6
    for xyz, quaternion, changes in (
        ((0.8e-6, 0, 0), (0, 0, 0, 1), False),
        ((1.2e-6, 0, 0), (0, 0, 0, 1), True),
        ((0, 0, 0), (0, 0, half, 1), False),
        ((0, 0, 0), (0, 0, 1.5 * half, 1), True),
    ):
        buffer = TransformBuffer()
        buffer.add(tf(transform("base", "camera")), static=True, logged_ns=1)
        buffer.add(tf(transform("base", "camera", xyz, quaternion)), static=True, logged_ns=2)
        assert codes(buffer.route("base", "camera", 3)) == ["transform_changed"] * changes


def test_an_arm_that_turns_back_within_a_tick_is_one() -> None:
    buffer = TransformBuffer()
    for k in range(200):
        x = 0.02 * abs(87 - k)
        buffer.add(tf(transform("base", "camera", (x, 0, 0), stamp_ns=k // 5 * S // 10)), logged_ns=k * S // 50)
    for k in range(14, 22):
        assert buffer.route("base", "camera", k * S // 10).warnings == ()


# time that jumps back


def reset(back_ms: int = 800, x: float = 5.0) -> list[Sent]:
    """A simulator that begins anew after 0.9 s: x grows by 1 m/s from 0, and then from `x`."""
    before = [(k * S // 10, k * S // 10, k / 10) for k in range(1, 10)]
    return [*before, *((S + k * S // 10, S + k * S // 10 - back_ms * MS - S // 10, x + k / 10) for k in range(9))]


def test_each_frame_gets_what_was_before_or_after_the_jump_as_it_was_itself() -> None:
    buffer = sent(reset())
    for logged, stamp, x in ((550, 550, 0.55), (1550, 650, 5.55), (600, 550, 0.55), (1600, 650, 5.55)):
        route = buffer.route("base", "camera", stamp * MS, logged * MS)
        assert route.frame.origin[0] == pytest.approx(x)
        (told,) = route.warnings
        assert told.code == "transform_time_jump"
        assert told.text == (
            "the time of the transform from base to camera jumps back by 0.800 s, and each frame got the one logged "
            "nearest to it; --camera-pose states where the camera stands"
        )


def test_a_jump_that_changes_nothing_is_told_nothing_of() -> None:
    still = [(logged, stamp, 1.0) for logged, stamp, _ in reset()]
    assert sent(still).route("base", "camera", 550 * MS).warnings == ()
    far = sent([*reset(), (100 * S, 100 * S, 7.0)])
    assert far.route("base", "camera", 100 * S).warnings == ()  # neither time was twice


def test_a_frame_whose_own_transform_is_lost_is_told_of() -> None:
    lost = [each for each in reset() if not 450 * MS <= each[0] < S]
    assert codes(sent(lost).route("base", "camera", 550 * MS)) == ["transform_time_jump"]


def test_what_was_read_ahead_beyond_a_jump_is_not_forgotten() -> None:
    buffer = sent([(9 * S, 100 * S, 0.0), (10 * S, 101 * S, 1.0), (11 * S, S, 5.0), (12 * S, 2 * S, 6.0)])
    buffer.forget_before(100 * S, 10 * S)
    assert buffer.lookup("base", "camera", S + S // 2, 11 * S + S // 2).origin[0] == 5.5
    buffer.forget_before(S, 11 * S)  # and what was before it is
    with pytest.raises(MissingTransform, match=r"earlier, at 2\.000 s"):
        buffer.lookup("base", "camera", 101 * S)


def test_publishers_side_by_side_are_no_jump() -> None:
    late = every_tenth(0.5, late_ns=400 * MS)
    assert sent(sorted([*every_tenth(0.5), *late])).route("base", "camera", S).warnings == ()
    with pytest.raises(MissingTransform, match="in two ways"):
        sent(sorted([*every_tenth(3.0), *late])).route("base", "camera", S)


def test_how_far_stamps_may_go_back() -> None:
    """Within TOLERANCE_NS they are only out of order."""
    for back_ms, jumps in ((90, False), (110, True)):
        buffer = sent([(S, S, 1.0), (S + 1, S - back_ms * MS, 2.0)])
        assert buffer.route("base", "camera", S, S).frame.origin[0] == 1.0
        x = buffer.lookup("base", "camera", S - 45 * MS).origin[0]
        assert x == (1.0 if jumps else 1.5)  # else between both


def test_a_recording_of_two_publishers_is_refused_and_one_of_a_reset_is_not(tmp_path: Path) -> None:
    def cloud(stamp: int) -> Any:
        message = cloud_message(ROS2, 0)
        message.header.stamp = ROS2.types["builtin_interfaces/msg/Time"](*divmod(START_NS + stamp, S))
        return message

    def recorded(samples: list[Sent], clouds: list[tuple[int, int]]) -> list[tuple[str, str, int, Any]]:
        moved = [
            ("/tf", *transform2("base", "camera", (x, 0, 0), stamp_ns=START_NS + stamp), START_NS + logged)
            for logged, stamp, x in samples
        ]
        seen = [(POINTS, CLOUD_TYPE, START_NS + logged, cloud(stamp)) for logged, stamp in clouds]
        return sorted([*((t, kind, at, m) for t, kind, m, at in moved), *seen], key=lambda each: each[2])

    path = write_messages(tmp_path / "two", recorded([*every_tenth(0.5), *every_tenth(3.0)], [(S, S)]))
    with pytest.raises(SourceError, match=r"the only frame .* in two ways"):
        frames(path, base_frame="base")
    path = write_messages(tmp_path / "jump", recorded(reset(), [(550 * MS, 550 * MS), (1550 * MS, 650 * MS)]))
    first, second = frames(path, base_frame="base")
    for found, x in ((first, 0.55), (second, 5.55)):
        np.testing.assert_allclose(found.points[:, 0].min(), x, atol=1e-6)
        assert [warning.code for warning in found.warnings] == ["transform_time_jump"]
