"""One thread for each process: planning is many small matrix products, which more threads only make wait."""

from __future__ import annotations

import os

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")


def one_thread_each() -> None:
    """Have numeric libraries start one thread, if nobody said otherwise; before they are imported, or for children."""
    for name in VARIABLES:
        os.environ.setdefault(name, "1")
