"""A batch as one HTML page that needs nothing else: no script, no network, no other file."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from pathlib import Path
from statistics import median
from typing import Any
from urllib.parse import quote

from flatgrasp_cli.batch.pages import page_of
from flatgrasp_cli.batch.sketch import sketch
from flatgrasp_cli.batch.summary import NO_OBJECT, InputSummary
from flatgrasp_cli.batch.words import in_words, object_in_words
from flatgrasp_cli.profiles import Gripper, load_settings
from flatgrasp_cli.source_names import name_of
from flatgrasp_cli.sources.remote import is_url

STYLE = """
:root { color-scheme: light dark; font: 14px/1.45 system-ui, sans-serif; }
body { max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.05rem; margin: 0 0 .3rem; overflow-wrap: anywhere; }
section { border-top: 1px solid #8886; padding: 1rem 0; }
.numbers { color: #777; } .error { color: #c22; } .warning { color: #a60; }
.bar { height: .5rem; background: #d55e0055; margin: .4rem 0; } .bar div { height: 100%; background: #009e73; }
.strip { display: flex; flex-wrap: wrap; gap: 1rem; margin-top: .6rem; }
figure { margin: 0; width: 14rem; } figcaption { font-size: .85rem; overflow-wrap: anywhere; }
figcaption ol { list-style: none; margin: .2rem 0; padding: 0; }
figure.refused svg { outline: 2px solid #d55e00; }
svg { background: #fff; display: block; width: 14rem; height: 12rem; }
table { border-collapse: collapse; margin: .5rem 0; }
td { padding: 0 1rem 0 0; vertical-align: top; } td.n { text-align: right; }
fieldset { border: 1px solid #8886; margin: .5rem 0; } label { margin-right: 1rem; }
details { margin: .3rem 0; }
"""
ANY_STATUS = (("every", "all frames"), ("ok", "with a grasp"), ("none", "without a grasp"), ("odd", "failed or warned"))
STATUS_RULES = """
body:has(#s-ok:checked) :is(figure.refused, section:not(.ok)),
body:has(#s-none:checked) :is(figure.grasped, section:not(.none)),
body:has(#s-odd:checked) section:not(.odd) { display: none; }
"""


@dataclass(frozen=True, slots=True)
class Made:
    """What a report tells of its batch beside the results: `made_with` is the store's manifest.

    `folder` is where the page will be, `table` the name of the file with a row for each object.
    """

    made_with: dict[str, Any]
    date: str
    folder: Path
    table: str


def report(inputs: list[InputSummary], values: dict[str, Any], made: Made) -> Iterator[str]:
    """Yield the page piece by piece: the whole batch, then each input, failures first."""
    reasons = _reasons(inputs)
    rules = STATUS_RULES + "".join(_rules(k) for k in range(len(reasons)))
    yield '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>flatgrasp: '
    yield f"{values['grasped']} of {values['frames']} frames</title><style>{STYLE}{rules}</style>"
    yield '<meta name="viewport" content="width=device-width"></head><body>\n'
    yield f"<h1>{values['grasped']} of {values['frames']} frames with a grasp</h1>\n"
    yield f'<p class="numbers">{values["inputs"]} inputs, {values["failed"]} failed. {_times(inputs)}</p>\n'
    yield _bar(values["grasped"], values["frames"])
    yield _stages(values["no_grasp_by_stage"])
    yield from _made(made)
    yield from _filters(reasons)
    for one in inputs:
        yield from _input(one, list(reasons), made)
    yield "</body></html>\n"


def _rules(k: int) -> str:
    """What style hides when frames of reason k are asked for: also sources that have none of the status asked for."""
    rules = f"body:has(#r{k}:checked) :is(figure, section):not(.r{k}) {{ display: none; }}\n"
    for status, mark in (("ok", "grasped"), ("none", "refused")):
        both = f"body:has(#s-{status}:checked):has(#r{k}:checked)"
        rules += f"{both} section:not(:has(figure.{mark}.r{k})) {{ display: none; }}\n"
    return rules


def _made(made: Made) -> Iterator[str]:
    """With what the results were made, and where they are."""
    given = made.made_with
    gripper = Gripper.model_validate_json(json.dumps(given["gripper"]))
    rows = {
        "made": f"{made.date}, flatgrasp {given['version']}",
        "gripper": f"{gripper.description}, opens {1000 * gripper.max_opening_m:.0f} mm",
        "robot": given["robot"] and f"{given['robot']['name']}, answers in {given['base_frame']}",
        "settings": ", ".join(_changed(given["settings"])) or "the shipped defaults",
    }
    cells = "".join(f"<tr><td>{name}</td><td>{escape(text)}</td></tr>" for name, text in rows.items() if text)
    yield f"<table>{cells}</table>\n"
    links = (("summary.json", "numbers"), (made.table, "a row for each object"))
    yield f"<p>{', '.join(f'{_link(name, name)} ({what})' for name, what in links)}</p>\n"
    for name in ("gripper", "robot", "settings"):
        if given[name]:
            cells = "".join(
                f"<tr><td>{escape(key)}</td><td>{escape(str(value))}</td></tr>" for key, value in _flat(given[name])
            )
            yield f"<details><summary>all of {name}</summary><table>{cells}</table></details>\n"


def _flat(values: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Nested values with their dotted names, as `--set` takes them."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _changed(settings: dict[str, Any]) -> list[str]:
    """The settings that are not the shipped ones."""
    shipped = dict(_flat(load_settings().model_dump(mode="json")))
    return [f"{key} = {value}" for key, value in _flat(settings) if shipped.get(key, value) != value]


def _filters(reasons: dict[str, int]) -> Iterator[str]:
    """Choices that the page's style follows."""
    yield "<fieldset><legend>show</legend>"
    for k, (key, words) in enumerate(ANY_STATUS):
        yield _choice("status", f"s-{key}", words, checked=k == 0)
    yield "</fieldset>\n"
    if reasons:
        yield "<fieldset><legend>frames with an object that has no grasp, by reason</legend>"
        yield _choice("reason", "r-any", "any", checked=True)
        for k, (stage, number) in enumerate(reasons.items()):
            yield _choice("reason", f"r{k}", f"{in_words(stage)} ({number})", checked=False)
        yield "</fieldset>\n"
    yield (
        '<p class="numbers">Sketches show the scene from above, as the camera or the robot\'s base sees it: outlines '
        "with their objects' numbers, blue with a grasp, orange without, and the line that fingers close along.</p>\n"
    )


def _choice(group: str, key: str, words: str, *, checked: bool) -> str:
    mark = " checked" if checked else ""
    return f'<label><input type="radio" name="{group}" id="{key}"{mark}> {escape(words)}</label>'


def _reasons(inputs: list[InputSummary]) -> dict[str, int]:
    """Why objects in the frames shown have no grasp, by stage, the commonest first."""
    found = Counter(stage for one in inputs for _, record in one.shown for stage in _stages_of(record))
    return dict(found.most_common())


def _stages_of(record: dict[str, Any]) -> list[str]:
    """The stages at which a frame's objects were lost, each once; of a frame without objects the scene itself."""
    lost = [thing["stage"] or NO_OBJECT for thing in record["objects"] if thing["status"] != "ok"]
    return list(dict.fromkeys(lost)) if record["objects"] else [NO_OBJECT]


def _input(one: InputSummary, reasons: list[str], made: Made) -> Iterator[str]:
    marks = {f"r{reasons.index(stage)}" for _, record in one.shown for stage in _stages_of(record)}
    marks |= {"ok"} if one.grasped else set()
    marks |= {"none"} if one.grasped < one.frames or one.error else set()
    marks |= {"odd"} if one.error or one.warnings else set()
    yield f'<section class="{" ".join(sorted(marks))}"><h2>{_source(one.source, made.folder)}</h2>\n'
    if one.error is not None:
        yield f'<p class="error">{escape(one.error)}</p>\n'
    for warning in one.warnings:
        yield f'<p class="warning">{escape(warning)}</p>\n'
    if one.frames:
        share, documents = f"{one.grasped} of {one.frames}", _link(f"{one.name}.jsonl", "documents, a line a frame")
        if made.made_with["plots"]:
            documents += f", and {_link(page_of(one.name), 'in three dimensions')}"
        yield f'<p class="numbers">{share} frames with a grasp; {documents}. {_times([one])}</p>\n'
        yield _bar(one.grasped, one.frames)
        yield _stages(dict(one.stages.most_common()))
        if len(one.shown) < one.frames:
            yield f'<p class="numbers">{len(one.shown)} of its frames, those without a grasp first:</p>\n'
        yield '<div class="strip">\n'
        for index, record in one.shown:
            yield _figure(index, record, reasons)
        yield "</div>\n"
    yield "</section>\n"


def _source(source: str, folder: Path) -> str:
    """The source's name, with a link to it where a browser can follow one."""
    if is_url(source):
        web = source.startswith(("http://", "https://"))
        return f'<a href="{escape(quote(source, safe=":/?&=%#"))}">{escape(source)}</a>' if web else escape(source)
    try:
        place = Path(os.path.relpath(source, folder)).as_posix()
    except ValueError:  # on another drive
        return escape(name_of(source))
    return _link(place, name_of(source))


def _link(path: str, words: str) -> str:
    return f'<a href="./{escape(quote(os.fsencode(path)))}">{escape(words)}</a>'


def _times(inputs: list[InputSummary]) -> str:
    """Milliseconds of a frame, and apart from them what the first frame of each worker took."""
    steady = [one.median_ms for one in inputs if one.median_ms]
    words = []
    if steady:
        steps = {step: median(times[step] for times in steady) for step in ("read", "scene", "plan", "total")}
        read, scene, plan, total = (f"{value:.0f} ms" for value in steps.values())
        words.append(f"Medians of a frame: {total} (read {read}, find objects {scene}, plan {plan}).")
    first = [time for one in inputs for time in one.first_ms]
    if first:
        words.append(f"Start-up, apart from that: {median(first):.0f} ms for the first frame of a worker.")
    return " ".join(words)


def _bar(part: int, whole: int) -> str:
    share = 100 * part / whole if whole else 0.0
    return f'<div class="bar" title="{share:.1f} %"><div style="width:{share:.1f}%"></div></div>\n'


def _stages(stages: dict[str, int]) -> str:
    """Why frames have no grasp, how often."""
    if not stages:
        return ""
    rows = "".join(
        f'<tr><td>{escape(in_words(stage))}</td><td class="n">{count}</td></tr>' for stage, count in stages.items()
    )
    return f"<table><tr><td>frames without a grasp, because</td><td></td></tr>{rows}</table>\n"


def _figure(index: int, record: dict[str, Any], reasons: list[str]) -> str:
    """A frame: its sketch, its pictures, and a line for each of its objects."""
    ok = record["status"] == "ok"
    marks = ["grasped" if ok else "refused", *(f"r{reasons.index(stage)}" for stage in _stages_of(record))]
    stamp = record["stamp_ns"]
    when = "" if stamp is None else f" at {stamp / 1e9:.3f} s"
    pictures = " ".join(_link(path, f"{path.rsplit('.', 2)[-2]} picture") for path in record["pictures"])
    lines = [escape(object_in_words(thing)) for thing in record["objects"]] or [escape(record["reason"] or "")]
    items = "".join(f"<li>{line}</li>" for line in lines)
    return (
        f'<figure class="{" ".join(marks)}">{sketch(record["sketch"])}'
        f"<figcaption>#{index}{when} {pictures}<ol>{items}</ol></figcaption></figure>\n"
    )
