"""Origin of the kernels, and a check of about a second of what the program computes against closed forms.

**Impacts of an oscillator at its stop.** η̈ + ω²η = 0 with the stop at η = 0, thrown off by v: impact k is at kπ/ω with
R^(k−1) v.

**Frequency of a cantilever.** βL = 1.8751040687119611 of cosh cos = −1, ω = (βL)² √(EI/(ρA))/L².
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from math import pi, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from vibeam.studies.doctor.packages import Finding, Severity

TOPIC, KERNELS = "self-check", "kernels"
CURE = "the installation computes wrongly: install vibeam anew, and report this output"
EXACT, MESH = 1e-10, 1e-6  # allowed relative errors: of round-off, and of a mesh of 24 elements
ROOT = 1.8751040687119611


def kernels() -> Iterator[Finding]:
    """Finding about where the kernels come from, and why from there."""
    from vibeam.flight.engine.entries import CURE as INSTALL
    from vibeam.flight.engine.entries import VARIABLE, move, origin
    from vibeam.flight.engine.loading import KernelsUnavailable, level_of_processor

    try:
        move.function  # noqa: B018  found, or compiled, when it is asked for
    except KernelsUnavailable as fault:
        yield Finding(KERNELS, "kernels", Severity.FAULT, str(fault), f"{INSTALL}, or unset {VARIABLE}")
        return
    came = origin()
    if came == "numba":
        yield Finding(
            KERNELS, "kernels", Severity.NOTE, f"compiled by numba: {reason()}", "the first use takes minutes"
        )
    else:
        yield Finding(KERNELS, "kernels", Severity.GOOD, f"{came}; the processor takes {level_of_processor()}")


def pages() -> Iterator[Finding]:
    """Finding about the kernels that pages carry."""
    from vibeam.flight.engine.browser import LIBRARIES, browser_libraries
    from vibeam.flight.engine.loading import WASM, KernelsUnavailable

    try:
        size = sum(map(len, browser_libraries(LIBRARIES).values()))
    except KernelsUnavailable as fault:
        yield Finding(KERNELS, "kernels of pages", Severity.NOTE, str(fault), "vibeam report writes pages without them")
        return
    yield Finding(
        KERNELS, "kernels of pages", Severity.GOOD, f"{WASM}, {len(LIBRARIES)} libraries, {size / 1e3:.0f} kB"
    )


def reason() -> str:
    """Why numba compiles the kernels and no library is taken."""
    from vibeam.flight.engine.entries import VARIABLE, move
    from vibeam.flight.engine.loading import LibraryUnavailable, function_of

    if os.environ.get(VARIABLE) == "numba":
        return f"{VARIABLE}=numba"
    try:
        function_of(move.library, move.module, move.name)
    except LibraryUnavailable as found:
        return str(found)
    return "the library cannot be loaded"


def self_check() -> Iterator[Finding]:
    """Findings about each closed form, and about a results file; a check that fails does not stop the others."""
    begun = perf_counter()
    for name, (deviation, allowed) in CHECKS.items():
        yield checked(name, deviation, allowed)
    yield Finding(TOPIC, "time", Severity.FACT, f"{perf_counter() - begun:.2g} s")


def checked(name: str, deviation: Callable[[], float], allowed: float) -> Finding:
    """Finding about one check, by its relative ``deviation`` from what is known."""
    from vibeam.flight.engine.loading import KernelsUnavailable

    try:
        off = deviation()
    except KernelsUnavailable:
        return Finding(TOPIC, name, Severity.NOTE, "not computed: there are no kernels")
    except Exception as fault:
        return Finding(TOPIC, name, Severity.FAULT, f"{type(fault).__name__}: {fault}", CURE)
    if not off <= allowed:  # NaN is none
        return Finding(TOPIC, name, Severity.FAULT, f"off by {off:.1e}, and {allowed:.0e} is allowed", CURE)
    return Finding(TOPIC, name, Severity.GOOD, f"off by {off:.1e}" if allowed else "written and read")


def oscillator() -> float:
    """Largest relative error of ten impacts, times and velocities, with a certificate that none was missed."""
    from vibeam.flight.trajectory import simulate
    from vibeam.system.impact_system import Drive, ImpactSystem
    from vibeam.system.state import State

    rate, kept, number = 7.0, 0.8, np.arange(1, 11)
    system = ImpactSystem.from_modes([rate], 0.0, [1.0], [1.0], gap=0.0, restitution=kept)
    thrown = State(np.zeros(1), np.array([-1.0]))
    path = simulate(system, Drive(1.0, 0.0), 10.5 * pi / rate, thrown, certify=True)
    proved = path.certificate is not None and path.certificate.complete
    if not (len(path.impact_times) == len(number) and proved):
        raise ValueError(f"{len(path.impact_times)} impacts of {len(number)}, or no proof of them")
    return _largest(path.impact_times / (number * pi / rate), path.impact_velocities / kept ** (number - 1.0))


def cantilever() -> float:
    """Relative error of the first frequency of 24 elements."""
    from vibeam_models.beams.beam import Beam, Damping
    from vibeam_models.beams.shapes import Rectangle
    from vibeam_models.space import bare_beam

    beam = Beam(0.3, Rectangle(0.02, 0.002), 70e9, 2700.0, Damping("constant", (0.0,)), elements=24)
    known = ROOT**2 / 0.3**2 * sqrt(70e9 * 0.002**2 / 12 / 2700)
    return _largest(bare_beam(beam)[0].modes(1).omega / known)


def results_file() -> float:
    """Number of values that an HDF5 file does not give back as they were written."""
    import h5py

    values = np.linspace(0.0, 1.0, 100)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        with h5py.File(path, "w") as file:
            file["values"] = values
        with h5py.File(path) as file:
            return float(np.count_nonzero(file["values"][()] != values))


def _largest(*ratios: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    """Largest distance from 1; NaN where there is nothing."""
    values = np.concatenate([np.asarray(each, dtype=float).ravel() for each in ratios])
    return float(np.max(np.abs(values - 1))) if len(values) else float("nan")


CHECKS: dict[str, tuple[Callable[[], float], float]] = {
    "impacts of an oscillator": (oscillator, EXACT),
    "frequency of a cantilever": (cantilever, MESH),
    "results file": (results_file, 0.0),
}
