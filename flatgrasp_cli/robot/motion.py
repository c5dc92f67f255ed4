"""How a grasp is carried out: which way the hand comes and goes, and where the flange is for that.

Fingers that move on an arc push their tips out as they close, and the flange does not move while they do. So it is
placed by the closed fingers: the grasp's pose less the tool's length at the grasp's width. On the way in the open
fingers' tips are short of `pre_grasp` and `pose` by what they will come out.
"""

from __future__ import annotations

from dataclasses import dataclass

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import axes_from_quaternion, turned_about_z
from flatgrasp_cli.model import Pose, Poses, Way
from flatgrasp_cli.profiles.gripper import Gripper


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """How a grasp is carried out.

    The hand comes `approach_m` along its z axis, then moves `lift_m` along `lift_direction` (3,), a unit vector in the
    frame of the grasp. `twin` says whether the hand may as well be turned by 180° about its z axis, `back_first` that
    it goes back the way it came before that: what it came in below is still above it.
    """

    approach_m: float
    lift_m: float
    lift_direction: FloatArray
    twin: bool
    back_first: bool = False


def flange_at(tips: Pose, width_m: float, gripper: Gripper) -> Pose:
    """The flange's pose where the fingertips have closed on `width_m`, the hand not turned into its twin."""
    back = gripper.tool_length_m(width_m) * axes_from_quaternion(tips.orientation)[2]
    return Pose(tips.position - back, turned_about_z(tips.orientation, -gripper.mounted_deg))


def way_to(tips: Pose, width_m: float, gripper: Gripper, motion: Motion, *, twin: bool) -> Way:
    """The way to the grasp whose fingertips close on `width_m` at `tips`.

    Where the arm takes the twin, flange and hand are turned by 180° about the approach, as the joint angles have them;
    the fingertips' frame stays as it is, for the fingers that change places are alike.
    """
    approach = axes_from_quaternion(tips.orientation)[2]
    before, after = motion.approach_m * approach, motion.lift_m * motion.lift_direction
    after = after - before if motion.back_first else after
    twin_deg = 180.0 if twin else 0.0

    def poses(at: Pose, turn_deg: float) -> Poses:
        turned = turned_about_z(at.orientation, turn_deg)
        return Poses(
            pre_grasp=Pose(at.position - before, turned),
            pose=Pose(at.position, turned),
            lift=Pose(at.position + after, turned),
        )

    flange = flange_at(tips, width_m, gripper)
    mounting = Pose(flange.position + gripper.adapter_m * approach, tips.orientation)
    return Way(
        tips=poses(tips, 0.0),
        flange=poses(flange, twin_deg),
        hand=poses(mounting, twin_deg) if gripper.adapter_m or gripper.mounted_deg else None,
        back_first=motion.back_first,
    )
