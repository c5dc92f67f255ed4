"""Decides where the sensor was that saw a cloud."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flatgrasp_cli.model import Cloud, Sensor


def located(cloud: Cloud, up: tuple[float, float, float] | None, seed: int) -> Cloud:
    """The cloud with its sensor."""
    del up, seed
    if cloud.sensor is not None:
        return cloud
    if cloud.viewpoint is not None:
        return replace(cloud, sensor=Sensor("viewpoint", cloud.viewpoint))
    return replace(cloud, sensor=Sensor("assumed", np.zeros(3)))
