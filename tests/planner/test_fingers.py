"""§III.A.3 on loops whose step points, chords and directions are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.polygon import ray_parity_inside
from flatgrasp_cli.model import FingerCandidates, Silhouette
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.profiles import Gripper, PlannerSettings, load_settings
from flatgrasp_cli.profiles.settings import FingerSettings

SQUARE = 0.1 * np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
HOLE = np.array([[0.02, 0.02], [0.02, 0.08], [0.08, 0.08], [0.08, 0.02]])
SLOT = 0.1 * np.array([[0.0, 0], [1, 0], [1, 1], [0.55, 1], [0.55, 0.3], [0.45, 0.3], [0.45, 1], [0, 1]])


def outline(*loops: FloatArray) -> Silhouette:
    frame = Frame(np.zeros(3), np.eye(3))
    points = np.concatenate(loops)
    return Silhouette(frame, loops, points, np.zeros(len(points)), 0.003, 1.0)


def finger_settings(**changes: object) -> FingerSettings:
    return load_settings().fingers.model_copy(update={"step_m": 0.01, "arc_ratio_max": None, **changes})


@pytest.mark.parametrize("step", ["chord", "arc_length"])
def test_a_square_of_40_cm_has_40_step_points_a_centimetre_apart(step: str) -> None:
    steps = step_points(outline(SQUARE), finger_settings(step=step))
    assert len(steps[0].points) == 40
    assert np.linalg.norm(np.diff(steps[0].points, axis=0), axis=1) == pytest.approx(np.full(39, 0.01))


@pytest.mark.parametrize(
    ("side_m", "step_mm"), [(0.05, 2), (0.2, 4), (0.5, 6), (2.0, 8000 / 600)], ids=["least", "share", "most", "many"]
)
def test_steps_are_a_200th_of_the_perimeter_2_to_6_mm_and_no_more_than_600(side_m: float, step_mm: float) -> None:
    (steps,) = step_points(outline(10 * side_m * SQUARE), finger_settings(step_m=None))
    assert steps.step_m == pytest.approx(step_mm * 1e-3)
    assert len(steps.points) <= 600


def test_who_sets_the_step_gets_no_more_than_3000() -> None:
    (steps,) = step_points(outline(20 * SQUARE), finger_settings(step_m=0.001))
    assert steps.step_m == pytest.approx(8 / 3000)


def test_inner_loops_have_step_points_of_their_own() -> None:
    steps = step_points(outline(SQUARE, HOLE), finger_settings())
    assert [step.loop for step in steps] == [0, 1]
    assert len(steps[1].points) == 24


def test_candidates_are_chords_as_wide_as_the_finger_all_around(pr2: Gripper) -> None:
    silhouette = outline(SQUARE)
    fingers = finger_candidates(silhouette, step_points(silhouette, finger_settings()), pr2, finger_settings())
    assert len(fingers) == 40
    assert np.linalg.norm(fingers.end - fingers.start, axis=1) == pytest.approx(np.full(40, pr2.finger_width_m))
    assert fingers.contact == pytest.approx(0.5 * (fingers.start + fingers.end))


def test_the_papers_boundary_ends_at_its_last_point(pr2: Gripper) -> None:
    """Ω does not wrap: the last finger width of the loop starts no candidate, the cyclic walk loses none."""
    silhouette, literal = outline(SQUARE), finger_settings(walk="open")
    fingers = finger_candidates(silhouette, step_points(silhouette, literal), pr2, literal)
    assert len(fingers) == 40 - 2


def test_a_thumb_and_a_pair_get_candidates_of_their_own_width(lacquey: Gripper) -> None:
    silhouette = outline(SQUARE)
    fingers = finger_candidates(silhouette, step_points(silhouette, finger_settings()), lacquey, finger_settings())
    assert fingers.width[fingers.jaw == 0] == pytest.approx(np.full(40, 0.010))
    assert fingers.width[fingers.jaw == 1] == pytest.approx(np.full(40, 0.0502))


def chords(silhouette: Silhouette, gripper: Gripper, **changes: object) -> FingerCandidates:
    """Candidates 1 mm apart by the default settings, but for these changes."""
    settings = load_settings().fingers.model_copy(update={"step_m": 0.001, **changes})
    return finger_candidates(silhouette, step_points(silhouette, settings), gripper, settings)


@pytest.mark.parametrize("spike_mm", [2, 0])
def test_the_boundary_under_a_pad_is_known_to_1_or_2_mm(spike_mm: float, pr2: Gripper) -> None:
    """A thorn that is 2 mm high and 3 mm wide at its foot does not escape a pad of 22 mm."""
    spike = 1e-3 * np.array([[48.5, 0], [50, -spike_mm], [51.5, 0]])
    found = chords(outline(np.concatenate([SQUARE[:1], spike, SQUARE[1:]])), pr2)
    over = (found.start[:, 1] == 0) & (found.end[:, 1] == 0) & (found.start[:, 0] < 0.045) & (found.end[:, 0] > 0.055)
    assert over.sum() > 5
    assert (found.arcs[over, :, 1].min(axis=1) < -0.3e-3 * spike_mm).all() == (spike_mm > 0)


def test_a_chord_is_no_longer_than_60_percent_of_a_small_object(pr2: Gripper) -> None:
    assert chords(outline(0.2 * SQUARE), pr2).width == pytest.approx(0.6 * 0.02)
    assert chords(outline(0.5 * SQUARE), pr2).width == pytest.approx(pr2.finger_width_m)


def test_the_boundary_under_a_chord_is_no_more_than_a_quarter_longer(pr2: Gripper) -> None:
    """Around a right corner it is up to 41 % longer."""
    ratio = chords(outline(SQUARE), pr2).arc_ratio
    assert 1.15 < ratio.max() <= 1.25


@pytest.mark.parametrize(
    ("thick_mm", "dent_mm", "kept"), [(4, 0, True), (40, 1, True), (40, 4, False)], ids=["thin", "dent", "slot"]
)
def test_the_object_is_looked_for_2_mm_inside_a_chord(
    thick_mm: float, dent_mm: float, kept: bool, pr2: Gripper
) -> None:
    """So a plate of 4 mm has an inside, a dent of a millimetre is none, and the mouth of a slot has none."""
    dent = [[40, 0], [40, dent_mm], [60, dent_mm], [60, 0]] if dent_mm else []
    loop = 1e-3 * np.array([[0, 0], *dent, [100, 0], [100, thick_mm], [0, thick_mm]], dtype=np.float64)
    settings = load_settings().fingers
    found = chords(outline(loop), pr2, arc_ratio_max=None)
    left, _ = inward_directions(outline(loop), found, settings, seed=1)
    over = (np.abs(left.contact[:, 0] - 0.05) < 0.5e-3) & (left.contact[:, 1] < 1e-3)
    assert over.any() == kept


@pytest.mark.parametrize("method", ["signed_area", "random_rays"])
def test_directions_point_into_the_object(method: str, pr2: Gripper) -> None:
    silhouette, settings = outline(SQUARE), finger_settings(direction=method, delta_m=0.001)
    places = finger_candidates(silhouette, step_points(silhouette, settings), pr2, settings)
    fingers, doubted = inward_directions(silhouette, places, settings, seed=1)
    assert doubted == 0
    toward_middle = (np.array([0.05, 0.05]) - fingers.contact) * fingers.direction
    assert (toward_middle.sum(axis=1) > 0).all()


def test_directions_at_a_hole_point_into_the_material(pr2: Gripper) -> None:
    silhouette, settings = outline(SQUARE, HOLE), finger_settings()
    places = finger_candidates(silhouette, step_points(silhouette, settings), pr2, settings)
    fingers, _ = inward_directions(silhouette, places, settings, seed=1)
    inner = fingers.loop == 1
    away = (fingers.contact[inner] - np.array([0.05, 0.05])) * fingers.direction[inner]
    assert inner.any()
    assert (away.sum(axis=1) > 0).all()


def test_the_rays_find_the_inside_of_a_loop_walked_backwards(pr2: Gripper) -> None:
    """The paper's search needs no orientation: on a clockwise loop it turns all directions over."""
    backwards, settings = outline(SQUARE[::-1]), finger_settings(direction="random_rays", delta_m=0.001)
    places = finger_candidates(backwards, step_points(backwards, settings), pr2, settings)
    fingers, _ = inward_directions(backwards, places, settings, seed=1)
    toward_middle = (np.array([0.05, 0.05]) - fingers.contact) * fingers.direction
    assert (toward_middle.sum(axis=1) > 0).all()


