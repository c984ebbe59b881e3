"""A command in a process of its own, forked from this warm one, with limits of time and memory."""

from __future__ import annotations

import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from progress import IDLE, Idleness

GIB = 2**30
HEADROOM = 2 * GIB  # of address space beyond the largest resident set allowed: libraries, stacks, arenas


@dataclass(frozen=True)
class Limits:
    """``cpu`` in seconds of CPU time, ``memory`` as the largest resident set in bytes."""

    cpu: int = 20
    memory: int = 2 * GIB


@dataclass(frozen=True)
class Ended:
    """How a process ended: exit ``code`` (negative: by that signal), what it printed, CPU seconds, resident bytes.

    ``idle``: it was ended because it waited for ``IDLE`` seconds.
    """

    code: int
    out: str
    err: str
    seconds: float
    resident: int
    idle: bool = False

    def fault(self, limits: Limits) -> str:
        """What no command may do; empty: nothing of it."""
        if self.idle:
            return f"waits for {IDLE:g} s without working"
        if -self.code in (signal.SIGXCPU, signal.SIGKILL):
            return f"no end in {limits.cpu} s of CPU time: {_last_call(self.err)}"
        if self.code < 0:
            return f"ended by {signal.Signals(-self.code).name}: {_last_call(self.err)}"
        if "Traceback" in self.err or self.code not in (0, 2):
            return f"exit {self.code}: {_last_call(self.err)}"
        if self.resident > limits.memory:
            return f"{self.resident / GIB:.1f} GiB"
        if self.code == 2 and not self.err.strip():
            return "exit 2 without a message"
        return ""


def run_limited(work: Callable[[], None], folder: Path, limits: Limits) -> Ended:
    """Run ``work`` in a fork of this process, in ``folder``."""
    before = set(folder.iterdir())
    sys.stdout.flush()
    child = os.fork()
    if not child:
        _child(work, folder, limits)
    code, usage, idle = _awaited(child)
    out, err = ((folder / name).read_text(errors="replace") for name in ("stdout", "stderr"))
    for name in {"stdout", "stderr"} - {path.name for path in before}:
        (folder / name).unlink()
    return Ended(code, out, err, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, idle)


def _child(work: Callable[[], None], folder: Path, limits: Limits) -> None:
    code = 1
    try:
        os.chdir(folder)
        for number, name in ((1, "stdout"), (2, "stderr")):
            os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
            setattr(sys, name, open(number, "w", encoding="utf-8", closefd=False))  # noqa: SIM115
        resource.setrlimit(resource.RLIMIT_AS, (limits.memory + HEADROOM,) * 2)
        resource.setrlimit(resource.RLIMIT_CPU, (limits.cpu, limits.cpu + 5))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        _say_where_on_time_out()
        code = _code_of(work)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _say_where_on_time_out() -> None:
    """Say on stderr where the process was when its time was up, then end it."""
    import faulthandler

    signal.signal(signal.SIGXCPU, signal.SIG_DFL)
    faulthandler.register(signal.SIGXCPU, all_threads=False, chain=True)
    faulthandler.enable()


def _code_of(work: Callable[[], None]) -> int:
    try:
        work()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _awaited(child: int) -> tuple[int, resource.struct_rusage, bool]:
    """Exit code of a child, what it used, and whether it was ended because it waited."""
    idleness, idle, pause = Idleness(child), False, 0.002
    while True:
        found, status, usage = os.wait4(child, os.WNOHANG)
        if found:
            return os.waitstatus_to_exitcode(status), usage, idle
        if idleness.lasts() and not idle:
            os.kill(child, signal.SIGKILL)
            idle = True
        time.sleep(pause)
        pause = min(0.05, 1.5 * pause)


def _last_call(err: str) -> str:
    """The innermost lines of a traceback, or of what faulthandler says."""
    lines = [line.strip() for line in err.strip().splitlines() if line.strip()]
    if "Traceback" in err:
        frames = [line for line in lines if line.startswith("File ")]
        return " < ".join([lines[-1], *reversed(frames[-3:])])[:700]
    frames = [line for line in lines if line.startswith("File ")]
    return " < ".join(frames[:4] or lines[-1:])[:700]
