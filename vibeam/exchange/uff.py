"""Modes from universal files: data at nodes (data set 55), read by pyuff, which is the extra ``lab``.

Normal modes have a frequency, a modal mass and a damping ratio; complex ones (analysis types 3 and 7) an eigenvalue
s = −ζω + iω√(1−ζ²) and a modal A, which is 2iω√(1−ζ²) m where the damping is proportional (R. J. Allemang, Vibrations:
Analytical and Experimental Modal Analysis, UC-SDRL, 1999, §3).
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Mapping, Sequence
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
NEAR = 0.01  # of a frequency, within which a mode is the one to be skipped
TOLD = 1e-3  # share of a complex shape that is out of phase, from which on it is told
TWISTED = 0.1  # share up to which it is taken as real


@dataclass(frozen=True, eq=False)
class FileModes:
    """Modes (n,): ``frequency`` Hz, ``damping`` ratios (None: not said), ``mass`` kg (0: not said).

    ``shapes`` by node and direction; ``format``: and what of the file was taken as what.
    """

    frequency: Array
    damping: Array | None
    mass: Array
    shapes: Mapping[Label, Any]
    format: str

    def taken(self, file: str) -> str:
        """The line that says what was taken of the ``file``."""
        nodes, (first, last) = len({node for node, _ in self.shapes}), self.frequency[[0, -1]]
        return f"taken: {file}, {self.format}, {len(self.frequency)} modes, {first:.5g} to {last:.5g} Hz, {nodes} nodes"

    def without(self, skip: Sequence[float]) -> FileModes:
        """The modes but those nearest to ``skip`` (Hz), each within a hundredth; FormatError where there is none."""
        left = set(range(len(self.frequency)))
        for each in skip:
            nearest = int(np.argmin(np.abs(self.frequency - each)))
            if abs(self.frequency[nearest] - each) > NEAR * self.frequency[nearest]:
                there = ", ".join(f"{one:.5g}" for one in self.frequency.tolist())
                raise FormatError(f"has no mode at {each:g} Hz to skip: its modes are at {there} Hz")
            left.discard(nearest)
        if not left:
            raise FormatError("has no modes left: all are in skip")
        kept = sorted(left)
        damping = None if self.damping is None else self.damping[kept]
        shapes = {label: values[kept] for label, values in self.shapes.items()}
        return FileModes(self.frequency[kept], damping, self.mass[kept], shapes, self.format)

    def real(self) -> FileModes:
        """The modes with their shapes turned into phase; FormatError where one is too far from being real."""
        values = np.array(list(self.shapes.values()), dtype=complex)
        turned = values * np.exp(-0.5j * np.angle(np.sum(values**2, axis=0)))
        share = np.linalg.norm(turned.imag, axis=0) / np.maximum(np.linalg.norm(turned, axis=0), 1e-300)
        for number, (frequency, out) in enumerate(zip(self.frequency.tolist(), share.tolist(), strict=True), 1):
            if out > TWISTED:
                said = f"mode {number} ({frequency:.5g} Hz) is complex, {100 * out:.2g} % of it out of phase"
                cure = f'at most {100 * TWISTED:g} % are taken as real: leave it out, skip = ["{frequency:.5g} Hz"]'
                raise FormatError(f"{said}: {cure}")
        told = f", shapes up to {100 * share.max():.2g} % out of phase taken as real" * bool(share.max() > TOLD)
        shapes = dict(zip(self.shapes, turned.real, strict=True))
        return FileModes(self.frequency, self.damping, self.mass, shapes, f"{self.format}{told}")


def read_modes(path: Path, skip: Sequence[float] = ()) -> FileModes:
    """The modes of a file by ascending frequency, but those at ``skip`` (Hz), taken as real.

    FormatError where there are none, one is too far from being real, or pyuff is not installed.
    """
    return _read(path, state_of(path, LARGEST_TEXT)).without(skip).real()


@lru_cache(maxsize=8)
def _read(path: Path, state: State) -> FileModes:
    """All modes, shapes complex."""
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
    return FileModes(frequency, damping, mass, shapes, "universal file")


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


def _mode(data: dict[str, Any], units: FileUnits) -> tuple[float, float, float, dict[Label, Any]]:
    """Frequency, damping ratio, modal mass, shape, such that all receptances are in SI."""
    shape = {
        (int(node), direction): value * (1 / units.length if direction > 3 else 1.0)
        for direction in range(1, 7)
        for node, value in zip(data["node_nums"], data.get(f"r{direction}", ()), strict=False)
    }
    scale = units.force / units.length
    if data["analysis_type"] == NORMAL:
        damping = data["modal_damp_vis"] or data["modal_damp_his"] / 2
        return float(data["freq"]), float(damping), float(data["modal_m"]) * scale, shape
    eigenvalue = complex(data["eig"])
    mass = complex(data["modal_a"]) / (2j * eigenvalue.imag) if eigenvalue.imag else 0j
    return abs(eigenvalue) / (2 * np.pi), -eigenvalue.real / abs(eigenvalue), abs(mass) * scale, shape
