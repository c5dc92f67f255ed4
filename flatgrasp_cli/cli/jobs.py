"""The `Job` that the values of planning options say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from flatgrasp_cli.cli.defaults import overrides, tell
from flatgrasp_cli.cli.image_options import of_images
from flatgrasp_cli.cli.imports import importing
from flatgrasp_cli.errors import UsageError

if TYPE_CHECKING:
    from flatgrasp_cli.job import Job
    from flatgrasp_cli.sources.selection import Selection

SHORTCUTS = {
    "scene": "scene.mode",
    "select": "scene.select",
    "up": "scene.up",
    "crop": "scene.crop",
    "approach": "approach.directions",
    "max_tilt": "approach.max_tilt_deg",
    "prefer": "ranking.prefer",
    "closing": "caging.closing",
    "require": "caging.require",
}
"""Options that only say a planner setting, by their parameters' names."""
FRAMES = ("topic", "start", "end", "at", "every", "count", "strict", "intrinsics", "depth_unit", "depth_axes")


def job_of(values: Mapping[str, Any]) -> Job:
    """The job that the options of the running command say, with the defaults of those that it does not have."""
    context = click.get_current_context()
    settings = overrides(context, shortcuts(values), values.get("given", ()))
    if values.get("verbose"):
        tell(context, settings)
    typed = [name for name in values if context.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    return make_job(values, tuple(each.text for each in settings), typed)


def shortcuts(values: Mapping[str, Any]) -> dict[str, str]:
    """The planner settings that options of their own say, as KEY=VALUE, by the options' parameters."""
    asked = {name: values[name] for name in SHORTCUTS if values.get(name) is not None}
    return {name: f"{SHORTCUTS[name]}={_value(name, text)}" for name, text in asked.items()}


def _value(name: str, text: str) -> str:
    """Turn "a,b,c" into the YAML list that a setting of several numbers wants; a word as it is."""
    if name == "require":
        return "true"
    return f"[{text}]" if "," in text else text or "''"  # an empty word is no null


def make_job(values: Mapping[str, Any], settings: tuple[str, ...], typed: Iterable[str]) -> Job:
    """The job that options' values say, by the options' parameters, with all planner `settings` that were said.

    `typed` are the options that are no defaults, but were given for just these sources.
    """
    with importing():
        from flatgrasp_cli.job import Job
    from flatgrasp_cli.cli.place_options import parse_sensor, parse_workcell
    from flatgrasp_cli.profiles import load_gripper, load_settings
    from flatgrasp_cli.sources import EVERYTHING

    said = values.get("sensor")
    stated = None if said is None else parse_sensor(said)
    frames = {name: values[name] for name in FRAMES if name in values}
    return Job(
        gripper=load_gripper(values["gripper"]),
        settings=load_settings(values["method"], settings),
        workcell=parse_workcell(values.get("robot"), values.get("camera_pose"), values.get("base_frame")),
        selection=replace(
            _selection(**frames) if frames else EVERYTHING,
            sensor_frame=stated if isinstance(stated, str) else None,
            typed=frozenset(name for name in typed if values.get(name) is not None),
        ),
        sensor=None if isinstance(stated, str) else stated,
        scale=values.get("scale", 1.0),
        top=values.get("top", 10),
    )


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
