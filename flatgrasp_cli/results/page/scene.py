"""What the page shows of a frame, as data for its script: places in metres, and words for people."""

from __future__ import annotations

from typing import Any

import numpy as np

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.geometry.frames import frame_on_plane
from flatgrasp_cli.model import Cloud
from flatgrasp_cli.profiles import Gripper, Robot
from flatgrasp_cli.results.hand_boxes import hand_boxes
from flatgrasp_cli.results.page.packing import Packed
from flatgrasp_cli.results.saved import SavedDocument, SavedGrasp, SavedObject

DECIMALS = 5
"""A hundredth of a millimetre: less than a pixel."""
PHASES = ("pre_grasp", "grasp", "lift")
AROUND_M = 0.15
"""Room around what is looked at, metres: that of a hand."""
UNITS = {"_m": (1e3, " mm"), "_deg": (1.0, "°"), "_share": (100.0, " %")}
"""How the end of a metric's name says its unit, the factor to the unit that people read, and that."""


def scene_of(document: SavedDocument, cloud: Cloud | None, packed: Packed | None) -> dict[str, Any]:
    """All that is shown of one frame; `cloud` is None where it is not there any more."""
    middle, radius = _looked_at(document, cloud)
    up = np.array(document.support_plane.normal) if document.support_plane else _toward_sensor(document)
    return {
        "name": document.source.name,
        "topic": document.source.topic,
        "frame_id": document.frame_id,
        "gripper": document.gripper.description,
        "robot": document.robot.name if document.robot else None,
        "notes": [note for note in (document.reason, document.remedy) if note],
        "warnings": [warning.text for warning in document.warnings],
        "up": _rounded(up),
        "middle": _rounded(middle),
        "radius": radius,
        "sensor": document.sensor.position,
        "plane": _plane(document, middle, radius),
        "cloud": packed and {key: getattr(packed, key) for key in ("count", "low", "step", "colored")},
        "objects": [_object(item, document) for item in document.objects],
    }


def _looked_at(document: SavedDocument, cloud: Cloud | None) -> tuple[FloatArray, float]:
    """The middle (3,) of the objects' outlines, or of the cloud, and the radius around it."""
    loops = [loop for item in document.objects if item.silhouette for loop in item.silhouette.in_space()]
    seen = np.zeros((1, 3)) if cloud is None or not len(cloud.points) else cloud.points
    points = np.vstack(loops) if loops else seen
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0)) if loops else np.median(points, axis=0)
    away = np.linalg.norm(points - middle, axis=1)
    return middle, AROUND_M + float(away.max() if loops else np.median(away))


def _toward_sensor(document: SavedDocument) -> FloatArray:
    """The way up without a support plane: against the approach of the best grasp, or against an optical axis."""
    best = next((grasp for _, grasp in document.grasps), None)
    if best is None:
        return np.array([0.0, 0.0, -1.0])
    back = np.array(best.pre_grasp.position) - np.array(best.pose.position)
    return np.asarray(back / max(float(np.linalg.norm(back)), np.finfo(np.float64).tiny))


def _plane(document: SavedDocument, middle: FloatArray, radius: float) -> Any:
    """The corners of the support plane as far as it is looked at."""
    if document.support_plane is None:
        return None
    frame = frame_on_plane(np.array(document.support_plane.normal), document.support_plane.offset_m)
    x, y, _ = frame.to_local(middle[None])[0]
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * radius + [x, y]
    return _rounded(frame.to_world(square))


def _object(item: SavedObject, document: SavedDocument) -> dict[str, Any]:
    return {
        "id": item.id,
        "why": [words for words in (item.reason, item.remedy) if words],
        "stages": [[stage.stage.replace("_", " "), stage.kept] for stage in item.funnel],
        "loops": [_rounded(loop) for loop in item.silhouette.in_space()] if item.silhouette else [],
        "grasps": [_grasp(grasp, document.gripper, document.robot) for grasp in item.grasps],
    }


def _grasp(grasp: SavedGrasp, gripper: Gripper, robot: Robot | None) -> dict[str, Any]:
    rows = [("holds", _percent(grasp.probability))] if grasp.probability is not None else []
    sizes = {"opens to": ("opening_m", grasp.opening_m), "object's width": ("width_m", grasp.width_m)}
    rows += [(name, _in_words(*size)) for name, size in sizes.items()]
    rows += [(_name(key), _in_words(key, value)) for key, value in grasp.metrics.items() if value is not None]
    return {
        "rank": grasp.rank,
        "holds": None if grasp.probability is None else _percent(grasp.probability),
        "opens": _in_words("opening_m", grasp.opening_m),
        "causes": [[_name(key), _percent(share)] for key, share in grasp.causes],
        "rows": rows,
        "contacts": _rounded(np.array(grasp.contacts)),
        "poses": {
            phase: {"position": list(pose.position), "orientation": list(pose.orientation)}
            for phase, pose in zip(PHASES, (grasp.pre_grasp, grasp.pose, grasp.lift), strict=True)
        },
        "open": _boxes(gripper, grasp.opening_m, grasp.width_m),
        "closed": _boxes(gripper, grasp.width_m, grasp.width_m),
        "wrist": _rounded(np.array([[0.0, 0.0, -back] for back in _wrist(grasp, gripper)])),
        "arm": _arm(grasp, robot),
    }


def _boxes(gripper: Gripper, opening_m: float, width_m: float) -> list[Any]:
    return [_rounded(np.array([box.center, box.size])) for box in hand_boxes(gripper, opening_m, width_m)]


def _wrist(grasp: SavedGrasp, gripper: Gripper) -> tuple[float, float]:
    """How far behind the fingertips' frame the palm begins, and how far the flange is, metres."""
    return gripper.finger_length_at_m(grasp.width_m), gripper.tool_length_m(grasp.width_m)


def _arm(grasp: SavedGrasp, robot: Robot | None) -> dict[str, Any] | None:
    """The arm's joints in space in each phase."""
    if robot is None or grasp.reach is None or grasp.reach.joints_rad is None:
        return None
    from flatgrasp_cli.results.figures.arm import links_of  # loads matplotlib

    joints = grasp.reach.joints_rad
    return {phase: _rounded(links_of(robot, np.array(getattr(joints, phase)))) for phase in PHASES}


def _name(key: str) -> str:
    ending = next((end for end in UNITS if key.endswith(end)), "")
    return key.removesuffix(ending).replace("_", " ")


def _in_words(key: str, value: float) -> str:
    factor, unit = next((UNITS[end] for end in UNITS if key.endswith(end)), (1.0, ""))
    return f"{factor * value:.3g}{unit}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _rounded(values: FloatArray) -> Any:
    return (np.round(values, DECIMALS) + 0.0).tolist()
