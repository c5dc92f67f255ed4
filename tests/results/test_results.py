"""The document, the figures and the samples."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely
from jsonschema import Draft202012Validator
from pydantic import TypeAdapter

from flatgrasp_cli import load_gripper, plan
from flatgrasp_cli.geometry.polygon import signed_area
from flatgrasp_cli.planning import Plan
from flatgrasp_cli.ranking import TIE
from flatgrasp_cli.results.contracts import json_schema
from flatgrasp_cli.results.contracts.plan import Document
from flatgrasp_cli.results.document import to_document, to_json
from flatgrasp_cli.results.figures import as_png, final_figure, stage_figures
from flatgrasp_cli.results.figures.hand import DrawnHand
from flatgrasp_cli.results.figures.style import RED
from flatgrasp_cli.results.hand_boxes import finger_boxes
from flatgrasp_cli.results.view import View, view_of
from tests.conftest import SAMPLES, cloud_of, planned_sample, rectangle, sampled

OBJECTS = ("teddy_bear", "electric_drill", "pistol", "spray_bottle", "pan", "hammer", "juice_box")


@cache
def a_plate() -> Plan:
    return plan(cloud_of(sampled(rectangle(120, 40))), load_gripper("lacquey"))


@cache
def too_wide() -> Plan:
    return plan(cloud_of(sampled(rectangle(200, 200), pitch_mm=2)), load_gripper("pr2"))


@cache
def nothing() -> Plan:
    return plan(cloud_of(np.empty((0, 3))), load_gripper("pr2"))


PLANS: dict[str, Callable[[], Plan]] = {"grasps": a_plate, "none": too_wide, "no points": nothing}


@pytest.mark.parametrize("kind", PLANS)
def test_documents_meet_their_schema_and_hold_no_nan(kind: str) -> None:
    schema = json_schema()
    Draft202012Validator.check_schema(schema)
    text = to_json(to_document(PLANS[kind]()))
    Draft202012Validator(schema).validate(json.loads(text, parse_constant=pytest.fail))


@pytest.mark.parametrize("kind", PLANS)
def test_documents_have_the_contracts_keys_in_its_order_and_values_of_its_types(kind: str) -> None:
    contract, text = TypeAdapter(Document), to_json(to_document(PLANS[kind]()))
    read = contract.validate_json(text, strict=True)
    assert to_json(contract.dump_python(read, mode="json")) == text


def test_a_refusal_names_stage_value_and_limit() -> None:
    document = to_document(too_wide())
    assert document["status"] == "no_grasp"
    miss = document["objects"][0]["nearest_miss"]
    assert miss["stage"] == document["objects"][0]["funnel"][-1]["stage"] == "grasping_range"
    assert miss["value"] == pytest.approx(0.2, abs=4e-3)
    assert miss["limit"] == pytest.approx(0.086)


def test_both_centres_of_gravity_are_reported() -> None:
    center = to_document(a_plate())["objects"][0]["gravity_center"]
    assert center["used"] == "area"
    assert center["area"] == pytest.approx([0, 0, 0], abs=1e-3)
    apart = np.linalg.norm(np.subtract(center["area"], center["points"]))
    assert center["distance_m"] == pytest.approx(apart, abs=1e-6)


def test_grasps_are_ranked_and_the_funnel_narrows() -> None:
    item = to_document(a_plate())["objects"][0]
    holds = [grasp["success"]["probability"] for grasp in item["grasps"]]
    assert [grasp["rank"] for grasp in item["grasps"]] == list(range(1, len(holds) + 1))
    assert len(holds) > 1
    assert all(one >= other - TIE for one, other in pairwise(holds))
    kept = [stage["kept"] for stage in item["funnel"] if stage["stage"] not in ("silhouette", "step_points")]
    from_pairs = kept[2:]
    assert from_pairs == sorted(from_pairs, reverse=True)


def test_the_silhouettes_loops_are_counter_clockwise_with_clockwise_holes() -> None:
    ring = planned_sample("pan", "pr2").objects[0].silhouette
    assert ring is not None
    assert signed_area(ring.loops[0]) > 0
    assert len(ring.loops) > 1  # the hanging hole
    assert all(signed_area(loop) < 0 for loop in ring.loops[1:])


@pytest.mark.parametrize("name", OBJECTS)
def test_the_papers_objects_are_grasped_with_the_papers_gripper(name: str) -> None:
    assert planned_sample(name, "lacquey").best is not None


@pytest.mark.parametrize("name", ["electric_drill", "pistol", "spray_bottle", "hammer", "juice_box"])
def test_the_paper_to_the_letter_grasps_what_stands_free(name: str) -> None:
    """Eq. (2) forbids any boundary as wide as the palm up to w_o on each side: limbs and a pan's rim are there."""
    assert planned_sample(name, "lacquey", "paper").best is not None


