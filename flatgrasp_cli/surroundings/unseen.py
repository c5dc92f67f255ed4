"""Beyond the paper: what of an object that stands on a plane was hidden, as far as hands that come aslant may meet it.

What was hidden straight below its rim is taken to belong to the object, as a hand from straight above takes for
granted. A surface that rises up to a ridge or a peak, as that of a tent or a cone does, has another side: that is taken
for the mirror image of the one that was seen (Bohg et al., "Mind the gap: robotic grasping under incomplete
observation", ICRA 2011), as far as no ray passed there.
"""

from __future__ import annotations

import cv2
import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, FloatArray, IntArray, true_entries
from flatgrasp_cli.geometry.broad import broad_pieces
from flatgrasp_cli.geometry.height_map import UNSEEN, HeightMap
from flatgrasp_cli.surroundings.sight import FAR_M
from flatgrasp_cli.surroundings.view import View
from flatgrasp_cli.surroundings.walls import LEAST_SLOPE

BROAD_M = 0.5 * FAR_M
"""How far beside its peak a profile must have fallen, metres, so that it ends in no level top; and how broad a side is
at least that is taken for hidden: about as a finger. What protrudes from an object has nothing to be mirrored in."""


def hidden_of(local: FloatArray, view: View, cell_m: float, behind_m: float) -> FloatArray:
    """Points (k, 3) of an object with points `local` (n, 3) over the plane that were hidden, about a cell apart.

    By the `view`, in the same frame, they lie at least `behind_m` behind what rays met, and that is how far heights are
    in doubt.
    """
    tops = [_rim(HeightMap.of(local, cell_m), local)]
    if view.viewpoint is not None:
        wide = HeightMap.around(local, cell_m, float(local[:, 2].max())).raised(local)
        tops.append(_behind_ridges(wide, _rim(wide, local), view, view.viewpoint, behind_m))
    body = _columns(np.concatenate(tops), cell_m)
    return body[_hides(view, body, behind_m)]


def _rim(chart: HeightMap, local: FloatArray) -> FloatArray:
    """The highest points (k, 3) in the outermost cells that were seen: straight below them the object was hidden."""
    seen = (chart.heights > UNSEEN).view(np.uint8)
    rim = (seen > 0) & (cv2.erode(seen, np.ones((3, 3), np.uint8)) == 0)
    cell = chart.raster.cells(local[:, 0], local[:, 1])
    order = np.argsort(-local[:, 2], kind="stable")
    _, first = np.unique(cell[order], return_index=True)
    tops = local[order[first]]  # the highest point of each cell
    return np.asarray(tops[rim.take(cell[order[first]])])


def _behind_ridges(chart: HeightMap, rim: FloatArray, view: View, viewpoint: FloatArray, doubt_m: float) -> FloatArray:
    """The highest points (n, 3) of the sides behind ridges and peaks, one in each cell where nothing was seen.

    Along each line of sight, seen from above, the hidden side is as high as the highest that was seen as far before its
    ridge, or farther.
    """
    profiles = _toward_sensor(chart, rim[:, :2], viewpoint, float(np.hypot(*np.ptp(rim[:, :2], axis=0))))
    rises = _rises_to_ridge(profiles, chart.cell_m)
    crests = np.maximum.accumulate(profiles[:, ::-1], axis=1)[:, ::-1]  # the highest from there on, to the sensor
    ridge = (crests >= profiles[:, :1] - doubt_m).sum(axis=1) - 1

    places = chart.raster.middles(*true_entries(chart.heights == UNSEEN))
    places = places[_hides(view, np.column_stack([places, np.zeros(len(places))]), doubt_m)]
    before, apart = _nearest_before(chart, rim, places, viewpoint)
    behind = np.flatnonzero((before >= 0) & rises[before])
    before, mirrored = before[behind], ridge[before[behind]] + apart[behind]
    heights = crests[before, np.minimum(mirrored, crests.shape[1] - 1)]
    tops = np.column_stack([places[behind], heights])[heights > 0]
    return np.asarray(tops[_is_broad(chart, tops[:, :2])])


def _toward_sensor(chart: HeightMap, places: FloatArray, viewpoint: FloatArray, far_m: float) -> FloatArray:
    """Heights (k, s), a cell apart, on the way from `places` (k, 2) to the sensor; 0 where nothing was seen."""
    steps, way = chart.cell_m * np.arange(far_m / chart.cell_m + 2), _ways(places, viewpoint)
    heights = chart.over(*(places[:, None, k] + steps * way[:, None, k] for k in (0, 1)))
    return np.maximum(heights, 0.0)


def _nearest_before(
    chart: HeightMap, rim: FloatArray, places: FloatArray, viewpoint: FloatArray
) -> tuple[IntArray, IntArray]:
    """Which of the `rim` (m, 3) comes first on the way from `places` (k, 2) to the sensor, −1 for none; cells apart."""
    raster, way, far_m = chart.raster, chart.cell_m * _ways(places, viewpoint), float(rim[:, 2].max())
    which = np.full(raster.shape, -1, dtype=np.intp)
    which.reshape(-1)[raster.cells(*rim[:, :2].T)] = np.arange(len(rim))
    found, apart = np.full((2, len(places)), -1, dtype=np.intp)
    for step in range(int(far_m / chart.cell_m) + 2):  # one after the other: all at once are many for a large object
        on = np.flatnonzero(found < 0)
        found[on], apart[on] = which.take(raster.cells(*(places[on] + step * way[on]).T)), step
    return found, apart


def _ways(places: FloatArray, viewpoint: FloatArray) -> FloatArray:
    """The unit vectors (k, 2) from `places` (k, 2) to below the sensor."""
    way = viewpoint[:2] - places
    return np.asarray(way / np.maximum(np.hypot(*way.T), np.finfo(np.float64).eps)[:, None])


def _rises_to_ridge(profiles: FloatArray, cell_m: float) -> BoolArray:
    """Which of the `profiles` (k, s) rise to a peak, and to no level top, by what they are beside it."""
    broad, last = int(BROAD_M / cell_m), profiles.shape[1] - 1
    peak = np.argmax(profiles, axis=1)[:, None]
    fall = np.take_along_axis(profiles, peak, 1) - np.take_along_axis(profiles, np.minimum(peak + broad, last), 1)
    return np.asarray(fall[:, 0] > LEAST_SLOPE * BROAD_M)


def _is_broad(chart: HeightMap, places: FloatArray) -> BoolArray:
    """Which of the `places` (k, 2), a cell of the chart each, are part of an area of them as broad as `BROAD_M`."""
    area, cell = np.zeros(chart.raster.shape, dtype=np.uint8), chart.raster.cells(*places.T)
    area.reshape(-1)[cell] = 1
    return np.asarray(broad_pieces(area, int(BROAD_M / chart.cell_m) | 1).take(cell))


def _columns(tops: FloatArray, cell_m: float) -> FloatArray:
    """Points (k, 3) from the plane up to each of the `tops` (n, 3), a cell apart."""
    levels = np.arange(0.0, float(tops[:, 2].max(initial=0.0)), cell_m)
    place, level = true_entries(levels < tops[:, 2:])
    return np.column_stack([tops[place, :2], levels[level]])


def _hides(view: View, points: FloatArray, behind_m: float) -> BoolArray:
    """Which of the points (k, 3) are hidden, by at least so far behind what rays met."""
    return view.hides(np.ascontiguousarray(points.T), behind_m)
