"""Model with a subset of the case's effects: its quantities of interest, ringing among them, its size, its CPU time."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import gap_drift
from vibeam.exchange.faults import reason_of
from vibeam.flight.trajectory import Trajectory, simulate
from vibeam.observe.restitution import extrapolated_restitution
from vibeam.observe.ringing import fit_ringing
from vibeam.observe.slow_motion import SlowPart, slow_part
from vibeam.studies.influence.curve import NAN, Curve, RefinedPeak, Step, ValueRead, ends, nearest, refined_peak, swept
from vibeam.studies.influence.subsets import Subsets
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of

WILD = 8  # drive periods evaluated of an aperiodic motion
BESIDE = 1.5  # drive periods beyond the period of a periodic one, so that no interval between impacts is cut off
SAMPLES = 50  # samples a period of the ringing …
LEAST = 300  # … and a drive period, at least
FITTED = 10  # largest number of faster modes in the fit: still faster ones have decayed
GUARD = 0.02  # share of a drive period left out next to impacts where there are still faster modes
RINGING = ("ringing", "ringing_frequency", "apparent_restitution")
UNSEEN = 1e-9  # share of the sensor's row below which a mode is not observable


def observed_ringing(curve: Curve, frequency: float, near: Step) -> dict[str, ValueRead]:
    """Measure ``ringing`` (mean peak velocity, m/s), ``ringing_frequency`` (Hz) and ``apparent_restitution``.

    Read at the case's output of the motion at ``frequency`` (Hz), started from ``near``. Ringing is the slowest mode
    above twice the drive's frequency that the output sees; apparent restitution is that of the slower ones.
    """
    if curve.case.scene_of(curve.fidelity).harmonics:
        return dict.fromkeys(RINGING, ValueRead(NAN, "the fit knows one harmonic of the drive"))
    settled = curve.on(np.array([frequency]), near.state)[0]
    omega = 2 * np.pi * frequency
    amplitude = float(np.ravel(curve.case.amplitude_of(curve.fidelity, np.array([omega])))[0])
    repeats = int(settled.response.period[0])
    periods = repeats + BESIDE if repeats > 0 else WILD
    drift = gap_drift(curve.case.scene, np.array([omega]))
    system = curve.system if drift is None else replace(curve.system, gap=curve.system.gap + float(drift[0]))
    path = simulate(system, Drive(omega, amplitude), periods / frequency, settled.state)
    if len(_contacts(path)) < 2:
        return dict.fromkeys(RINGING, ValueRead(NAN, "no impacts to read it from"))
    return _read(path, curve.case.sweep.output, frequency)


def _read(path: Trajectory, output: str, frequency: float) -> dict[str, ValueRead]:
    system, omega = path.system, path.drive.omega
    order = np.argsort(system.omega)
    slow = max(int(np.count_nonzero(system.omega < 2 * omega)), 1)
    faster = order[slow : slow + FITTED]
    row = np.abs(system.output(output))
    observable = [mode for mode in faster if row[mode] > UNSEEN * row.max() and system.zeta[mode] < 1]
    rate = max(LEAST * frequency, SAMPLES * system.omega[observable[0]] / (2 * np.pi) if observable else 0.0)
    times = np.linspace(0, path.t_end, int(rate * path.t_end), endpoint=False)
    displacement = path.at(times, output)
    guard = GUARD / frequency if system.size > slow + FITTED else 0.0
    r = _restitution(
        times, displacement, _contacts(path), slow_part(system, path.drive, slow), window=1 / frequency, guard=guard,
        beside=_free(system, faster),
    )  # fmt: skip
    found = {
        "apparent_restitution": ValueRead(r) if np.isfinite(r) else ValueRead(NAN, "too few samples at any impact")
    }
    if not observable:
        silent = ValueRead(NAN, "no faster mode that the output sees: nothing rings")
        return found | {"ringing": silent, "ringing_frequency": silent}
    return found | _ringing(path, times, displacement, observable[0], [*order[:slow], *faster], guard)


def _contacts(path: Trajectory) -> Array:
    """Begin and end (m, 2) of each impact, s: one instant, or the contact time of a stop that yields."""
    contacts = path.contacts
    pushed = np.stack([contacts[:, 0], contacts[:, 0] + contacts[:, 1]], axis=1)
    hits = np.repeat(path.impact_times[:, None], 2, axis=1)
    found = np.concatenate([hits, pushed])
    return np.asarray(found[np.argsort(found[:, 0])])


def _restitution(times: Array, displacement: Array, contacts: Array, slow: SlowPart, **keys: Any) -> float:
    """Mean over the impacts of −after/before, from the slow part's rate at end and begin; NaN without any."""
    marks = np.unique(contacts)
    read = extrapolated_restitution(times, displacement, marks, slow, **keys)
    first, last = np.searchsorted(marks, contacts.T)
    return replace(read, time=contacts[:, 0], before=read.before[first], after=read.after[last]).mean


