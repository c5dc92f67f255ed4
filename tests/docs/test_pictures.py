"""The pictures in docs/ are those that the program draws."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import drawn
import make_pictures
import pytest

MEASURED = {"frame_rate.png"}
"""Made by a benchmark: they show how fast some machine was."""
NUMBER = re.compile(r"[−-]?\d+(?:\.\d+)?")


def alike(one: Any, other: Any) -> bool:
    """Whether two pictures show the same, but for what rounding on another machine may change."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, str) and isinstance(other, str):  # a tenth of a millimetre or of a degree may round up or down
        return NUMBER.split(one) == NUMBER.split(other) and numbers(one) == pytest.approx(
            numbers(other), rel=0.01, abs=0.11
        )
    return bool(one == pytest.approx(other, rel=0.01, abs=0.005) if isinstance(one, float) else one == other)


def numbers(text: str) -> list[float]:
    return [float(number.replace("−", "-")) for number in NUMBER.findall(text)]


@pytest.mark.parametrize("name", make_pictures.PICTURES)
def test_the_program_draws_what_the_picture_shows(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(make_pictures, "FOLDER", tmp_path)
    with drawn.recorded() as found:
        make_pictures.PICTURES[name]()
    pictures, record = list(tmp_path.glob("*.png")), drawn.read()
    assert pictures
    for picture in pictures:
        now, kept = found[drawn.digest(picture)], record[picture.name]["shows"]
        older = f"docs/{picture.name} is older than the program: python docs/make_pictures.py {name}"
        assert alike(now, kept), older


def test_each_picture_is_the_one_that_the_record_is_about() -> None:
    digests = {path.name: drawn.digest(path) for path in drawn.RECORD.parent.glob("*.png")}
    assert set(digests) > MEASURED
    record = {name: entry["sha256"] for name, entry in drawn.read().items()}
    assert record == {name: digest for name, digest in digests.items() if name not in MEASURED}


def test_what_differs_is_told_from_what_rounds_differently() -> None:
    text = "the fingertips end at x −83, y 102 mm"
    assert alike(text, "the fingertips end at x −83, y 103 mm")
    assert not alike(text, "the fingertips end at x 83, y 102 mm")
    assert not alike(text, "the fingertips ended at x −83, y 102 mm")
    assert alike({"extent": [0.1, None]}, {"extent": [0.104, None]})
    assert not alike({"extent": [0.1, None]}, {"extent": [0.12, None]})
    assert not alike(["cloud"], ["cloud", "outline"])
