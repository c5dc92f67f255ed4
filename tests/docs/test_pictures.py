"""The pictures in docs/ are those that the program draws."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import drawn
import make_pictures
import pytest

MEASURED = {"calibration.png", "frame_rate.png", "teddy_bear.trial.png", "view.png"}
"""Made by a benchmark, a simulation or a browser: they show how fast some machine was, where its physics ended, or its
fonts."""
NUMBER = re.compile(r"[−-]?\d+(?:\.\d+)?")


def differences(now: Any, kept: Any, where: str = "") -> Iterator[str]:
    """Where two pictures show something else, but for what rounding on another machine may change."""
    if isinstance(now, dict) and isinstance(kept, dict) and now.keys() == kept.keys():
        for key, value in now.items():
            yield from differences(value, kept[key], f"{where} {key}")
    elif isinstance(now, list) and isinstance(kept, list) and len(now) == len(kept):
        for number, (one, other) in enumerate(zip(now, kept, strict=True)):
            yield from differences(one, other, f"{where} {number}")
    elif not alike(now, kept):
        yield f"{where}: now {now!r}, in the picture {kept!r}"


def alike(now: Any, kept: Any) -> bool:
    """Whether two values are the same but for rounding: in texts of the last digit, in places of a pixel or two."""
    if isinstance(now, str) and isinstance(kept, str):
        words = NUMBER.split(now) == NUMBER.split(kept)
        return words and numbers(now) == pytest.approx(numbers(kept), rel=0.01, abs=0.11)
    if isinstance(now, float) and isinstance(kept, float):
        return now == pytest.approx(kept, rel=0.01, abs=0.005)
    return bool(now == kept)


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
        changed = list(differences(found[drawn.digest(picture)], record[picture.name]["shows"]))
        assert changed == [], f"docs/{picture.name} is older than the program: python docs/make_pictures.py {name}"


def test_each_picture_is_the_one_that_the_record_is_about() -> None:
    digests = {path.name: drawn.digest(path) for path in drawn.RECORD.parent.glob("*.png")}
    assert set(digests) > MEASURED
    record = {name: entry["sha256"] for name, entry in drawn.read().items()}
    assert record == {name: digest for name, digest in digests.items() if name not in MEASURED}


def test_what_differs_is_told_from_what_rounds_differently() -> None:
    text = "the fingertips end at x −83, y 102 mm"
    for other in ("the fingertips end at x 83, y 102 mm", "the fingertips ended at x −83, y 102 mm"):
        assert len(list(differences({"words": text}, {"words": other}))) == 1
    assert list(differences(text, "the fingertips end at x −83, y 103 mm")) == []
    assert list(differences({"extent": [0.1, None]}, {"extent": [0.104, None]})) == []
    shifted = differences({"panels": [{"extent": [0.1, 0.5]}]}, {"panels": [{"extent": [0.1, 0.52]}]})
    assert list(shifted) == [" panels 0 extent 1: now 0.5, in the picture 0.52"]
    assert len(list(differences(["cloud"], ["cloud", "outline"]))) == 1
