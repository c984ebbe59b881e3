"""Origin of the kernels, and a check of about a second of what the program computes against closed forms.

**Impacts of an oscillator at its stop.** η̈ + ω²η = 0 with the stop at η = 0, thrown off by v: impact k is at kπ/ω with
R^(k−1) v.

**A ball that comes to rest.** η̈ = g toward a stop at η = 0, thrown off by v: it rests from 2v/(g(1 − R)) on.

**An orbit at twice the natural frequency.** η̈ + ω²η = Ω²B sin Ωt with Ω = 2ω and the stop at η = 0, one impact a drive
period π/ω. The free part changes its sign from impact to impact, so that both parts vanish there. With p = (4/3)ΩB, the
driven part's velocity then, and h that of the free part just after, p + h = −R(p − h): h = −p(1 + R)/(1 − R), and it
strikes with p − h = (8/3)ΩB/(1 − R).

**Frequency of a cantilever.** βL = 1.8751040687119611 of cosh cos = −1, ω = (βL)² √(EI/(ρA))/L².
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.studies.doctor.machine import Finding, Severity

if TYPE_CHECKING:
    from vibeam.flight.trajectory import Trajectory
    from vibeam.system.impact_system import ImpactSystem

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
    import os

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
    rate, kept = 7.0, 0.8
    path = _flown(_at_stop(rate, kept), 1.0, 0.0, 1.0, (0.0, 10.5 * pi / rate), impacts=10)
    number = np.arange(1, 11)
    return _largest(path.impact_times / (number * pi / rate), path.impact_velocities / kept ** (number - 1.0))


def ball() -> float:
    """Relative error of the time at which the ball comes to rest."""
    fall, kept = 9.81, 0.5
    path = _flown(_at_stop(0.0, kept, static=[fall]), 1.0, 0.0, 1.0, (0.0, 1.0))
    return _largest(path.rests[:1, 0] * fall * (1 - kept) / 2)


RATE, KEPT, SIZE = 50.0, 0.7, 1e-4  # of the orbit
STRIKES = 8 / 3 * 2 * RATE * SIZE / (1 - KEPT)  # m/s


def orbit() -> float:
    """Largest relative error of the impact velocities along the orbit, flown from just after an impact."""
    begin = pi / (2 * RATE)  # Ωt = π: the driven part passes the stop from outside
    times = begin + np.arange(1, 6) * pi / RATE
    span = begin, begin + 5.5 * pi / RATE
    path = _flown(_at_stop(RATE, KEPT), 2 * RATE, SIZE, KEPT * STRIKES, span, impacts=5)
    return _largest(path.impact_times / times, path.impact_velocities / STRIKES)


def closed_orbit() -> float:
    """Relative error of the velocity of the same orbit, as the equations of periodic motions give it."""
    from vibeam.periodic.orbit_search import orbits
    from vibeam.system.impact_system import Drive

    found = [each.velocity for each in orbits(_at_stop(RATE, KEPT), Drive(2 * RATE, SIZE)) if each.admissible]
    return _largest(np.array(found[:1]) / STRIKES)


def shot_orbit() -> float:
    """Relative error of the velocity of the same orbit, shot at from a start 1 % off its launch."""
    from vibeam.periodic.orbit_search import orbits
    from vibeam.system.impact_system import Drive
    from vibeam.system.state import State

    thrown = State(np.zeros(1), np.array([-1.01 * KEPT * STRIKES]))
    [found] = orbits(_at_stop(RATE, KEPT), Drive(2 * RATE, SIZE), start=thrown, time=pi / (2 * RATE))
    return _largest(found.velocities / STRIKES)


def _at_stop(rate: float, kept: float, **more: Any) -> ImpactSystem:
    """One mode without damping, of ``rate`` rad/s, with the stop where it rests."""
    from vibeam.system.impact_system import ImpactSystem

    return ImpactSystem.from_modes([rate], 0.0, [1.0], [1.0], gap=0.0, restitution=kept, **more)


def _flown(
    system: ImpactSystem, omega: float, size: float, velocity: float, span: tuple[float, float], impacts: int = 0
) -> Trajectory:
    """Flight over ``span`` s, thrown off the stop (m/s); ValueError without the ``impacts``, or a proof of them."""
    from vibeam.flight.trajectory import simulate
    from vibeam.system.impact_system import Drive
    from vibeam.system.state import State

    thrown = State(np.zeros(1), np.array([-velocity]))
    path = simulate(system, Drive(omega, size), span[1], thrown, t_start=span[0], certify=impacts > 0)
    proved = path.certificate is not None and path.certificate.complete
    if impacts and not (len(path.impact_times) == impacts and proved):
        raise ValueError(f"{len(path.impact_times)} impacts of {impacts}, or no proof of them")
    return path


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
    "rest after endless impacts": (ball, EXACT),
    "orbit of period 1 by flight": (orbit, EXACT),
    "the same orbit in closed form": (closed_orbit, EXACT),
    "and by shooting": (shot_orbit, EXACT),
    "frequency of a cantilever": (cantilever, MESH),
    "results file": (results_file, 0.0),
}