def _ringing(
    path: Trajectory, times: Array, displacement: Array, mode: int, modes: list[int], guard: float
) -> dict[str, ValueRead]:
    """Mean over the intervals between impacts of a damped sinusoid fitted beside all other modes."""
    system = path.system
    others = _free(system, np.array([each for each in modes if each != mode]))
    known = others or SlowPart(0)
    rest = SlowPart(0, path.drive.omega, known.omega, known.zeta)
    fit = fit_ringing(
        times, displacement, _contacts(path).ravel(), rest, near=float(system.omega[mode]) / (2 * np.pi), guard=guard
    )
    if not fit.found.any():
        none = ValueRead(NAN, "no interval between impacts could be fitted")
        return {"ringing": none, "ringing_frequency": none}
    mean = {name: float(np.nanmean(getattr(fit, name))) for name in ("mean_velocity", "frequency")}
    return {"ringing": ValueRead(mean["mean_velocity"]), "ringing_frequency": ValueRead(mean["frequency"])}


def _free(system: ImpactSystem, modes: NDArray[np.int64]) -> SlowPart | None:
    """Free vibrations of some modes, overdamped ones left out; None without any."""
    kept = [mode for mode in modes if system.zeta[mode] < 1]
    if not kept:
        return None
    return SlowPart(-1, None, tuple(system.omega[kept].tolist()), tuple(system.zeta[kept].tolist()))


@dataclass(frozen=True)
class EffectModel:
    """Number of ``coordinates`` of the finite-element model, ``frequencies`` (Hz) of the swept modes; ``why``: the
    reason where the model cannot be built, with all ``values`` missing.
    """

    kept: tuple[str, ...]
    values: Mapping[str, ValueRead] = field(default_factory=dict)
    coordinates: int = 0
    frequencies: tuple[float, ...] = ()
    curve: Curve | None = None
    why: str = ""

    @property
    def swept(self) -> Curve:
        """Sweep of a model that can be built."""
        assert self.curve is not None
        return self.curve

    def value(self, quantity: str) -> ValueRead:
        """Value of a quantity."""
        return self.values.get(quantity, ValueRead(NAN, self.why))


def model(subsets: Subsets, kept: Collection[str], wanted: Collection[str], frequency: float | None) -> EffectModel:
    """Build the model and read the quantities in ``wanted``, at ``frequency`` (Hz; None: at its peak)."""
    names = tuple(name for name in subsets.effects if name in kept)
    try:
        case = subsets.case(names)
        curve = swept(case, subsets.fidelity, case.system(subsets.fidelity))
    except ValueError as refusal:
        return EffectModel(names, why=reason_of(refusal))
    modes = tuple(np.sort(curve.system.omega / (2 * np.pi)).tolist())
    return EffectModel(names, _values(curve, wanted, frequency), _coordinates(case.scene), modes, curve)


def _values(curve: Curve, wanted: Collection[str], frequency: float | None) -> dict[str, ValueRead]:
    top = refined_peak(curve)
    values = {"peak": top.amplitude, "peak_frequency": top.frequency}
    if {"period_one_from", "period_one_to"} & set(wanted):
        values |= dict(zip(("period_one_from", "period_one_to"), ends(curve), strict=True))
    if set(RINGING) & set(wanted):
        values |= _in_motion(curve, top, frequency)
    return {name: values[name] for name in wanted}


def _in_motion(curve: Curve, top: RefinedPeak, frequency: float | None) -> dict[str, ValueRead]:
    if frequency is not None:
        return observed_ringing(curve, frequency, nearest(curve, frequency))
    if top.near is None:
        return dict.fromkeys(RINGING, top.frequency)
    return observed_ringing(curve, top.frequency.number, top.near)


def _coordinates(scene: Any) -> int:
    """Coordinates of the finite elements, and of a platform that is pushed back."""
    moves = scene.platform is not None and scene.platform.coupling == "two-way"
    return int(structure_of(scene).size) + moves
