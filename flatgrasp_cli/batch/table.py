"""The best grasp of each object in each frame as one table: Parquet with pyarrow, else CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import Any

from flatgrasp_cli.batch.inputs import Input
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.whole_files import draft_of

Row = dict[str, Any]

ROWS_AT_ONCE = 10_000
TEXT = ("input", "topic", "frame_id", "status", "reason")
WHOLE = ("frame", "stamp_ns", "object", "points")
REAL = (
    *("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "width_m", "opening_m"),
    *("force_balance_deg", "torque_arm_m", "required_friction", "gravity_distance_m", "probability", "total_ms"),
)
COLUMNS = (
    *("input", "frame", "stamp_ns", "topic", "frame_id", "object", "points", "status", "reason"),
    *REAL,
)


def write_table(store: Store, inputs: Iterable[Input]) -> Path:
    """Write `grasps.parquet` or `grasps.csv`; a frame without objects is a row, too, that says why."""
    rows = (row for item in inputs if store.state(item) is not None for row in _rows(store, item))
    parquet = find_spec("pyarrow") is not None
    path = store.path("grasps.parquet" if parquet else "grasps.csv")
    with draft_of(path) as draft:
        (_write_parquet if parquet else _write_csv)(draft, rows)
    return path


def _rows(store: Store, item: Input) -> Iterator[Row]:
    for index, record in enumerate(store.records(item)):
        frame = {
            "input": item.called,
            "frame": index,
            **{key: record[key] for key in ("stamp_ns", "topic", "frame_id", "points", "status", "reason")},
            "total_ms": record["timing_ms"]["total"],
        }
        for thing in record["objects"] or [{}]:
            yield {**dict.fromkeys(COLUMNS), **frame, **_object_values(thing)}


def _object_values(thing: dict[str, Any]) -> Row:
    if not thing:
        return {}
    values: Row = {"object": thing["id"], **{key: thing[key] for key in ("points", "status", "reason")}}
    if "pose" in thing:
        position, orientation = thing["pose"]["position"], thing["pose"]["orientation"]
        values |= dict(zip(("x_m", "y_m", "z_m"), position, strict=True))
        values |= dict(zip(("qx", "qy", "qz", "qw"), orientation, strict=True))
        values |= {key: thing[key] for key in ("width_m", "opening_m")}
        values |= {key: value for key, value in thing["metrics"].items() if key in REAL}
        values["probability"] = thing["success"] and thing["success"]["probability"]
    return values


def _write_csv(path: Path, rows: Iterable[Row]) -> None:
    with path.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


def _write_parquet(path: Path, rows: Iterator[Row]) -> None:
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    types = {**dict.fromkeys(TEXT, pa.string()), **dict.fromkeys(WHOLE, pa.int64())}
    schema = pa.schema([(name, types.get(name, pa.float64())) for name in COLUMNS])
    with path.open("wb") as out, ParquetWriter(out, schema) as writer:  # by itself it opens no path but one in UTF-8
        while some := list(islice(rows, ROWS_AT_ONCE)):
            writer.write_table(pa.Table.from_pylist(some, schema))
