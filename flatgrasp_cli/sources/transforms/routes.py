"""Ways between two frames at one time, and which of two counts where transforms contradict each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import CloudWarning
from flatgrasp_cli.sources.transforms.links import Link

SAME_M, SAME_RAD = 1e-3, 1e-3
"""Two ways to a frame that end nearer to each other than this agree."""
REMEDY = "--camera-pose states where the camera stands"
IDENTITY = Frame(np.zeros(3), np.eye(3))


class MissingTransform(LookupError):  # noqa: N818 - says what is missing, as the standard library's do
    """Two frames are not connected, not at that time, or in two ways; the text says where and how."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Frames from one upwards, with the first one's pose in each, and the links that hold for each.

    `stale` says why it ends, if not at a root; `circle` is the frame that it comes back to, if it does.
    """

    poses: dict[str, Frame]
    links: dict[str, list[Link]]
    stale: str | None
    circle: str | None

    @property
    def root(self) -> str:
        """The last frame upwards."""
        return next(reversed(self.poses))

    def goes_round(self, name: str) -> bool:
        """Whether a frame of the chain is one of its circle."""
        order = list(self.poses)
        return self.circle is not None and order.index(name) >= order.index(self.circle)


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """The two chains from a frame and from the one it is wanted in; `common` is where they meet, if they do."""

    up: Chain
    down: Chain
    common: str | None

    @property
    def frame(self) -> Frame | None:
        """The one frame in the other; None where the chains don't meet, or go round in a circle where they do."""
        if self.common is None or self.up.goes_round(self.common) or self.down.goes_round(self.common):
            return None
        return _relative(self.up.poses[self.common], self.down.poses[self.common])

    @property
    def used(self) -> dict[str, list[Link]]:
        """The links of the frames below the common one; all that were met if there is none."""
        met: dict[str, list[Link]] = {}
        for chain in (self.up, self.down):
            for name in chain.poses:
                if name == self.common and self.frame is not None:
                    break
                met[name] = chain.links.get(name, [])
        return met


def decided(
    attempt: Attempt, other: Attempt, child: str, links: tuple[Link, Link], target: str
) -> tuple[Attempt, CloudWarning | None]:
    """Which of two ways counts, that differ in one link; and what to say if only one leads anywhere.

    Raises
    ------
    MissingTransform
        If both lead to the target, but to different places.
    """
    one, two = attempt.frame, other.frame
    names = " and in ".join(f"{link.sample.parent} ({'static' if link.static else 'moving'})" for link in links)
    if links[0].sample.parent == links[1].sample.parent and links[0].static == links[1].static:
        names = f"{links[0].sample.parent} (moving) in two ways"
    if one is not None and two is not None:
        if _agree(one, two):
            return attempt, None
        raise MissingTransform(f"{child} is given in {names}, which place it differently in {target}; {REMEDY}")
    if one is None and two is None:
        return attempt, None
    used = links[0] if one is not None else links[1]
    text = f"{child} is given in {names}, of which only {used.sample.parent} leads to {target}; {REMEDY}"
    return (attempt if one is not None else other), CloudWarning("transform_conflict", text)


def _agree(one: Frame, two: Frame) -> bool:
    """Whether two frames are the same but for what sensors and rounding add."""
    turned = float(np.linalg.norm(one.axes - two.axes)) / np.sqrt(2.0)  # of small angles, the angle
    return float(np.linalg.norm(one.origin - two.origin)) <= SAME_M and turned <= SAME_RAD


def _relative(source: Frame, target: Frame) -> Frame:
    """`source` in `target`, both given in a third frame."""
    return Frame(target.to_local(source.origin), source.axes @ target.axes.T)
