"""Ferrari–Canny's ε by hand, by Qhull, and its sign by Nguyen's condition."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, QhullError

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.planner import balance
from flatgrasp_cli.proof.force_closure import (
    Reference,
    contact_wrenches,
    ferrari_canny,
    friction_margin,
    lift_margins,
    pad_quality,
    point_quality,
    reference_of,
)
from tests.by_hand import candidates

seeds = st.integers(0, 2**32 - 1)
OPPOSED = np.array([[[-1.0, 0.0], [1.0, 0.0]]])
INWARD = np.array([[[1.0, 0.0], [-1.0, 0.0]]])
ORIGIN = Reference(np.zeros(2), 1.0)


def random_grasps(seed: int, count: int = 20) -> tuple[FloatArray, FloatArray]:
    """Contacts and inward normals (count, 2, 2) that face each other, more or less."""
    rng = np.random.default_rng(seed)
    contacts = rng.normal(size=(count, 2, 2))
    apart = contacts[:, 1] - contacts[:, 0]
    angle = np.arctan2(apart[:, 1], apart[:, 0])[:, None] + [0.0, np.pi] + rng.uniform(-0.8, 0.8, (count, 2))
    return contacts, np.stack([np.cos(angle), np.sin(angle)], axis=2)


@pytest.mark.parametrize("friction", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("length", [1.0, 2.5])
def test_opposed_points_span_a_tetrahedron(friction: float, length: float) -> None:
    # its vertices are every other corner of a box with half sides x, y and z, its faces lie on ±a/x ± b/y ± c/z = 1
    half = np.arctan(friction)
    x, y, z = np.cos(half), np.sin(half), np.sin(half) / length
    expected = 1 / np.sqrt(x**-2 + y**-2 + z**-2)
    reference = Reference(np.zeros(2), length)
    assert point_quality(OPPOSED, INWARD, friction, reference) == pytest.approx([expected], abs=1e-12)


def test_the_regular_tetrahedron() -> None:
    assert point_quality(OPPOSED, INWARD, 1.0, ORIGIN) == pytest.approx([np.sqrt(0.5 / 3)], abs=1e-12)


def test_pads_without_friction_turn_but_do_not_slide() -> None:
    # no force across the normals: all wrenches have fy = 0
    assert pad_quality(OPPOSED, INWARD, np.full((1, 2), 0.4), 1e-9, ORIGIN) == pytest.approx([0.0], abs=1e-8)


def test_wide_pads_by_hand() -> None:
    # contacts at (±1, 0), cones of 45°, c = √½, pad ends at y = ±1: forces c·(±1, ±1), torques x·fy − y·fx.
    # In units of c the hull's facets lie on fx = ±1, fy = ±1 and ±(fx + fy) ± τ = 2, at 2/√3: the nearest are at 1.
    ends = np.array([[[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]])
    wrenches = contact_wrenches(ends, np.tile(INWARD, (1, 2, 1)), 1.0, ORIGIN)[0] / np.sqrt(0.5)
    expected = {(1, -1, 2), (1, -1, 0), (1, 1, 0), (1, 1, -2), (-1, 1, 2), (-1, 1, 0), (-1, -1, 0), (-1, -1, -2)}
    assert {tuple(row) for row in np.rint(wrenches).astype(int).tolist()} == expected
    assert pad_quality(OPPOSED, INWARD, np.full((1, 2), 2.0), 1.0, ORIGIN) == pytest.approx([np.sqrt(0.5)])


def by_qhull(wrenches: FloatArray) -> float:
    try:
        hull = ConvexHull(wrenches)
    except QhullError:
        return 0.0
    return max(0.0, float(-hull.equations[:, 3].max()))


@given(seeds)
def test_epsilon_is_qhulls(seed: int) -> None:
    contacts, normals = random_grasps(seed)
    points = contact_wrenches(contacts, normals, 0.5, ORIGIN)
    assert ferrari_canny(points) == pytest.approx([by_qhull(each) for each in points], abs=1e-9)
    pads = contact_wrenches(np.tile(contacts, (1, 2, 1)) + 0.1, np.tile(normals, (1, 2, 1)), 0.5, ORIGIN)
    assert ferrari_canny(pads) == pytest.approx([by_qhull(each) for each in pads], abs=1e-9)


@given(seeds)
def test_force_closed_exactly_when_friction_suffices(seed: int) -> None:
    contacts, normals = random_grasps(seed)
    epsilon = point_quality(contacts, normals, 0.5, ORIGIN)
    k = len(contacts)
    fingers = candidates(contacts.reshape(-1, 2), normals.reshape(-1, 2))
    pairs = balance.weigh(fingers, np.arange(2 * k).reshape(k, 2).T.copy())
    margin = friction_margin(pairs.required_friction, 0.5)
    clear = np.abs(margin) > 1e-6
    assert (epsilon[clear] > 0).tolist() == (margin[clear] > 0).tolist()


@given(seeds)
def test_pads_hold_more_than_points_and_the_sign_needs_no_reference(seed: int) -> None:
    contacts, normals = random_grasps(seed)
    point = point_quality(contacts, normals, 0.5, ORIGIN)
    pad = pad_quality(contacts, normals, np.full((len(contacts), 2), 0.2), 0.5, ORIGIN)
    assert (pad >= point - 1e-9).all()
    moved = point_quality(contacts, normals, 0.5, Reference(np.array([0.7, -0.4]), 3.0))
    assert ((moved > 1e-9) == (point > 1e-9)).all()


@given(seeds, st.floats(-np.pi, np.pi))
def test_epsilon_turns_with_the_object(seed: int, angle: float) -> None:
    contacts, normals = random_grasps(seed)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    center = np.array([0.3, 0.1])
    before = point_quality(contacts, normals, 0.5, Reference(center, 2.0))
    after = point_quality(contacts @ turn, normals @ turn, 0.5, Reference(center @ turn, 2.0))
    assert after == pytest.approx(before, abs=1e-9)


def test_the_reference_is_the_centre_of_area_and_the_largest_radius() -> None:
    reference = reference_of([np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 8.0], [0.0, 8.0]])])
    assert reference.point == pytest.approx([3.0, 4.0])
    assert reference.length_m == pytest.approx(5.0)


def test_lift_margins_by_hand() -> None:
    # 1 kg, 20 N, μ = 0.5: 20 N of friction against 9.80665 N; r = 15 mm: 0.2 N·m against 9.80665 N · 10 mm
    margins = lift_margins(np.array([0.01, 0.0]), 1.0, 20.0, 0.5, np.full(2, 0.015))
    assert margins.weight == pytest.approx([20 / 9.80665] * 2)
    assert margins.torque == pytest.approx([0.2 / 0.0980665, np.inf])
