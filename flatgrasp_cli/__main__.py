"""The command `flatgrasp`, and `python -m flatgrasp_cli`."""

from __future__ import annotations

import gc
import sys

from flatgrasp_cli.interrupts import Interrupts, end_at_once, say_interrupted

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def main() -> NoReturn:
    """Run the command line as a process, which Ctrl-C ends quietly from here on."""
    interrupts = Interrupts()
    try:
        try:
            interrupts.install()
            from flatgrasp_cli.cli import run

            code = run()
        finally:
            interrupts.ignore()
    except BaseException:
        if not interrupts.asked:
            raise
        say_interrupted()  # whatever a library made of it
    if interrupts.asked:
        end_at_once()
    gc.freeze()  # as it ends, Python would look for garbage in all that was imported, a sixth of a short run's time
    sys.exit(code)


if __name__ == "__main__":
    main()
