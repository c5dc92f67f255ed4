"""The words of `--robot`, `--camera-pose`, `--base-frame` and `--sensor`, which say where things are."""

from __future__ import annotations

import math
import re

import click
import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.model.clouds import LARGEST_COORDINATE_M
from flatgrasp_cli.placing import Workcell, workcell
from flatgrasp_cli.profiles import load_camera_pose, load_robot
from flatgrasp_cli.robot import arm_of

ASSUMED = (
    "a URDF does not say how thick links are (60 mm are assumed) nor what stance is usual (the middle of all limits); "
    "a robot profile with urdf: {file: …} does"
)


def parse_sensor(text: str) -> Sensor | str:
    """The sensor that "X,Y,Z", "above" or "none" states; of anything else, the name of its frame.

    "none" are clouds merged from several views, which nothing was hidden from.

    Raises
    ------
    UsageError
        If it is empty, or begins as a place but is not three finite numbers, or is one where no sensor can be.
    """
    if text == "above":
        return Sensor("option")
    if text == "none":
        return Sensor("all_sides")
    if "," not in text and not re.fullmatch(r"[-+.\d][-+.\d\seE]*|", text):
        return text.lstrip("/")
    try:
        place = [float(part) for part in text.split(",")]
    except ValueError:
        place = []
    if len(place) != 3 or not all(map(math.isfinite, place)):
        raise UsageError(f"--sensor {text}: give its place X,Y,Z, the name of its frame in a recording, above, or none")
    if max(map(abs, place)) > LARGEST_COORDINATE_M:
        raise UsageError(f"--sensor {text}: is more than {LARGEST_COORDINATE_M / 1000:g} km away; give it in metres")
    return Sensor("option", np.array(place))


def parse_workcell(robot: str | None, camera_pose: str | None, base_frame: str | None) -> Workcell:
    """The workcell of a robot's profile and a camera's pose, each by name, path or in numbers; see `workcell`.

    Raises
    ------
    ProfileError
        If one of them is not there, or wrong.
    UsageError
        If the robot has no such base frame.
    """
    arm = None if robot is None else load_robot(robot)
    if arm is not None and arm.chain is not None:
        arm_of(arm)  # says at once what is missing, and not after the first cloud
    if arm is not None and robot is not None and robot.endswith(".urdf"):
        click.echo(f"flatgrasp: warning: {robot}: {ASSUMED}", err=True)
    return workcell(arm, None if camera_pose is None else load_camera_pose(camera_pose), base_frame)
