"""The robot, and where the camera stands in its base frame, from the command line's words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.model import Cloud
    from flatgrasp_cli.profiles import CameraPose, Robot

BASE_FRAMES = ("base", "base_link")


@dataclass(frozen=True, slots=True)
class Mounting:
    """A robot, if one was named, and a camera's pose in `base_frame`, if one is known.

    Answers are in `base_frame`; None: in the cloud's own frame.
    """

    robot: Robot | None
    camera: CameraPose | None
    base_frame: str | None

    @property
    def looked_up(self) -> str | None:
        """The frame in which the recording's own transforms must place the clouds."""
        return self.base_frame if self.camera is None else None

    def placed(self, cloud: Cloud) -> Cloud:
        """The cloud in the base frame, or as it is when none was asked for.

        Raises
        ------
        UsageError
            If the place of the cloud's frame in the base frame is not known.
        """
        if self.camera is not None and self.base_frame is not None:
            from flatgrasp_cli.planning import in_base_frame

            return in_base_frame(cloud, self.camera, self.base_frame)
        if self.base_frame is not None and cloud.frame_name != self.base_frame:
            raise UsageError(
                f"{cloud.source.path}: the cloud is in frame {cloud.frame_name!r}, the answer is wanted in "
                f"{self.base_frame!r}; say where the camera stands: --camera-pose x,y,z,qx,qy,qz,qw"
            )
        return cloud


def mounting(robot: str | None, camera_pose: str | None, base_frame: str | None) -> Mounting:
    """Load what was named; a robot's own camera pose counts when none is given."""
    from flatgrasp_cli.profiles import load_camera_pose, load_robot

    arm = load_robot(robot) if robot is not None else None
    base_frame = base_frame.lstrip("/") if base_frame is not None else None  # tf wrote a slash, tf2 does not
    camera = load_camera_pose(camera_pose) if camera_pose is not None else None
    if arm is None:
        return Mounting(None, camera, base_frame or (BASE_FRAMES[0] if camera else None))
    frame = base_frame or arm.base_frame
    if frame not in BASE_FRAMES:
        raise UsageError(f"--base-frame {frame}: a UR arm has the base frames {' and '.join(BASE_FRAMES)}")
    if camera is None and arm.camera_pose is not None:
        camera = arm.camera_pose if frame == arm.base_frame else arm.camera_pose.half_turned()
    return Mounting(arm.model_copy(update={"base_frame": frame}), camera, frame)
