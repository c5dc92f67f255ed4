"""Every kind of picture can be read at its own size: words are large enough, and nothing lies over anything."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.path import Path

from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.methods.comparison import compare
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.planning import Plan, plan
from flatgrasp_cli.profiles import load_gripper, load_robot, load_settings
from flatgrasp_cli.proof.caging import immobilising_grasps
from flatgrasp_cli.results.figures import arm_figure, final_figure, stage_figures
from flatgrasp_cli.results.figures.cage import cage_figure
from flatgrasp_cli.results.figures.comparison import comparison_figure
from flatgrasp_cli.results.figures.marks import BEHIND, TRIAD_PX, draw_triad
from flatgrasp_cli.results.figures.page import Page, in_lines, show
from flatgrasp_cli.results.figures.style import TEXT
from flatgrasp_cli.results.view import View, view_of
from flatgrasp_cli.sources import read_clouds
from tests.conftest import SAMPLES, Box, Camera, Tube
from tests.results.drawn_texts import DrawnText, collisions, drawn_texts

GROUND = Box((0.4, 0.0, -0.01), (0.9, 0.8, 0.02))
BAR = Box((0.35, -0.1, 0.02), (0.1, 0.04, 0.04))
UP = np.array([0.0, 0.0, 1.0])
WIDTH_PX = 1200


@pytest.fixture(scope="module", autouse=True)
def letters_of_pictures() -> Iterator[None]:
    """As wide as `as_png` draws them."""
    with rc_context(TEXT):
        yield


def seen(
    *solids: Box | Tube, gripper: str = "pr2", robot: str | None = None, tilt_deg: float = 30, around: int = 8
) -> Plan:
    """The plan of a table seen from before it; hands come from so many sides `around` where straight down fails."""
    cloud = Camera(tilt_deg=tilt_deg, target=(0.4, 0.0, 0.0), distance=0.9).sees(GROUND, *solids)
    settings = load_settings("default", ("scene.mode=table", f"approach.around={around}"))
    return plan(cloud, load_gripper(gripper), settings, robot=load_robot(robot) if robot else None)


@cache
def a_bar() -> Plan:
    """Planned once for all tests that look at it."""
    return seen(BAR)


@cache
def of_a_bar() -> Figure:
    """Its final figure."""
    return final_figure(a_bar())


def of_sample(name: str, gripper: str = "lacquey") -> Plan:
    (cloud,) = read_clouds(str(SAMPLES / f"{name}.pcd"))
    return plan(cloud, load_gripper(gripper))


def ten_objects() -> Plan:
    places = product(np.linspace(0.15, 0.65, 5), (-0.12, 0.14))
    return seen(*(Box((x, y, 0.02), (0.05, 0.03, 0.04), 40.0 * k) for k, (x, y) in enumerate(places)))


def out_of_reach() -> Plan:
    cloud = Camera(tilt_deg=30, target=(3.0, 0.0, 0.0)).sees(
        Box((3.0, 0.0, -0.01), (0.7, 0.6, 0.02)), Box((3.0, 0.0, 0.02), (0.1, 0.04, 0.04))
    )
    straight_down = load_settings("default", ("approach.directions=top",))
    return plan(cloud, load_gripper("pr2"), straight_down, robot=load_robot("ur5"))


def named_at_length() -> Plan:
    """A path and a frame whose names have more letters than a line holds."""
    result = a_bar()
    source = replace(result.cloud.source, path="/data/" + "a_night_of_grasping_" * 9 + ".pcd")
    return replace(result, cloud=replace(result.cloud, source=source, frame_id="camera_" * 12))


PLANS: dict[str, Callable[[], Plan]] = {
    "alone": lambda: of_sample("teddy_bear"),
    "scene": lambda: of_sample("table_scene", "pr2"),
    "ten objects": ten_objects,
    "no grasp": lambda: seen(Box((0.4, 0.0, 0.03), (0.15, 0.15, 0.06)), around=3),
    "empty table": seen,
    "narrow": lambda: seen(Box((0.4, 0.0, 0.01), (0.25, 0.008, 0.02))),
    "robot": lambda: seen(BAR, robot="ur5"),
    "from the side": lambda: seen(Tube((0.4, 0.0, 0.03), 0.03, 0.12, (1.0, 0.0, 0.0)), tilt_deg=65),
    "out of reach": out_of_reach,
    "long names": named_at_length,
}
STAGES_AS_ELSEWHERE = {"ten objects", "long names"}
"""Stages show the first object alone, and no names: these plans' are those of a bar, which the robot's plan has."""


def figures_of(result: Plan, *, stages: bool) -> Iterator[tuple[str, Figure]]:
    yield "final", final_figure(result)
    arm = arm_figure(result)
    if arm is not None:
        yield "arm", arm
    if stages:
        yield from ((name, draw()) for name, draw in stage_figures(result))
    for item in result.objects[:1]:
        pair = compare(item, result.gripper, result.settings)
        if pair.theirs is not None:
            yield "comparison", comparison_figure(result, item, pair.theirs.contacts, pair.verdicts, "a.pcd")
    for item in result.objects[:1]:
        if item.silhouette is not None:
            loops = item.silhouette.loops
            found = immobilising_grasps(loops, load_settings().caging)
            yield "cage", cage_figure(loops, found, "a.pcd", in_metres=True)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A figure, and the words that drawing it wrote."""

    name: str
    figure: Figure
    texts: list[DrawnText]


