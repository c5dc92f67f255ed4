"""The tree of frames over time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from flatgrasp_cli.sources.messages import MessageError
from flatgrasp_cli.sources.transforms import MissingTransform, TransformBuffer

S = 1_000_000_000
IDENTITY = (0.0, 0.0, 0.0, 1.0)
QUARTER_Z = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5))
record = SimpleNamespace


def transform(
    parent: str, child: str, xyz: Any = (0, 0, 0), quaternion: Any = IDENTITY, stamp_ns: int = 0
) -> SimpleNamespace:
    return record(
        header=record(stamp=record(sec=stamp_ns // S, nanosec=stamp_ns % S), frame_id=parent),
        child_frame_id=child,
        transform=record(
            translation=record(**dict(zip("xyz", xyz, strict=True))),
            rotation=record(**dict(zip("xyzw", quaternion, strict=True))),
        ),
    )


def tf(*transforms: Any) -> SimpleNamespace:
    return record(transforms=list(transforms))


def moving(*transforms: Any) -> TransformBuffer:
    buffer = TransformBuffer()
    for one in transforms:
        buffer.add(tf(one))
    return buffer


def test_a_static_chain_is_composed() -> None:
    buffer = TransformBuffer()
    buffer.add(
        tf(transform("base", "arm", (1, 0, 0), QUARTER_Z), transform("/arm", "/camera", (0.5, 0, 0))), static=True
    )
    frame = buffer.lookup("base", "camera", 123)
    # the arm looks along base's y: half a metre ahead of it is (1, 0.5, 0), and its own x axis is base's y
    np.testing.assert_allclose(frame.origin, [1, 0.5, 0], atol=1e-15)
    np.testing.assert_allclose(frame.to_world(np.array([[0.25, 0, 0]])), [[1, 0.75, 0]], atol=1e-15)
    back = buffer.lookup("camera", "/base", 123)
    np.testing.assert_allclose(back.to_world(np.array([[1, 0.75, 0]])), [[0.25, 0, 0]], atol=1e-15)


def test_siblings_meet_at_their_parent() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("base", "left", (0, 1, 0)), transform("base", "right", (0, -1, 0))), static=True)
    np.testing.assert_array_equal(buffer.lookup("left", "right", 0).origin, [0, -2, 0])


def test_a_frame_in_itself_is_the_identity() -> None:
    np.testing.assert_array_equal(TransformBuffer().lookup("a", "/a", 0).axes, np.eye(3))


def test_between_samples_translation_is_linear_and_rotation_an_arc() -> None:
    buffer = moving(
        transform("base", "camera", (1, 0, 0), QUARTER_Z, 3 * S), transform("base", "camera", (0, 0, 0), stamp_ns=1 * S)
    )
    frame = buffer.lookup("base", "camera", 1 * S + S // 2)
    angle = np.radians(90 / 4)
    np.testing.assert_allclose(frame.origin, [0.25, 0, 0], atol=1e-15)
    np.testing.assert_allclose(frame.axes[0], [np.cos(angle), np.sin(angle), 0], atol=1e-15)


@given(st.integers(0, 1000), st.floats(0, 1))
def test_the_arc_is_scipys(seed: int, share: float) -> None:
    ends = Rotation.random(2, rng=np.random.default_rng(seed))
    first, second = ends.as_quat()
    buffer = moving(transform("a", "b", (0, 0, 0), first), transform("a", "b", (0, 0, 0), -second, S))
    stamp = round(share * S)
    axes = buffer.lookup("a", "b", stamp).axes
    np.testing.assert_allclose(axes.T, Slerp([0, S], ends)(stamp).as_matrix(), atol=1e-7)


def test_a_sample_holds_for_the_tolerance_and_no_longer() -> None:
    buffer = moving(transform("base", "camera", (1, 0, 0), stamp_ns=10 * S))
    for stamp in (10 * S - S // 10, 10 * S + S // 10):
        np.testing.assert_array_equal(buffer.lookup("base", "camera", stamp).origin, [1, 0, 0])
    with pytest.raises(MissingTransform, match=r"camera ← base is not known at that time, .* earlier, at 10\.000 s"):
        buffer.lookup("base", "camera", 10 * S + S // 4)
    with pytest.raises(MissingTransform, match=r"later, at 10\.000 s"):
        buffer.lookup("base", "camera", 10 * S - S // 4)


def test_a_stale_link_above_the_common_frame_does_not_matter() -> None:
    buffer = moving(transform("odom", "base"))
    buffer.add(tf(transform("base", "camera", (1, 0, 0))), static=True)
    np.testing.assert_array_equal(buffer.lookup("base", "camera", 100 * S).origin, [1, 0, 0])


def test_forgetting_keeps_one_older_sample() -> None:
    buffer = moving(*(transform("base", "camera", (float(t), 0, 0), stamp_ns=t * S) for t in range(10)))
    buffer.forget_before(5 * S + S // 2)
    np.testing.assert_array_equal(buffer.lookup("base", "camera", 5 * S + S // 2).origin, [5.5, 0, 0])
    with pytest.raises(MissingTransform, match=r"later, at 5\.000 s"):
        buffer.lookup("base", "camera", 4 * S)
    assert sum(map(len, buffer._moving.values())) == 5


def test_the_same_time_again_replaces() -> None:
    buffer = moving(transform("a", "b", (1, 0, 0), stamp_ns=S), transform("a", "b", (2, 0, 0), stamp_ns=S))
    np.testing.assert_array_equal(buffer.lookup("a", "b", S).origin, [2, 0, 0])


def test_the_parent_is_that_of_the_time() -> None:
    buffer = moving(
        transform("left", "cup", (1, 0, 0), stamp_ns=S), transform("right", "cup", (2, 0, 0), stamp_ns=2 * S)
    )
    assert buffer.lookup("left", "cup", S).origin[0] == 1
    assert buffer.lookup("left", "cup", S + S // 20).origin[0] == 1
    assert buffer.lookup("right", "cup", 2 * S).origin[0] == 2
    with pytest.raises(MissingTransform):
        buffer.lookup("right", "cup", S)


def test_quaternions_are_normalised_and_nonsense_is_ignored_and_counted() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("a", "b", quaternion=(0, 0, 3, 3))), static=True)
    np.testing.assert_allclose(buffer.lookup("a", "b", 0).axes[0], [0, 1, 0], atol=1e-15)
    buffer.add(
        tf(
            transform("a", "c", quaternion=(0, 0, 0, 0)),
            transform("a", "c", (np.nan, 0, 0)),
            transform("a", "c", quaternion=(0, 0, np.inf, 1)),
            transform("a", "/a"),
        )
    )
    assert buffer.ignored == 4
    assert buffer.frames() == ("a", "b")


def test_a_broken_chain_says_where() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("camera_link", "optical"), transform("base_link", "torso")), static=True)
    with pytest.raises(MissingTransform) as caught:
        buffer.lookup("base_link", "optical", 0)
    assert str(caught.value) == (
        "no transform from optical to base_link: optical ← camera_link is known and ends there; base_link is the root "
        "of: base_link, torso; frames in this recording: base_link, camera_link, optical, torso"
    )


def test_an_unknown_frame_is_named_and_the_list_is_short() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(*(transform("base", f"f{i:02}") for i in range(30))), static=True)
    with pytest.raises(MissingTransform, match=r"^no frame 'nowhere' in this recording; .* f18, and 11 more$"):
        buffer.lookup("nowhere", "base", 0)
    with pytest.raises(MissingTransform, match="frames in this recording: none"):
        TransformBuffer().lookup("a", "b", 0)


def test_a_cycle_ends() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("a", "b"), transform("b", "a"), transform("x", "y")), static=True)
    with pytest.raises(MissingTransform):
        buffer.lookup("x", "a", 0)


def test_foxglove_transforms() -> None:
    def foxglove(**stamp: int) -> SimpleNamespace:
        return record(
            timestamp=record(**stamp),
            parent_frame_id="base",
            child_frame_id="camera",
            translation=record(x=1.0, y=2.0, z=3.0),
            rotation=record(x=0.0, y=0.0, z=0.0, w=1.0),
        )

    for message in (foxglove(sec=1, nsec=5), record(transforms=[foxglove(seconds=1, nanos=5)])):
        buffer = TransformBuffer(tolerance_ns=0)
        buffer.add(message)
        np.testing.assert_array_equal(buffer.lookup("base", "camera", S + 5).origin, [1, 2, 3])


def test_other_messages_are_refused_and_an_empty_one_is_not() -> None:
    TransformBuffer().add(tf())
    with pytest.raises(MessageError, match="is no transform"):
        TransformBuffer().add(record(data="hello"))
