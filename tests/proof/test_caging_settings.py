"""The numbers that cages are judged with, on outlines in millimetres that lie on either side of each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from flatgrasp_cli import load_settings, plan, read_clouds
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.profiles import Gripper
from flatgrasp_cli.proof.caging import Hands, Proof, prove
from flatgrasp_cli.proof.caging.outline import prepare
from tests.by_hand import MM
from tests.conftest import EACH, SAMPLES

CAGING = load_settings().caging


def proof_of(half_mm: Sequence[tuple[float, float]], pr2: Gripper) -> tuple[Proof, Hands]:
    """What a bar proves of a grasp 30 mm wide at its middle; `half_mm` are x and y along its upper side."""
    upper = np.array(half_mm, dtype=np.float64)
    loop = np.concatenate([upper[::-1], upper * [1, -1]])
    hands = Hands(np.zeros((1, 2)), np.array([[0.0, 1.0]]), np.array([0.03]), np.array([0.06]))
    slim = pr2.model_copy(update={"finger_width_m": 2 * MM})
    return prove([MM * loop], hands, slim, CAGING), hands


def notched(depth_mm: float) -> list[tuple[float, float]]:
    """A neck of 30 mm between flanges that stand out by so much."""
    high = 15 + depth_mm
    return [(-60, high), (-20, high), (-20, 15), (20, 15), (20, high), (60, high)]


@pytest.mark.parametrize(("depth_mm", "guaranteed"), [(1.2, False), (2.2, True)])
def test_a_cage_is_guaranteed_if_it_is_deeper_than_outlines_err(
    depth_mm: float, guaranteed: bool, pr2: Gripper
) -> None:
    """By 1.5 mm at each of the pads."""
    proof, hands = proof_of(notched(depth_mm), pr2)
    assert proof.limits.caged[0]
    assert proof.guaranteed(hands)[0] == guaranteed


@pytest.mark.parametrize(("ridge_mm", "told_apart"), [(1, False), (3, True)])
def test_grooves_less_than_3_mm_deep_are_one_basin(ridge_mm: float, told_apart: bool, pr2: Gripper) -> None:
    """Two of them, side by side between flanges that stand out by 20 mm, and a ridge on either side between them."""
    ridge = [(2, 15), (12, 15 + ridge_mm), (22, 15)]
    proof, _ = proof_of([(-60, 35), (-12, 35), (-12, 15), *ridge, (36, 15), (36, 35), (84, 35)], pr2)
    assert (proof.limits.merge[0] < (30 + 2 * ridge_mm + 1) * MM) == told_apart


def wavy(height_mm: float, waves: int = 40, radius_mm: float = 60) -> FloatArray:
    """A disc around which the boundary runs in and out by so much, as a loop (n, 2)."""
    radius = radius_mm + 0.5 * height_mm * (-1.0) ** np.arange(2 * waves)
    angles = np.pi * np.arange(2 * waves) / waves
    return np.asarray(MM * radius[:, None] * np.column_stack([np.cos(angles), np.sin(angles)]))


@pytest.mark.parametrize(("height_mm", "kept"), [(0.6, False), (2, True)])
def test_a_millimetre_is_simplified_away(height_mm: float, kept: bool) -> None:
    outline = prepare([wavy(height_mm)], CAGING)
    assert outline is not None
    assert (len(outline.boundary) == 80) == kept


def test_an_outline_has_120_vertices_and_not_much_less_if_it_needs_more() -> None:
    outline = prepare([wavy(0, waves=512, radius_mm=6000)], CAGING)
    assert outline is not None
    assert 60 < len(outline.boundary) <= 120


def test_where_cages_decide_60_grasps_compete(pr2: Gripper) -> None:
    (pan,) = read_clouds(SAMPLES / "pan.pcd")
    found = plan(pan, pr2, load_settings("default", ("ranking.prefer=cage", *EACH)), top=1000)
    assert len(found.objects[0].grasps) == 60
