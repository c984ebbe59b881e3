"""Cost of a solid's modes: 100 000 coordinates, a strip and a chunky block, 20 modes by scipy alone.

    python tests/benchmarks/solid.py [--out tests/benchmarks/results/solid.json]

Quadratic hexahedra of steel, one face held. Each row in a process of its own, CPU time and largest memory of which are
kept: order, factors, modes with their count. Beside them the peer, SuperLU as scipy has it, factors the same matrix
once: by minimum degree and in our order (it gets no modes).
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam_models.beams.stretch import Material
from vibeam_models.sparse import SparseStructure

HERE = Path(__file__).parent
MODES = 20
BODIES = {  # elements, lengths in m
    "strip": ((160, 10, 2), (0.32, 0.06, 0.006)),
    "block": ((16, 16, 16), (0.1, 0.1, 0.1)),
    "small block": ((8, 8, 8), (0.1, 0.1, 0.1)),
}
LIMIT = 200  # s of CPU time, beyond which a peer is given up


def matrices(name: str) -> tuple[Any, Any]:
    """K and M of a body, held at x = 0."""
    from skfem import MeshHex

    counts, lengths = BODIES[name]
    mesh = MeshHex.init_tensor(*(np.linspace(0, size, n + 1) for size, n in zip(lengths, counts, strict=True)))
    elements = SolidElements(mesh)
    steel = (Material(210e9, 7850.0, 0.3),)
    index, density = np.zeros(mesh.t.shape[1], dtype=int), np.full(mesh.t.shape[1], 7850.0)
    free = np.flatnonzero(np.repeat(elements.points[0] > 1e-9, 3))
    return tuple(
        each.tocsc()[free][:, free].tocsc() for each in (elements.stiffness(steel, index), elements.mass(density))
    )


def own(name: str) -> dict[str, Any]:
    """Modes of a body, in this process."""
    K, M = matrices(name)
    size = K.shape[0]
    row = np.eye(1, size)[0]
    structure = SparseStructure(M, 0 * M, K, row, np.zeros(size), row)
    clock = [time.process_time()]
    fronts = structure.fronts
    clock.append(time.process_time())
    regular = structure.stiffness_factor.regular
    clock.append(time.process_time())
    modes = structure.modes(MODES)
    clock.append(time.process_time())
    assert fronts is not None
    assert regular
    off = K @ modes.shapes - M @ (modes.shapes * modes.omega**2)
    parts = dict(zip(("order", "factor", "modes"), np.diff(clock).tolist(), strict=True))
    wrong = float(np.max(np.linalg.norm(off, axis=0) / np.linalg.norm(K @ modes.shapes, axis=0)))
    return {
        "coordinates": size,
        **parts,
        "told gigabytes": fronts.bytes() / 1e9,
        "residual": wrong,
        "entries": sum((f.end - f.begin) * (f.end - f.begin + len(f.border)) for f in fronts.fronts),
    }


def superlu(name: str, order: str) -> dict[str, Any]:
    """One factor by SuperLU, in this process: ``order`` "minimum degree" or "dissection", which is ours."""
    from scipy.sparse.linalg import splu

    K, M = matrices(name)
    size, spec = K.shape[0], "MMD_AT_PLUS_A"
    if order == "dissection":
        row = np.zeros(size)
        fronts = SparseStructure(M, 0 * M, K, row, row, row).fronts
        assert fronts is not None
        K, spec = K[fronts.order][:, fronts.order].tocsc(), "NATURAL"
    begun = time.process_time()
    found = splu(K, permc_spec=spec, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return {"coordinates": size, "factor": time.process_time() - begun, "entries": int(found.nnz)}


def row(name: str, by: str) -> dict[str, Any]:
    """One row with its memory."""
    found = own(name) if by == "fronts" else superlu(name, by)
    return {"body": name, "by": by, **found, "gigabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6}


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "solid.json")
    parser.add_argument("--row", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.row:
        print(json.dumps(row(*given.row)))
        return
    before, found = os.getloadavg(), []
    for name in BODIES:
        for by in ("fronts", "minimum degree", "dissection"):
            if name == "block" and by != "fronts":
                continue  # minutes, and 8 to 10 GB
            command = ["bash", "-c", f'ulimit -t {LIMIT}; exec "$@"', "-", sys.executable, __file__, "--row", name, by]
            done = subprocess.run(command, capture_output=True, check=False, text=True)
            found.append(
                json.loads(done.stdout) if not done.returncode else {"body": name, "by": by, "given up": LIMIT}
            )
            print(found[-1], flush=True)
    load = {"before": before, "after": os.getloadavg()}
    given.out.write_text(json.dumps({"rows": found, "load": load}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
