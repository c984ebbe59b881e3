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

import numpy as np

from peers.job import LIMIT, Answer, Entry, Impacts, Job

PYTHON = os.environ.get("SICONOS_PYTHON", "/usr/bin/python3")
WORKER = Path(__file__).with_name("siconos_worker.py")


def version() -> str:
    """Of Siconos; ImportError where there is none."""
    ask = "import siconos.kernel as k; print(getattr(k, '__version__', ''))"
    try:
        done = subprocess.run([PYTHON, "-c", ask], capture_output=True, text=True, timeout=120)
    except OSError as error:
        raise ImportError(f"SICONOS_PYTHON = {PYTHON}: {error}") from error
    if done.returncode:
        raise ImportError(f"no Siconos for {PYTHON}: install Debian's python3-siconos, or set SICONOS_PYTHON")
    return done.stdout.strip() or "as in Debian"


def prepare(job: Job, method: str, steps: int) -> Callable[[], Answer]:
    """The worker's own CPU time, its start not counted."""
    asked = {
        "omega": job.omega.tolist(), "zeta": job.zeta.tolist(), "contact": job.contact.tolist(),
        "load": job.load.tolist(), "gap": job.gap, "restitution": job.restitution, "amplitude": job.amplitude,
        "grid": job.grid.tolist(), "starts": job.starts.tolist(), "periods": job.periods, "method": method,
        "steps": steps, "limit": LIMIT * job.periods,
    }  # fmt: skip
    text = json.dumps(asked)

    def run() -> Answer:
        done = subprocess.run([PYTHON, str(WORKER)], input=text, capture_output=True, text=True)
        if done.returncode:
            lines = done.stderr.strip().splitlines()
            raise RuntimeError(lines[-1] if lines else f"it ended with {done.returncode}")
        answer = json.loads(done.stdout)
        return answer["seconds"], [Impacts(np.array(t), np.array(v), failed) for t, v, failed in answer["points"]]

    return run


VERSION = version()
ENTRIES = [
    Entry("Siconos", "event driven", partial(prepare, method="event driven", steps=0), "siconos"),
    Entry("Siconos", "Moreau-Jean 2000", partial(prepare, method="time stepping", steps=2000), "siconos", most_modes=1),
]
