"""Where the work is done, behind the one interface of concurrent.futures: here, on all cores, or on a Dask cluster."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import wait
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, TypeVar

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.threads import one_thread_each

T = TypeVar("T")

LOCAL_CLUSTER = "local"
EXTRA = "pip install 'flatgrasp[cluster]'"
WORKER_MEMORY = {"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 1 << 28}
"""Dask has workers give every freed array back to the system at once: planning would take half as long again."""
CLOSING_S = 5.0
"""Seconds that the queues of ended workers have to close: usually some milliseconds, but a message may be cut off."""


class InProcess(Executor):
    """Does the work at once, in the caller's own thread."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Call `fn` and give back a future that is done."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 - it belongs to whoever asks the future
            future.set_exception(error)
        return future


@dataclass(frozen=True, slots=True)
class Workers:
    """So many worker processes; with `cluster`, an address or "local", those of a Dask cluster."""

    count: int
    cluster: str | None = None

    @contextmanager
    def open(self) -> Iterator[tuple[Executor, int]]:
        """Open an executor; with it comes how many calls it does at a time.

        When it closes, nothing is waited for: what is still at work is stopped.
        """
        if self.cluster is not None:
            with _dask(self.cluster, self.count) as opened:
                yield opened
        elif self.count == 1:
            yield InProcess(), 1
        else:
            with _processes(self.count) as executor:
                yield executor, self.count


@contextmanager
def _processes(workers: int) -> Iterator[Executor]:
    one_thread_each()
    pool = ProcessPoolExecutor(workers, mp_context=_Workplace(), initializer=_end_with_parent)
    try:
        yield pool
    finally:
        for process in multiprocessing.active_children():
            process.terminate()
        # an interrupted process ends at once, and what its queues hold until then would be told of as leaked
        closing = threading.Thread(target=pool.shutdown, kwargs={"cancel_futures": True}, daemon=True)
        closing.start()
        closing.join(CLOSING_S)


class _Worker(SpawnProcess):
    """Never gets a Ctrl-C, from its first moment on: that is for the coordinator."""

    def start(self) -> None:
        if not hasattr(signal, "pthread_sigmask"):  # Windows sends it to the console's processes by other ways
            super().start()
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which the new process inherits
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Workplace(SpawnContext):
    """Workers are spawned, not forked: libraries with threads of their own do not survive a fork."""

    Process = _Worker


def _end_with_parent() -> None:
    """Have this process end when its coordinator does, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def end_after_it() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=end_after_it, daemon=True).start()


@contextmanager
def _dask(cluster: str, workers: int) -> Iterator[tuple[Executor, int]]:
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise UsageError(f"--cluster needs Dask: {EXTRA}") from error
    logging.getLogger("distributed").setLevel(logging.ERROR)  # it tells of every worker's coming and going
    one_thread_each()
    try:
        if cluster == LOCAL_CLUSTER:
            with dask.config.set(WORKER_MEMORY):
                here = LocalCluster(n_workers=workers, threads_per_worker=1)
            client = Client(here)
        else:
            here, client = None, Client(cluster, timeout="10s")
    except (OSError, ValueError) as error:
        raise UsageError(f"--cluster {cluster}: cannot be reached: {error or type(error).__name__}") from error
    try:
        yield client.get_executor(), max(1, sum(client.nthreads().values()))
    finally:
        with suppress(TimeoutError):  # they go on closing, and nothing of ours waits for that
            client.close(timeout=1)
        if here is not None:
            with suppress(TimeoutError):
                here.close(timeout=5)
