"""``python -m vibeam`` is the command ``vibeam``."""

from __future__ import annotations

import gc
import os

INTERRUPTED = 130


def main() -> None:
    """The entry point. Ctrl-C outside the command, at its import or after its end, silently ends the process.

    Before the first line here it is the interpreter that is interrupted, which says so with a traceback.
    """
    try:
        import signal

        usual = signal.getsignal(signal.SIGINT)  # ignored in a background job: it stays so
        outside = _leave if usual is signal.default_int_handler else usual
        signal.signal(signal.SIGINT, outside)
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # tiny matrices: more threads take hundreds of times as long
        gc.set_threshold(10_000)  # what imports make is no garbage: the usual 700 search it over and over
        from vibeam.cli.entry import main as command

        signal.signal(signal.SIGINT, usual)
        try:
            command()
        finally:
            signal.signal(signal.SIGINT, outside)
            gc.freeze()  # nothing is searched for garbage at the end of the process
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None


def _leave(*_: object) -> None:
    """End the process where it is: an exception would be lost, or turned into another, in code that is imported."""
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    main()
