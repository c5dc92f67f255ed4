"""The picture of the architecture page: the rooms of the package, and what goes from one to the next."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from typing import NamedTuple


class Room(NamedTuple):
    """A package or module of `flatgrasp_cli`, and what it is for, a line each."""

    name: str
    lines: tuple[str, ...]


ASKING = (
    Room("cli", ("options, files, tables", "the only one that prints")),
    Room("batch", ("many sources, all cores,", "resumable")),
    Room("serving", ("requests, answers:", "a process that stays")),
    Room("simulation", ("camera, arm and hand:", "are grasps held?")),
    Room("job", ("what to do with", "every cloud")),
)
READING = (
    Room("recordings", ("containers and messages;", "knows nothing of grasping")),
    Room("sources", ("files, frames of recordings,", "transforms")),
    Room("placing", ("each cloud in the frame", "that was asked for")),
)
PLACED = ("points", "Cloud")
"""What goes from each reading room to the next."""
WORKING = (
    Room("sensor", ("where the", "sensor was")),
    Room("scene", ("support plane,", "objects on it")),
    Room("planner", ("the paper's", "section III")),
    Room("proof", ("cages,", "force closure")),
    Room("robot", ("poses, joints,", "reach")),
    Room("results", ("JSON, tables,", "pictures")),
)
PASSED = ("Sensor", "Objects", "Grasps", "Poses", "Plan")
"""What goes from each working room to the next."""
ASKED = (
    Room("surroundings", ("what stands around it,", "and what of that was seen")),
    Room("ranking", ("how probable it is", "that a grasp holds")),
    Room("methods", ("the paper's, and its", "reference [1], by name")),
    Room("funnel", ("what each stage keeps,", "and why nothing is left")),
)
UNDERLYING = (
    Room("profiles", ("grippers, robots, settings:", "YAML, checked")),
    Room("model", ("the records", "that flow")),
    Room("geometry", ("numpy alone,", "no domain words")),
    Room("kernels", ("inner loops, compiled:", "arrays in, arrays out")),
    Room("errors", ("what can go wrong,", "with its exit code")),
)
COMPOSING = Room("planning", ("plan(cloud, gripper, settings) → Plan: composes sensor, scene, planner and robot",))
ROOMS = (*ASKING, *READING, COMPOSING, *WORKING, *ASKED, *UNDERLYING)

WIDTH, HEIGHT, MARGIN, GAP = 1000, 638, 10, 60
INK, LINE, PAPER = "#1b1f24", "#57606a", "#ffffff"
ASK, COMPOSE, WORK, UNDERLIE = "#ddeeff", "#fff3cd", "#e2f2df", "#eceef1"


def svg() -> str:
    """The picture as SVG."""
    parts = [
        _text(MARGIN, 22, "Who asks", "start"),
        *_row(ASKING, 34, ASK, GAP / 3),
        *_row(READING, 136, WORK, GAP),
        *_arrows(PLACED, 136 + 42),
        *_box(COMPOSING, (MARGIN, 232, WIDTH - 2 * MARGIN, 52), COMPOSE),
        *_row(WORKING, 306, WORK, GAP),
        *_arrows(PASSED, 306 + 42),
        _text(MARGIN, 418, "What the method asks", "start"),
        *_row(ASKED, 430, COMPOSE, GAP / 3),
        _text(MARGIN, 536, "What everything stands on: imports go down, never up", "start"),
        *_row(UNDERLYING, 548, UNDERLIE, GAP / 3),
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">'
    arrow = (
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        f'<path d="M0 0L8 4L0 8z" fill="{LINE}"/></marker></defs>'
    )
    paper = f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{PAPER}"/>'
    return "\n".join([head, arrow, paper, *parts, "</svg>", ""])


def _row(rooms: tuple[Room, ...], top: float, color: str, gap: float) -> Iterator[str]:
    width = _width(len(rooms), gap)
    for k, room in enumerate(rooms):
        yield from _box(room, (MARGIN + k * (width + gap), top, width, 78), color)


def _width(count: int, gap: float) -> float:
    return (WIDTH - 2 * MARGIN - (count - 1) * gap) / count


def _box(room: Room, place: tuple[float, float, float, float], color: str) -> Iterator[str]:
    """A box at its left, top, width and height with the room's name and lines in the middle."""
    left, top, width, height = place
    yield (
        f'<rect x="{left:.1f}" y="{top}" width="{width:.1f}" height="{height}" rx="7" fill="{color}" stroke="{LINE}"/>'
    )
    middle = left + width / 2
    yield _text(middle, top + 23, room.name, "middle", 'font-size="14" font-weight="bold"')
    for k, line in enumerate(room.lines):
        yield _text(middle, top + 42 + 17 * k, line, "middle", 'font-size="12.5"')


def _arrows(words: tuple[str, ...], height: float) -> Iterator[str]:
    """An arrow from each room of a row to the next, with what it passes on."""
    width = _width(len(words) + 1, GAP)
    for k, word in enumerate(words, start=1):
        right = MARGIN + k * (width + GAP) - 2
        left = right - GAP + 4
        yield (
            f'<line x1="{left:.1f}" y1="{height}" x2="{right:.1f}" y2="{height}" stroke="{LINE}" stroke-width="1.6" '
            'marker-end="url(#tip)"/>'
        )
        yield _text((left + right) / 2, height - 7, word, "middle", 'font-size="12.5" font-style="italic"')


def _text(x: float, y: float, words: str, anchor: str, style: str = 'font-size="14"') -> str:
    return f'<text x="{x:.1f}" y="{y}" text-anchor="{anchor}" fill="{INK}" {style}>{escape(words)}</text>'