def test_the_vote_of_the_rays_outlives_every_fifth_being_wrong() -> None:
    """As rays that graze a vertex may be; here wrong ones end inside. They outvote the others in 4 of 10,000 cases.

    With a third of the rays they would in 300, and three times as many take their time for nothing.
    """
    rng, votes, count = np.random.default_rng(0), 5000, load_settings().fingers.rays
    assert count % 2 == 1  # no tie
    angles = rng.uniform(0, 2 * np.pi, (votes, count))
    reach = np.where(rng.random((votes, count)) < 0.2, 0.01, 1.0)
    far = 0.05 + reach[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    inside = [ray_parity_inside(SQUARE, np.array([0.05, 0.05]), ends) for ends in far]
    assert 0.999 < np.mean(inside) < 1


def test_a_chord_over_the_mouth_of_a_slot_is_doubted_and_dropped(pr2: Gripper) -> None:
    silhouette, settings = outline(SLOT), finger_settings(step_m=0.002)
    places = finger_candidates(silhouette, step_points(silhouette, settings), pr2, settings)
    fingers, doubted = inward_directions(silhouette, places, settings, seed=1)
    assert doubted == len(places) - len(fingers) > 0
    over_mouth = (np.abs(fingers.contact[:, 0] - 0.05) < 0.004) & (fingers.contact[:, 1] > 0.09)
    assert not over_mouth.any()


@pytest.mark.parametrize(
    ("variance", "expected"), [("mean", 0.0044), ("max", 0.0088), ("rms", 0.00507)], ids=["mean", "max", "rms"]
)
def test_variance_over_a_corner(variance: str, expected: float, pr2: Gripper) -> None:
    """A chord c over a right corner cut at 45°: the boundary is a triangle of height c/2 over it."""
    settings = finger_settings(variance=variance)
    width = 2 * 0.0088
    gripper = pr2.model_copy(update={"finger_width_m": width})
    silhouette = outline(SQUARE)
    start = 0.1 - width / np.sqrt(2)
    steps = step_points(silhouette, settings)[0]
    one = replace(steps, positions=np.array([start]), points=np.array([[start, 0.0]]))
    fingers = finger_candidates(silhouette, [one], gripper, settings)
    assert fingers.variance[0] == pytest.approx(expected, rel=0.002)
    assert fingers.arc_ratio[0] == pytest.approx(np.sqrt(2), rel=1e-6)


def test_the_papers_variance_is_the_plain_sum_over_hull_points(pr2: Gripper) -> None:
    """One hull point, the corner, lies under the chord: the sum is its distance."""
    literal: PlannerSettings = load_settings("paper")
    settings = literal.fingers.model_copy(update={"step_m": 0.01})
    silhouette = outline(SQUARE)
    fingers = finger_candidates(silhouette, step_points(silhouette, settings), pr2, settings)
    over_corner = np.flatnonzero(np.isclose(fingers.start[:, 0], 0.09) & np.isclose(fingers.start[:, 1], 0.0))[0]
    chord = fingers.end[over_corner] - fingers.start[over_corner]
    to_corner = np.array([0.1, 0.0]) - fingers.start[over_corner]
    height = abs(chord[0] * to_corner[1] - chord[1] * to_corner[0]) / np.linalg.norm(chord)
    assert fingers.variance[over_corner] == pytest.approx(height)
    assert fingers.variance[0] == 0.0
