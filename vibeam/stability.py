"""The stability map of a case: frequency against gap or drive, for each model that its fidelities make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.line import Kind, motions
from vibeam.periodic.map import OrbitMap, orbit_map
from vibeam.solvers.averaging import slow_flow
from vibeam.units import LENGTH, RATIO, VOLTAGE, UnitError, to_si
from vibeam.units import Kind as UnitKind
from vibeam_models.scene import SdofScene

if TYPE_CHECKING:
    from vibeam.case import Case
    from vibeam.system import ImpactSystem

Array = NDArray[np.float64]
KINDS = (Kind.FOLD, Kind.GRAZING, Kind.TOUCHING, Kind.DOUBLING, Kind.NEIMARK_SACKER)
NAMES = {
    Kind.FOLD: "fold",
    Kind.GRAZING: "grazing",
    Kind.TOUCHING: "second touch",
    Kind.DOUBLING: "period doubling",
    Kind.NEIMARK_SACKER: "Neimark–Sacker",
}
BRANCHES = ("harder", "softer")
WIDE = 2.0  # the gaps shown by default, in amplitudes without the stop


@dataclass(frozen=True)
class Axis:
    """The second parameter: ``over`` as in ``OrbitMap``, what it is called, its unit, SI for one of it, the case's own.

    ``low``, ``high`` and ``own`` are in ``unit`` ("1": no dimension).
    """

    over: str
    name: str
    unit: str
    factor: float
    own: float
    low: float
    high: float

    @property
    def own_text(self) -> str:
        """The case's own value in words."""
        return f"{self.name} of {self.own:.4g} {'' if self.unit == '1' else self.unit}".strip()


@dataclass(frozen=True)
class ModelMap:
    """One model: the ``fidelities`` that share it, its map, and where averaging has motions, in the axis' SI unit.

    ``averaged``: least and greatest value (columns, 2) at each frequency, NaN without; None for more than one mode.
    """

    fidelities: tuple[str, ...]
    modes: int
    orbits: OrbitMap
    averaged: Array | None


@dataclass(frozen=True)
class Crossing:
    """A boundary at the case's own gap and drive: frequency in Hz, impact velocity in m/s, the largest multipliers."""

    fidelity: str
    periods: int
    boundary: str
    motion: str
    frequency: float
    velocity: float
    multipliers: str


@dataclass(frozen=True)
class CurvePoint:
    """One point of a boundary curve: Hz, m, m/s; ``clear``: its motion keeps clear of the stop between impacts."""

    fidelity: str
    periods: int
    boundary: str
    motion: str
    curve: int
    frequency: float
    gap: float
    amplitude: float
    velocity: float
    clear: bool


@dataclass(frozen=True)
class Share:
    """How much of a map has a motion, an admissible one, a stable admissible one: 0 … 1."""

    fidelity: str
    periods: int
    exists: float
    admissible: float
    stable: float


@dataclass(frozen=True)
class Stability:
    """The maps of a case, and the boundaries that its own line runs into."""

    case: Case
    axis: Axis
    maps: tuple[ModelMap, ...]
    crossings: tuple[Crossing, ...]

    @property
    def points(self) -> list[CurvePoint]:
        """All points of all boundary curves."""
        return [point for one in self.maps for point in _points(one)]

    @property
    def shares(self) -> list[Share]:
        """What the maps hold, in three numbers each."""
        rows = []
        for one in self.maps:
            flags = (np.isfinite(one.orbits.velocity), one.orbits.admissible, one.orbits.stable)
            shares = (float(each.any(axis=2).mean()) for each in flags)
            rows.append(Share(" ".join(one.fidelities), one.orbits.periods, *shares))
        return rows


def stability(
    case: Case,
    over: str = "gap",
    low: str | float | None = None,
    high: str | float | None = None,
    points: int = 101,
    frequencies: int = 161,
    periods: int = 1,
    fidelity: str | None = None,
) -> Stability:
    """Maps over the case's frequencies and its gap (at the contact) or drive, from ``low`` to ``high``.

    ``over``: "gap" or "drive"; ``low``, ``high``: as a case has them, with unit, None: chosen from the case. Fidelities
    that make the same model share a map. ValueError for what makes no sense, an unknown fidelity among it.
    """
    if fidelity is not None and fidelity not in case.fidelities:
        raise ValueError(f"no fidelity {fidelity!r}: there are {', '.join(case.fidelities)}")
    models = _models(case, fidelity)
    axis = _axis(case, over, low, high, next(iter(models.values()))[0])
    grid, values = _frequencies(case, frequencies), axis.factor * np.linspace(axis.low, axis.high, points)
    maps: list[ModelMap] = []
    crossings: list[Crossing] = []
    for name, (system, names) in models.items():
        amplitude = float(case.amplitude_of(name))
        given = {"amplitude": amplitude, "gap": system.gap} | {axis.over: values}
        found = orbit_map(system, grid, given["amplitude"], periods, given["gap"])
        maps.append(ModelMap(tuple(names), system.size, found, _averaged(amplitude, system, axis.over, grid, periods)))
        crossings += _crossings(name, system, amplitude, grid, periods)
    return Stability(case, axis, tuple(maps), tuple(crossings))


def _models(case: Case, fidelity: str | None) -> dict[str, tuple[ImpactSystem, list[str]]]:
    """The systems that differ, by the first fidelity that makes each, with all that do."""
    found: dict[str, tuple[ImpactSystem, list[str]]] = {}
    for name in case.fidelities if fidelity is None else [fidelity]:
        system = case.system(name)
        twin = next((names for other, names in found.values() if _same(other, system)), None)
        if twin is None:
            found[name] = system, [name]
        else:
            twin.append(name)
    return found


