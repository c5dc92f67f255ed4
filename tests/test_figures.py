"""Figures of scenes and of the arm."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from flatgrasp_cli.planning import Plan, plan
from flatgrasp_cli.profiles import Gripper, load_robot, load_settings
from flatgrasp_cli.results.figures import arm_figure, final_figure
from tests.conftest import TABLE, Box, Camera, Tube

CAMERA = Camera(tilt_deg=30, target=(0.4, 0.0, 0.0), distance=0.9)
BESIDE = Box((0.4, 0.0, -0.01), (0.7, 0.6, 0.02))
SMALL, OTHER = Box((0.35, -0.1, 0.02), (0.1, 0.04, 0.04)), Box((0.5, 0.08, 0.02), (0.1, 0.05, 0.04), 40)
WIDE = Box((0.4, 0.0, 0.03), (0.15, 0.15, 0.06))


def planned(gripper: Gripper, *solids: Box, robot: str | None = None, settings: tuple[str, ...] = ()) -> Plan:
    arm = load_robot(robot) if robot else None
    return plan(CAMERA.sees(BESIDE, *solids), gripper, load_settings("default", settings), top=3, robot=arm)


def texts(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def caption(figure: Figure) -> str:
    return figure.get_supxlabel()


def test_every_object_of_a_scene_has_its_number_and_its_hand(pr2: Gripper) -> None:
    result = planned(pr2, SMALL, OTHER)
    figure = final_figure(result)
    scene, close = figure.axes
    assert {item.object.id for item in result.objects} == {0, 1}
    assert set(texts(scene)) == {"0", "1"}
    assert len([patch for patch in scene.patches if isinstance(patch, Polygon)]) == 2 * 3  # two fingers and a palm each
    assert "2 objects on a support plane" in scene.get_title(loc="left")
    assert f"object {result.objects[0].object.id}" in close.get_title(loc="left")


def test_the_hand_is_drawn_where_the_grasp_is(pr2: Gripper) -> None:
    result = planned(pr2, SMALL)
    (scene, _), grasp = final_figure(result).axes, result.objects[0].grasps[0]
    *fingers, _ = (np.asarray(patch.get_xy())[:4] for patch in scene.patches if isinstance(patch, Polygon))
    left, right = (finger.mean(axis=0) for finger in fingers)
    assert np.linalg.norm(left - right) == pytest.approx(1e3 * (grasp.opening_m + pr2.finger_thickness_m))
    # the drawing's axes are the world's: x to the right, and away from the sensor, +y, upward
    points = result.cloud.points
    assert 0.5 * (left + right) == pytest.approx(1e3 * (grasp.position - points.mean(axis=0))[:2], abs=3.0)


def test_the_caption_holds_the_numbers(pr2: Gripper) -> None:
    result = planned(pr2, SMALL)
    best = result.best
    assert best is not None
    assert best.tip_height_m is not None
    text = caption(final_figure(result))
    assert f"width {1e3 * best.width_m:.1f} mm, open {1e3 * best.opening_m:.1f} of 90 mm" in text
    assert f"fingertips {1e3 * best.tip_height_m:.1f} mm above the plane" in text


def test_an_object_without_a_grasp_is_marked_and_the_caption_says_why(pr2: Gripper) -> None:
    figure = final_figure(planned(pr2, WIDE))
    assert texts(figure.axes[0]) == ["0 no grasp"]
    assert caption(figure).startswith("no grasp: narrowest graspable width")


def test_an_empty_table_is_drawn_too(pr2: Gripper) -> None:
    figure = final_figure(planned(pr2, settings=("scene.mode=table",)))
    (scene,) = figure.axes
    assert texts(scene) == []
    assert len(scene.lines) > 0
    assert caption(figure) == "no grasp: nothing stands on the support plane"


def test_sides_that_were_not_seen_are_marked(pr2: Gripper) -> None:
    can = Tube((0.0, 0.0, 0.03), 0.03, 0.12, (1.0, 0.0, 0.0))
    hidden = final_figure(plan(Camera(tilt_deg=50).sees(TABLE, can), pr2)).axes[1]
    shown = final_figure(planned(pr2, SMALL)).axes[1]
    assert "not seen behind" in hidden.get_legend_handles_labels()[1]
    assert "not seen behind" not in shown.get_legend_handles_labels()[1]


class TestArm:
    def test_it_goes_from_the_base_to_the_flange_three_times(self, pr2: Gripper) -> None:
        result = planned(pr2, SMALL, robot="ur5")
        figure, best = arm_figure(result), result.best
        assert figure is not None
        assert best is not None
        (axes,) = figure.axes
        names = {"pre-grasp", "grasp", "lift"}
        lines: list[Any] = [line for line in axes.lines if line.get_label() in names]
        arms = [np.array(line.get_data_3d()).T for line in lines]
        assert [len(arm) for arm in arms] == [7, 7, 7]
        assert all(np.allclose(arm[0], 0.0) for arm in arms)
        tool = pr2.palm_offset_m + pr2.finger_length_at_m(best.width_m)
        assert arms[1][-1] == pytest.approx(best.position + np.array([0, 0, tool]), abs=2e-3)
        assert "ur5 in base" in axes.get_title(loc="left")

    def test_there_is_none_without_a_robot_or_a_grasp_that_it_reaches(self, pr2: Gripper) -> None:
        assert arm_figure(planned(pr2, SMALL)) is None
        far = Camera(tilt_deg=30, target=(3.0, 0.0, 0.0))
        cloud = far.sees(Box((3.0, 0.0, -0.01), (0.7, 0.6, 0.02)), Box((3.0, 0.0, 0.02), (0.1, 0.04, 0.04)))
        assert arm_figure(plan(cloud, pr2, robot=load_robot("ur5"))) is None
