"""What batch costs and gains: frames per second of one worker, two workers and a Dask cluster of two.

    python benchmarks/batch_speed.py [--frames 120] [--repeat 3] [--cluster]

The frames are those of sample_data/pan_ros2 over and over, as PointCloud2 in a rosbag2. A loop is the same job without
batch: read, plan, make the JSON; it runs in turn with one worker, which is this process, too. Starting others takes
some seconds, whatever they do then, so each rate is that of the frames that a long run has more than a short one.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median

from flatgrasp_cli.threads import one_thread_each

one_thread_each()  # before numpy is imported: a loop that uses both cores is no measure for one worker

from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from flatgrasp_cli import load_gripper, load_settings
from flatgrasp_cli.batch.executors import Workers
from flatgrasp_cli.batch.inputs import find_inputs
from flatgrasp_cli.batch.run import Progress, run
from flatgrasp_cli.batch.store import Store
from flatgrasp_cli.job import Job
from flatgrasp_cli.placing import Workcell
from flatgrasp_cli.results.document import to_document, to_json

SAMPLE = Path(__file__).resolve().parent.parent / "sample_data" / "pan_ros2"
START_NS, PERIOD_NS, SHORT, LOOPS = 1_700_000_000 * 10**9, 100_000_000, 32, 3


def record(path: Path, frames: int) -> Path:
    """The sample's clouds over and over."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Reader(SAMPLE) as reader:
        topic = next(connection for connection in reader.connections if "points" in connection.topic)
        clouds = [data for _, _, data in reader.messages([topic])]
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(topic.topic, topic.msgtype, typestore=store)
        for k in range(frames):
            writer.write(connection, START_NS + k * PERIOD_NS, clouds[k % len(clouds)])
    return path


def in_a_loop(job: Job, path: Path) -> float:
    """Seconds of planning all frames without batch."""
    began = time.perf_counter()
    for cloud, read_ms in job.clouds(str(path)):
        to_json(to_document(job.plan(cloud), read_ms))
    return time.perf_counter() - began


def in_batch(workers: Workers, job: Job, path: Path) -> float:
    """Seconds of planning all frames with batch."""
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder))
        store.prepare(job, plots=False, force=False)
        began = time.perf_counter()
        run(job, find_inputs([str(path)]), store, workers, Progress(print, lambda _: None), plots=False)
        return time.perf_counter() - began


def main() -> None:
    """Print frames per second, and ratios to the loop and to one worker."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--cluster", action="store_true", help="measure a local Dask cluster, too")
    options = parser.parse_args()
    job = replace(Job(load_gripper("pr2"), load_settings(), Workcell()), top=1)
    ways: dict[str, Callable[[Job, Path], float]] = {
        "1 worker": partial(in_batch, Workers(1)),
        "2 workers": partial(in_batch, Workers(2)),
    }
    if options.cluster:
        ways["Dask, 2 workers"] = partial(in_batch, Workers(2, "local"))
    times: dict[str, list[float]] = {name: [] for name in ways}
    overhead: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        short, long = record(Path(folder, "short"), SHORT), record(Path(folder, "long"), SHORT + options.frames)
        in_a_loop(job, short)  # the first time imports
        for _ in range(options.repeat):
            for name, way in ways.items():
                times[name].append(way(job, long) - way(job, short))
            overhead += [ways["1 worker"](job, short) / in_a_loop(job, short) for _ in range(LOOPS)]
    rates = {name: options.frames / median(seconds) for name, seconds in times.items()}
    for name, rate in rates.items():
        print(f"{name:16s} {rate:6.2f} frames/s   {rate / rates['1 worker']:.2f} × one worker")
    print(f"overhead of batch over a loop, per frame: {100 * (median(overhead) - 1):.1f} %")


if __name__ == "__main__":
    main()