def _same(one: ImpactSystem, other: ImpactSystem) -> bool:
    names = [field.name for field in fields(one) if field.name != "outputs"]
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def _frequencies(case: Case, count: int) -> Array:
    grid = case.sweep.frequency
    if not grid.min() < grid.max():
        raise ValueError("sweep.frequency: a map needs a range of frequencies, there is one")
    return np.asarray(2 * np.pi * np.linspace(grid.min(), grid.max(), count))


def _axis(case: Case, over: str, low: str | float | None, high: str | float | None, system: ImpactSystem) -> Axis:
    if over not in ("gap", "drive"):
        raise ValueError(f"--over: {over!r} is none of gap, drive")
    name, kind, factor = _gap_unit(case) if over == "gap" else _drive_unit(case)
    own = system.gap if over == "gap" else case.base_amplitude / factor
    usual = _usual_gaps(case, system) if over == "gap" else (own / 20, 2 * own)
    first, last = (
        default if given is None else _value(flag, given, kind)
        for flag, given, default in (("--from", low, usual[0]), ("--to", high, usual[1]))
    )
    if not first < last:
        raise ValueError(f"--from, --to: {name} must ascend, not go from {first:.4g} to {last:.4g}")
    if over == "drive" and first <= 0:
        raise ValueError(f"--from: {name} must be > 0, not {first:.4g}")
    return Axis("gap" if over == "gap" else "amplitude", name, kind.unit or "1", factor, own, first, last)


def _value(flag: str, given: str | float, kind: UnitKind) -> float:
    try:
        return to_si(given, kind)
    except UnitError as fault:
        raise ValueError(f"{flag}: {fault}") from None


def _gap_unit(case: Case) -> tuple[str, UnitKind, float]:
    if isinstance(case.scene, SdofScene):
        return "gap Δ", RATIO, 1.0
    return "gap at the contact", LENGTH, 1.0


def _drive_unit(case: Case) -> tuple[str, UnitKind, float]:
    """Volts where the case drives by voltage: SI amplitude for one of them."""
    if isinstance(case.scene, SdofScene):
        return "base amplitude B", RATIO, 1.0
    if case.scene.base.voltage is None:
        return "base amplitude", LENGTH, 1.0
    from vibeam.fidelity import base_amplitude

    volt = replace(case.scene, base=replace(case.scene.base, voltage=1.0))
    return "drive voltage", VOLTAGE, base_amplitude(volt)


def _usual_gaps(case: Case, system: ImpactSystem) -> tuple[float, float]:
    """Around no gap, some amplitudes of the motion that there is without the stop, and the case's own gap inside."""
    grid = _frequencies(case, 101)
    free = motions(system, 1, grid, np.full(101, case.base_amplitude), np.zeros(101))
    half = max(WIDE * case.base_amplitude * float(np.median(np.abs(free.total.unit))), 2 * abs(system.gap))
    return -half, half


def _averaged(amplitude: float, system: ImpactSystem, over: str, omega: Array, periods: int) -> Array | None:
    """The open interval of gaps, or of amplitudes, with a stationary averaged motion near Ω = 2n (Δ_MAX of eq. 25)."""
    try:
        flow, unit = slow_flow(system, amplitude, resonance=periods)
    except ValueError:
        return None
    ends = np.array([flow.gaps(float(each) / unit) for each in omega])
    if over == "gap":
        return ends + (system.gap - flow.oscillator.gap)  # of the stop, not from the static place
    gap = flow.oscillator.gap
    with np.errstate(divide="ignore"):
        least = amplitude * np.where(gap > 0, gap / ends[:, 1], gap / ends[:, 0])  # both ends grow with the drive
    return np.stack([least, np.full(len(omega), np.nan)], axis=1)


def _crossings(name: str, system: ImpactSystem, amplitude: float, grid: Array, periods: int) -> Iterator[Crossing]:
    if amplitude == 0:
        return
    for each in boundaries(system, amplitude, (float(grid[0]), float(grid[-1])), periods, kinds=KINDS):
        if each.clear:
            place = (each.omega / (2 * np.pi), each.velocity)
            yield Crossing(name, periods, NAMES[each.kind], BRANCHES[each.branch], *place, _shown(each))


def _shown(each: Boundary) -> str:
    """The multipliers that matter: the largest, and its twin."""
    if not len(each.multipliers):
        return ""
    largest = each.multipliers[0]
    twin = f"{largest.real:.4g} ± {abs(largest.imag):.4g}i"
    return twin if abs(largest.imag) > 1e-9 * abs(largest) else f"{largest.real:.4g}"


def _points(one: ModelMap) -> Iterator[CurvePoint]:
    for number, curve in enumerate(one.orbits.curves):
        name, motion = NAMES[curve.kind], "both" if curve.kind is Kind.FOLD else BRANCHES[curve.branch]
        for omega, gap, amplitude, velocity, clear in zip(
            curve.omega, curve.gap, curve.amplitude, curve.velocity, curve.clear, strict=True
        ):
            place = (float(omega) / (2 * np.pi), float(gap), float(amplitude), float(velocity), bool(clear))
            yield CurvePoint(" ".join(one.fidelities), one.orbits.periods, name, motion, number, *place)
