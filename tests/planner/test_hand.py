"""§III.B.3 to B.5: range, flatness and room, against shapely and against the paper's inequality written out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from flatgrasp_cli.funnel import Funnel, NothingLeft
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import Frame
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.kernels import pairs as kernels
from flatgrasp_cli.model import FingerCandidates, GraspCandidates, Silhouette
from flatgrasp_cli.planner import balance
from flatgrasp_cli.planner.contacts import pad_contacts
from flatgrasp_cli.planner.fingers import finger_candidates, inward_directions, step_points
from flatgrasp_cli.planner.grasping_range import closing_axes, extents
from flatgrasp_cli.planner.operability import eq2_fit, operable, swept_fit
from flatgrasp_cli.planner.variance import flat
from flatgrasp_cli.profiles import Gripper, load_gripper, load_settings
from flatgrasp_cli.surroundings.alone import openings
from tests.by_hand import across

TOLERANCE_M = 0.002
GRIPPERS = ("pr2", "lacquey")


def bumpy(seed: int) -> Silhouette:
    """A random non-convex outline about 8 cm across, with a hole."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    radius = 0.04 * (1 + 0.35 * np.cos(rng.integers(2, 6) * angles + rng.uniform(0, 6)))
    outer, inner = circle * radius[:, None], 0.012 * circle[::-1] + rng.uniform(-0.008, 0.008, 2)
    return Silhouette(Frame(np.zeros(3), np.eye(3)), (outer, inner), outer, np.zeros(40), 0.003, 1.0)


def pairs_on(outline: Silhouette, gripper: Gripper) -> tuple[FingerCandidates, GraspCandidates]:
    """All force-balanced pairs, closing along their bisector."""
    planner = load_settings().resolve(gripper)
    chords = finger_candidates(outline, step_points(outline, planner.fingers), gripper, planner.fingers)
    fingers, _ = inward_directions(outline, chords, planner.fingers, 0)
    counts = np.zeros(2, dtype=np.intp)
    found = kernels.balanced(fingers.contact, fingers.direction, fingers.jaw, True, 25.0, counts)
    pairs = balance.weigh(fingers, found)
    return fingers, closing_axes(fingers, pairs, "bisector")


def finger_box(
    gripper: Gripper, side: int, span: tuple[float, float], place: tuple[FloatArray, FloatArray]
) -> shapely.Polygon:
    """A jaw's fingers between two distances from the hand's middle, in the plane."""
    origin, axis = place
    across, out = left_normal(axis[None])[0], (-1, 1)[side] * axis
    boxes = []
    for offset in gripper.jaws[side]:
        low, high = offset - gripper.finger_width_m / 2, offset + gripper.finger_width_m / 2
        corners = [(low, span[0]), (high, span[0]), (high, span[1]), (low, span[1])]
        boxes.append(shapely.Polygon([origin + x * across + y * out for x, y in corners]))
    return shapely.union_all(boxes)


