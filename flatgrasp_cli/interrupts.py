"""Ctrl-C ends the process with 130 and one line, whenever it comes.

Python raises KeyboardInterrupt wherever it happens to be. In the middle of an import a C extension may turn that into
an ImportError, in the middle of removing a temporary folder the folder stays, and in a callback of the interpreter's
own it is printed and forgotten. So the handler here waits for the end of an import or of such a removal, asks again for
what was lost, and raises only once: a second Ctrl-C ends the process on the spot. Nothing is lost by that, for files
are written beside their place and renamed.

This module is loaded before anything that takes time, and loads next to nothing itself.
"""

from __future__ import annotations

import os
import signal
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import NoReturn

INTERRUPTED = 130
AGAIN_S = 0.02
WAITED_FOR = {"<frozen importlib._bootstrap>", os.path.join(os.path.dirname(os.__file__), "tempfile.py")}  # noqa: PTH118, PTH120
"""Where the code stands whose end is waited for: pathlib would take longer to load than all the rest."""
STDERR = 2


class Interrupts:
    """What becomes of SIGINT in the main thread; `asked` says whether one came."""

    def __init__(self) -> None:
        self.asked = False

    def install(self) -> None:
        """Take SIGINT over, unless whoever started the process has it ignored, or the system has no timers."""
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler and hasattr(signal, "setitimer"):
            signal.signal(signal.SIGALRM, self._raise)
            signal.signal(signal.SIGINT, self._interrupt)
            sys.unraisablehook = self._unraisable

    def ignore(self) -> None:
        """All is said and done: what is left is Python's own end, which takes no KeyboardInterrupt."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if hasattr(signal, "SIGALRM"):
            signal.signal(signal.SIGALRM, signal.SIG_IGN)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            say_interrupted()
            os._exit(INTERRUPTED)
        self.asked = True
        self._raise(number, frame)

    def _raise(self, _number: int, frame: FrameType | None) -> None:
        if _must_end_first(frame):
            self._again()
        else:
            raise KeyboardInterrupt

    def _unraisable(self, lost: sys.UnraisableHookArgs) -> None:
        if issubclass(lost.exc_type, KeyboardInterrupt):
            self._again()
        else:
            sys.__unraisablehook__(lost)

    @staticmethod
    def _again() -> None:
        signal.setitimer(signal.ITIMER_REAL, AGAIN_S)


def _must_end_first(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename in WAITED_FOR:
            return True
        frame = frame.f_back
    return False


def say_interrupted() -> None:
    """One line on stderr, whatever state Python's own streams are in."""
    try:
        os.write(STDERR, b"flatgrasp: interrupted\n")
    except OSError:  # nobody listens
        return


def end_at_once() -> NoReturn:
    """End the interrupted process without Python's own end, which waits for workers.

    One that was stopped amid a message never reads the rest of it, and all files are whole by now.
    """
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):  # nobody listens
            continue
    os._exit(INTERRUPTED)
