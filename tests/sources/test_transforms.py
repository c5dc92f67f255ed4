"""The tree of frames over time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from flatgrasp_cli.recordings.messages import MessageError
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
        transform("base", "camera", (0, 0, 0), stamp_ns=1 * S), transform("base", "camera", (1, 0, 0), QUARTER_Z, 3 * S)
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
    with pytest.raises(MissingTransform):
        buffer.lookup("base", "camera", 4 * S + S // 2)


def test_the_parent_is_that_of_the_time() -> None:
    buffer = moving(
        transform("left", "cup", (1, 0, 0), stamp_ns=S), transform("right", "cup", (2, 0, 0), stamp_ns=2 * S)
    )
    assert buffer.lookup("left", "cup", S).origin[0] == 1
    assert buffer.lookup("left", "cup", S + S // 20).origin[0] == 1
    assert buffer.lookup("right", "cup", 2 * S).origin[0] == 2
    with pytest.raises(MissingTransform):
        buffer.lookup("right", "cup", S)


def codes(route: Any) -> list[str]:
    return [warning.code for warning in route.warnings]


def test_quaternions_are_normalised_and_only_beyond_rounding_is_that_told() -> None:
    buffer = TransformBuffer()
    rounded = tuple(1.0005 * part for part in QUARTER_Z)
    buffer.add(tf(transform("a", "b", quaternion=(0, 0, 3, 3)), transform("a", "c", quaternion=rounded)), static=True)
    for child in "bc":
        np.testing.assert_allclose(buffer.lookup("a", child, 0).axes[0], [0, 1, 0], atol=1e-15)
    (told,) = buffer.route("a", "b", 0).warnings
    assert told.code == "transform_normalised"
    assert "from a to b was used, though its quaternion is not of length 1" in told.text
    assert codes(buffer.route("a", "c", 0)) == []


@pytest.mark.parametrize(
    ("broken", "why"),
    [
        ({"quaternion": (0, 0, 0, 0)}, "its quaternion is 0 0 0 0"),
        ({"xyz": (np.nan, 0, 0)}, "its translation is not finite"),
        ({"xyz": (0, 1e300, 0)}, "its translation is beyond all places"),
        ({"quaternion": (0, 0, np.inf, 1)}, "its quaternion is not finite"),
    ],
)
def test_what_is_no_rigid_motion_is_ignored_and_the_frame_is_still_there(broken: dict[str, Any], why: str) -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("a", "c", **broken), transform("c", "d")), static=True)
    assert buffer.frames() == ("a", "c", "d")
    with pytest.raises(MissingTransform, match=f"from d to a: the transform from a to c was ignored, for {why}; --cam"):
        buffer.lookup("a", "d", 0)
    buffer.add(tf(transform("a", "c")), static=True)  # another message mends it
    (told,) = buffer.route("a", "d", 0).warnings
    assert told.code == "transform_ignored"
    assert f"the transform from a to c was ignored, for {why}" in told.text
    assert codes(buffer.route("c", "d", 0)) == []


def test_a_frame_in_itself_is_ignored() -> None:
    buffer = moving(transform("a", "/a"), transform("b", "a"))
    (told,) = buffer.route("b", "a", 0).warnings
    assert "the transform from a to a was ignored, for it is one of a frame in itself" in told.text


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


def test_a_circle_is_named_and_does_not_matter_above_the_common_frame() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("a", "b"), transform("b", "a"), transform("x", "y")), static=True)
    for pair in (("x", "a"), ("b", "a"), ("a", "b")):
        with pytest.raises(MissingTransform, match=r"go round in a circle, (a ← b ← a|b ← a ← b); --camera-pose"):
            buffer.lookup(*pair, 0)
    buffer.add(tf(transform("a", "arm"), transform("arm", "left"), transform("arm", "right", (1, 0, 0))), static=True)
    np.testing.assert_array_equal(buffer.lookup("left", "right", 0).origin, [1, 0, 0])


# contradictions


def two_parents(odom_to_camera: Any = (9, 9, 9), *, joined: bool = True) -> TransformBuffer:
    """A camera in base_link, static, and in odom, moving; `joined`: base_link is in odom."""
    buffer = moving(transform("odom", "camera", odom_to_camera), *[transform("odom", "base_link")] * joined)
    buffer.add(tf(transform("base_link", "camera", (1, 0, 0))), static=True)
    return buffer


def test_two_parents_that_place_a_frame_differently_are_an_error_that_names_both() -> None:
    with pytest.raises(MissingTransform) as caught:
        two_parents().lookup("base_link", "camera", 0)
    assert str(caught.value) == (
        "camera is given in odom (moving) and in base_link (static), which place it differently in base_link; "
        "--camera-pose states where the camera stands"
    )


def test_two_parents_that_agree_are_none_too_many() -> None:
    route = two_parents((1, 0, 0.0005)).route("base_link", "camera", 0)
    np.testing.assert_array_equal(route.frame.origin, [1, 0, 0.0005])
    assert route.warnings == ()


@pytest.mark.parametrize(("target", "x"), [("base_link", 1), ("odom", 9)])
def test_of_two_parents_the_one_that_leads_there_counts_and_both_are_named(target: str, x: float) -> None:
    route = two_parents(joined=False).route(target, "camera", 0)
    assert route.frame.origin[0] == x
    (told,) = route.warnings
    assert told.code == "transform_conflict"
    assert told.text == (
        f"camera is given in odom (moving) and in base_link (static), of which only {target} leads to {target}; "
        "--camera-pose states where the camera stands"
    )


def test_two_parents_above_the_common_frame_do_not_matter() -> None:
    buffer = two_parents()
    buffer.add(tf(transform("camera", "lens", (0, 0, 1))), static=True)
    assert buffer.route("camera", "lens", 0).warnings == ()


def test_two_static_parents_contradict_each_other() -> None:
    buffer = TransformBuffer()
    buffer.add(tf(transform("world", "base"), transform("world", "camera"), transform("base", "camera", (1, 0, 0))),
               static=True)  # fmt: skip
    with pytest.raises(MissingTransform, match=r"is given in world \(static\) and in base \(static\)"):
        buffer.lookup("world", "camera", 0)


def test_two_publishers_that_take_turns_contradict_each_other() -> None:
    turns = (transform(("left", "right")[k % 2], "cup", (k % 2, 0, 0), stamp_ns=k * S // 10) for k in range(8))
    buffer = moving(*turns)
    buffer.add(tf(transform("base", "left"), transform("base", "right")), static=True)
    with pytest.raises(MissingTransform, match=r"cup is given in right \(moving\) and in left \(moving\)"):
        buffer.lookup("base", "cup", S // 2)


def test_a_static_transform_holds_from_when_it_was_sent() -> None:
    buffer = TransformBuffer()
    for x, sent in ((1, 10 * S), (2, 20 * S), (3, 30 * S)):
        buffer.add(tf(transform("base", "camera", (x, 0, 0))), static=True, logged_ns=sent)
        buffer.add(tf(transform("base", "camera", (x, 0, 0))), static=True, logged_ns=sent + 1)  # says nothing new
    for logged, x in ((0, 1), (10 * S, 1), (20 * S - 1, 1), (20 * S, 2), (25 * S, 2), (99 * S, 3)):
        route = buffer.route("base", "camera", 7, logged)
        assert route.frame.origin[0] == x
        assert codes(route) == ["transform_changed"]
    buffer.forget_before(0, 25 * S)
    assert buffer.lookup("base", "camera", 7, 25 * S).origin[0] == 2
    assert buffer.lookup("base", "camera", 7, 0).origin[0] == 2


def test_only_what_is_new_is_taken_if_so_asked() -> None:
    buffer = TransformBuffer()
    for x in (1, 2):
        buffer.add(tf(transform("base", "camera", (x, 0, 0))), static=True, logged_ns=x, only_new=True)
    assert buffer.lookup("base", "camera", 9).origin[0] == 1


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
