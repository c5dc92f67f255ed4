"""The options that write a bag beside all else, for the commands that plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.results.exports.bag import Bag

ROS1, LATEST = "noetic", "jazzy"
DISTROS = ("dashing", "eloquent", "foxy", "galactic", "humble", "iron", "jazzy", "kilted", ROS1)


class BagFile:
    """The bag that was asked for, if one was."""

    def __init__(self, path: Path | None, distro: str | None) -> None:
        is_ros1 = path is not None and path.suffix == ".bag"
        self.path = path
        self._distro = distro or (ROS1 if is_ros1 else LATEST)
        if path is None and distro is not None:
            raise UsageError("--ros-distro says how a bag is written: give --bag OUT, too")
        if path is not None and is_ros1 != (self._distro == ROS1):
            raise UsageError(
                f"--ros-distro {self._distro}: {path} is {'a ROS 1 bag' if is_ros1 else 'a bag of ROS 2'}; "
                f"{'leave the option out' if is_ros1 else 'name it OUT.bag for ROS 1'}"
            )

    @property
    def written(self) -> list[Path]:
        """The bag, once it is there."""
        return [self.path] if self.path is not None and self.path.exists() else []

    def check_new(self) -> None:
        """Refuse one that is there already, before anything is planned: it may be a recording."""
        if self.path is not None and self.path.exists():
            raise UsageError(f"--bag {self.path}: is there already; choose another name, or remove it")

    @contextmanager
    def opened(self) -> Iterator[Bag | None]:
        """The bag to add plans to, whole when this ends; None if none was asked for."""
        if self.path is None:
            yield None
            return
        from flatgrasp_cli.results.exports.bag import Bag

        with Bag.open(self.path, self._distro) as bag:
            yield bag


def bag_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and the `BagFile` that they say as its argument `bag`."""

    @wraps(command)
    def with_bag(bag: Path | None, ros_distro: str | None, **options: Any) -> Any:
        return command(bag=BagFile(bag, ros_distro), **options)

    for each in reversed(OPTIONS):
        with_bag = each(with_bag)
    return with_bag


OPTIONS = (
    click.option(
        "--bag",
        type=click.Path(path_type=Path),
        metavar="OUT",
        help="Write a bag to play beside the recording, too: OUT.mcap, OUT.bag for ROS 1, else a rosbag2 folder. It "
        "has the cloud (a point each 3 mm), the grasps and what RViz and Foxglove draw of them.",
    ),
    click.option(
        "--ros-distro",
        type=click.Choice(DISTROS),
        metavar="NAME",
        help=f"Whose message definitions the bag has, e.g. humble; {LATEST} if not given, {ROS1} for OUT.bag.",
    ),
)
