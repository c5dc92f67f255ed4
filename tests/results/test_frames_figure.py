"""The picture of the frames: what is drawn where, in millimetres."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation

from flatgrasp_cli.profiles import Gripper, list_profiles, load_gripper
from flatgrasp_cli.results.figures import as_png
from flatgrasp_cli.results.figures.frames import frames_figure

OPENING_M, WIDTH_M = 0.080, 0.040


def panels(gripper: Gripper) -> tuple[Axes, Axes]:
    side, along = frames_figure(gripper, OPENING_M, WIDTH_M).axes
    return side, along


def boxes(axes: Axes, label: str) -> list[list[float]]:
    """Left, right, low and high of the boxes of a kind, which only the first of them is labelled with."""
    found: list[list[float]] = []
    kind = None
    for patch in axes.patches:
        if isinstance(patch, Rectangle):
            kind = str(patch.get_label()) or kind
            (x, y), width, height = patch.get_xy(), patch.get_width(), patch.get_height()
            found += [[x, x + width, *sorted((y, y + height))]] if kind == label else []
    return found


def test_an_arcs_open_fingers_end_short_of_the_closed_ones() -> None:
    """2F-85 at 40 mm: fingers of 59 + 13.5 · 45/85 mm and a hand of 94 mm; open to 80 mm, 6.35 mm shorter."""
    side, _ = panels(load_gripper("robotiq_2f_85"))
    length = 59 + 13.5 * 45 / 85
    closed = boxes(side, "fingers, closed to width_m")[:2]
    assert closed == [pytest.approx([-26, -20, -length, 0]), pytest.approx([20, 26, -length, 0])]
    opened = boxes(side, "fingers, open to opening_m")
    assert opened == [pytest.approx([y, y + 6, -length, -13.5 * 40 / 85]) for y in (-46, 40)]
    assert boxes(side, "hand") == [pytest.approx([-42.5, 42.5, -length - 94, -length])]


def test_the_two_frames_are_a_tools_length_apart_and_none_is_beside_the_approach() -> None:
    gripper = load_gripper("wsg_50")
    side, _ = panels(gripper)
    circles = np.array([np.asarray(line.get_xydata())[0] for line in side.lines if line.get_marker() == "o"])
    assert circles == pytest.approx(np.array([[0, -152], [0, 0]]))
    texts = {text.get_text() for text in side.texts}
    assert texts >= {"x", "y", "z", "flange (tool0)", "pose: fingertips", "arm", "support plane"}
    assert not any("short" in text for text in texts)  # parallel fingers move straight


def test_the_contacts_are_on_the_pads_in_the_documents_order() -> None:
    _, along = panels(load_gripper("lacquey"))
    lines = [np.asarray(line.get_xydata()) for line in along.lines]
    (contacts,) = (line for line in lines if len(line) == 2)
    assert contacts == pytest.approx(np.array([[-20, 0], [20, 0]]))
    named = {text.get_text(): text.xy for text in along.texts if isinstance(text, Annotation)}
    assert (named["contacts[0]"], named["contacts[1]"]) == ((-20, 0), (20, 0))
    assert len(boxes(along, "fingers, closed to width_m")) == 3  # a thumb, and a pair


@pytest.mark.parametrize("name", list_profiles("gripper"))
def test_every_gripper_can_be_drawn(name: str) -> None:
    assert all(axes.patches for axes in panels(load_gripper(name)))


def test_it_is_drawn_as_png() -> None:
    content = as_png(lambda: frames_figure(load_gripper("lacquey"), OPENING_M, WIDTH_M))
    assert content is not None
    assert content.startswith(b"\x89PNG")
