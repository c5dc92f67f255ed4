"""A batch as one HTML page that needs nothing else: no script, no network, no other file."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from typing import Any

from flatgrasp_cli.batch.summary import InputSummary

SKETCH_PX = 120
STYLE = """
:root { color-scheme: light dark; font: 14px/1.45 system-ui, sans-serif; }
body { max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.05rem; margin: 0 0 .3rem; overflow-wrap: anywhere; }
section { border-top: 1px solid #8886; padding: 1rem 0; }
.numbers { color: #777; } .error { color: #c22; } .warning { color: #a60; }
.bar { height: .5rem; background: #d55e0055; margin: .4rem 0; } .bar div { height: 100%; background: #009e73; }
.strip { display: flex; flex-wrap: wrap; gap: .6rem; margin-top: .6rem; }
figure { margin: 0; width: 8.5rem; } figcaption { font-size: .8rem; overflow-wrap: anywhere; }
figure.refused svg { outline: 2px solid #d55e00; } svg { background: #fff; display: block; }
table { border-collapse: collapse; } td { padding: 0 1rem 0 0; } td.n { text-align: right; }
"""


def report(inputs: list[InputSummary], values: dict[str, Any]) -> Iterator[str]:
    """Yield the page piece by piece: the whole batch, then each input, failures first."""
    yield f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>flatgrasp</title><style>{STYLE}</style>'
    yield '<meta name="viewport" content="width=device-width"></head><body>\n'
    yield f"<h1>{values['grasped']} of {values['frames']} frames with a grasp</h1>\n"
    yield f'<p class="numbers">{values["inputs"]} inputs, {values["failed"]} failed</p>\n'
    yield _bar(values["grasped"], values["frames"])
    yield _stages(values["no_grasp_by_stage"])
    for one in inputs:
        yield from _input(one)
    yield "</body></html>\n"


def _input(one: InputSummary) -> Iterator[str]:
    yield f"<section><h2>{escape(one.source)}</h2>\n"
    if one.error is not None:
        yield f'<p class="error">{escape(one.error)}</p>\n'
    for warning in one.warnings:
        yield f'<p class="warning">{escape(warning)}</p>\n'
    if one.frames:
        speed = "" if one.total_ms is None else f", {one.total_ms:.0f} ms a frame"
        yield f'<p class="numbers">{one.grasped} of {one.frames} frames with a grasp{speed}</p>\n'
        yield _bar(one.grasped, one.frames)
        yield _stages(dict(one.stages.most_common()))
        yield '<div class="strip">\n'
        for index, record in one.shown:
            yield _figure(index, record)
        yield "</div>\n"
    yield "</section>\n"


def _bar(part: int, whole: int) -> str:
    share = 100 * part / whole if whole else 0.0
    return f'<div class="bar" title="{share:.1f} %"><div style="width:{share:.1f}%"></div></div>\n'


def _stages(stages: dict[str, int]) -> str:
    """Which stage of the method kept nothing, how often."""
    if not stages:
        return ""
    rows = "".join(f'<tr><td>{escape(stage)}</td><td class="n">{count}</td></tr>' for stage, count in stages.items())
    return f"<table><tr><td>no grasp after</td><td></td></tr>{rows}</table>\n"


def _figure(index: int, record: dict[str, Any]) -> str:
    ok = record["status"] == "ok"
    best = next((thing for thing in record["objects"] if "pose" in thing), None)
    words = f"{1000 * best['width_m']:.0f} mm wide" if best else record["reason"] or ""
    return (
        f'<figure class="{"grasped" if ok else "refused"}">{_svg(record["sketch"])}'
        f"<figcaption>#{index} {escape(words)}</figcaption></figure>\n"
    )


def _svg(sketch: dict[str, Any] | None) -> str:
    """The outline, filled, and the line between the contacts."""
    if sketch is None:
        return f'<svg width="{SKETCH_PX}" height="{SKETCH_PX}" viewBox="0 0 1 1"></svg>'
    points = [point for loop in sketch["loops"] for point in loop] + sketch["contacts"]
    left, right = min(u for u, _ in points) - 5, max(u for u, _ in points) + 5
    low, high = min(v for _, v in points) - 5, max(v for _, v in points) + 5
    path = " ".join("M" + " ".join(f"{u},{-v}" for u, v in loop) + "Z" for loop in sketch["loops"])
    line = ""
    if sketch["contacts"]:
        (u, v), (p, q) = sketch["contacts"]
        line = f'<line x1="{u}" y1="{-v}" x2="{p}" y2="{-q}" stroke="#d55e00" vector-effect="non-scaling-stroke"/>'
        line += "".join(
            f'<circle cx="{x}" cy="{-y}" r="{max(right - left, high - low) / 40:.1f}" fill="#d55e00"/>'
            for x, y in sketch["contacts"]
        )
    return (
        f'<svg width="{SKETCH_PX}" height="{SKETCH_PX}" viewBox="{left} {-high} {right - left} {high - low}">'
        f'<path d="{path}" fill="#56b4e966" stroke="#000" fill-rule="evenodd" '
        f'vector-effect="non-scaling-stroke"/>{line}</svg>'
    )
