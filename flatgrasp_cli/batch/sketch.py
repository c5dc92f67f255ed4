"""A scene as a small drawing in SVG."""

from __future__ import annotations

from typing import Any

BLUE, ORANGE, RED = "#56b4e9", "#e69f00", "#d55e00"
MARGIN_SHARE = 0.08


def sketch(things: list[dict[str, Any]]) -> str:
    """The objects' outlines, filled, with their numbers, and the lines between the contacts; millimetres, y up."""
    points = [point for thing in things for loop in thing["loops"] for point in loop]
    points += [point for thing in things for point in thing["contacts"]]
    if not points:
        return '<svg viewBox="0 0 1 1"></svg>'
    left, right = min(x for x, _ in points), max(x for x, _ in points)
    low, high = min(y for _, y in points), max(y for _, y in points)
    size = max(right - left, high - low, 1)
    pad = MARGIN_SHARE * size
    box = f"{left - pad:.1f} {-high - pad:.1f} {right - left + 2 * pad:.1f} {high - low + 2 * pad:.1f}"
    return f'<svg viewBox="{box}">{"".join(_thing(thing, size) for thing in things)}</svg>'


def _thing(thing: dict[str, Any], size: float) -> str:
    """One object of a drawing of so many millimetres."""
    path = " ".join("M" + " ".join(f"{x},{-y}" for x, y in loop) + "Z" for loop in thing["loops"])
    color = BLUE if thing["contacts"] else ORANGE
    style = f'fill="{color}" fill-opacity=".4" stroke="#000" fill-rule="evenodd" vector-effect="non-scaling-stroke"'
    drawn = f'<path d="{path}" {style}/>'
    if thing["contacts"]:
        (x0, y0), (x1, y1) = thing["contacts"]
        line = f'stroke="{RED}" stroke-width="2" vector-effect="non-scaling-stroke"'
        drawn += f'<line x1="{x0}" y1="{-y0}" x2="{x1}" y2="{-y1}" {line}/>'
        drawn += "".join(f'<circle cx="{x}" cy="{-y}" r="{size / 60:.1f}" fill="{RED}"/>' for x, y in thing["contacts"])
    x, y = max(thing["loops"][0], key=lambda point: point[0] + point[1])
    return f'{drawn}<text x="{x}" y="{-y}" font-size="{size / 12:.1f}">{thing["id"]}</text>'
