"""Siconos: Moreau–Jean time stepping, and event driven (LSODAR with root finding), by Debian's own Python.

The worker of ``tests/benchmarks/peers`` runs there, in a process of its own that measures itself.
"""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tests.others.scenes.told import Answer, Peer, Told

sys.path[:0] = [str(Path(__file__).parents[2] / "benchmarks")]

from peers.siconos_event_driven import VERSION, asked  # noqa: E402

__all__ = ["PEERS", "VERSION"]
START, LIMIT = 2, 20_000  # seconds in which its Python starts, impacts
TOLERANCE = 1e4 * float(np.finfo(float).eps)  # Siconos' own; it gives up where time has fewer digits
LEAST, FEWER, MANY = 20_000, 4000, 100  # steps of a motion, of one with so many modes
EVENTS = (
    "`EventDriven`, `LsodarOSI`, `NewtonImpactNSL`, an event each 1/100 of the motion; the drive as a further degree "
    "of freedom"
)
STEPS = (
    "`TimeStepping`, `MoreauJeanOSI` (θ = ½), `NewtonImpactNSL`, 1 000 steps a period of the drive or the slowest "
    "mode, 20 000 in the motion at least (402 modes: 4 000)"
)


def prepare(told: Told, method: str) -> Callable[[], Answer]:
    """The job, which its process reads."""
    span = told.end - told.begin
    least = FEWER if told.size > MANY else LEAST
    step = min(told.cycle / 1000, span / least) if method == "time stepping" else span / 100
    point = {"drive": told.drive, "begin": told.begin, "end": told.end, "step": step}
    job: dict[str, Any] = {
        "omega": told.omega.tolist(), "zeta": told.zeta.tolist(), "load": told.load.tolist(),
        "static": told.static.tolist(), "amplitude": told.amplitude, "method": method, "limit": LIMIT,
        "stops": [[stop.row.tolist(), stop.gap, stop.restitution] for stop in told.stops],
        "tolerance": max(TOLERANCE, 100 * float(np.spacing(told.end))),
        "points": [point | {"start": [told.displacement.tolist(), told.velocity.tolist()]}],
    }  # fmt: skip

    def run() -> Answer:
        left, most = resource.getrlimit(resource.RLIMIT_CPU)
        ends = left if left == resource.RLIM_INFINITY else left - int(_spent()) + START
        limited = partial(resource.setrlimit, resource.RLIMIT_CPU, (ends, most))
        seconds, [[times, speeds, failed, last, least, greatest]] = asked(job, preexec_fn=limited)
        impacts = np.stack([times, speeds], axis=1).reshape(-1, 2)
        places = np.array([least, greatest, told.stops[0].row @ last[0]])
        return Answer(impacts, places, np.array(last), "gives up" if failed else "", seconds)

    return run


def _spent() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


PEERS = [
    Peer("Siconos, stepping", "siconos", STEPS, partial(prepare, method="time stepping")),
    Peer("Siconos, events", "siconos", EVENTS, partial(prepare, method="event driven")),
]