@settings(max_examples=15)
@given(st.integers(0, 999), st.sampled_from(GRIPPERS))
def test_pads_touch_the_boundary_that_comes_nearest_to_them(seed: int, name: str) -> None:
    """Each contact lies on its pad, in front of what a search along the boundary finds within the tolerance."""
    gripper = load_gripper(name)
    outline = bumpy(seed)
    fingers, pairs = pairs_on(outline, gripper)
    pads, _ = swept_fit(outline, fingers, pairs, gripper, TOLERANCE_M)
    pairs = pairs.having(pads=pads.T)
    touched = pad_contacts(fingers, pairs, gripper, TOLERANCE_M)
    middle, across = pairs.center, left_normal(pairs.axis)
    for k in range(0, len(pairs), max(1, len(pairs) // 10)):
        for side, candidate, out in ((0, pairs.i[k], -pairs.axis[k]), (1, pairs.j[k], pairs.axis[k])):
            assert (touched[k, side] - middle[k]) @ out == pytest.approx(0.5 * pairs.width[k], abs=1e-9)
            arc = fingers.arcs[candidate] - middle[k]
            aside = arc @ across[k]
            under = np.abs(aside[:, None] - gripper.jaws[side]).min(axis=1) <= 0.5001 * gripper.finger_width_m
            if under.any():
                near = under & (arc @ out >= (arc @ out)[under].max() - TOLERANCE_M)
                assert (touched[k, side] - middle[k]) @ across[k] == pytest.approx(aside[near].mean(), abs=1e-9)


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1), st.sampled_from(GRIPPERS))
def test_the_room_behind_each_pad_is_free_and_no_larger(seed: int, name: str) -> None:
    """Shapely finds nothing of the object in the room that swept_fit promises, and something just beyond it."""
    outline, gripper = bumpy(seed), load_gripper(name)
    fingers, pairs = pairs_on(outline, gripper)
    pads, rooms = swept_fit(outline, fingers, pairs, gripper, TOLERANCE_M)
    solid = shapely.Polygon(outline.loops[0], [outline.loops[1]])
    for k in np.random.default_rng(seed).permutation(len(pairs))[:12]:
        middle = 0.5 * (fingers.contact[pairs.i[k]] + fingers.contact[pairs.j[k]])
        for side in (0, 1):
            pad, room = pads[side, k], min(rooms[side, k], 0.5)
            if room < 1e-6:
                continue
            free = finger_box(gripper, side, (pad + 1e-6, pad + room - 1e-6), (middle, pairs.axis[k]))
            assert solid.intersection(free).area < 1e-10
            if np.isfinite(rooms[side, k]):
                beyond = finger_box(gripper, side, (pad + room, pad + room + 1e-4), (middle, pairs.axis[k]))
                assert solid.intersects(beyond)


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1), st.sampled_from(GRIPPERS))
def test_eq2_is_the_papers_inequality(seed: int, name: str) -> None:
    outline, gripper = bumpy(seed), load_gripper(name)
    fingers, pairs = pairs_on(outline, gripper)
    _, room = eq2_fit(outline, pairs, gripper, 0.0)
    points = np.concatenate(outline.loops)
    for k in np.random.default_rng(seed).permutation(len(pairs))[:12]:
        middle = 0.5 * (fingers.contact[pairs.i[k]] + fingers.contact[pairs.j[k]])
        x = (points - middle) @ left_normal(pairs.axis[k : k + 1])[0]
        y = (points - middle) @ pairs.axis[k]
        d, w_h, w_o = pairs.distance[k], gripper.hand_width_m, gripper.max_opening_m
        collides = (np.abs(x) <= 0.5 * w_h) & (((-w_o <= y) & (y <= -0.5 * d)) | ((0.5 * d <= y) & (y <= w_o)))
        assert bool(collides.any()) == (room[:, k].min() == 0.0)


def test_opening_leaves_the_wanted_space_but_not_beyond_room_or_hand(pr2: Gripper) -> None:
    asked = load_settings().hand
    _, pairs = pairs_on(bumpy(0), pr2)
    pads = np.array([[0.020, 0.020], [0.020, 0.020], [0.044, 0.044]])
    room = np.array([[np.inf, np.inf], [0.014, np.inf], [np.inf, np.inf]])
    assert openings(pairs.select(np.arange(3)).having(pads=pads, room=room), pr2, asked) == pytest.approx(
        [0.040 + 2 * asked.preshape_m, 0.040 + 2 * (0.014 - 0.009), pr2.max_opening_m]
    )


def test_width_is_the_extent_under_the_pads_not_the_distance_of_the_midpoints(pr2: Gripper) -> None:
    """On a disc of 30 mm radius, chords as wide as the finger lie √(30² − 11.2²) mm from the centre."""
    angles = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    circle = 0.03 * np.column_stack([np.cos(angles), np.sin(angles)])
    outline = Silhouette(Frame(np.zeros(3), np.eye(3)), (circle,), circle, np.zeros(720), 0.003, 1.0)
    fingers, pairs = pairs_on(outline, pr2)
    straight = pairs.required_friction < 0.01
    assert straight.any()
    assert pairs.distance[straight] == pytest.approx(2 * np.sqrt(0.03**2 - 0.0112**2), abs=1e-4)
    assert extents(fingers, pairs).sum(axis=0)[straight] == pytest.approx(0.06, abs=2e-4)


def test_a_wide_pair_of_fingers_needs_its_own_room(lacquey: Gripper) -> None:
    """Beside a wall that only one finger of the pair would hit, the pair has no room although the thumb has."""
    loop = 1e-3 * np.array([[0.0, 0], [100, 0], [100, 40], [62, 40], [62, 60], [55, 60], [55, 40], [0, 40]])
    outline = Silhouette(Frame(np.zeros(3), np.eye(3)), (loop,), loop, np.zeros(len(loop)), 0.003, 1.0)
    fingers, pairs = pairs_on(outline, lacquey)
    _, room = swept_fit(outline, fingers, pairs, lacquey, TOLERANCE_M)
    middle_x = 0.5 * (fingers.contact[pairs.i] + fingers.contact[pairs.j])[:, 0]
    upward = fingers.direction[pairs.j][:, 1] < -0.999
    beside_wall, clear = upward & (np.abs(middle_x - 0.034) < 0.003), upward & (np.abs(middle_x - 0.027) < 0.002)
    assert beside_wall.any()
    assert clear.any()
    assert room[1, beside_wall].max() == 0
    assert room[0, beside_wall].max() == np.inf
    assert room[1, clear].max() == np.inf


