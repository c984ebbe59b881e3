"""Ctrl-C in every command that computes: while its kernels are at work, on input that keeps them at it for minutes.

The signal is sent by a thread of the command's own process once its kernels have been at work for so many seconds.
From then on the process may use ``ALLOWED`` seconds of CPU time: one that goes on is ended by the system, with another
code. A busy machine changes nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

CASES = Path(__file__).parents[3] / "cases"
STOPPED, ALLOWED = 130, 10

WATCHED = """
import os, resource, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job inherits it as ignored
from vibeam.flight.engine import entries

usual, begun, spent = entries.EntryPoint.__call__, {{}}, [0.0]

def watched(entry, *given):
    begun[threading.get_ident()] = time.monotonic()
    try:
        return usual(entry, *given)
    finally:
        spent[0] += time.monotonic() - begun.pop(threading.get_ident())

def interrupt():
    while spent[0] + sum(time.monotonic() - each for each in list(begun.values())) < {need}:
        if time.process_time() > {latest}:
            break
        time.sleep(0.005)
    limit = int(time.process_time()) + 1 + {allowed}
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    print("interrupted", file=sys.stderr, flush=True)
    os.kill(os.getpid(), signal.SIGINT)

entries.EntryPoint.__call__ = watched
threading.Thread(target=interrupt, daemon=True).start()
sys.argv = ["vibeam", *{given!r}]
from vibeam.__main__ import main
main()
"""

LONG = ("sweep.settle=1000000", "sweep.hold=1000")
COMMANDS = {
    "run": ("run", "dtu_neutral.toml", *LONG),
    "run, slowly driven": ("run", "dtu_neutral.toml", "sweep.frequency.from='1e-3 Hz'", "sweep.frequency.to='2e-3 Hz'"),
    "run, many modes": ("run", "dtu_loose.toml", *LONG, "fidelity.beam.modes=36"),
    "run, linear stops": ("run", "rigs/tube.toml", *LONG),
    "run, several contacts": ("run", "rigs/two_stops.toml", *LONG),
    "run, random record": ("run", "inputs/tube_noise.toml", "record.duration='60 s'", "record.realisations=1"),
    "check": ("check", "dtu_neutral.toml", *LONG),
    "verdict": ("verdict", "dtu_neutral.toml", *LONG),
    "map": ("map", "maps/fig18.toml"),
    "map, stability": ("map", "dtu_neutral.toml", "--picture", "stability", "--points", "201"),
    "fit": ("fit", "synthetic/fit.toml"),
    "uncertainty": ("uncertainty", "uncertain/neutral.toml", *LONG),
}
CLOSED = {"map, stability", "fit"}  # closed forms, in Python: interrupted after 2 s of CPU time
MORE = {  # the same kernels, from elsewhere
    "verdict, effects": ("verdict", "rigs/relay.toml", "--only", "effects", *LONG),
    "verdict, solvers": ("verdict", "dtu_neutral.toml", "--only", "solvers", *LONG),
    "verdict, modes": ("verdict", "rigs/harvester.toml", "--only", "modes", *LONG),
    "run, relay": ("run", "rigs/relay.toml", *LONG),
    "run, chirp": ("run", "dtu_swept.toml", *LONG),
    "run, relay's shock": ("run", "inputs/relay_shock.toml", "record.duration='2000 s'"),
    "map, basins": ("map", "maps/basins.toml"),
    "map, doubling": ("map", "maps/doubling.toml"),
    "study of cost": ("study", "cost", "dtu_neutral.toml", *LONG),
    "study of effects": ("study", "influence", "dtu_neutral.toml", *LONG),
}


def interrupted(given: tuple[str, ...], folder: Path, need: float, latest: float) -> subprocess.CompletedProcess[str]:
    """A command whose settings stand by themselves, interrupted after so many seconds in kernels, or of CPU time."""
    words = []
    for word in given:
        words += ["--set", word] if "=" in word else [str(CASES / word) if word.endswith(".toml") else word]
    script = WATCHED.format(need=need, latest=latest, allowed=ALLOWED, given=words)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    return subprocess.run(
        [sys.executable, "-c", script], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def check_it_ends(given: tuple[str, ...], folder: Path, need: float, latest: float) -> None:
    done = interrupted(given, folder, need, latest)
    assert "interrupted" in done.stderr
    assert done.returncode == STOPPED, done.stderr[-2000:]
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("name", COMMANDS)
def test_ctrl_c_ends_a_command_at_work(name: str, tmp_path: Path) -> None:
    check_it_ends(COMMANDS[name], tmp_path, 0.1, 2.0 if name in CLOSED else 1000.0)


@pytest.mark.slow
@pytest.mark.parametrize("need", [0.01, 1.0, 5.0])
@pytest.mark.parametrize("name", [name for name in {**COMMANDS, **MORE} if name not in CLOSED])
def test_at_other_times_and_in_all_others(name: str, need: float, tmp_path: Path) -> None:
    check_it_ends({**COMMANDS, **MORE}[name], tmp_path, need, 1000.0)
