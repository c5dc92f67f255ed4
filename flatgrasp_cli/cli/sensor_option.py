"""What `--sensor` says, in words."""

from __future__ import annotations

import math
import re

import numpy as np

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.model import Sensor


def parse_sensor(text: str) -> Sensor | str:
    """The sensor that "X,Y,Z", "above" or "none" states; of anything else, the name of its frame.

    "none" are clouds merged from several views, which nothing was hidden from.

    Raises
    ------
    UsageError
        If it is empty, or begins as a place but is not three finite numbers.
    """
    if text == "above":
        return Sensor("option")
    if text == "none":
        return Sensor("all_sides")
    if "," not in text and not re.fullmatch(r"[-+.\d][-+.\d\seE]*|", text):
        return text.lstrip("/")
    try:
        place = [float(part) for part in text.split(",")]
    except ValueError:
        place = []
    if len(place) != 3 or not all(map(math.isfinite, place)):
        raise UsageError(f"--sensor {text}: give its place X,Y,Z, the name of its frame in a recording, above, or none")
    return Sensor("option", np.array(place))
