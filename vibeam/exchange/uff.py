"""Modes from universal files: data at nodes (data set 55), read by pyuff, which is the extra ``lab``.

Normal modes have a frequency, a modal mass and a damping ratio; complex ones (analysis types 3 and 7) an eigenvalue
s = −ζω + iω√(1−ζ²) and a modal A, which is 2iω√(1−ζ²) m where the damping is proportional (R. J. Allemang, Vibrations:
Analytical and Experimental Modal Analysis, UC-SDRL, 1999, §3).
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.data_sets import FileUnits, data_sets, units_of
from vibeam.exchange.files import LARGEST_TEXT, FormatError, State, read_by, state_of
from vibeam.exchange.matrices.entries import Label
from vibeam_models.arrays import Array

MISSING = "pyuff reads it, and is not installed: pip install 'vibeam[lab]', or write frequencies and shapes in the case"
NORMAL, COMPLEX = 2, (3, 7)  # analysis types
TWISTED = 0.1  # share of a complex shape that is out of phase, up to which it is taken as real


@dataclass(frozen=True, eq=False)
class FileModes:
    """Modes (n,): ``frequency`` Hz, ``damping`` ratios (None: not said), ``mass`` kg (0: not said).

    ``shapes`` by node and direction; ``format``: and what of the file was taken as what.
    """

    frequency: Array
    damping: Array | None
    mass: Array
    shapes: Mapping[Label, Array]
    format: str

    def taken(self, file: str) -> str:
        """The line that says what was taken of the ``file``."""
        nodes, (first, last) = len({node for node, _ in self.shapes}), self.frequency[[0, -1]]
        return f"taken: {file}, {self.format}, {len(self.frequency)} modes, {first:.5g} to {last:.5g} Hz, {nodes} nodes"


def read_modes(path: Path) -> FileModes:
    """The modes of a file by ascending frequency; FormatError where there are none, or pyuff is not installed."""
    return _read(path, state_of(path, LARGEST_TEXT))


@lru_cache(maxsize=8)
def _read(path: Path, state: State) -> FileModes:
    units = units_of(data_sets(path))
    modes = [_mode(each, units) for each in _at_nodes(path) if each["analysis_type"] in (NORMAL, *COMPLEX)]
    if not modes:
        raise FormatError("has no modes: a data set 55 of analysis type 2, 3 or 7 is needed")
    modes.sort(key=lambda mode: float(mode[0]))
    labels = set(modes[0][3])
    if any(set(mode[3]) != labels for mode in modes):
        raise FormatError("its modes are of different nodes: export them of the same")
    frequency, damping, mass = (np.array([mode[part] for mode in modes]) for part in range(3))
    shapes = {label: np.array([mode[3][label] for mode in modes]) for label in sorted(labels)}
    twisted = 100 * max(mode[4] for mode in modes)
    said = (
        f"universal file, shapes up to {twisted:.2g} % out of phase taken as real"
        if twisted > 1e-3
        else "universal file"
    )
    return FileModes(frequency, damping, mass, shapes, said)


def _at_nodes(path: Path) -> list[dict[str, Any]]:
    """Data sets 55 of a file; FormatError of another one, and where pyuff is not installed."""
    try:
        import pyuff
    except ImportError:
        raise FormatError(MISSING) from None
    quiet = contextlib.redirect_stdout(io.StringIO())
    with read_by("is no universal file that can be read"), quiet, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = pyuff.UFF(str(path))
        return [file.read_sets(int(each)) for each in np.flatnonzero(file.get_set_types() == 55)]


def _mode(
    data: dict[str, Any], units: FileUnits
) -> tuple[float, float, float, dict[Label, float], float]:  # fmt: skip
    """Frequency, damping ratio, modal mass, shape, the share of it that was out of phase; receptances are in SI."""
    shape = {
        (int(node), direction): value * (units.length if direction > 3 else 1.0)
        for direction in range(1, 7)
        for node, value in zip(data["node_nums"], data.get(f"r{direction}", ()), strict=False)
    }
    scale = units.length / units.force
    if data["analysis_type"] == NORMAL:
        damping = data["modal_damp_vis"] or data["modal_damp_his"] / 2
        mass, frequency = float(data["modal_m"]) * scale, float(data["freq"])
        return frequency, float(damping), mass, *_real(shape, frequency)
    eigenvalue = complex(data["eig"])
    mass = abs(complex(data["modal_a"]) / (2j * eigenvalue.imag)) * scale if eigenvalue.imag else 0.0
    frequency = abs(eigenvalue) / (2 * np.pi)
    return frequency, -eigenvalue.real / abs(eigenvalue), mass, *_real(shape, frequency)


def _real(shape: Mapping[Label, Any], frequency: float) -> tuple[dict[Label, float], float]:
    """A shape turned into phase, and the share that is out of it; FormatError where it is too far from being real."""
    values = np.array(list(shape.values()), dtype=complex)
    turned = values * np.exp(-0.5j * np.angle(np.sum(values**2)))
    share = float(np.linalg.norm(turned.imag) / (np.linalg.norm(turned) or 1.0))
    if share > TWISTED:
        said = f"the shape at {frequency:.5g} Hz is complex, {100 * share:.2g} % of it out of phase"
        raise FormatError(f"{said}: real modes are needed, export the file without this one")
    return dict(zip(shape, turned.real.tolist(), strict=True)), share
