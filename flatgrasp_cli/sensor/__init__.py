"""Where the sensor was: stated, told by the cloud itself, or assumed."""

from flatgrasp_cli.sensor.location import located

__all__ = ["located"]
