"""What a cage's certificate promises of a hand: limits worked out by hand, and a flood fill of all placements."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.polygon import left_normal
from flatgrasp_cli.proof.caging.boundary import Boundary
from flatgrasp_cli.proof.caging.contact_space import squeezing
from flatgrasp_cli.proof.caging.hands import pad_points, sweeps
from flatgrasp_cli.proof.caging.limits import limits
from flatgrasp_cli.proof.caging.outline import prepare
from flatgrasp_cli.proof.caging.stretching import stretching
from tests.proof.caging_shapes import (
    SLOT,
    hollow,
    i_beam,
    star,
    ways_out,
)
from tests.proof.hands import CM, EXACT, beam_hand, caging_settings, certify, gripper, hands_at, seeds


def test_the_certificate_of_an_i_beam_by_hand() -> None:
    loop = CM * i_beam(flange=2.0, mouth=3.0)
    (cage,) = certify([loop], beam_hand(), gripper(), caging_settings())
    escape, small = np.hypot(2.0, 2.0), np.hypot(1.8, 1.8)  # the flange's and the neck's sides come in by 0.1 each
    assert cage.squeezing
    assert not cage.stretching
    assert (cage.opening_max_m, cage.basin_opening_max_m) == pytest.approx((escape * CM, escape * CM))
    assert cage.margin_m == pytest.approx((escape - 1) * CM)
    assert cage.closes_into_m == pytest.approx(CM)
    assert cage.guaranteed
    assert cage.guaranteed_opening_max_m == pytest.approx(small * CM)
    assert cage.on_approach
    assert cage.basin_on_approach
    assert cage.opening_min_m is cage.basin_opening_min_m is cage.guaranteed_opening_min_m is None
    (wide,) = certify([loop], beam_hand(3.0 * CM), gripper(), caging_settings())
    assert (wide.on_approach, wide.basin_on_approach) == (False, False)


def test_how_far_the_hand_may_miss_by_hand() -> None:
    # pads 2.2 apart on a neck of 1, fingers 0.5 wide in notches 3 wide: 0.6 along the axis, 1.25 across
    loop = CM * i_beam(flange=2.0, mouth=3.0)
    (cage,) = certify([loop], beam_hand(), gripper(), caging_settings())
    assert cage.tolerance is not None
    assert (cage.tolerance.position_m, cage.tolerance.along_m, cage.tolerance.across_m) == pytest.approx(
        (0.6 * CM, 0.6 * CM, 1.25 * CM)
    )
    assert cage.tolerance.lever_m == pytest.approx(np.hypot(0.25, 1.5) * CM)
    # of a hand that opens 3.0, more than the cage, only what closing to 2.83 leaves is sure
    (wide,) = certify([loop], beam_hand(3.0 * CM), gripper(), caging_settings())
    assert wide.tolerance is not None
    assert wide.tolerance.along_m == pytest.approx((np.sqrt(2) - 0.5) * CM)


@given(seeds, st.floats(0.012, 0.03))
@hypothesis_settings(max_examples=15)
def test_fingers_stay_free_up_to_the_tolerance_and_touch_beyond(seed: int, opening: float) -> None:
    loop = CM * i_beam(flange=0.8, mouth=2.0) + np.random.default_rng(seed).uniform(-0.0008, 0.0008, (12, 2))
    hands, hand = beam_hand(opening), gripper()
    (cage,) = certify([loop], hands, hand, caging_settings(noise_m=0.0005))
    assert cage.tolerance is not None
    begin = np.array([min(opening, cage.basin_opening_max_m or np.inf)])
    fingers = shapely.union_all(
        [shapely.box(box.low, box.near[0], box.high, box.far[0]) for box in sweeps(hands, begin, hand, outward=False)]
    )  # the hand's frame: x across, y along the axis; here the axis is y and across −x
    shape = shapely.Polygon(np.column_stack([loop @ left_normal(hands.axis)[0], loop @ hands.axis[0]]))
    assert cage.tolerance.position_m == pytest.approx(fingers.distance(shape), abs=2e-6)
    most = cage.tolerance.rotation_deg
    turned = [shapely.affinity.rotate(fingers, angle, origin=(0, 0)) for angle in np.linspace(-most, most, 41)]
    assert all(shape.intersection(each).area < 1e-12 for each in turned)
    assert most == 90 or min(shape.distance(turned[0]), shape.distance(turned[-1])) < 2e-4


def test_a_thumb_against_a_pair_of_fingers() -> None:
    # fingers 5 wide at ±8 against one at 0: their nearest edges are 3 aside, and σ² = opening² + 3²
    hand = gripper(jaws=((0.0,), (-0.008, 0.008)))
    points, aside = pad_points(beam_hand(), hand)
    assert aside == pytest.approx([0.003, 0.003])
    assert np.linalg.norm(points[:, 0, 1] - points[:, 0, 0], axis=1) == pytest.approx([np.hypot(0.01, 0.003)] * 2)
    (cage,) = certify([CM * i_beam(flange=2.0, mouth=3.0)], beam_hand(), hand, caging_settings())
    assert cage.opening_max_m == pytest.approx(np.sqrt(8.0 - 0.09) * CM)


def test_why_there_is_no_cage() -> None:
    loop = CM * i_beam(flange=0.5)
    contacts = CM * np.array([[[0.0, -1.2], [0.0, 1.2]], [[1.6, -0.5], [1.6, 0.5]], [[-1.25, 0.0], [1.25, 0.1]]])
    wide, beside, ends = certify([loop], hands_at(contacts, np.full(3, 0.03)), gripper(), caging_settings())
    assert wide.reason == "escapes at 0.0206 m, not above the 0.0240 m of the grasp itself"
    assert beside.reason == "nothing of the object lies between the fingers"
    assert ends.reason == "closing, the fingers slip off"
    (crossed,) = certify([loop[[0, 2, 1, 3]]], beam_hand(), gripper(), caging_settings())
    assert crossed.reason == "the outline crosses itself"
    assert certify([loop], beam_hand().select(np.empty(0, dtype=np.intp)), gripper(), caging_settings()) == ()


def test_a_cage_finer_than_the_noise_is_not_guaranteed() -> None:
    loop = CM * i_beam(neck=1.0, depth=0.1, flange=0.5)
    (cage,) = certify([loop], beam_hand(), gripper(finger_width_m=0.002), caging_settings(noise_m=0.0011))
    assert cage.squeezing
    assert not cage.guaranteed
    assert cage.guaranteed_opening_max_m is None
    (nothing_left,) = certify([loop], beam_hand(), gripper(), caging_settings(noise_m=0.1))
    assert nothing_left.squeezing
    assert not nothing_left.guaranteed


def test_a_hand_that_opens_in_a_slot() -> None:
    contacts = CM * np.array([[[-0.95, -0.2], [0.95, -0.8]]])
    hands = hands_at(contacts, np.array([1.85 * CM]))
    hand = gripper(finger_width_m=0.0005, finger_thickness_m=0.0005)
    (cage,) = certify([CM * SLOT], hands, hand, caging_settings(closing="outward", noise_m=0.0001))
    assert cage.stretching
    assert not cage.squeezing
    assert (cage.opening_min_m, cage.basin_opening_min_m) == pytest.approx((np.hypot(1.5, 1.0) * CM, 2 * CM), rel=0.02)
    assert cage.margin_m == pytest.approx(np.linalg.norm([1.9, 0.6]) * CM - np.hypot(1.5, 1.0) * CM)
    assert (cage.on_approach, cage.basin_on_approach, cage.guaranteed) == (True, False, True)
    assert cage.opening_max_m is None


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_the_eroded_outline_lies_within_every_outline_that_may_be_meant(seed: int) -> None:
    loop = 0.05 * star(seed, 40)
    settings = caging_settings(tolerance_m=0.002, noise_m=0.001, max_vertices=20)
    outline = prepare([loop], settings)
    assert outline is not None
    assert len(outline.boundary) <= 20
    whole, plain = shapely.Polygon(loop), shapely.Polygon(outline.boundary.start)
    assert shapely.hausdorff_distance(plain.boundary, whole.boundary, 0.05) <= outline.tolerance_m + 1e-9
    eroded = outline.eroded(settings.noise_m)
    if eroded is not None:
        assert whole.buffer(-settings.noise_m + 1e-6, quad_segs=64).covers(shapely.Polygon(eroded.start))


def placements(loop: FloatArray, bottoms: FloatArray, apart: float, rng: np.random.Generator) -> FloatArray:
    """Placements (m, 2, 2) of fingers `apart`, clear of the outline, near `bottoms` (b, 2, 2)."""
    near = bottoms[rng.integers(0, len(bottoms), 400)]
    middle = near.mean(axis=1) + rng.normal(0, 0.25, (400, 2))
    angle = np.arctan2(*(near[:, 1] - near[:, 0]).T[::-1]) + rng.normal(0, 0.25, 400)
    half = 0.5 * apart * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.stack([middle - half, middle + half], axis=1)
    grown = shapely.Polygon(loop).buffer(GRID)
    blocked = shapely.contains_xy(grown, *points.reshape(-1, 2).T).reshape(-1, 2).any(axis=1)
    return np.asarray(points[~blocked])


GRID = 0.07


def count_against_flood(seed: int) -> dict[str, int]:
    """How many placements were caged by proof, and how often the flood fill disagreed, either way."""
    rng, counts = np.random.default_rng(seed), {"caged": 0, "escapes": 0, "unsound": 0, "too_cautious": 0}
    loop = hollow(seed, GRID)
    if loop is None:
        return counts
    cages = [kind(Boundary.of([loop]), EXACT) for kind in (squeezing, stretching)]
    for caging, sign in zip(cages, (1, -1), strict=True):
        depth = caging.levels.escape - caging.basins.lowest
        deepest = int(np.where(np.isfinite(depth), depth, 0.0).argmax())
        level = sign * float(caging.levels.escape[deepest])
        if depth[deepest] < 7 * GRID:
            continue
        minima = caging.minima
        in_deepest = caging.basins.of_node[minima.vertex, minima.edge] == deepest
        bottoms = minima.points(caging.boundary)[in_deepest]
        for apart in (level - 3.5 * GRID, level + 3.5 * GRID):
            points = placements(loop, bottoms, apart, rng)
            escapes = ways_out(loop, apart, GRID)
            found = [limits(each, points) for each in cages]
            near = np.any([np.abs(each.escape - apart) < 3 * GRID for each in found], axis=0)
            held = np.any([each.caged for each in found], axis=0)
            for placement, caged in zip(points[~near], held[~near], strict=True):
                out = escapes(placement)
                if out is not None:
                    counts["caged" if caged else "escapes"] += 1
                    counts["unsound"] += int(caged and out)
                    counts["too_cautious"] += int(not caged and not out)
    return counts


@pytest.mark.parametrize("seed", [3, 6, 7, 16, 17, 20, 22, 31])
def test_no_way_out_of_a_proven_cage(seed: int) -> None:
    counts = count_against_flood(seed)
    assert counts["caged"] > 40
    assert counts["escapes"] > 40
    assert counts["unsound"] == counts["too_cautious"] == 0


@pytest.mark.slow
def test_no_way_out_of_thousands_of_proven_cages() -> None:
    every = [count_against_flood(seed) for seed in range(400)]
    total = {key: sum(each[key] for each in every) for key in every[0]}
    assert total["caged"] > 10_000
    assert total["unsound"] == 0
    assert total["too_cautious"] < 0.001 * total["escapes"]  # the flood cannot pass gaps of a few cells
