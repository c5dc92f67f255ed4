"""The options that say how to plan and which frames, the same for every command that plans; they make a `Job`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.completion import complete_profile
from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.sources.selection import DepthAxes, Selection


def _positive(_context: click.Context, _parameter: click.Parameter, value: float | None) -> float | None:
    if value is not None and not 0 < value < math.inf:  # false for NaN, too
        raise click.BadParameter(f"{value} is not a positive number")
    return value


IMAGE_OPTIONS = (
    click.option(
        "--intrinsics",
        metavar="FX,FY,CX,CY|FILE",
        help="Of the camera of depth images: pixels, a ROS camera_info (YAML), or Open3D's JSON.",
    ),
    click.option(
        "--depth-unit",
        type=float,
        callback=_positive,
        metavar="METRES",
        help="One count of depth images in metres; 0.001 for integers, 1 for floats if not given.",
    ),
    click.option(
        "--depth-axes",
        type=click.Choice(["optical", "body"]),
        help="Of the frame of depth images: z forward, y down, or x forward, z up; else as names and transforms say.",
    ),
)
OPTIONS = (
    click.option(
        "--gripper",
        "-g",
        default="lacquey",
        show_default=True,
        metavar="NAME|FILE",
        shell_complete=complete_profile("gripper"),
        help="Gripper profile; `flatgrasp profiles list` shows them.",
    ),
    click.option(
        "--method",
        default="default",
        show_default=True,
        metavar="default|paper|FILE",
        shell_complete=complete_profile("planner"),
        help="Planner settings: ours, or the paper's to the letter.",
    ),
    click.option(
        "--set",
        "overrides",
        multiple=True,
        metavar="KEY=VALUE",
        help="Override a planner setting, e.g. --set fingers.step_m=0.004. Repeatable.",
    ),
    click.option(
        "--scene",
        type=click.Choice(["auto", "object", "table"]),
        help="One object alone, or objects on a support plane; auto: as the cloud says.",
    ),
    click.option(
        "--object",
        "select",
        metavar="all|nearest|largest|X,Y",
        help="Which objects of a scene to plan: nearest to the sensor, largest, or nearest to a place.",
    ),
    click.option(
        "--up",
        metavar="X,Y,Z",
        help="The way up in the frame of the answer: normal of the support plane, and the side the hand comes from.",
    ),
    click.option(
        "--sensor",
        metavar="X,Y,Z|FRAME|above|none",
        help="Where the sensor was: a place in the frame of the answer, a frame of the recording, above, or in several "
        "places (merged clouds); else found, or assumed with a warning.",
    ),
    click.option("--crop", metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX", help="Region of interest in metres."),
    click.option(
        "--prefer", type=click.Choice(["cost", "cage"]), help="Best first by cost, or by what a cage forgives."
    ),
    click.option("--require", type=click.Choice(["cage"]), help="Keep only grasps that cage the object."),
    click.option("--closing", type=click.Choice(["inward", "outward"]), help="Which way the fingers close in a cage."),
    click.option(
        "--robot",
        metavar="NAME|FILE",
        shell_complete=complete_profile("robot"),
        help="Robot profile: keep only grasps that it reaches, with joint angles.",
    ),
    click.option(
        "--camera-pose",
        metavar="FILE|X,Y,Z,QX,QY,QZ,QW",
        help="Pose of the cloud's frame in the base frame, in which all answers are then given.",
    ),
    click.option(
        "--base-frame",
        metavar="NAME",
        help="Give all answers in this frame: that of the camera pose, or one of the recording's own; the robot's if "
        "there is one.",
    ),
    click.option("--topic", metavar="NAME", help="Topic of a recording; the only one with clouds if not given."),
    click.option("--start", metavar="TIME", help="From this time on: seconds from the start, or ISO 8601."),
    click.option("--end", metavar="TIME", help="Before this time."),
    click.option("--at", metavar="TIME", help="Only the first frame at or after this time."),
    click.option("--every", metavar="N|SECONDSs", help="Every N-th frame (5), or one frame a period (0.5s)."),
    click.option("--count", type=click.IntRange(min=1), metavar="N", help="At most so many frames of each recording."),
    click.option("--strict", is_flag=True, help="The first damage in a recording is an error, not a warning."),
    *IMAGE_OPTIONS,
    click.option(
        "--scale",
        type=float,
        callback=_positive,
        default=1.0,
        show_default=True,
        help="Metres in one unit of the source; 0.001 for millimetres.",
    ),
    click.option(
        "--top",
        type=click.IntRange(min=1),
        default=10,
        show_default=True,
        metavar="K",
        help="How many grasps to keep, best first.",
    ),
)
NAMES = (
    *(
        "gripper",
        "method",
        "overrides",
        "scene",
        "select",
        "up",
        "sensor",
        "crop",
        "prefer",
        "require",
        "closing",
        "robot",
        "camera_pose",
        "base_frame",
    ),
    *(
        "topic",
        "start",
        "end",
        "at",
        "every",
        "count",
        "strict",
        "intrinsics",
        "depth_unit",
        "depth_axes",
        "scale",
        "top",
    ),
)


def planning_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and the `Job` that they say as its argument `job`."""

    @wraps(command)
    def with_job(**options: Any) -> Any:
        chosen = {name: options.pop(name) for name in NAMES}
        return command(job=_job(**chosen), **options)

    for option in reversed(OPTIONS):
        with_job = option(with_job)
    return with_job


