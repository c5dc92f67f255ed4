"""Two publishers of one transform that moves, whose stamps differ."""

from __future__ import annotations

import numpy as np
import pytest

from flatgrasp_cli.sources.transforms import MissingTransform, TransformBuffer
from tests.sources.test_transform_times import Sent, check_whether_two, every_tenth, sent
from tests.sources.test_transforms import QUARTER_Z, S, tf, transform


def stamped_by_turns(*, x: float = 3.0, every: int = 2, count: int = 40, ends: int = 40) -> list[Sent]:
    """A camera at 0, a hundred times a second; every n-th sample before the last ones is another publisher's, at x."""
    return [(k * S // 100, k * S // 100, x * (k % every == every - 1 and k < ends)) for k in range(count)]


@pytest.mark.parametrize("every", [2, 3, 11])
def test_publishers_that_take_turns_contradict_each_other(every: int) -> None:
    buffer = sent(stamped_by_turns(every=every))
    for k in range(15, 25):
        with pytest.raises(MissingTransform, match="in two ways"):
            buffer.route("base", "camera", k * S // 100 + S // 300)


@pytest.mark.parametrize(
    ("samples", "two"),
    [
        (stamped_by_turns(x=0.009), False),  # a servo's counts, at rest
        (stamped_by_turns(x=0.011), True),
        (stamped_by_turns(ends=4), False),  # 0 x 0 x 0: the other one has ended before the fifteen samples
        ([*every_tenth(0.0, range(5)), *every_tenth(3.0, range(5, 20))], False),  # it was carried away
        ([(k, k, 3.0 * (k == 7)) for k in range(20)], False),  # a mistake
        ([(k, k, 3.0 * (k in (6, 8, 9, 10))) for k in range(9)], False),  # not yet twice
        ([(k, k, 3.0 * (k in (6, 8))) for k in range(10)], True),
        ([(k, k, (0.0, 3.0, 0.0, 3.0 + 0.08 * 3)[k % 4]) for k in range(20)], True),
        ([(k, k, (0.0, 3.0, 0.0, 3.0 + 0.13 * 3)[k % 4]) for k in range(20)], False),  # neither is steady
        ([(k, k, float(np.sin(k))) for k in range(40)], False),
        ([(k, k, float(x)) for k, x in enumerate(np.random.default_rng(0).normal(size=100))], False),
    ],
)
def test_what_are_two_publishers(samples: list[Sent], two: bool) -> None:
    buffer = sent(samples)
    stamp = 20 * S // 100 + 1 if samples[1][0] == S // 100 else min(samples[-1][0], 10)
    check_whether_two(buffer, stamp, two=two)


def test_publishers_that_turn_a_frame_differently_take_turns() -> None:
    buffer = TransformBuffer()
    for k in range(20):
        message = tf(transform("base", "camera", quaternion=(QUARTER_Z, (0, 0, 0, 1))[k % 2], stamp_ns=k))
        buffer.add(message, logged_ns=k)
    with pytest.raises(MissingTransform, match="in two ways"):
        buffer.route("base", "camera", 9)
