"""Figures of scenes and of the arm: what is drawn where, and which way up."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import get_data_path
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.font_manager import get_font
from matplotlib.patches import Polygon

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.model import Sensor
from flatgrasp_cli.planning import Plan, plan
from flatgrasp_cli.profiles import Gripper, load_robot, load_settings
from flatgrasp_cli.results.figures import arm_figure, final_figure, stage_figures
from flatgrasp_cli.results.figures.hand import DrawnHand, hand_solids
from flatgrasp_cli.results.figures.labels import Label, put
from flatgrasp_cli.results.figures.marks import draw_place, sensor_in_words
from flatgrasp_cli.results.figures.page import Page, show
from flatgrasp_cli.results.figures.scene import PLACES
from flatgrasp_cli.results.figures.solid import AZIMUTH_DEG
from flatgrasp_cli.results.figures.style import ORANGE
from flatgrasp_cli.results.view import View, middle_of, view_of
from tests.conftest import TABLE, Box, Camera, Tube

CAMERA = Camera(tilt_deg=30, target=(0.4, 0.0, 0.0), distance=0.9)
BESIDE = Box((0.4, 0.0, -0.01), (0.7, 0.6, 0.02))
SMALL, OTHER = Box((0.35, -0.1, 0.02), (0.1, 0.04, 0.04)), Box((0.5, 0.08, 0.02), (0.1, 0.05, 0.04), 40)
WIDE = Box((0.4, 0.0, 0.03), (0.15, 0.15, 0.06))
FAR = Camera(tilt_deg=30, target=(3.0, 0.0, 0.0))
UP = np.array([0.0, 0.0, 1.0])


@cache
def planned(gripper: Gripper, *solids: Box, robot: str | None = None, settings: tuple[str, ...] = ()) -> Plan:
    arm = load_robot(robot) if robot else None
    return plan(CAMERA.sees(BESIDE, *solids), gripper, load_settings("default", settings), top=3, robot=arm)


@cache
def final(result: Plan) -> Figure:
    """Its final figure, drawn once for all tests that look at it."""
    return final_figure(result)


def out_of_reach(gripper: Gripper) -> Plan:
    cloud = FAR.sees(Box((3.0, 0.0, -0.01), (0.7, 0.6, 0.02)), Box((3.0, 0.0, 0.02), (0.1, 0.04, 0.04)))
    return plan(cloud, gripper, robot=load_robot("ur5"))


def texts(axes: Axes) -> set[str]:
    return {text.get_text() for text in axes.texts}


def caption(figure: Figure) -> dict[str, str]:
    """What stands beside each word below the panels."""
    rows: dict[str, str] = {}
    word = ""
    for text in figure.texts:
        if text.get_fontweight() == "bold":
            word = text.get_text()
        elif text is not figure._suptitle:  # type: ignore[attr-defined]
            words = text.get_text().replace("\N{NO-BREAK SPACE}", " ")
            rows[word] = f"{rows[word]} {words}" if word in rows else words
    return rows


def legend(figure: Figure) -> set[str]:
    return {text.get_text().replace("\n", " ") for text in figure.legends[0].get_texts()}


def fingers(axes: Axes) -> list[FloatArray]:
    """Corners (4, 2) of what is drawn orange and not faint."""
    solid = [patch for patch in axes.patches if isinstance(patch, Polygon) and patch.get_facecolor() == to_rgba(ORANGE)]
    return [np.asarray(patch.get_xy())[:4] for patch in solid]


def ahead(gripper: Gripper, *, squarely: bool) -> Plan:
    """A plan whose one object is before a camera at its frame's origin, in the middle of its image or aside."""
    result = planned(gripper, SMALL)
    shift = np.array([-0.35, 0.1, 0.8] if squarely else [-0.2, 0.1, 0.8])
    things = tuple(
        replace(item, object=replace(item.object, points=item.object.points + shift)) for item in result.objects
    )
    return replace(result, objects=things, cloud=replace(result.cloud, sensor=Sensor("frame", np.zeros(3))))


