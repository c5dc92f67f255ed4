"""What answers are wanted for: a robot, a camera whose pose is known, and the frame that they share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.profiles.robot import CameraPose, Robot

BASE_FRAMES = ("base", "base_link")
"""Of a UR arm: its controller's, and ROS's."""


@dataclass(frozen=True, slots=True)
class Workcell:
    """A robot, if there is one, and the frame that answers are wanted in.

    `base_frame` None stands for each cloud's own frame. `camera` is the pose of clouds' own frames in the base frame,
    None where only a recording's own transforms may tell.
    """

    robot: Robot | None = None
    camera: CameraPose | None = None
    base_frame: str | None = None


def workcell(robot: Robot | None, camera: CameraPose | None, base_frame: str | None) -> Workcell:
    """The workcell of what is given: a robot's own base frame and camera pose count where none is.

    Without a robot, a camera pose is one in a frame called `base`.

    Raises
    ------
    UsageError
        If the robot has no such base frame.
    """
    base_frame = base_frame.lstrip("/") if base_frame is not None else None  # tf wrote a slash, tf2 does not
    if robot is None:
        return Workcell(None, camera, base_frame or (BASE_FRAMES[0] if camera else None))
    frame = base_frame or robot.base_frame
    frames = (robot.base_frame,) if robot.dh is None else BASE_FRAMES
    if frame not in frames:
        raise UsageError(f"--base-frame {frame}: robot {robot.name} has the base frame {' or '.join(frames)}")
    if camera is None and robot.camera_pose is not None:
        camera = robot.camera_pose if frame == robot.base_frame else robot.camera_pose.half_turned()
    return Workcell(robot.model_copy(update={"base_frame": frame}), camera, frame)