@pytest.fixture(scope="module", params=PLANS)
def pictures(request: pytest.FixtureRequest, letters_of_pictures: None) -> list[Picture]:  # noqa: ARG001 (for drawing)
    """All pictures of a kind of plan, each of which is drawn once for all tests that look at it."""
    figures = figures_of(PLANS[request.param](), stages=request.param not in STAGES_AS_ELSEWHERE)
    return [Picture(name, figure, drawn_texts(figure)) for name, figure in figures]


def test_words_collide_in_no_picture(pictures: list[Picture]) -> None:
    wrong = {each.name: found for each in pictures if (found := collisions(each.figure, each.texts))}
    assert wrong == {}


def test_pictures_are_1200_pixels_wide_and_about_as_high(pictures: list[Picture]) -> None:
    for each in pictures:
        width, height = each.figure.bbox.size
        assert width == WIDTH_PX, each.name
        assert height < 1.1 * WIDTH_PX, each.name


def test_stages_say_what_they_do_and_what_is_drawn(pictures: list[Picture]) -> None:
    for each in pictures:
        if each.name[0].isdigit():
            words = {text.text for text in each.texts}
            assert words & {"Method", "Box", "Approach"}, each.name
            assert each.figure.legends[0].get_texts(), each.name


def test_collisions_are_found() -> None:
    """Of the test's own eyes: what it must see."""
    page = Page("title", 1)
    axes = page.panel("")
    for place, words in ((0.5, "one"), (0.5, "other"), (1.9, "outside")):
        axes.text(place, 0.5, words, fontsize=9)
    axes.text(0.2, 0.2, "tiny", fontsize=5)
    figure = page.finish([])
    found = collisions(figure, drawn_texts(figure))
    assert found == ["'outside' leaves the page", "'tiny' is 5.0 pt", "'one' is over 'other'"]


def test_the_widths_are_beside_the_hand() -> None:
    result = a_bar()
    best = result.best
    assert best is not None
    words = f"open {1e3 * best.opening_m:.1f} mm\nclosed {1e3 * best.width_m:.1f} mm"
    scene, close = of_a_bar().axes
    assert words in {text.get_text() for text in close.texts}
    assert words not in {text.get_text() for text in scene.texts}


def test_marks_of_contacts_point_at_them_from_outside() -> None:
    """So they hide no narrow object, and not each other."""
    result = a_bar()
    best = result.best
    assert best is not None
    contacts = view_of(result, UP).of_world(best.contacts)
    marks = [line for line in of_a_bar().axes[1].lines if isinstance(line.get_marker(), Path)]
    assert np.concatenate([np.asarray(mark.get_xydata()) for mark in marks]) == pytest.approx(contacts, abs=0.01)
    for mark, place, other in zip(marks, contacts, contacts[::-1], strict=True):
        corners = np.asarray(mark.get_marker().vertices)  # type: ignore[union-attr]
        assert (corners @ (place - other) >= -1e-12).all()


@pytest.mark.parametrize("size", [0.05, 0.15])
def test_the_frames_axes_cover_no_object(size: float) -> None:
    """A square thing fills its close-up but for the room that is left for them."""
    result = seen(Box((0.4, 0.0, 0.03), (size, size, 0.06)), around=3)
    (item,) = result.objects
    outline = item.silhouette
    assert outline is not None
    close = final_figure(result).axes[1]
    (paper,) = (patch for patch in close.patches if patch.get_zorder() == BEHIND)
    drawn = close.transData.transform(view_of(result, UP).of_plane(outline.frame, outline.loops[0]))
    assert paper.get_window_extent().width == pytest.approx(TRIAD_PX)
    assert not paper.get_window_extent().count_contains(drawn)


def test_obstacles_are_not_written_over() -> None:
    result = a_bar()
    axes = of_a_bar().axes[0]
    (label,) = (text for text in axes.texts if text.get_text().startswith("0:"))
    x, y = 1e-3 * np.array(label.get_position())
    grid = np.stack(np.meshgrid(*(np.linspace(c - 0.02, c + 0.02, 15) for c in (x, y))), axis=-1).reshape(-1, 2)
    clutter = np.column_stack([grid, np.full(len(grid), 0.03)])
    moved = final_figure(replace(result, scene=replace(result.scene, clutter=clutter))).axes[0]
    (label,) = (text for text in moved.texts if text.get_text().startswith("0:"))
    assert not label.get_window_extent().count_contains(moved.transData.transform(1e3 * grid))