def test_every_object_of_a_scene_has_its_number_and_its_hand(pr2: Gripper) -> None:
    result = planned(pr2, SMALL, OTHER)
    figure = final(result)
    scene, close = figure.axes
    assert {item.object.id for item in result.objects} == {0, 1}
    items = zip("①②", result.objects, strict=True)
    assert {f"{place} {item.object.id}: {1e3 * item.grasps[0].width_m:.0f} mm" for place, item in items} <= texts(scene)
    assert caption(figure)["Order"].startswith("the numbers in circles: pick one after the other")
    assert len(fingers(scene)) == 2 * 2
    assert "2 objects on a support plane" in scene.get_title(loc="left")
    assert f"object {result.objects[0].object.id}" in close.get_title(loc="left")
    assert "pr2: two fingers on an arc" in figure.get_suptitle()


def test_matplotlibs_own_font_has_the_numbers_of_the_order() -> None:
    font = get_font(str(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"))
    assert {ord(number) for number in PLACES} <= set(font.get_charmap())


def test_the_hand_is_drawn_where_the_grasp_is_in_both_panels(pr2: Gripper) -> None:
    """On a level plane both drawings have the answer's own coordinates, x to the right and y up."""
    result = planned(pr2, SMALL)
    grasp = result.objects[0].grasps[0]
    for axes in final(result).axes:
        left, right = (finger.mean(axis=0) for finger in fingers(axes))
        assert np.linalg.norm(left - right) == pytest.approx(1e3 * (grasp.opening_m + pr2.finger_thickness_m))
        assert 0.5 * (left + right) == pytest.approx(1e3 * grasp.position[:2], abs=0.5)
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (mm)", "y (mm)")


def test_the_caption_says_where_how_wide_and_why(pr2: Gripper) -> None:
    result = planned(pr2, SMALL)
    best = result.best
    assert best is not None
    assert best.tip_height_m is not None
    rows = caption(final(result))
    assert f"x {1e3 * best.position[0]:.0f}, y −{-1e3 * best.position[1]:.0f}" in rows["Where"]
    assert f"{1e3 * best.tip_height_m:.1f} mm above the plane" in rows["Where"]
    assert f"open {1e3 * best.opening_m:.1f} of 90 mm, and closes to {1e3 * best.width_m:.1f} mm" in rows["How wide"]
    assert f"needs friction {best.required_friction:.2f}, pads have" in rows["Why"]
    away = result.cloud.sensor.toward(middle_of(result)) if result.cloud.sensor else np.zeros(3)
    assert rows["Camera"].startswith(f"{1e3 * np.linalg.norm(away):.0f} mm away")


def test_an_object_without_a_grasp_is_marked_and_the_caption_says_why(pr2: Gripper) -> None:
    figure = final(planned(pr2, WIDE, settings=("approach.around=2",)))
    assert "0: no grasp" in texts(figure.axes[0])
    assert caption(figure)["No grasp"].startswith("narrowest graspable width")
    assert any(name == "the last pairs, refused by: grasping range" for name in legend(figure))


def test_why_another_object_has_no_grasp_is_said(pr2: Gripper) -> None:
    wide = Box((0.55, 0.1, 0.03), (0.15, 0.15, 0.06))
    rows = caption(final(planned(pr2, SMALL, wide, settings=("approach.around=2",))))
    assert "Where" in rows
    assert rows["No grasp"].startswith("object 1: ") or rows["No grasp"].startswith("object 0: ")


def test_an_empty_table_is_drawn_too(pr2: Gripper) -> None:
    figure = final(planned(pr2, settings=("scene.mode=table",)))
    (scene,) = figure.axes
    assert len(scene.collections) > 0
    assert caption(figure)["No grasp"] == "nothing stands on the support plane"


def test_sides_that_were_not_seen_are_marked(pr2: Gripper) -> None:
    can = Tube((0.0, 0.0, 0.03), 0.03, 0.12, (1.0, 0.0, 0.0))
    hidden = legend(final_figure(plan(Camera(tilt_deg=50).sees(TABLE, can), pr2)))
    shown = legend(final(planned(pr2, SMALL)))
    assert "not seen behind: it may go on" in hidden
    assert "not seen behind: it may go on" not in shown


def test_all_that_is_drawn_is_in_the_legend(pr2: Gripper) -> None:
    names = legend(final(planned(pr2, SMALL, OTHER)))
    for word in ("cloud", "next best", "the way the fingers close", "axes of the hand", "axes of the frame", "palm"):
        assert any(word in name for name in names), word


class TestView:
    @pytest.mark.parametrize(
        ("place", "right", "up"),
        [
            ((0.4, -0.7, 0.8), (1, 0, 0), (0, 1, 0)),
            ((0.4, 0.7, 0.8), (-1, 0, 0), (0, -1, 0)),
            ((-0.6, 0.1, 0.8), (0, -1, 0), (1, 0, 0)),
            ((0.45, 0.02, 0.9), (1, 0, 0), (0, 1, 0)),
        ],
        ids=["before", "behind", "left", "overhead"],
    )
    def test_what_is_far_from_the_camera_is_further_up(
        self, pr2: Gripper, place: tuple[float, ...], right: tuple[int, ...], up: tuple[int, ...]
    ) -> None:
        result = planned(pr2, SMALL)
        seen = replace(result, cloud=replace(result.cloud, sensor=Sensor("option", np.array(place))))
        assert view_of(seen, UP).frame.axes == pytest.approx(np.array([right, up, (0, 0, 1)]))

    def test_a_robots_base_counts_more_than_the_camera(self, pr2: Gripper) -> None:
        """The scene lies ahead of the base, along x."""
        assert view_of(planned(pr2, SMALL, robot="ur5"), UP).frame.axes[1] == pytest.approx([1, 0, 0])

    def test_no_picture_has_an_angle_of_its_own(self, pr2: Gripper) -> None:
        """In a camera's frame, x is level, whatever way the table leans and the scene lies."""
        seen = ahead(pr2, squarely=False)
        for lean in ((0.0, -0.6, -0.8), (0.1, -0.5, -0.86), (-0.2, -0.7, -0.68)):
            normal = np.array(lean) / np.linalg.norm(lean)
            view = view_of(seen, normal)
            assert view.of_direction(np.eye(3)[0])[1] == pytest.approx(0.0, abs=1e-12)
            assert np.cross(*view.frame.axes[:2]) == pytest.approx(normal)

    def test_an_image_looked_at_square_on_is_upright(self, pr2: Gripper) -> None:
        seen = ahead(pr2, squarely=True)
        view = view_of(seen, -UP)
        assert view.frame.axes == pytest.approx(np.diag([1, -1, -1]))
        assert view.label(1) == ("y (mm)", -1.0)
        assert view.upright(on_plane=False).axes[2] == pytest.approx([0, -1, 0])
        assert view.upright(on_plane=True).axes[2] == pytest.approx([0, 0, -1])

    def test_axes_that_lean_are_named_by_where_they_go(self) -> None:
        lean = np.radians(40)
        axes = np.array([[1, 0, 0], [0, -np.cos(lean), np.sin(lean)], [0, -np.sin(lean), -np.cos(lean)]])
        view = View(replace(VIEW.frame, axes=axes))
        assert view.label(0) == ("x (mm)", 1.0)
        assert view.label(1) == ("in the plane, toward −y (mm)", 1.0)


NOTHING = np.empty((0, 2))
VIEW = View(Frame(np.zeros(3), np.eye(3)))


class TestMarks:
    @staticmethod
    def axes() -> Axes:
        axes = Page("", 1).panel("")
        show(axes, np.array([[-100.0, -100.0], [100.0, 100.0]]), 0.0)
        return axes

    def test_a_place_outside_is_shown_at_the_edge_on_its_side(self) -> None:
        axes = self.axes()
        start = draw_place(axes, np.array([0.0, -900.0]), "camera", color="k", drawn=NOTHING).thing[0]
        assert start[0] == pytest.approx(0.0, abs=1e-9)
        assert axes.get_ylim()[0] < start[1] < -80

    def test_a_place_inside_is_shown_where_it_is(self) -> None:
        label = draw_place(self.axes(), np.array([30.0, 40.0]), "camera", color="k", drawn=NOTHING)
        assert label.thing[0] == pytest.approx([30.0, 40.0])
        way = label.thing[-1] - label.thing[0]
        assert way / np.linalg.norm(way) == pytest.approx([-0.6, -0.8])

    def test_two_places_on_the_same_side_are_beside_each_other(self) -> None:
        axes = self.axes()
        one = draw_place(axes, np.array([0.0, -900.0]), "base", color="k", drawn=NOTHING).thing
        other = draw_place(axes, np.array([5.0, -900.0]), "camera", color="b", drawn=one).thing
        assert other[0, 1] == pytest.approx(one[0, 1], abs=0.5)
        assert np.abs(other[0, 0] - one[0, 0]) > 10

    @pytest.mark.parametrize(
        ("sensor", "words"),
        [
            (Sensor("option", np.array([0.0, 0.0, 0.5])), "500 mm away, 90° above the drawing's plane (as stated)"),
            (Sensor("assumed", np.array([0.4, 0.0, 0.3])), "500 mm away, 37° above"),
            (Sensor("up", direction=UP), "its place is not known"),
            (Sensor("all_sides", direction=UP), "seen from all sides"),
        ],
    )
    def test_where_the_camera_was_is_said(self, pr2: Gripper, sensor: Sensor, words: str) -> None:
        result = planned(pr2, SMALL)
        seen = replace(result, cloud=replace(result.cloud, sensor=sensor))
        assert sensor_in_words(seen, np.zeros(3), UP).startswith(words)


def test_labels_cover_neither_each_other_nor_what_is_drawn() -> None:
    axes = TestMarks.axes()
    grid = np.stack(np.meshgrid(np.linspace(-30, 30, 40), np.linspace(-30, 30, 40)), axis=-1).reshape(-1, 2)
    things = [grid + offset for offset in ((-35.0, 0.0), (35.0, 0.0), (0.0, 65.0))]
    put(axes, [Label(f"{k}: no grasp", thing) for k, thing in enumerate(things)], np.concatenate(things))
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    busy = axes.transData.transform(np.concatenate(things))
    assert not any(box.count_contains(busy) for box in boxes)
    area = axes.get_window_extent()
    assert all(area.x0 < box.x0 and box.x1 < area.x1 and area.y0 < box.y0 and box.y1 < area.y1 for box in boxes)


def test_a_hand_in_space_holds_the_object_between_its_fingers(pr2: Gripper) -> None:
    grasp = planned(pr2, SMALL).best
    assert grasp is not None
    (minus, plus), palm = hand_solids(grasp, pr2)
    heights = np.concatenate([minus, plus])[:, 2]
    assert heights.min() == pytest.approx(grasp.position[2], abs=1e-3)
    assert palm[:, 2].min() == pytest.approx(heights.max(), abs=2e-3)
    middle = 0.5 * (minus.mean(axis=0) + plus.mean(axis=0))
    assert middle[:2] == pytest.approx(grasp.position[:2], abs=2e-3)
    apart = np.linalg.norm(minus.mean(axis=0) - plus.mean(axis=0))
    assert apart == pytest.approx(grasp.width_m + pr2.finger_thickness_m)


def test_the_stage_in_space_stands_upright_with_the_hand_above(pr2: Gripper) -> None:
    result = planned(pr2, SMALL)
    figure = dict(stage_figures(result))[[name for name, _ in stage_figures(result)][-1]]()
    solid: Any = figure.axes[1]
    assert solid.azim == AZIMUTH_DEG
    (flange,) = (line for line in solid.lines if line.get_label().startswith("hand, closed"))
    (contacts,) = (line for line in solid.lines if line.get_label().startswith("grasping line"))
    assert np.min(flange.get_data_3d()[2]) > np.max(contacts.get_data_3d()[2])


def test_stages_of_pairs_come_in_the_order_of_the_funnel_and_below_their_titles(pr2: Gripper) -> None:
    result = planned(pr2, SMALL)
    stages = dict(stage_figures(result))
    names = [name[3:] for name in stages]
    order = [stage.stage for stage in result.objects[0].funnel if stage.stage in names]
    assert [name for name in names if name in order] == order
    for name in (name for name in stages if name.endswith(("_image", "_surface", "_funnel"))):
        figure = stages[name]()
        figure.draw_without_rendering()
        title = figure._suptitle.get_window_extent()  # type: ignore[attr-defined]
        assert all(axes.get_window_extent().y1 < title.y0 for axes in figure.axes)


class TestArm:
    def arms(self, axes: Any) -> list[FloatArray]:
        lines = [line for line in axes.lines if str(line.get_label()).startswith("arm ")]
        return [1e-3 * np.array(line.get_data_3d()).T for line in lines]

    def test_it_goes_from_the_base_to_the_flange_three_times(self, pr2: Gripper) -> None:
        result = planned(pr2, SMALL, robot="ur5")
        figure, best = arm_figure(result), result.best
        assert figure is not None
        assert best is not None
        arms = self.arms(figure.axes[0])
        assert [len(arm) for arm in arms] == [7, 7, 7]
        assert all(np.allclose(arm[0], 0.0) for arm in arms)
        tool = pr2.palm_offset_m + pr2.finger_length_at_m(best.width_m)
        assert arms[1][-1] == pytest.approx(best.position + np.array([0, 0, tool]), abs=2e-3)
        assert "ur5 in 'base'" in figure.get_suptitle()

    def test_it_is_beside_the_grasp_in_the_final_figure(self, pr2: Gripper) -> None:
        figure = final(planned(pr2, SMALL, robot="ur5"))
        assert len(figure.axes) == 3
        assert [len(arm) for arm in self.arms(figure.axes[2])] == [7, 7, 7]
        assert {"arm at the pre-grasp", "arm at the grasp", "arm after the lift"} <= legend(figure)
        assert "base of ur5" in texts(figure.axes[0])
        assert "manipulability" in caption(figure)["Robot"]

    def test_grasps_out_of_reach_are_drawn_as_such(self, pr2: Gripper) -> None:
        result = out_of_reach(pr2)
        figure = final(result)
        assert result.best is None
        assert arm_figure(result) is None
        assert "best grasp that ur5 does not reach" in legend(figure)
        assert "hand, where the arm cannot bring it" in legend(figure)
        assert fingers(figure.axes[0]) == []
        assert "0: out of reach" in texts(figure.axes[0])
        grasp = result.objects[0].refused[0]
        view = view_of(result, UP)
        (cross,) = (
            line
            for line in figure.axes[1].lines
            if line.get_marker() == "x" and len(np.asarray(line.get_xydata())) == 1
        )
        assert np.asarray(cross.get_xydata())[0] == pytest.approx(DrawnHand.of(grasp, view).origin, abs=0.5)

    def test_there_is_none_without_a_robot(self, pr2: Gripper) -> None:
        assert arm_figure(planned(pr2, SMALL)) is None
        assert len(final(planned(pr2, SMALL)).axes) == 2
