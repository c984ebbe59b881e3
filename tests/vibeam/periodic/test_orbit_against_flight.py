"""The formula against the flight: every case of the house; and both against 40-digit shooting at published orbits."""

from __future__ import annotations

from functools import cache
from math import ceil, log
from pathlib import Path
from typing import NamedTuple

import mpmath as mp
import numpy as np
import pytest
from case_files import COARSE, SWEPT
from numpy.typing import NDArray
from orbit_curve import orbit_curve

import vibeam
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.between_impacts import carried
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

FILES = SWEPT
POINTS = 16  # a case and model
FORGOTTEN = 1e-13  # share of a disturbance that is left when the flight is read
LONGEST = 20_000  # periods: what settles more slowly starts on the orbit itself and must stay there
STAYING = 2000  # periods
QUANTITIES = ("impact_velocity", "reach", "amplitude", "maximum", "minimum")


WITHOUT = {
    "paper",
    "experiment",
    "rigs",
    "stuttgart",
    "lodz",
    "reductions",
    "dtu_harmonic",
    "linear_stop",
    *("hammer", "discs"),  # the stop is out of reach
    *("ratio_3", "stuttgart_left"),  # a linear stop
    "slender",  # driven by an acceleration: a base of its own at every frequency
}  # folders and cases that may have no closed orbit


@cache
def models(file: Path) -> tuple[tuple[ImpactSystem, float, tuple[float, ...]], ...]:
    """The systems of a case that differ, the base amplitude, and some of the sweep's frequencies, rad/s.

    Those beside which period 1 gains or loses stability are always among them: there a motion settles most slowly.
    """
    case = vibeam.load(file, set=COARSE.get(file.stem))
    grid = 2 * np.pi * case.sweep.frequency
    found: list[tuple[ImpactSystem, float]] = []
    for name in case.fidelities:
        system, amplitude = case.system(name), case.amplitude_of(name, grid)
        if system.beyond_plain or not isinstance(amplitude, float):
            continue  # no closed form for it, or a base of its own at every frequency, behind a platform's filter
        if not any((repr(system), amplitude) == (repr(other), base) for other, base in found):
            found.append((system, amplitude))
    even = np.linspace(0, len(grid) - 1, POINTS).round().astype(int)
    chosen = [grid[np.union1d(even, edges(orbit_curve(system, grid, base).stable))] for system, base in found]
    return tuple((*each, tuple(map(float, few))) for each, few in zip(found, chosen, strict=True))


