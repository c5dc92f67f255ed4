"""The options that say how to plan and which frames, the same for every command that plans; they make a `Job`."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import click

from flatgrasp_cli.cli.completion import complete_profile
from flatgrasp_cli.cli.defaults import config_option, option
from flatgrasp_cli.cli.image_options import IMAGE_OPTIONS, positive
from flatgrasp_cli.cli.jobs import job_of
from flatgrasp_cli.source_names import in_utf8


def _text(_context: click.Context, _parameter: click.Parameter, value: str | None) -> str | None:
    """Check that a name, which may come into documents, is text, for click."""
    if value is not None and (called := in_utf8(value)) != value:
        raise click.BadParameter(f"{called} is no text in UTF-8")
    return value


METHOD_OPTIONS = (
    option(
        "--gripper",
        "-g",
        default="lacquey",
        show_default=True,
        metavar="NAME|FILE",
        shell_complete=complete_profile("gripper"),
        help="Gripper profile; `flatgrasp profiles list` shows them.",
    ),
    option(
        "--method",
        default="default",
        show_default=True,
        metavar="default|paper|FILE",
        shell_complete=complete_profile("planner"),
        help="Planner settings: ours, or the paper's to the letter.",
    ),
    option(
        "--set",
        "given",
        multiple=True,
        envvar=None,
        metavar="KEY=VALUE",
        help="Override a planner setting, e.g. --set fingers.step_m=0.004. Repeatable.",
    ),
)
APPROACH_OPTIONS = (
    option(
        "--approach",
        metavar="auto|top|view|any|X,Y,Z",
        help="From where the hand comes: straight down and, where that is not enough, from other sides (auto); "
        "straight down; as the sensor looks; from whichever side is best; or along this vector of the answer's frame.",
    ),
    option(
        "--max-tilt", metavar="DEGREES", help="The largest angle to straight down that the hand may come at; else 90."
    ),
)
CAGE_OPTIONS = (
    option(
        "--prefer",
        type=click.Choice(["success", "gravity_distance", "cage"]),
        help="Best first: what most probably holds, the paper's choice, or what a cage forgives.",
    ),
    option("--require", type=click.Choice(["cage"]), help="Keep only grasps that cage the object."),
    option("--closing", type=click.Choice(["inward", "outward"]), help="Which way the fingers close in a cage."),
)
DEFAULTS_OPTIONS = (
    config_option,
    option("--verbose", "-v", is_flag=True, help="Say where each option's value comes from."),
)
SCALE_OPTION = option(
    "--scale",
    type=float,
    callback=positive,
    default=1.0,
    show_default=True,
    help="Metres in one unit of the source; 0.001 for millimetres.",
)
OPTIONS = (
    *METHOD_OPTIONS,
    option(
        "--scene",
        type=click.Choice(["auto", "object", "table", "bin"]),
        help="One object alone, objects on a support plane, or things in a bin; auto: judged by the cloud.",
    ),
    option(
        "--object",
        "select",
        metavar="all|nearest|largest|X,Y",
        help="Which objects of a scene to plan: nearest to the sensor, largest, or nearest to a place.",
    ),
    option(
        "--up",
        metavar="X,Y,Z",
        help="The way up in the frame of the answer: normal of the support plane, and the side the hand comes from.",
    ),
    option(
        "--sensor",
        callback=_text,
        metavar="X,Y,Z|FRAME|above|none",
        help="Where the sensor was: a place in the frame of the answer, a frame of the recording, above, or in several "
        "places (merged clouds); else found, or assumed with a warning.",
    ),
    option("--crop", metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX", help="Region of interest in metres."),
    *APPROACH_OPTIONS,
    *CAGE_OPTIONS,
    option(
        "--robot",
        metavar="NAME|FILE",
        shell_complete=complete_profile("robot"),
        help="Robot profile, or a URDF: keep only grasps that it reaches, with joint angles.",
    ),
    option(
        "--camera-pose",
        metavar="FILE|X,Y,Z,QX,QY,QZ,QW",
        help="Pose of the cloud's frame in the base frame, in which all answers are then given.",
    ),
    option(
        "--base-frame",
        callback=_text,
        metavar="NAME",
        help="Give all answers in this frame: that of the camera pose, or one of the recording's own; the robot's if "
        "there is one.",
    ),
    option(
        "--topic", callback=_text, metavar="NAME", help="Topic of a recording; the only one with clouds if not given."
    ),
    option("--start", metavar="TIME", help="From this time on: seconds from the start, or ISO 8601."),
    option("--end", metavar="TIME", help="Before this time."),
    option("--at", metavar="TIME", help="Only the first frame at or after this time."),
    option("--every", metavar="N|SECONDSs", help="Every N-th frame (5), or one frame a period (0.5s)."),
    option("--count", type=click.IntRange(min=1), metavar="N", help="At most so many frames of each recording."),
    option("--strict", is_flag=True, help="The first damage in a recording is an error, not a warning."),
    *IMAGE_OPTIONS,
    SCALE_OPTION,
    option(
        "--top",
        type=click.IntRange(min=1),
        default=10,
        show_default=True,
        metavar="K",
        help="How many grasps to keep, best first.",
    ),
    *DEFAULTS_OPTIONS,
)
NAMES = (
    *("gripper", "method", "given", "scene", "select", "up", "sensor", "crop", "prefer", "require", "closing"),
    *("approach", "max_tilt"),
    *("robot", "camera_pose", "base_frame", "topic", "start", "end", "at", "every", "count", "strict"),
    *("intrinsics", "depth_unit", "depth_axes", "scale", "top", "verbose"),
)


def planning_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and the `Job` that they say as its argument `job`."""

    @wraps(command)
    def with_job(**options: Any) -> Any:
        chosen = {name: options.pop(name) for name in NAMES}
        return command(job=job_of(chosen), **options)

    for each in reversed(OPTIONS):
        with_job = each(with_job)
    return with_job
