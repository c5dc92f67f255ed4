"""Whether a camera that somebody stated can be that of an image: cameras look out of the middle of their images."""

from __future__ import annotations

from flatgrasp_cli.recordings.messages.camera_info import CameraInfo
from flatgrasp_cli.recordings.messages.decoded import Assumption

MOST_ASIDE = 0.1
"""Of the image's sides. A depth camera's principal point lies within 5 % of the middle, and no more than 8 % where a
strip of an eighth is cut off. Intrinsics of half or double the size are 22 % or more aside, those of 640 × 480 are 12 %
aside in images of 848 × 480."""
DOUBTED = Assumption(
    "intrinsics_doubted",
    "the principal point that --intrinsics states is far from the middle of the image, as if it were for another size; "
    "--intrinsics FILE states the size, too",
)


def camera_doubt(info: CameraInfo, width: int, height: int) -> Assumption | None:
    """What to say if the principal point of `info` is far from the middle of an image of that size.

    Whoever states which region of the sensor the image shows has said why its middle is elsewhere.
    """
    if info.offset != (0, 0):
        return None
    places = zip((info.k[2], info.k[5]), info.binning, (width, height), strict=True)
    aside = max(abs(place / binning - (side - 1) / 2) / side for place, binning, side in places)
    return DOUBTED if aside > MOST_ASIDE else None
