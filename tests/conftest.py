"""The same examples in every run: a failure here is a failure everywhere; one thread of linear algebra a process."""

from __future__ import annotations

import os

from hypothesis import settings

# before numpy is imported: OpenBLAS's further threads wait by spinning, most of the CPU time of small matrices
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")
