"""Where the camera looks from: a floating one from anywhere around, that on an arm's wrist from where the arm reaches.

The camera looks at the spot on the table where things are put, tilted by a given angle against the vertical.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.robot import forward, in_dh_base, inverse, ur_rows

DISTANCES_M = (0.8, 0.7, 0.6, 0.5, 0.4)
"""How far the camera is from what it looks at, as far as the arm gets: an Xtion measures from 0.4 m on, best at 0.8."""
AROUND = 24
"""Azimuths and turns about the optical axis that are tried, evenly spaced."""
BESIDE_M = 0.14
"""How far the camera sits from the hand's axis, along the hand's x: far enough for the fingers to stay out of view."""
SPOT_SHARE = 0.55
"""Where things are put, as a share of the arm's reach: the middle of what it reaches from above."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A camera's pose in the world, its optical frame (x right, y down, z forward), and the arm's joints there (6,)."""

    camera: Frame
    joints: FloatArray | None = None


def spot_of(robot: Robot | None) -> FloatArray:
    """Where things are put (3,) in the world: before the arm's reference stance; the origin without an arm."""
    if robot is None:
        return np.zeros(3)
    flange = forward(ur_rows(robot, "simulate"), np.radians(robot.reach.reference_deg))[5, :3, 3]
    ahead = in_dh_base(robot.base_frame, flange) * [1.0, 1.0, 0.0]
    return np.asarray(SPOT_SHARE * robot.reach_m * ahead / np.linalg.norm(ahead))


def look_at(spot: FloatArray, tilt_rad: float, azimuth_rad: float) -> Look:
    """The look of a floating camera at a spot (3,), from an azimuth; its image is as upright as it may be."""
    return Look(_optical(spot, DISTANCES_M[0], tilt_rad, azimuth_rad, 0.0))


def look_by_arm(robot: Robot, gripper: Gripper, spot: FloatArray, tilt_rad: float, azimuth_rad: float) -> Look:
    """A look of the camera on the arm's wrist, from the reachable azimuth nearest to the one that is wanted.

    Raises
    ------
    UsageError
        If the arm brings the camera to no such place.
    """
    turns = 2 * np.pi * np.arange(AROUND) / AROUND
    nearest = np.argsort(np.abs(np.angle(np.exp(1j * turns))), kind="stable")
    for distance in DISTANCES_M:
        for azimuth in azimuth_rad + turns[nearest]:
            cameras = [_optical(spot, distance, tilt_rad, azimuth, roll) for roll in turns]
            joints = _nearest_joints(robot, [_flange(camera, gripper) for camera in cameras])
            if joints is not None:
                return Look(cameras[joints[0]], joints[1])
    raise UsageError(
        f"{robot.name} brings its camera nowhere from which it sees the table at {np.degrees(tilt_rad):.0f}°; "
        "give another --sensor-tilt, or --robot none"
    )


def _optical(spot: FloatArray, distance_m: float, tilt_rad: float, azimuth_rad: float, roll_rad: float) -> Frame:
    out = np.array([np.cos(azimuth_rad), np.sin(azimuth_rad), 0.0])
    away = np.sin(tilt_rad) * out + np.cos(tilt_rad) * np.array([0.0, 0.0, 1.0])
    across = np.array([-out[1], out[0], 0.0])
    down = np.cross(-away, across)
    x = np.cos(roll_rad) * across + np.sin(roll_rad) * down
    return Frame(spot + distance_m * away, np.stack([x, np.cross(-away, x), -away]))


def _flange(camera: Frame, gripper: Gripper) -> Frame:
    """Where the flange is for a camera that is mounted beside the hand: optical x = hand y, optical y = −hand x."""
    hand_x, hand_y, z = -camera.axes[1], camera.axes[0], camera.axes[2]
    c, s = np.cos(np.radians(gripper.mounted_deg)), np.sin(np.radians(gripper.mounted_deg))
    axes = np.stack([c * hand_x - s * hand_y, s * hand_x + c * hand_y, z])
    return Frame(camera.origin - BESIDE_M * hand_x, axes)


def _nearest_joints(robot: Robot, flanges: list[Frame]) -> tuple[int, FloatArray] | None:
    """Which of several flange poses is reached nearest to the reference stance, and with which joints."""
    base, reference = robot.base_frame, np.radians(robot.reach.reference_deg)
    positions = in_dh_base(base, np.array([flange.origin for flange in flanges]))
    axes = in_dh_base(base, np.array([flange.axes for flange in flanges]))
    joints = inverse(ur_rows(robot, "simulate"), positions, axes)
    joints = joints - 2 * np.pi * np.round((joints - reference) / (2 * np.pi))
    distance = np.where(_allowed(robot, joints), np.square(joints - reference).sum(axis=-1), np.inf)
    best = np.unravel_index(np.argmin(distance), distance.shape)
    return (int(best[0]), joints[best]) if np.isfinite(distance[best]) else None


def _allowed(robot: Robot, joints: FloatArray) -> BoolArray:
    """Whether joints (…, 6) are there, within the limits, and keep all of the arm over the table."""
    lower, upper = np.radians(robot.joints.lower_deg), np.radians(robot.joints.upper_deg)
    within = ((joints >= lower) & (joints <= upper)).all(axis=-1)  # false for NaN, too
    lowest = forward(ur_rows(robot, "simulate"), np.nan_to_num(joints))[..., 1:, 2, 3].min(axis=-1)
    return np.asarray(within & (lowest > robot.links.elbow_m))
