"""Siconos: event driven (LSODAR with root finding) and Moreau–Jean time stepping.

It is no Python package but Debian's python3-siconos, built for Debian's own Python: it runs there, in a process of its
own that measures itself. SICONOS_PYTHON names another interpreter, or a script that starts one.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from peers.job import LIMIT, Answer, Entry, Impacts, Job

PYTHON = os.environ.get("SICONOS_PYTHON", "/usr/bin/python3")
WORKER = Path(__file__).with_name("siconos_worker.py")


def version() -> str:
    """Of Debian's package, since its module tells none; ImportError where there is no Siconos."""
    try:
        done = subprocess.run([PYTHON, "-c", "import siconos.kernel"], capture_output=True, text=True, timeout=120)
        if done.returncode:
            raise ImportError(f"no Siconos for {PYTHON}: install Debian's python3-siconos, or set SICONOS_PYTHON")
        ask = ["dpkg-query", "-W", "-f", "${Version}", "python3-siconos"]
        told = subprocess.run(ask, capture_output=True, text=True)
    except OSError as error:
        raise ImportError(f"SICONOS_PYTHON = {PYTHON}: {error}") from error
    return told.stdout.strip() or "version not told"


def asked(told: dict[str, Any], **how: Any) -> tuple[float, list[list[Any]]]:
    """The worker's own CPU time, its start not counted, and its motions; ``how``: further arguments of the process."""
    done = subprocess.run([PYTHON, str(WORKER)], input=json.dumps(told), capture_output=True, text=True, **how)
    if done.returncode < 0:
        raise TimeoutError(f"ended by signal {-done.returncode}")
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise RuntimeError(lines[-1] if lines else f"it ended with {done.returncode}")
    answer = json.loads(done.stdout)
    return answer["seconds"], answer["points"]


def prepare(job: Job, method: str, steps: int) -> Callable[[], Answer]:
    """``steps`` a drive period."""
    points = [
        {"drive": omega, "start": start, "begin": 0.0, "end": job.end(omega), "step": 2 * np.pi / omega / steps}
        for omega, start in zip(job.grid.tolist(), job.starts.tolist(), strict=True)
    ]
    told = {
        "omega": job.omega.tolist(), "zeta": job.zeta.tolist(), "load": job.load.tolist(), "amplitude": job.amplitude,
        "static": [0.0] * job.size, "stops": [[job.contact.tolist(), job.gap, job.restitution]], "points": points,
        "method": method, "limit": LIMIT * job.periods,
    }  # fmt: skip

    def run() -> Answer:
        seconds, motions = asked(told)
        return seconds, [Impacts(np.array(t), np.array(v), failed) for t, v, failed, *_ in motions]

    return run


VERSION = version()
ENTRIES = [
    Entry("Siconos", "event driven", partial(prepare, method="event driven", steps=1), "siconos"),
    Entry("Siconos", "Moreau-Jean 2000", partial(prepare, method="time stepping", steps=2000), "siconos", most_modes=1),
]
