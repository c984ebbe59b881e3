"""A program run in a process of its own, so that one that never ends fails a test instead of stopping them all."""

from __future__ import annotations

import os
import subprocess
import sys

PATIENCE = 150  # seconds, kernels compiled anew included


def run_apart(program: str) -> str:
    """What the program prints; AssertionError where it fails or does not end."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    try:
        done = subprocess.run(
            [sys.executable, "-c", program],
            env=environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise AssertionError("it never ends") from None
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
