"""Where should this two-finger gripper close on this flat unknown object, and why there.

>>> from flatgrasp_cli import load_gripper, plan, read_clouds
>>> for cloud in read_clouds("cloud.pcd"):
...     result = plan(cloud, load_gripper("lacquey"))
...     print(result.best)
"""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes as long to load as Python does: Ctrl-C must be answered before that
if TYPE_CHECKING:
    from typing import Any

    from flatgrasp_cli.model import Cloud, Grasp, ObjectPlan, Pose, Rejection, Scene, Sensor, Source
    from flatgrasp_cli.placing import in_base_frame
    from flatgrasp_cli.planning import Plan, plan
    from flatgrasp_cli.profiles import load_camera_pose, load_gripper, load_robot, load_settings
    from flatgrasp_cli.results.document import to_document
    from flatgrasp_cli.sources import Selection, read_clouds
    from flatgrasp_cli.version import __version__ as __version__

__all__ = [
    "Cloud",
    "Grasp",
    "ObjectPlan",
    "Plan",
    "Pose",
    "Rejection",
    "Scene",
    "Selection",
    "Sensor",
    "Source",
    "in_base_frame",
    "load_camera_pose",
    "load_gripper",
    "load_robot",
    "load_settings",
    "plan",
    "read_clouds",
    "to_document",
]

_HOMES = {
    "Cloud": "flatgrasp_cli.model",
    "Grasp": "flatgrasp_cli.model",
    "ObjectPlan": "flatgrasp_cli.model",
    "Pose": "flatgrasp_cli.model",
    "Rejection": "flatgrasp_cli.model",
    "Scene": "flatgrasp_cli.model",
    "Sensor": "flatgrasp_cli.model",
    "Source": "flatgrasp_cli.model",
    "Plan": "flatgrasp_cli.planning",
    "Selection": "flatgrasp_cli.sources",
    "in_base_frame": "flatgrasp_cli.placing",
    "load_camera_pose": "flatgrasp_cli.profiles",
    "load_gripper": "flatgrasp_cli.profiles",
    "load_robot": "flatgrasp_cli.profiles",
    "load_settings": "flatgrasp_cli.profiles",
    "plan": "flatgrasp_cli.planning",
    "read_clouds": "flatgrasp_cli.sources",
    "to_document": "flatgrasp_cli.results.document",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for: `flatgrasp --help` needs none of numpy, pydantic and Open3D."""
    import importlib

    home = "flatgrasp_cli.version" if name == "__version__" else _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(home), name)
