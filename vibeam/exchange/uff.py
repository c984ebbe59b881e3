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

from vibeam.exchange.curves.taken import Taken, TakenColumn
from vibeam.exchange.curves.told import tell
from vibeam.exchange.files import LARGEST_TEXT, FormatError, State, read_by, state_of
from vibeam.exchange.matrices.entries import Label
from vibeam_models.arrays import Array

MISSING = "pyuff reads it, and is not installed: pip install 'vibeam[lab]', or "
NORMAL, COMPLEX = 2, (3, 7)  # analysis types
SI = 1  # code of the units data set, 164
NEAR = 0.01  # of a frequency, within which a mode is the one to be skipped
TOLD = 1e-3  # share of a complex shape that is out of phase, from which on it is told
TWISTED = 0.1  # share of a complex shape that is out of phase, up to which it is taken as real


@dataclass(frozen=True, eq=False)
class FileModes:
    """Modes (n,): ``frequency`` Hz, ``damping`` ratios, ``mass`` kg (0: not said), ``shapes`` by node and direction."""

    frequency: Array
    damping: Array
    mass: Array
    shapes: Mapping[Label, Array]


def read_modes(path: Path, skip: Sequence[float] = ()) -> FileModes:
    """The modes of a file by ascending frequency without those nearest to ``skip`` (Hz), complex ones taken as real.

    FormatError where there are none, one is too far from real, or pyuff is not installed. What of a mode is out of
    phase is told.
    """
    found = _without(_read(path, state_of(path, LARGEST_TEXT)), skip)
    shapes = [_real(mode[3], f"mode {number} ({mode[0]:.5g} Hz)") for number, mode in found]
    frequency, damping, mass = (np.array([mode[part] for _, mode in found]) for part in range(3))
    if notes := tuple(said for _, said in shapes if said):
        taken = TakenColumn(f"{len(found)} data sets 55", "", "their own scale")
        tell(Taken(path.name, "modes", (taken,), len(found), frequency[0], frequency[-1], "Hz", notes=notes))
    rows = {label: np.array([shape[label] for shape, _ in shapes]) for label in sorted(shapes[0][0])}
    return FileModes(frequency, damping, mass, rows)


def _without(modes: list[Any], skip: Sequence[float]) -> list[tuple[int, Any]]:
    """Modes with their numbers, less those nearest to ``skip``, each within a hundredth of a mode's frequency."""
    frequencies, left = np.array([mode[0] for mode in modes]), dict(enumerate(modes, 1))
    for each in skip:
        nearest = int(np.argmin(np.abs(frequencies - each)))
        if abs(frequencies[nearest] - each) > NEAR * frequencies[nearest]:
            there = ", ".join(f"{one:.5g}" for one in frequencies.tolist())
            raise FormatError(f"has no mode at {each:g} Hz to skip: its modes are at {there} Hz")
        left.pop(nearest + 1, None)
    if not left:
        raise FormatError("has no modes left: all are in skip")
    return list(left.items())


@lru_cache(maxsize=8)
def _read(path: Path, state: State) -> list[Any]:
    sets = data_sets(path, "write frequencies and shapes in the case")
    modes = [_mode(each) for each in sets if each["type"] == 55 and each["analysis_type"] in (NORMAL, *COMPLEX)]
    if not modes:
        raise FormatError("has no modes: a data set 55 of analysis type 2, 3 or 7 is needed")
    modes.sort(key=lambda mode: float(mode[0]))
    labels = set(modes[0][3])
    if any(set(mode[3]) != labels for mode in modes):
        raise FormatError("its modes are of different nodes: export them of the same")
    return modes


def data_sets(path: Path, cure: str) -> list[dict[str, Any]]:
    """Data sets of a file in SI; FormatError of another one, and, with the ``cure``, where pyuff is not installed."""
    try:
        import pyuff
    except ImportError:
        raise FormatError(MISSING + cure) from None
    quiet = contextlib.redirect_stdout(io.StringIO())
    with read_by("is no universal file that can be read"), quiet, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found: Any = pyuff.UFF(str(path)).read_sets()
    sets = found if isinstance(found, list) else [found]
    for each in sets:
        if each["type"] == 164 and each["units_code"] != SI:
            raise FormatError(f"its units have the code {each['units_code']}: export it in SI (code {SI})")
    return sets


def _mode(data: dict[str, Any]) -> tuple[float, float, float, dict[Label, Any]]:
    """Frequency, damping ratio, modal mass, shape."""
    shape = {
        (int(node), direction): value
        for direction in range(1, 7)
        for node, value in zip(data["node_nums"], data.get(f"r{direction}", ()), strict=False)
    }
    if data["analysis_type"] == NORMAL:
        damping = data["modal_damp_vis"] or data["modal_damp_his"] / 2
        return float(data["freq"]), float(damping), float(data["modal_m"]), shape
    eigenvalue = complex(data["eig"])
    mass = complex(data["modal_a"]) / (2j * eigenvalue.imag) if eigenvalue.imag else 0j
    return abs(eigenvalue) / (2 * np.pi), -eigenvalue.real / abs(eigenvalue), abs(mass), shape


def _real(shape: Mapping[Label, Any], called: str) -> tuple[dict[Label, float], str]:
    """A shape turned into phase, and what is said of a complex one; FormatError where it is too far from real."""
    values = np.array(list(shape.values()), dtype=complex)
    turned = values * np.exp(-0.5j * np.angle(np.sum(values**2)))
    share = float(np.linalg.norm(turned.imag)) / max(float(np.linalg.norm(turned)), 1e-300)
    said = f"{called} is complex, {100 * share:.2g} % of it out of phase"
    if share > TWISTED:
        cure = (
            f'at most {100 * TWISTED:g} % are taken as real: leave it out, skip = ["{called[:-1].rpartition("(")[2]}"]'
        )
        raise FormatError(f"{said}: {cure}")
    return dict(zip(shape, turned.real.tolist(), strict=True)), f"{said}: taken as real" if share > TOLD else ""
