"""The options that say how to plan and which frames, the same for every command that plans; they make a `Job`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.completion import complete_profile
from flatgrasp_cli.cli.defaults import config_option, option, overrides, tell
from flatgrasp_cli.cli.image_options import IMAGE_OPTIONS, of_images, positive
from flatgrasp_cli.cli.imports import importing
from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.sources.selection import Selection


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
        metavar="X,Y,Z|FRAME|above|none",
        help="Where the sensor was: a place in the frame of the answer, a frame of the recording, above, or in several "
        "places (merged clouds); else found, or assumed with a warning.",
    ),
    option("--crop", metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX", help="Region of interest in metres."),
    *CAGE_OPTIONS,
    option(
        "--robot",
        metavar="NAME|FILE",
        shell_complete=complete_profile("robot"),
        help="Robot profile: keep only grasps that it reaches, with joint angles.",
    ),
    option(
        "--camera-pose",
        metavar="FILE|X,Y,Z,QX,QY,QZ,QW",
        help="Pose of the cloud's frame in the base frame, in which all answers are then given.",
    ),
    option(
        "--base-frame",
        metavar="NAME",
        help="Give all answers in this frame: that of the camera pose, or one of the recording's own; the robot's if "
        "there is one.",
    ),
    option("--topic", metavar="NAME", help="Topic of a recording; the only one with clouds if not given."),
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
    *("robot", "camera_pose", "base_frame", "topic", "start", "end", "at", "every", "count", "strict"),
    *("intrinsics", "depth_unit", "depth_axes", "scale", "top", "verbose"),
)


def planning_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and the `Job` that they say as its argument `job`."""

    @wraps(command)
    def with_job(**options: Any) -> Any:
        chosen = {name: options.pop(name) for name in NAMES}
        return command(job=job_of(**chosen), **options)

    for each in reversed(OPTIONS):
        with_job = each(with_job)
    return with_job


def job_of(
    gripper: str,
    method: str,
    given: tuple[str, ...],
    scene: str | None = None,
    select: str | None = None,
    up: str | None = None,
    sensor: str | None = None,
    crop: str | None = None,
    prefer: str | None = None,
    require: str | None = None,
    closing: str | None = None,
    robot: str | None = None,
    camera_pose: str | None = None,
    base_frame: str | None = None,
    scale: float = 1.0,
    top: int = 10,
    verbose: bool = False,
    **frames: Any,
) -> Job:
    """The job that options say, with the defaults of those that a command does not have."""
    with importing():
        from flatgrasp_cli.job import Job
    from flatgrasp_cli.cli.place_options import parse_sensor, parse_workcell
    from flatgrasp_cli.profiles import load_gripper, load_settings
    from flatgrasp_cli.sources import EVERYTHING

    asked = {
        "scene": f"scene.mode={scene}" if scene else None,
        "select": select if select is None else f"scene.select={_list(select)}",
        "up": up if up is None else f"scene.up={_list(up)}",
        "crop": crop if crop is None else f"scene.crop={_list(crop)}",
        "prefer": f"ranking.prefer={prefer}" if prefer else None,
        "closing": f"caging.closing={closing}" if closing else None,
        "require": "caging.require=true" if require else None,
    }
    context = click.get_current_context()
    settings = overrides(context, {name: text for name, text in asked.items() if text is not None}, given)
    if verbose:
        tell(context, settings)
    stated = None if sensor is None else parse_sensor(sensor)
    return Job(
        gripper=load_gripper(gripper),
        settings=load_settings(method, tuple(each.text for each in settings)),
        workcell=parse_workcell(robot, camera_pose, base_frame),
        selection=replace(
            _selection(**frames) if frames else EVERYTHING, sensor_frame=stated if isinstance(stated, str) else None
        ),
        sensor=None if isinstance(stated, str) else stated,
        scale=scale,
        top=top,
    )


def _list(text: str) -> str:
    """Turn "a,b,c" into the YAML list that a setting of several numbers wants; a word as it is."""
    return f"[{text}]" if "," in text else text or "''"  # an empty word is no null


def _selection(
    topic: str | None,
    start: str | None,
    end: str | None,
    at: str | None,
    every: str | None,
    count: int | None,
    strict: bool,
    **images: Any,
) -> Selection:
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
        **of_images(**images),
    )
