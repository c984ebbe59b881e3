"""A program run in a process of its own, so that one that never ends fails a test instead of stopping them all."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

PATIENCE = 600  # seconds of CPU time, kernels compiled anew included: a busy machine changes nothing
LIMITED = """
import resource, signal
resource.setrlimit(resource.RLIMIT_CPU, ({limit}, {limit}))
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job inherits it as ignored
"""


def run_apart(program: str) -> str:
    """What the program prints; AssertionError where it fails or does not end."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    done = subprocess.run(
        [sys.executable, "-c", LIMITED.format(limit=PATIENCE) + program],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode not in (-signal.SIGKILL, -signal.SIGXCPU), "it never ends"
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