def edges(stable: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Points of either branch (points, 2) beside one of the other stability."""
    turns = np.unique(np.nonzero(stable[1:] != stable[:-1])[0])
    return np.union1d(turns, turns + 1)


def stable_orbits(system: ImpactSystem, amplitude: float, grid: tuple[float, ...]) -> list[Orbit]:
    curve = orbit_curve(system, grid, amplitude)
    drives = [Drive(omega, amplitude) for omega, stable in zip(grid, curve.stable.any(axis=1), strict=True) if stable]
    found = [orbit for drive in drives for orbit in orbits(system, drive)]
    return [o for o in found if o.stable and o.admissible]


def settle(orbit: Orbit) -> int:
    return ceil(log(FORGOTTEN) / log(abs(orbit.multipliers[0])))


def begun(orbit: Orbit, off: float) -> State:
    """The motion at the drive's phase 0, its velocities off by a share of themselves."""
    next_ = 2 * np.pi / orbit.drive.omega
    x, y = carried(orbit.system, orbit.drive, orbit.state, orbit.time, np.array([next_ if orbit.time > 0 else 0.0]))
    return State(x[0], y[0] * (1 - off))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_case(file: Path) -> None:
    judged = 0
    for system, amplitude, grid in models(file):
        solver = FlightSolver(system, min(grid))
        for orbit in stable_orbits(system, amplitude, grid):
            needed = settle(orbit)
            count, off = (max(needed, 20), 1e-3) if needed <= LONGEST else (STAYING, 0.0)
            flown, _ = solver.steady([orbit.drive.omega], amplitude, begun(orbit, off), count, 2, "contact")
            seen = orbit.watched()
            if flown.period[0] != 1 or abs(flown.impact_velocity[0] / orbit.velocity - 1) > 1e-3:
                continue  # the disturbance led to another motion: its basin ends nearer than 10⁻³
            judged += 1
            assert flown.impact_velocity[0] == pytest.approx(orbit.velocity, rel=1e-10)
            for name in QUANTITIES[1:]:
                bar = 1e-10 * orbit.reach
                assert getattr(flown, name)[0] == pytest.approx(getattr(seen, name)[0], abs=bar), (name, orbit)
    expected = sum(len(stable_orbits(*model)) for model in models(file))
    assert judged >= 0.9 * expected
    assert expected > 0 or {file.parent.name, file.stem} & WITHOUT


# published orbits


class Exact(NamedTuple):
    """Phase, velocities before and after, both multipliers; Q = Δ − min q."""

    phase: mp.mpf
    before: mp.mpf
    after: mp.mpf
    multipliers: list[mp.mpc]
    reach: mp.mpf


def shooting(beta: str, r: str, gap: str, omega: str, drive: str, guess: tuple[float, float]) -> Exact:
    """The period-1 motion of q̈ + 2βq̇ + q = Ω²B sin Ωt as a fixed point of the map from impact to impact.

    Multipliers: eigenvalues of that map's derivative in (phase, velocity), by differences in 40 digits.
    """
    b, e, d, w, a = (mp.mpf(text) for text in (beta, r, gap, omega, drive))
    own, h = mp.sqrt(1 - b**2), w**2 * a / (1 - w**2 + 2j * b * w)

    def flight(phase: mp.mpf, after: mp.mpf, t: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        start, now = h * mp.exp(1j * phase), h * mp.exp(1j * (phase + w * t))
        x, y = d - start.imag, after - w * start.real
        fade, c, s = mp.exp(-b * t), mp.cos(own * t), mp.sin(own * t) / own
        return fade * (x * (c + b * s) + y * s) + now.imag, fade * (y * (c - b * s) - x * s) + w * now.real

    span = 2 * mp.pi / w

    def closes(phase: mp.mpf, after: mp.mpf) -> list[mp.mpf]:
        q, v = flight(phase, after, span)
        return [q - d, after + e * v]

    phase, after = mp.findroot(closes, guess, tol=mp.mpf(10) ** -60)

    def next_(p: mp.mpf, v: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        t = mp.findroot(lambda t: flight(p, v, t)[0] - d, span, tol=mp.mpf(10) ** -70)
        return p + w * t - 2 * mp.pi, -e * flight(p, v, t)[1]

    step = mp.mpf(10) ** -15
    ends = [[next_(phase + s * step, after), next_(phase, after + s * step)] for s in (1, -1)]
    matrix = mp.matrix(2, 2)
    for column in range(2):
        for row in range(2):
            matrix[row, column] = (ends[0][column][row] - ends[1][column][row]) / (2 * step)
    trace, determinant = matrix[0, 0] + matrix[1, 1], mp.det(matrix)
    root = mp.sqrt(mp.mpc(trace**2 / 4 - determinant))
    values = sorted((trace / 2 + root, trace / 2 - root), key=lambda m: -abs(m))
    bottom = min(range(401), key=lambda k: flight(phase, after, span * k / 400)[0])
    time = mp.findroot(lambda t: flight(phase, after, t)[1], span * bottom / 400)
    low = flight(phase, after, time)[0]
    return Exact(phase, -after / e, after, values, d - low)


PUBLISHED = {
    "nominal": (("0.015", "0.9", "0", "2", "0.0005"), {"reach": (1.753002e-2, 5e-9)}),
    "Budd & Dux, Ω = 2": (("0", "0.8", "0", "2", "0.25"), {"before": (20 / 3, 1e-13)}),
    "Budd & Dux, Ω = 2.8": (("0", "0.8", "0.1", "2.8", str(1 / 2.8**2)), {"before": (0.106477937315, 5e-13)}),
    "COCO": (
        ("0.05", "0.8", "1", "1", "1"), {"before": (1.69573294, 5e-9), "after": (-1.35658635, 5e-9)},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_orbits_to_ten_digits(name: str) -> None:
    mp.mp.dps = 50
    numbers, printed = PUBLISHED[name]
    beta, r, gap, omega, drive = map(float, numbers)
    system = ImpactSystem.from_modes([1.0], beta, 1.0, 1.0, gap=gap, restitution=r)
    orbit = orbits(system, Drive(omega, drive))[0]
    exact = shooting(*numbers, (orbit.phase, float(orbit.state.velocity[0])))
    for quantity, (value, bar) in printed.items():
        assert float(getattr(exact, quantity)) == pytest.approx(value, abs=bar)
    assert orbit.velocity == pytest.approx(float(exact.before), rel=1e-12)
    assert orbit.phase == pytest.approx(float(exact.phase) % (2 * np.pi), rel=1e-12)
    assert orbit.state.velocity[0] == pytest.approx(float(exact.after), rel=1e-12)
    for got, wanted in zip(orbit.multipliers, exact.multipliers, strict=True):
        assert abs(abs(got) - float(abs(wanted))) < 1e-10
        assert got.real == pytest.approx(float(wanted.real), abs=1e-10)
        assert abs(got.imag) == pytest.approx(float(abs(wanted.imag)), abs=1e-10)
    assert orbit.multipliers.prod().real == pytest.approx(float(mp.fprod(exact.multipliers).real), abs=1e-10)
    if orbit.admissible:
        assert orbit.reach == pytest.approx(float(exact.reach), rel=1e-10)
    if name == "COCO":
        assert exact.multipliers[0].real == pytest.approx(-0.584295, abs=5e-7)
        assert abs(exact.multipliers[0].imag) == pytest.approx(0.005600, abs=5e-7)
