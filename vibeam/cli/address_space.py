"""A limited address space (``ulimit -v``): OpenBLAS, short of it, may ask for its buffers for ever.

It is loaded with NumPy and again with SciPy, and takes buffers for every thread at once. So a limit that is too narrow
for them is refused before they are loaded.
"""

from __future__ import annotations

import os

MIB = 2**20

OWN, EACH = 400 * MIB, 48 * MIB  # of a small run, and of each thread of OpenBLAS in both libraries

MOST = 64  # threads of OpenBLAS as it is distributed

COUNTS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")


def refusal() -> str:
    """Why no command can run in the address space that there is; empty where it may suffice."""
    try:
        import resource
    except ImportError:  # no limit of this kind on this system
        return ""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return ""
    count = _threads()
    needed = OWN + EACH * count
    if limit >= needed:
        return ""
    fewer = f", or {(OWN + EACH) // MIB} MiB with {COUNTS[0]}=1" if count > 1 else ""
    return f"the address space is limited to {limit // MIB} MiB (ulimit -v): allow {needed // MIB} MiB{fewer}"


def _threads() -> int:
    """Threads that OpenBLAS will have."""
    given = [os.environ[name] for name in COUNTS if os.environ.get(name, "").isdecimal()]
    try:
        there = len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        there = os.cpu_count() or 1
    return max(1, min(int(given[0]) if given else there, there, MOST))