@pytest.mark.parametrize("name", OBJECTS)
def test_the_papers_objects_are_grasped_with_one_finger_pair(name: str) -> None:
    grasp = planned_sample(name, "pr2").best
    assert grasp is not None
    assert grasp.required_friction < 0.5
    assert grasp.width_m < 0.09


def test_samples_are_small() -> None:
    files = list(SAMPLES.glob("*.pcd"))
    assert {path.stem for path in files} == {*OBJECTS, "pan_on_table", "table_scene"}
    assert max(path.stat().st_size for path in files) < 600_000


def test_the_final_figure_draws_the_grasp_where_it_is() -> None:
    """The red line runs through the hand's origin along the closing axis, as long as the opening, in millimetres."""
    result = a_plate()
    grasp, outline = result.best, result.objects[0].silhouette
    assert grasp is not None
    assert outline is not None
    axes = final_figure(result).axes[0]
    line = next(each for each in axes.lines if each.get_label() == "final grasp: the closing line")
    assert line.get_color() == RED
    ends = np.asarray(line.get_xydata())
    hand = DrawnHand.of(grasp, view_of(result, outline.frame.axes[2]))
    assert ends.mean(axis=0) == pytest.approx(hand.origin, abs=1e-6)
    assert ends[1] - ends[0] == pytest.approx(1e3 * grasp.opening_m * hand.y, abs=1e-6)


def test_finger_boxes_of_a_thumb_and_a_pair() -> None:
    boxes = finger_boxes(load_gripper("lacquey"), 0.08)
    assert boxes[0] == pytest.approx((-0.005, 0.005, -0.06, -0.04))
    assert [box[2:] for box in boxes[1:]] == [pytest.approx((0.04, 0.06))] * 2


@pytest.mark.parametrize(("kind", "count"), [("grasps", 17), ("none", 12), ("no points", 1)])
def test_stage_figures_go_as_far_as_the_method_went(kind: str, count: int) -> None:
    result = PLANS[kind]()
    names = [name for name, draw in stage_figures(result) if draw().axes]
    assert len(names) == count
    assert [int(name[:2]) for name in names] == list(range(1, count + 1))
    assert any(name.endswith("_funnel") for name in names)
    assert (as_png(lambda: final_figure(result)) or b"").startswith(b"\x89PNG")


@pytest.mark.parametrize("gripper", ["lacquey", "pr2", "wsg_50"])
@pytest.mark.parametrize("name", OBJECTS)
def test_no_finger_stands_in_the_outline(name: str, gripper: str) -> None:
    """At the opening to approach with, and half a millimetre before the pads meet: by shapely, for the twenty best."""
    hand, item = load_gripper(gripper), planned_sample(name, gripper).objects[0]
    outline = item.silhouette
    assert outline is not None
    solid = shapely.Polygon(outline.loops[0], outline.loops[1:])
    for grasp in item.grasps[:20]:
        drawn = DrawnHand.of(grasp, View(outline.frame))
        for opening in (grasp.opening_m, grasp.width_m + 0.0005):
            for x0, x1, y0, y1 in finger_boxes(hand, opening):
                corners = drawn.place(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]))
                assert solid.intersection(shapely.Polygon(1e-3 * corners)).area < 1e-9
