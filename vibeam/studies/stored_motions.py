"""Motions at the stored points of a run: each goes on from the state that its file holds.

A few drive periods are flown, or stepped by a fidelity's own solver where that steps, so that a reader may look at any
of the points without running the sweep again.

A motion stepped so is read like an exact one, by cubics between the solver's own samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.beam_field import stations, stop_places
from vibeam.case.fidelity import gap_drift, system
from vibeam.flight.trajectory import simulate
from vibeam.observe.harmonics import modal_participation, spectrum_of
from vibeam.observe.harmonics import shares as energy_shares
from vibeam.observe.motion import impacts_within
from vibeam.observe.phase_plane import phase_portrait, stroboscopic_section
from vibeam.solvers import SOLVERS, solver
from vibeam.solvers.harmonic_point import several_of
from vibeam.solvers.integration.samples import SampledMotion, between
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array
from vibeam_models.outputs import Output
from vibeam_models.scene import Scene

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.stored_result import StoredResult


@dataclass(frozen=True)
class SampledPath:
    """Cubics through the displacements and velocities of a sampled ``motion``, which has both sides of its impacts."""

    motion: SampledMotion

    def at(self, times: Array) -> Array:
        """Modal displacements and velocities (k, 2, n) at times (k,) of the motion, just after an impact."""
        values = self.motion.values
        return np.stack(between(self.motion.times, values[:, 0], values[:, 1], times), axis=1)

    def shown(self, begin: float, points: int) -> tuple[Array, Array]:
        """Times (m,) and modal values (m, 2, n) at ``points`` even times from ``begin`` to the end, and at the impacts.

        An impact is two points at the same time.
        """
        known, values = self.motion.times, self.motion.values
        even = np.linspace(begin, known[-1], points)
        jumps = np.flatnonzero((np.diff(known) <= 0) & (known[1:] >= begin))
        jumps = jumps[(values[jumps] != values[jumps + 1]).any(axis=(1, 2))]
        even = even[~np.isin(even, known[jumps])]
        times = np.concatenate([even, known[jumps], known[jumps]])
        rank = np.repeat([0, 0, 1], [len(even), len(jumps), len(jumps)])
        order = np.lexsort((rank, times))
        return times[order], np.concatenate([self.at(even), values[jumps], values[jumps + 1]])[order]

    def energy_shares(self, begin: float) -> Array:
        """Shares (n,) of the modes in the mean energy from ``begin`` on, by the trapezoidal rule over the samples."""
        inside = self.motion.times >= begin
        values, times = self.motion.values[inside], self.motion.times[inside]
        energy = (values[:, 1] ** 2 + (self.motion.system.omega * values[:, 0]) ** 2) / 2
        total = np.asarray(np.trapezoid(energy, times, axis=0))
        return np.asarray(total / total.sum()) if total.sum() > 0 else np.full(len(total), np.nan)


WINDOW = 4  # drive periods shown of a motion that does not repeat within them
FLOWN = 16  # drive periods flown, of which the spectrum is
HARMONICS = 16  # highest drive harmonic of the spectrum
FRAMES = 32  # of the moving beam over the window
POINTS = 480  # of a sampled motion that are shown


def _none() -> Array:
    return np.empty(0)


@dataclass(frozen=True)
class StoredMotion:
    """Motion of one fidelity at a stored point, on from its state; ``fault`` says why there is none.

    ``frequency`` Hz, ``window`` drive periods shown. ``time`` in drive periods, ``displacement`` and ``velocity`` of
    the output (SI), both sides of each impact; ``impacts`` (k, 2): times in drive periods, contact velocities just
    before, m/s. ``section`` (m, 2): displacement and velocity at the drive's phase 0. ``lines``: amplitudes of the
    output at multiples of 1/16 of the drive frequency, from 0 on. ``shares``: of the modes in the mean energy.
    ``deflection`` (frames, stations) in m: the beam seen from its base, evenly over the window; empty where no places
    are known. ``stops`` (k, 3): their places along the beam (m), deflections at which they are touched (m), and 1 above
    the beam, −1 below. ``base``: B of the base's own motion B sin Ωt (m), NaN where it is not harmonic.
    """

    fidelity: str
    direction: str
    frequency: float
    window: int = 0
    time: Array = field(default_factory=_none)
    displacement: Array = field(default_factory=_none)
    velocity: Array = field(default_factory=_none)
    impacts: Array = field(default_factory=_none)
    section: Array = field(default_factory=_none)
    lines: Array = field(default_factory=_none)
    shares: Array = field(default_factory=_none)
    deflection: Array = field(default_factory=_none)
    stops: Array = field(default_factory=_none)
    base: float = np.nan
    fault: str = ""


@dataclass(frozen=True)
class StoredMotions:
    """Motions of a stored run at the points nearest to ``frequency`` (Hz)."""

    stored: StoredResult
    frequency: Array

    def __iter__(self) -> Iterator[StoredMotion]:
        case = self.stored.result.case
        result = self.stored.result
        ways = [(name, way, each) for name in result if name in case.fidelities for way, each in result[name].items()]
        rigs = {name: _MovingRig(case, name) for name, _, _ in ways}
        for name, direction, response in ways:
            states = self.stored.states[name, direction]
            for point in np.unique([int(np.argmin(np.abs(response.frequency - each))) for each in self.frequency]):
                state, at = states[point], float(response.frequency[point])
                ended = Ended.of_code(int(response.ended[point]))
                if state is None or ended is not Ended.COMPLETE:
                    why = ended.value if ended is not Ended.COMPLETE else "the file has no state of this point"
                    yield StoredMotion(name, direction, at, fault=why)
                    continue
                head = StoredMotion(name, direction, at, _window(int(response.period[point])))
                yield _motion(rigs[name], head, state, response.mode_energy[point])


@dataclass(frozen=True)
class _MovingRig:
    """System of one fidelity whose outputs are also the deflections at places along the beam."""

    case: Case
    name: str

    @cached_property
    def stations(self) -> Mapping[str, float]:
        return stations(self.case, self.name)

    @cached_property
    def plain(self) -> ImpactSystem:
        scene = self.case.scene_of(self.name)
        if not isinstance(scene, Scene):
            return self.case.system(self.name)
        places = tuple(Output(name, position) for name, position in self.stations.items())
        return system(replace(scene, outputs=(*scene.outputs, *places)), self.case.fidelities[self.name])

    def at(self, frequency: float) -> tuple[ImpactSystem, Drive]:
        omega = np.array([2 * np.pi * frequency])
        drift = gap_drift(self.case.scene_of(self.name), omega)
        here = self.plain if drift is None else replace(self.plain, gap=self.plain.gap + float(drift[0]))
        return here, Drive(float(omega[0]), float(np.ravel(self.case.amplitude_of(self.name, omega))[0]))

    def stops(self, here: ImpactSystem) -> Array:
        """Stops that stand still as seen from the base; none where no places are known."""
        scene = self.case.scene_of(self.name)
        if not isinstance(scene, Scene) or scene.named("opposite"):
            return np.empty((0, 3))
        return np.array(list(stop_places(scene, here)), dtype=float)

    def base(self, drive: Drive) -> float:
        """Amplitude of the base (m); NaN on a platform, which moves by itself, with harmonics, and without a beam."""
        scene = self.case.scene_of(self.name)
        if not isinstance(scene, Scene) or scene.platform or scene.harmonics:
            return np.nan
        return 0.0 if scene.base.on_beam else drive.amplitude


def _window(period: int) -> int:
    """Drive periods shown of a motion of that period."""
    return period if 1 <= period <= WINDOW else 1 if period == -1 else WINDOW


def _motion(rig: _MovingRig, head: StoredMotion, state: State, energy: Array) -> StoredMotion:
    """Motion on from ``state``; ``energy`` (n,) of the modes, as stored."""
    here, drive = rig.at(head.frequency)
    head = replace(head, stops=rig.stops(here), base=rig.base(drive))
    shares: Array | None = None
    fidelity, harmonics = rig.case.fidelities[rig.name], rig.case.scene_of(rig.name).harmonics
    if harmonics:
        several = several_of(here, drive, harmonics, fidelity.solver)
        here, state = several.system, several.enter(state)
        shares = energy_shares(energy)  # the modes of ``here`` are without their steady responses
    continued = _stepped if SOLVERS[fidelity.solver].samples else _flown
    return continued(rig, head, here, drive, state, shares)


def _flown(
    rig: _MovingRig, head: StoredMotion, here: ImpactSystem, drive: Drive, state: State, shares: Array | None
) -> StoredMotion:
    turn, output, window = 2 * np.pi / drive.omega, rig.case.sweep.output, head.window
    path = simulate(here, drive, FLOWN * turn, state)
    if path.ended is not Ended.COMPLETE:
        return replace(head, fault=path.ended.value)
    curve = phase_portrait(path, output, periods=window, points=max(120, 480 // window))
    section = stroboscopic_section(path, output, periods=FLOWN)
    begin = path.t_end - window * turn
    hits = impacts_within(path, begin, path.t_end)
    return replace(
        head,
        time=(curve.time - curve.time[0]) / turn,
        displacement=curve.displacement,
        velocity=curve.velocity,
        impacts=np.column_stack([(hits[:, 0] - begin) / turn, hits[:, 1]]),
        section=np.column_stack([section.displacement, section.velocity]),
        lines=_lines(path.at(_samples(path.t_end, turn), output), turn),
        shares=modal_participation(path, output, periods=window).energy_share if shares is None else shares,
        deflection=_deflection(rig, here, path.modes_at(_frames(begin, path.t_end))[:, 0]),
    )


def _stepped(
    rig: _MovingRig, head: StoredMotion, here: ImpactSystem, drive: Drive, state: State, shares: Array | None
) -> StoredMotion:
    """Motion at the solver's own samples, thinned out."""
    turn, fidelity = 2 * np.pi / drive.omega, rig.case.fidelities[rig.name]
    made: Any = solver(fidelity.solver, here, drive.omega, 0.0, **fidelity.options)
    found = made.motion(drive, state, 0.0, FLOWN * turn)
    if found.ended is not Ended.COMPLETE:
        return replace(head, fault=found.ended.value)
    path, row, begin = SampledPath(found), here.output(rig.case.sweep.output), (FLOWN - head.window) * turn
    time, values = path.shown(begin, POINTS)
    strobes, struck = path.at(turn * np.arange(1.0, FLOWN + 1)), found.impact_times >= begin
    return replace(
        head,
        time=(time - begin) / turn,
        displacement=values[:, 0] @ row,
        velocity=values[:, 1] @ row,
        impacts=np.column_stack([(found.impact_times[struck] - begin) / turn, found.impact_velocities[struck]]),
        section=strobes @ row,
        lines=_lines(path.at(_samples(found.t_end, turn))[:, 0] @ row, turn),
        shares=path.energy_shares(begin) if shares is None else shares,
        deflection=_deflection(rig, here, path.at(_frames(begin, found.t_end))[:, 0]),
    )


def _samples(end: float, turn: float) -> Array:
    """Even times over all periods flown."""
    count = 8 * HARMONICS * FLOWN
    return np.asarray(end + (np.arange(count) - count) * (FLOWN * turn / count))


def _frames(begin: float, end: float) -> Array:
    return np.linspace(begin, end, FRAMES, endpoint=False)


def _lines(values: Array, turn: float) -> Array:
    """Amplitudes of the output at multiples of 1/FLOWN of the drive frequency: of a whole number of periods, no window.

    A motion that does not repeat within them leaks; its lines are those of this record.
    """
    lines: Array = spectrum_of(_samples(0.0, turn), values, window="boxcar").amplitude
    return np.asarray(lines[: HARMONICS * FLOWN + 1])


def _deflection(rig: _MovingRig, here: ImpactSystem, modes: Array) -> Array:
    """Deflections (frames, stations) of modal displacements (frames, n)."""
    if not rig.stations:
        return np.empty((0, 0))
    rows = np.stack([here.output(name) for name in rig.stations])
    return np.asarray(modes @ rows.T)
