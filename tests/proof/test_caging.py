"""Two-finger caging: levels worked out by hand, invariances, and a scalar twin."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.proof.caging import contact_space, immobilising_grasps
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.contact_space import Caging, squeezing
from flatgrasp_cli.proof.caging.limits import Limits, limits
from flatgrasp_cli.proof.caging.merge_tree import ESCAPE, merge_levels
from flatgrasp_cli.proof.caging.stretching import stretching
from tests.proof.caging_shapes import (
    ARCH,
    SLOT,
    bowtie,
    i_beam,
    plus_sign,
    regular,
    star,
    two_notch_bar,
)
from tests.proof.hands import CM, EXACT, beam_hand, caging_settings, certify, gripper, hands_at, seeds


def levels_at(loop: FloatArray, p: tuple[float, float], q: tuple[float, float], kind: Callable[..., Caging]) -> Limits:
    return limits(kind(Boundary.of([loop]), EXACT), np.array([[p, q]], dtype=np.float64))


def squeezed(loop: FloatArray, p: tuple[float, float], q: tuple[float, float]) -> tuple[float, float, float]:
    """Escape, merge and bottom levels."""
    found = levels_at(loop, p, q, squeezing)
    return float(found.escape[0]), float(found.merge[0]), float(found.bottom[0])


@pytest.mark.parametrize("flange", [0.2, 0.5, 3.0])
def test_the_i_beam_lets_go_over_its_flange(flange: float) -> None:
    # one finger round a flange's end, or both out of their notches
    escape = min(3.0, np.hypot(flange, 2.0))
    assert squeezed(i_beam(flange=flange), (0, -0.5), (0, 0.5)) == pytest.approx((escape, escape, 1.0), abs=EXACT)


def test_the_bowtie() -> None:
    escape = 6 / np.sqrt(5)
    assert squeezed(bowtie(), (0, -0.5), (0, 0.5)) == pytest.approx((escape, escape, 1.0), abs=EXACT)


def test_the_plus_sign_is_held_in_opposite_corners() -> None:
    found = squeezed(plus_sign(), (-0.5, -0.5), (0.5, 0.5))
    assert found == pytest.approx((np.sqrt(5), np.sqrt(5), np.sqrt(2)), abs=EXACT)


@pytest.mark.parametrize(("half", "escape"), [(3.0, 2 / np.sqrt(1.0625)), (2.0, 2 / np.sqrt(1.25))])
def test_from_one_notch_into_the_next(half: float, escape: float) -> None:
    found = squeezed(two_notch_bar(half), (1, -0.5), (1, 0.5))
    assert found == pytest.approx((escape, 2 / np.sqrt(1.25), 1.0), abs=EXACT)


def test_the_arch_is_left_through_a_tunnel(monkeypatch: pytest.MonkeyPatch) -> None:
    assert squeezed(ARCH, (7, 0.3), (7, 2.7))[0] == pytest.approx(3.0, abs=EXACT)
    none = np.empty(0, dtype=np.intp)
    monkeypatch.setattr(contact_space, "_closing_tunnels", lambda *_: (none, none, np.empty(0)))
    assert squeezed(ARCH, (7, 0.3), (7, 2.7))[0] == pytest.approx(4.0, abs=EXACT)


def test_a_slot_holds_fingers_that_open() -> None:
    # from corner to corner √5; to change the diagonal they close to the slot's width, to leave, one goes to the lip
    found = levels_at(SLOT, (-0.9, -0.1), (0.9, -0.9), stretching)
    assert found.caged[0]
    assert (found.bottom[0], found.merge[0], found.escape[0]) == pytest.approx(
        (np.sqrt(5), 2.0, np.hypot(1.5, 1.0)), abs=EXACT
    )
    assert not levels_at(SLOT, (-0.8, -0.5), (0.8, -0.5), stretching).caged[0]


@pytest.mark.parametrize("corners", [3, 4, 5, 8, 50])
def test_convex_outlines_are_never_caged(corners: int) -> None:
    loop = 5 * CM * regular(corners)
    assert immobilising_grasps([loop], caging_settings()) == ()
    assert immobilising_grasps([loop], caging_settings(closing="outward")) == ()
    contacts = np.array([[[-0.04, 0.0], [0.04, 0.0]]])
    (cage,) = certify([loop], hands_at(contacts, np.array([0.09])), gripper(), caging_settings())
    assert not cage.squeezing
    assert cage.reason == "convex outline: two fingers never cage it"


def test_free_placements_are_caged_as_what_they_close_into() -> None:
    rng = np.random.default_rng(0)
    y = rng.uniform([-1.5, 0.5], [-0.5, 1.5], (50, 2))
    x = rng.uniform(-0.75, 0.75, (50, 1)) + np.zeros((50, 2))
    found = limits(squeezing(Boundary.of([i_beam()]), EXACT), np.stack([x, y], axis=2))
    assert found.escape == pytest.approx(np.full(50, np.hypot(0.5, 2.0)), abs=EXACT)
    assert found.caged.tolist() == (y[:, 1] - y[:, 0] < np.hypot(0.5, 2.0)).tolist()
    beside = limits(squeezing(Boundary.of([i_beam()]), EXACT), np.array([[[2.0, -1.0], [2.0, 1.0]]]))
    assert not beside.meets[0]
    assert not beside.caged[0]


def test_a_finger_in_the_outline_counts_as_withdrawn() -> None:
    found = levels_at(i_beam(), (0, -0.4), (0, 0.5), squeezing)
    assert found.opening[0] == pytest.approx(1.0, abs=EXACT)
    assert found.escape[0] == pytest.approx(np.hypot(0.5, 2.0), abs=EXACT)


def ring_and_holes() -> list[FloatArray]:
    """A block 10 × 4 with two square holes of side 2."""
    block = np.array([(0.0, 0.0), (10, 0), (10, 4), (0, 4)])
    hole = np.array([(1.0, 1.0), (1, 3), (3, 3), (3, 1)])
    return [block, hole, hole + np.array([6.0, 0.0])]


def test_a_finger_in_a_hole_never_leaves_it() -> None:
    caging = squeezing(Boundary.of(ring_and_holes()), EXACT)
    placements = np.array(
        [
            [[2.0, 2.0], [2.0, 5.0]],  # through the block's top
            [[2.0, 2.0], [8.0, 2.0]],  # from hole to hole
            [[1.0, 2.0], [3.0, 2.0]],  # in one hole: they meet
            [[-1.0, 2.0], [11.0, 2.0]],  # around a convex block
        ]
    )
    found = limits(caging, placements)
    assert found.escape[:2].tolist() == [np.inf, np.inf]
    assert found.caged.tolist() == [True, True, False, False]
    assert found.bottom[:2] == pytest.approx([1.0, 4.0], abs=EXACT)
    # both in one hole hold the block from inside, corner to corner; to another diagonal they close to the side
    inside = limits(stretching(Boundary.of(ring_and_holes()), EXACT), np.array([[[1.1, 1.2], [2.9, 2.9]]]))
    assert inside.escape[0] == -np.inf
    assert (inside.bottom[0], inside.merge[0]) == pytest.approx((np.sqrt(8), 2.0), abs=EXACT)


def test_the_certificate_of_a_finger_in_a_hole_has_no_limit() -> None:
    loops = [CM * loop for loop in ring_and_holes()]
    contacts = CM * np.array([[[2.0, 3.0], [2.0, 4.0]], [[2.0, 2.9], [2.0, 4.0]]])
    hands = hands_at(contacts, np.array([0.02, 0.0115]))
    free, tight = certify(loops, hands, gripper(finger_thickness_m=0.002), caging_settings())
    assert free.squeezing
    assert free.opening_max_m is free.margin_m is free.guaranteed_opening_max_m is None
    assert free.basin_opening_max_m == pytest.approx(np.sqrt(2) * CM)  # round the corner, to the block's left wall
    assert (free.guaranteed, free.on_approach, free.basin_on_approach) == (True, True, False)
    assert free.closes_into_m == pytest.approx(CM)
    assert free.tolerance is not None
    assert free.tolerance.position_m == pytest.approx((np.sqrt(2) - 1) / 2 * CM)
    assert tight.tolerance is not None
    assert tight.tolerance.position_m == pytest.approx(0.025 * CM)


def test_fingers_that_stand_in_the_outline_forgive_nothing() -> None:
    (cage,) = certify([CM * i_beam(flange=2.0, mouth=3.0)], beam_hand(0.8 * CM), gripper(), caging_settings())
    assert cage.tolerance is not None
    assert (cage.tolerance.position_m, cage.tolerance.across_m, cage.tolerance.rotation_deg) == (0.0, 0.0, 0.0)


def spectrum(loop: FloatArray, closing: str, told_apart: float) -> FloatArray:
    grasps = immobilising_grasps([loop], caging_settings(closing=closing, told_apart_m=told_apart))
    return np.array(sorted((each.width_m, each.escape_m or 0, each.basin_m or 0) for each in grasps)).reshape(-1, 3)


@given(seeds, st.floats(-np.pi, np.pi), st.floats(0.2, 5.0), st.booleans(), st.sampled_from(["inward", "outward"]))
@hypothesis_settings(max_examples=40)
def test_grasps_turn_mirror_and_scale_with_the_outline(
    seed: int, angle: float, scale: float, mirrored: bool, closing: str
) -> None:
    loop = star(seed)
    moved = np.roll(loop, seed % 9, axis=0) @ np.array(
        [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    )
    moved = scale * (moved[::-1] * [-1, 1] if mirrored else moved) + [0.3, -0.2]
    assert spectrum(moved, closing, 1e-4 * scale) == pytest.approx(scale * spectrum(loop, closing, 1e-4), rel=1e-6)


@pytest.mark.parametrize("closing", ["inward", "outward"])
@given(seeds, st.floats(0.1, 0.9))
@hypothesis_settings(max_examples=20)
def test_a_corner_on_a_straight_edge_changes_nothing(closing: str, seed: int, share: float) -> None:
    """It lies there but for rounding, and what rounding makes is no basin of its own."""
    loop = star(seed)
    edges = np.stack([loop, loop + share * (np.roll(loop, -1, axis=0) - loop)], axis=1)
    assert spectrum(edges.reshape(-1, 2), closing, 0.0) == pytest.approx(spectrum(loop, closing, 0.0), rel=1e-6)


def test_contacts_lie_on_the_outline_and_all_grasps_are_found() -> None:
    grasps = immobilising_grasps([CM * two_notch_bar(3.0)], caging_settings())
    assert len(grasps) == 2
    for grasp in grasps:
        x = abs(grasp.contacts[0, 0])
        assert np.abs(grasp.contacts) == pytest.approx(CM * np.array([[x / CM, 0.5], [x / CM, 0.5]]), abs=EXACT)
        assert (grasp.width_m, grasp.escape_m, grasp.basin_m) == pytest.approx(
            (CM, 2 * CM / np.sqrt(1.0625), 2 * CM / np.sqrt(1.25)), abs=EXACT
        )
        assert grasp.depth_m == pytest.approx(CM * (2 / np.sqrt(1.25) - 1), abs=EXACT)
    (neck,) = immobilising_grasps([i_beam()], caging_settings())
    assert np.sort(neck.contacts, axis=0) == pytest.approx(np.array([[0, -0.5], [0, 0.5]]), abs=EXACT)
    assert immobilising_grasps([np.array([(0, 0), (1, 1), (1, 0), (0, 1.0)])], caging_settings()) == ()


def test_dents_are_no_grasps_of_their_own() -> None:
    bar = two_notch_bar(3.0)
    assert len(immobilising_grasps([bar], caging_settings(told_apart_m=0.78))) == 2
    assert len(immobilising_grasps([bar], caging_settings(told_apart_m=0.8))) == 1  # the hump between is 0.7889 high


def by_hand_kruskal(boundary: Boundary) -> FloatArray:
    """Escape level (n, n) of all edge pairs, without tunnels: every link of the full torus, one by one."""
    n = len(boundary)
    ends = [(boundary.start[k], boundary.start[boundary.follow[k]]) for k in range(n)]
    segments = [shapely.LineString(each) for each in ends]
    corners = [shapely.Point(each) for each in boundary.start]
    links = [(0.0, (k, k), (-1, -1)) for k in range(n)]
    for i in range(n):
        for j in range(n):
            follow = int(boundary.follow[i])
            links.append((corners[follow].distance(segments[j]), (i, j), (follow, j)))
            links.append((corners[follow].distance(segments[j]), (j, i), (j, follow)))
    pools = {(i, j): {(i, j)} for i in range(n) for j in range(n)} | {(-1, -1): {(-1, -1)}}
    escape = np.full((n, n), np.inf)
    for level, a, b in sorted(links):
        if pools[a] is pools[b]:
            continue
        with_exit = (-1, -1) in pools[a] or (-1, -1) in pools[b]
        for node in pools[a] | pools[b] if with_exit else ():
            if node != (-1, -1):
                escape[node] = min(escape[node], level)
        merged = pools[a] | pools[b]
        pools |= dict.fromkeys(merged, merged)
    return escape


@given(seeds)
@hypothesis_settings(max_examples=10)
def test_levels_agree_with_the_scalar_twin(seed: int) -> None:
    boundary = Boundary.of([star(seed)])
    caging = squeezing(boundary, EXACT)
    direct = merge_levels(
        caging.basins.lowest,
        [caging.basins.links, (caging.basins.of_node.diagonal(), np.full(9, ESCAPE), np.zeros(9))],
        EXACT,
    )
    levels = np.maximum(direct.escape[caging.basins.of_node], caging.land.birth)
    assert levels == pytest.approx(by_hand_kruskal(boundary), abs=EXACT)
