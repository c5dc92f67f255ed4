"""Which grasp comes first: what most probably holds and, of equals, the paper's."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from flatgrasp_cli import load_settings, plan
from flatgrasp_cli.model import GraspCandidates
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.profiles.uncertainty import HandUncertainty, Uncertainty
from flatgrasp_cli.ranking import TIE, best_first, by_probability
from flatgrasp_cli.ranking.success import Situation
from tests.by_hand import MM, across
from tests.conftest import EACH, TABLE, Box, Camera, cloud_of, rectangle, sampled
from tests.ranking.situations import situation, unsure

SCENE = Camera().sees(TABLE, Box((0.0, 0.0, 0.02), (0.12, 0.04, 0.04)))


def order(probabilities: list[float], distances_mm: list[float]) -> list[int]:
    """The order of grasps that so probably hold, and are so far from the centre of gravity."""
    return [int(k) for k in by_probability(np.array(probabilities), np.multiply(distances_mm, MM))]


def test_the_most_probable_one_is_first() -> None:
    assert order([0.9, 0.99, 0.95], [1, 20, 5]) == [1, 2, 0]


def test_of_those_within_a_hundredth_the_nearest_to_the_centre_of_gravity_is() -> None:
    assert TIE == 0.01
    assert order([0.985, 0.991, 0.99, 0.9], [3, 9, 1, 0]) == [2, 0, 1, 3]


def test_a_tie_reaches_no_further_than_a_hundredth_from_its_first() -> None:
    """Each is equal to the one before it, but not to the one before that."""
    assert order([0.99, 0.982, 0.974], [9, 5, 1]) == [1, 0, 2]


def test_no_grasp_has_no_order() -> None:
    assert order([], []) == []


def along_a_bar(length_mm: float) -> GraspCandidates:
    """A hundred grasps, evenly spread about the middle of a bar."""
    places = np.column_stack([np.linspace(-0.5, 0.5, 100) * length_mm * MM, np.zeros(100)])
    _, grasps = across(
        [0.04] * 100, opening=np.full(100, 0.06), tip=np.zeros(100), grip=np.full(100, 0.02), margin=np.full(100, 0.01)
    )
    return grasps.having(
        middle=places,
        lean=np.zeros((100, 1)),
        feet=np.zeros((100, 2, 2)),
        hidden=np.zeros((100, 2)),
        unseen=np.zeros(100),
        gravity_distance=np.abs(places[:, 0]),
    )


def test_what_could_not_win_is_only_estimated() -> None:
    """Of a hundred grasps along a bar so many are tried; the others follow them."""
    ranked = best_first(along_a_bar(60), situation(rectangle(100, 40), unsure("position_m=0.005")))
    tried = np.isfinite(ranked.probability)
    assert 10 < np.count_nonzero(tried) <= 16
    assert tried.tolist() == sorted(tried.tolist(), reverse=True)
    assert sorted(ranked.i.tolist()) == list(range(100))
    assert ranked.gravity_distance[0] < 2 * MM


def test_48_are_tried_with_a_quarter_of_the_samples_and_16_with_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a hundred lie farther apart than the hand misses by."""
    trials = list[tuple[int, int]]()
    tried = Situation.tried

    def counted(self: Situation, grasps: GraspCandidates) -> GraspCandidates:
        trials.append((len(grasps), len(self.errors)))
        return tried(self, grasps)

    monkeypatch.setattr(Situation, "tried", counted)
    best_first(along_a_bar(800), situation(rectangle(840, 40), unsure("position_m=0.005", "samples=128")))
    assert trials == [(48, 32), (16, 96)]


def test_the_papers_choice_is_the_smallest_gravity_distance(pr2: Gripper) -> None:
    settings = load_settings("default", ("ranking.prefer=gravity_distance", *EACH))
    grasps = plan(SCENE, pr2, settings, top=100).objects[0].grasps
    distances = [grasp.gravity_distance_m for grasp in grasps]
    assert distances == sorted(distances)
    assert all(grasp.success is not None for grasp in grasps)


def test_listed_grasps_are_in_the_order_of_their_probabilities(pr2: Gripper) -> None:
    chances = [grasp.success.probability for grasp in plan(SCENE, pr2, top=30).objects[0].grasps if grasp.success]
    assert len(chances) > 3
    assert all(after <= before + TIE for before, after in pairwise(chances))


def test_the_same_cloud_has_the_same_probabilities(pr2: Gripper) -> None:
    first, again = (plan(SCENE, pr2).objects[0].grasps for _ in range(2))
    assert [grasp.success for grasp in first] == [grasp.success for grasp in again]


class TestWhoSaysHowMuchIsOff:
    def test_the_usual_figures_are_those_of_the_settings_comments(self, pr2: Gripper) -> None:
        figures = load_settings().resolve(pr2).uncertainty
        assert figures.figures == Uncertainty()
        assert (figures.position_m, figures.yaw_deg, figures.samples) == (0.005, 5.0, 128)

    def test_a_grippers_profile_knows_better_and_the_settings_best(self, pr2: Gripper) -> None:
        sure = pr2.model_copy(update={"uncertainty": HandUncertainty(position_m=0.001, friction_share=0.1)})
        told = load_settings().resolve(sure).uncertainty
        assert (told.position_m, told.friction_share, told.height_m) == (0.001, 0.1, 0.002)
        asked = load_settings("default", ("uncertainty.position_m=0.003",)).resolve(sure).uncertainty
        assert (asked.position_m, asked.friction_share) == (0.003, 0.1)

    def test_a_hand_that_misses_less_holds_more(self, pr2: Gripper) -> None:
        wide = cloud_of(sampled(rectangle(120, 76)))
        chances = []
        for spread in (0.002, 0.006, 0.012):
            found = plan(wide, pr2, load_settings("default", (f"uncertainty.position_m={spread}",))).best
            assert found is not None
            assert found.success is not None
            chances.append(found.success.probability)
        assert chances == sorted(chances, reverse=True)
        assert chances[0] > 0.99
        assert chances[2] < 0.95
