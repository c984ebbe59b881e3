"""Which kernels a compiled entry is good for."""

from __future__ import annotations

from pathlib import Path

import vibeam.flight.kernels as kernels
from vibeam.flight.kernels import entry
from vibeam.flight.kernels.regimes import entry as regimes
from vibeam.flight.kernels.sources import EVERY, FLIGHT, digest


def test_a_change_in_any_kernel_is_noticed_wherever_it_lies(tmp_path: Path) -> None:
    folders = {file.parent.name for file in FLIGHT}
    assert {"kernels", "lanes", "roots"} == folders
    assert set(EVERY) - set(FLIGHT) == set((Path(kernels.__file__).parent / "regimes").glob("*.py"))
    one, other = tmp_path / "a.py", tmp_path / "b.py"
    one.write_text("x = 1")
    other.write_text("x = 2")
    assert digest((one,)) != digest((other,))


def test_plain_flight_stays_compiled_when_another_regime_changes() -> None:
    assert entry.move._cache._sources == digest(FLIGHT)
    assert regimes.move._cache._sources == digest(EVERY)
