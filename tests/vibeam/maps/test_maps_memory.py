"""Ten million points through store, gathering and picture, their flights stood in for: less than 1 GiB."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import resource, sys
from pathlib import Path
import numpy as np
import vibeam
from vibeam.maps import run as running
from vibeam.maps.block import DTYPES
from vibeam.report.maps.page import write_map

def stand_in(block):
    shape = (block.last - block.first, *block.grid.shape)
    whole = lambda name: np.ones(shape, DTYPES[name]) if name == "period" else np.zeros(shape, DTYPES[name])
    names = block.grid.quantities
    return {name: whole(name) if name in DTYPES else np.full(shape, float(block.first)) for name in names}

running.evaluate_here = stand_in
axes = [{"key": "drive.voltage", "from": 0.1, "to": 0.7, "points": 2500},
        {"key": "sweep.frequency", "from": 14, "to": 17, "points": 4000}]
table = {"axes": axes, "fidelities": ["sdof"], "direction": "up", "settle": 100, "hold": 20, "boundaries": False}
case = vibeam.load(sys.argv[1], set={"units": "SI", "map": {"m": table}, "reference": None})
found = vibeam.run_map(case, "m", sys.argv[2])
assert found.points == 10_000_000
assert found["sdof"]["period"].shape == (1250, 2000)
write_map(found, Path(sys.argv[2]).with_suffix(".png"))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


@pytest.mark.slow
def test_ten_million_points_take_less_than_a_gibibyte(tmp_path: Path) -> None:
    case = Path("cases/dtu_neutral.toml").absolute()
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, case, tmp_path / "m.h5"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) < 2**30
