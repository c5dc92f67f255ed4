"""What to do with every cloud of every source: the gripper, the settings, the robot, which frames, in which frame."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from flatgrasp_cli.model import Cloud, Sensor
from flatgrasp_cli.placing import Workcell
from flatgrasp_cli.planning import Plan, plan
from flatgrasp_cli.profiles import Gripper, PlannerSettings
from flatgrasp_cli.sources import EVERYTHING, Selection, read_clouds, read_content


@dataclass(frozen=True, slots=True)
class Job:
    """Everything that decides an answer but the cloud itself.

    `scale` is the metres in a unit of the source, `sensor` where the sensor was if that is stated, in the base frame.
    """

    gripper: Gripper
    settings: PlannerSettings
    workcell: Workcell
    selection: Selection = EVERYTHING
    sensor: Sensor | None = None
    scale: float = 1.0
    top: int = 10

    def clouds(
        self, source: str, content: bytes | None = None, *, colors: bool = False
    ) -> Iterator[tuple[Cloud, float]]:
        """The wanted clouds of a source in the base frame, each with the milliseconds that reading it took.

        With `content`, a whole file's, `source` is only what that is called.
        """
        cell = self.workcell
        selection = replace(self.selection, base_frame=cell.base_frame, camera_pose=cell.camera, colors=colors)
        if content is None:
            clouds = read_clouds(source, self.scale, selection)
        else:
            clouds = read_content(content, source, self.scale, selection)
        while True:
            began = time.perf_counter()
            cloud = next(clouds, None)
            if cloud is None:
                return
            if self.sensor is not None:
                cloud = replace(cloud, sensor=self.sensor)
            yield cloud, 1e3 * (time.perf_counter() - began)

    def plan(self, cloud: Cloud) -> Plan:
        """Plan grasps on one of them."""
        return plan(cloud, self.gripper, self.settings, top=self.top, robot=self.workcell.robot)


@contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collects what readers and pictures warn of instead of printing it: whoever asked for the work says it."""
    logger, texts = logging.getLogger("flatgrasp_cli"), list[str]()

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            texts.append(record.getMessage())

    collector, propagate = Collector(logging.WARNING), logger.propagate
    logger.addHandler(collector)
    logger.propagate = False
    try:
        yield texts
    finally:
        logger.removeHandler(collector)
        logger.propagate = propagate
