"""Which topic of a recording holds the clouds."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from flatgrasp_cli.errors import SourceError
from flatgrasp_cli.recordings.containers.recording import Recording, Topic, printable
from flatgrasp_cli.recordings.messages import CLOUD_TYPES, IMAGE_TYPES, LOSSY, is_depth, is_lossy_depth

LEGACY = "sensor_msgs/msg/PointCloud"
LISTED = 40
NO_DEPTH = frozenset({"ir", "infra", "infrared", "amplitude", "intensity", "confidence"})
"""Words of topics whose images have depth's encodings and hold something else."""


def choose_topic(recording: Recording, wanted: str | None, name: str) -> Topic:
    """The topic called `wanted`, or, if that is None, the only one with clouds.

    PointCloud2 and Foxglove's clouds come before ROS's old PointCloud, and that before depth images.

    Raises
    ------
    SourceError
        If it is not there, holds something else, or if there are several.
    """
    if not recording.topics:
        problem = recording.problems.taken()
        raise SourceError(f"{name}: is a recording ({recording.container}) without topics{problem and f': {problem}'}")
    if wanted is not None:
        return _called(recording, wanted, name)
    clouds = [topic for topic in recording.topics if topic.type in CLOUD_TYPES and topic.count != 0]
    preferred = [topic for topic in clouds if topic.type != LEGACY] or clouds or depth_topics(recording)
    if len(preferred) == 1:
        return preferred[0]
    if preferred:
        raise SourceError(f"{name}: several topics hold clouds; choose one with --topic{_listed(preferred)}")
    before = recording.problems.copy()
    lossy = next((topic.name for topic in recording.topics if _begins_with(recording, topic, is_lossy_depth)), None)
    lost = [printable(topic.name) for topic in recording.topics if _may_be_depth(topic) and _is_lost(recording, topic)]
    recording.problems.reset(before)  # all that had been met already
    if lossy is not None:
        raise SourceError(f"{name}: the depth images on {printable(lossy)} are {LOSSY}")
    problem = recording.problems.taken()
    if lost:
        which = " or ".join(lost[:LISTED])
        raise SourceError(f"{name}: no message on {which} could be read{problem and f': {problem}'}")
    far = problem and f", as far as it can be read ({problem})"
    raise SourceError(f"{name}: holds no point clouds and no depth images{far}{_listed(recording.topics)}")


def depth_topics(recording: Recording) -> list[Topic]:
    """The image topics whose first message is a depth image by its encoding, and whose name does not say otherwise."""
    return [topic for topic in recording.topics if _may_be_depth(topic) and _begins_with(recording, topic, is_depth)]


def _may_be_depth(topic: Topic) -> bool:
    """Whether it has images, and its name does not say that they are of something else."""
    name = topic.name.lower()
    return topic.type in IMAGE_TYPES and ("depth" in name or NO_DEPTH.isdisjoint(re.split("[^a-z]+", name)))


def _is_lost(recording: Recording, topic: Topic) -> bool:
    """Whether none of a topic's messages can be read, though it has some, or may have lost some."""
    there = topic.count if topic.count is not None else len(recording.problems.counts)
    return there > 0 and next(recording.messages([topic.name]), None) is None


def _begins_with(recording: Recording, topic: Topic, kind: Callable[[Any], bool]) -> bool:
    """Whether the first image of a topic is of a kind."""
    if topic.type not in IMAGE_TYPES:
        return False
    before = recording.problems.copy()
    first = next(recording.messages([topic.name]), None)
    if first is None or not kind(first.value):
        return False
    recording.problems.reset(before)  # its frames are read from the beginning
    return True


def _called(recording: Recording, wanted: str, name: str) -> Topic:
    named = [topic for topic in recording.topics if topic.name.strip("/") == wanted.strip("/")]
    if not named:
        raise SourceError(f"{name}: has no topic {wanted}{_listed(recording.topics)}")
    usable = [topic for topic in named if topic.type in CLOUD_TYPES or topic.type in IMAGE_TYPES]
    if not usable:
        types = " and ".join(topic.type for topic in named)
        raise SourceError(
            f"{name}: topic {wanted} holds {types}, no point clouds or depth images{_listed(recording.topics)}"
        )
    return usable[0]


def _listed(topics: tuple[Topic, ...] | list[Topic]) -> str:
    """The topics with types and counts, a line each, those with clouds first."""

    def usefulness(topic: Topic) -> tuple[bool, bool, str]:
        return (topic.type not in CLOUD_TYPES, topic.type not in IMAGE_TYPES, topic.name)

    ordered = sorted(topics, key=usefulness)
    lines = [f"  {printable(topic.name)}  {printable(topic.type)}  {_counted(topic)}" for topic in ordered[:LISTED]]
    more = [f"  … and {len(ordered) - LISTED} more"] if len(ordered) > LISTED else []
    return "; it has:\n" + "\n".join(lines + more)


def _counted(topic: Topic) -> str:
    return "messages not counted" if topic.count is None else f"{topic.count} message{'s'[: topic.count != 1]}"