class TestTriad:
    @staticmethod
    def drawn(*axes: tuple[float, ...]) -> tuple[Figure, Axes]:
        page = Page("", 1)
        panel = page.panel("")
        show(panel, np.array([[-100.0, -100.0], [100.0, 100.0]]), 0.0)
        draw_triad(panel, View(Frame(np.zeros(3), np.array(axes))), "base", np.zeros((1, 2)))
        return page.finish([]), panel

    def test_arrows_of_one_direction_have_their_names_beside_each_other(self) -> None:
        """Seen from 50° over a plane: y and z both go down in the drawing."""
        c, s = np.cos(np.radians(50)), np.sin(np.radians(50))
        figure, panel = self.drawn((-1, 0, 0), (0, -s, -c), (0, -c, s))
        assert collisions(figure, drawn_texts(figure)) == []
        places = {text.get_text(): text.get_position() for text in panel.texts if text.get_text() in {"y", "z"}}
        assert places["z"][0] != pytest.approx(places["y"][0])

    @pytest.mark.parametrize(("up", "sign"), [(1.0, "⊙"), (-1.0, "⊗")])
    def test_an_axis_toward_the_reader_is_a_sign(self, up: float, sign: str) -> None:
        _, panel = self.drawn((1, 0, 0), (0, up, 0), (0, 0, up))
        assert sign in {text.get_text() for text in panel.texts}


def test_where_the_camera_was_is_never_negative() -> None:
    result = a_bar()
    below = Sensor("option", np.array([0.4, 0.0, -0.5]))
    words = {
        text.text for text in drawn_texts(final_figure(replace(result, cloud=replace(result.cloud, sensor=below))))
    }
    assert any("° below the drawing's plane" in text for text in words)


class TestCage:
    def test_finger_1_goes_to_the_right_in_contact_space(self) -> None:
        """Of an outline from its lower left corner, that has its waist where the fingers are, below and above."""
        waist = np.array([[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [4.0, 4.0], [2.0, 3.0], [0.0, 4.0]])
        exact = {"tolerance_m": 0.0, "noise_m": 0.0, "told_apart_m": 0.0}
        found = immobilising_grasps((waist,), load_settings().caging.model_copy(update=exact))
        _, space = cage_figure((waist,), found, "", in_metres=False).axes[:2]
        (dot,) = (line for line in space.lines if line.get_label() == "grasp 1")
        side = np.sqrt(5.0)
        along = {1.0: side, 3.0: 3 * side + 4.0}
        first, second = (along[float(contact[1])] for contact in found[0].contacts)
        assert np.asarray(dot.get_xydata())[0] == pytest.approx([first, second], abs=0.1)
        assert "finger 1" in space.get_xlabel()
        assert "finger 2" in space.get_ylabel()

    def test_a_finger_in_a_hole_goes_along_the_hole(self) -> None:
        ring = (
            np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]),
            np.array([[1.0, 1.0], [1.0, 3.0], [2.0, 2.0]]),
        )
        found = immobilising_grasps(ring, load_settings().caging.model_copy(update={"noise_m": 0.0}))
        figure = cage_figure(ring, found, "", in_metres=False)
        assert found[0].escape_m is None
        assert "another loop" in figure.axes[1].get_ylabel()


class TestLines:
    @pytest.fixture
    def page(self) -> Figure:
        return Page("", 1).figure

    def test_words_are_kept_together(self, page: Figure) -> None:
        lines = in_lines(page, "the hand comes along", 0.85)
        assert lines == ["the hand", "comes along"]
        assert all(page.text(0, 0, line, fontsize=9).get_window_extent().width <= 0.85 * page.dpi for line in lines)
        assert in_lines(page, "", 1.0) == [""]

    def test_a_place_stays_on_one_line(self, page: Figure) -> None:
        place = "x\N{NO-BREAK SPACE}12,\N{NO-BREAK SPACE}y\N{NO-BREAK SPACE}7\N{NO-BREAK SPACE}mm"
        assert in_lines(page, f"it ends at {place}", 1.0) == ["it ends at", place]

    @pytest.mark.parametrize("unit", ["%", "mm"])
    def test_a_number_and_its_unit_stay_on_one_line(self, page: Figure, unit: str) -> None:
        for width_in in np.arange(0.6, 2.4, 0.05):
            lines = in_lines(page, f"of what lies there 100 {unit} or more", width_in)
            assert not any(line.endswith("100") for line in lines)

    def test_a_word_longer_than_a_line_is_cut(self, page: Figure) -> None:
        lines = in_lines(page, "a" * 60 + " end", 1.0)
        assert "".join(lines) == "a" * 60 + " end"
        assert len(lines) > 3