def bars(*spans_mm: tuple[float, float]) -> Silhouette:
    """Bars 200 mm long along x, each from one y to another."""
    loops = [
        1e-3 * np.array([[-100, low], [100, low], [100, high], [-100, high]], dtype=np.float64)
        for low, high in spans_mm
    ]
    return Silhouette(Frame(np.zeros(3), np.eye(3)), tuple(loops), loops[0], np.zeros(4), 0.003, 1.0)


def fit(outline: Silhouette, reach_mm: float, pr2: Gripper) -> tuple[float, float]:
    """Where the +y pad rests and the room behind it, millimetres, for candidates that reach ±`reach_mm` along y."""
    fingers, pairs = across([2e-3 * reach_mm])
    pads, room = swept_fit(outline, fingers, pairs, pr2, load_settings().hand.contact_tolerance_m)
    return float(pads[1, 0]) * 1e3, float(room[1, 0]) * 1e3


@pytest.mark.parametrize(("beside_mm", "pad_mm", "room_mm"), [((20.8, 21.6), 21.6, np.inf), ((23, 24), 20, 3)])
def test_what_stands_out_by_2_mm_is_what_the_pad_rests_on(
    beside_mm: tuple[float, float], pad_mm: float, room_mm: float, pr2: Gripper
) -> None:
    """What stands farther out is in the finger's way."""
    assert fit(bars((-20, 20), beside_mm), 20, pr2) == pytest.approx((pad_mm, room_mm))


@pytest.mark.parametrize(("sunk_mm", "room_mm"), [(10.5, np.inf), (12, 0)])
def test_a_pad_that_rests_half_its_width_below_its_candidate_rests_on_something_else(
    sunk_mm: float, room_mm: float, pr2: Gripper
) -> None:
    assert fit(bars((-20 - sunk_mm, 20)), 20 + sunk_mm, pr2)[1] == room_mm


@pytest.mark.parametrize(("strays", "kept"), [(0.10, True), (0.15, False)])
def test_a_boundary_that_strays_by_an_eighth_of_the_pads_width_is_not_flat(strays: float, kept: bool) -> None:
    fingers, pairs = across([0.04])
    fingers = replace(fingers, variance=strays * fingers.width)
    funnel, hand = Funnel(), load_settings().hand
    if kept:
        assert len(flat(fingers, pairs, hand, funnel)) == 1
    else:
        with pytest.raises(NothingLeft, match=r"allowed 0\.120"):
            flat(fingers, pairs, hand, funnel)


class TestWhatGoesOnOutOfSight:
    """A bar 20 mm wide and 100 mm long, whose upper side goes on out of sight by `hidden_mm` at most."""

    BAR = Silhouette(
        Frame(np.zeros(3), np.eye(3)),
        (0.001 * np.array([[-50.0, -10.0], [50.0, -10.0], [50.0, 10.0], [-50.0, 10.0]]),),
        np.zeros((4, 2)),
        np.zeros(4),
        0.003,
        1.0,
    )

    def found(self, hidden_mm: float, **changes: float) -> GraspCandidates:
        gripper = load_gripper("pr2").model_copy(update=changes)
        fingers, pair = across([0.02])
        fingers = replace(fingers, hidden=np.array([0.0, 0.001 * hidden_mm]))
        return operable(self.BAR, fingers, pair, gripper, load_settings().resolve(gripper).hand, Funnel())

    @pytest.mark.parametrize("hidden_mm", [0.0, 8.0, 30.0])
    def test_the_pads_stand_where_it_ends_in_the_mean(self, hidden_mm: float) -> None:
        found = self.found(hidden_mm)
        assert found.pads[0] == pytest.approx([0.01, 0.01 + 0.0005 * hidden_mm], abs=1e-6)
        assert found.beyond[0] == pytest.approx(0.0005 * hidden_mm)

    def test_or_as_far_as_the_hand_still_opens(self) -> None:
        found = self.found(30.0, max_opening_m=0.032)
        assert found.width[0] == pytest.approx(0.032 - 2 * 0.002, abs=1e-6)
        assert found.hidden[0] == pytest.approx([0.0, 0.03])