def _job(
    gripper: str,
    method: str,
    overrides: tuple[str, ...],
    scene: str | None,
    select: str | None,
    up: str | None,
    sensor: str | None,
    crop: str | None,
    prefer: str | None,
    require: str | None,
    closing: str | None,
    robot: str | None,
    camera_pose: str | None,
    base_frame: str | None,
    scale: float,
    top: int,
    **frames: Any,
) -> Job:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.mounting import mounting
    from flatgrasp_cli.profiles import load_gripper, load_settings
    from flatgrasp_cli.sensor.statement import parse_sensor

    asked = {"scene.mode": scene, "scene.select": _list(select), "scene.up": _list(up), "scene.crop": _list(crop)}
    asked |= {"caging.prefer": prefer, "caging.closing": closing, "caging.require": "true" if require else None}
    shortcuts = tuple(f"{key}={value}" for key, value in asked.items() if value is not None)
    stated = None if sensor is None else parse_sensor(sensor)
    return Job(
        gripper=load_gripper(gripper),
        settings=load_settings(method, (*shortcuts, *overrides)),
        mounting=mounting(robot, camera_pose, base_frame),
        selection=replace(_selection(**frames), sensor_frame=stated if isinstance(stated, str) else None),
        sensor=None if isinstance(stated, str) else stated,
        scale=scale,
        top=top,
    )


def _list(text: str | None) -> str | None:
    """Turn "a,b,c" into the YAML list that a setting of several numbers wants; a word as it is."""
    if text is None:
        return None
    return f"[{text}]" if "," in text else text or "''"  # an empty word is no null


def _selection(
    topic: str | None,
    start: str | None,
    end: str | None,
    at: str | None,
    every: str | None,
    count: int | None,
    strict: bool,
    intrinsics: str | None,
    depth_unit: float | None,
    depth_axes: DepthAxes | None,
) -> Selection:
    from flatgrasp_cli.sources.intrinsics import parse_intrinsics
    from flatgrasp_cli.sources.selection import Every, Selection, parse_every, parse_moment

    if at is not None and (start, end, every, count) != (None, None, None, None):
        raise UsageError("--at names one frame; leave out --start, --end, --every and --count")
    return Selection(
        topic=topic,
        start=None if start is None else parse_moment(start),
        end=None if end is None else parse_moment(end),
        at=None if at is None else parse_moment(at),
        every=Every() if every is None else parse_every(every),
        count=count,
        strict=strict,
        intrinsics=None if intrinsics is None else parse_intrinsics(intrinsics),
        depth_unit_m=depth_unit,
        depth_axes=depth_axes,
    )
