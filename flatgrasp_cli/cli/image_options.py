"""The options that say what depth images mean, for every command that reads clouds."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from flatgrasp_cli.cli.defaults import option

if TYPE_CHECKING:
    from flatgrasp_cli.sources.selection import DepthAxes


def positive(_context: click.Context, _parameter: click.Parameter, value: float | None) -> float | None:
    """Check an option's number, for click."""
    if value is not None and not 0 < value < math.inf:  # false for NaN, too
        raise click.BadParameter(f"{value} is not a positive number")
    return value


def _unit(context: click.Context, parameter: click.Parameter, value: float | None) -> float | None:
    if value is not None and value > 1:
        raise click.BadParameter(f"{value} metres a count is more than any depth image has")
    return positive(context, parameter, value)


IMAGE_OPTIONS = (
    option(
        "--intrinsics",
        metavar="FX,FY,CX,CY|FILE",
        help="Of the camera of depth images: pixels, a ROS camera_info (YAML), or Open3D's JSON.",
    ),
    option(
        "--depth-unit",
        type=float,
        callback=_unit,
        metavar="METRES",
        help="One count of depth images in metres; 0.001 for integers, 1 for floats if not given.",
    ),
    option(
        "--depth-axes",
        type=click.Choice(["optical", "body"]),
        help="Of the frame of depth images: z forward, y down, or x forward, z up; else as names and transforms say.",
    ),
)


def image_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options that say what depth images mean; `of_images` reads their values."""
    for each in reversed(IMAGE_OPTIONS):
        command = each(command)
    return command


def of_images(intrinsics: str | None, depth_unit: float | None, depth_axes: DepthAxes | None) -> dict[str, Any]:
    """The fields of a `Selection` that say what depth images mean."""
    camera = None
    if intrinsics is not None:
        from flatgrasp_cli.sources.intrinsics import parse_intrinsics

        camera = parse_intrinsics(intrinsics)
    return {"intrinsics": camera, "depth_unit_m": depth_unit, "depth_axes": depth_axes}
