"""Motions at the stored points of a run: each goes on from the state that its file holds, exactly.

A few drive periods are flown, so that a reader may look at any of the points without running the sweep again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import gap_drift, system
from vibeam.flight.trajectory import Trajectory, simulate
from vibeam.observe.motion import impacts_within
from vibeam.observe.participation import modal_participation
from vibeam.observe.poincare import stroboscopic_section
from vibeam.observe.portrait import phase_portrait
from vibeam.observe.spectrum import spectrum_of
from vibeam.solvers import SOLVERS
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam_models.outputs import Output
from vibeam_models.scene import Scene

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.run.stored_result import StoredResult


Array = NDArray[np.float64]

WINDOW = 4  # drive periods shown of a motion that does not repeat within them

FLOWN = 16  # drive periods flown, of which the spectrum is

LINES = 16  # highest drive harmonic of the spectrum

FRAMES = 32  # of the moving beam over the window

STATIONS = 25  # places along the beam at which it is drawn


def _none() -> Array:
    return np.empty(0)


@dataclass(frozen=True)
class StoredMotion:
    """Motion of one fidelity at a stored point, on from its state; ``fault`` says why there is none.

    ``frequency`` Hz, ``window`` drive periods shown. ``time`` in drive periods, ``displacement`` and ``velocity`` of
    the output (SI), both sides of each impact; ``impacts`` (k, 2): times in drive periods, contact velocities just
    before, m/s. ``section`` (m, 2): displacement and velocity at the drive's phase 0. ``lines``: amplitudes of the
    output at multiples of 1/16 of the drive frequency, from 0 on. ``shares``: of the modes in the mean energy.
    ``deflection`` (frames, stations) in m: the beam, evenly over the window; empty where no places are known.
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
        rigs = {name: _Rig(case, name) for name, _, _ in ways}
        for name, direction, response in ways:
            states = self.stored.states[name, direction]
            for point in np.unique([int(np.argmin(np.abs(response.frequency - each))) for each in self.frequency]):
                state, at = states[point], float(response.frequency[point])
                ended = Ended.of_code(int(response.ended[point]))
                if state is None or ended is not Ended.COMPLETE:
                    why = ended.value if ended is not Ended.COMPLETE else "the file has no state of this point"
                    yield StoredMotion(name, direction, at, fault=why)
                    continue
                yield _motion(rigs[name], direction, at, int(response.period[point]), state)


@dataclass(frozen=True)
class _Rig:
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


def stations(case: Case, name: str) -> dict[str, float]:
    """Places (m) along the beam at which it is drawn, by name; empty where no places are known."""
    scene = case.scene_of(name)
    if not isinstance(scene, Scene):
        return {}
    taken = {each.name for each in scene.outputs}
    places = np.linspace(0, scene.beam.length, STATIONS)[1:]
    return {made: float(x) for x in places if (made := f"at {x:.6g} m") not in taken}


def _motion(rig: _Rig, direction: str, frequency: float, period: int, state: object) -> StoredMotion:
    case, name, output = rig.case, rig.name, rig.case.sweep.output
    if case.scene_of(name).harmonics:
        return StoredMotion(name, direction, frequency, fault="a drive of several harmonics is not shown here")
    if SOLVERS[case.fidelities[name].solver].samples:
        why = f"{case.fidelities[name].solver} steps on by itself: see the figure kind history"
        return StoredMotion(name, direction, frequency, fault=why)
    here, drive = rig.at(frequency)
    turn = 2 * np.pi / drive.omega
    path = simulate(here, drive, FLOWN * turn, state)  # type: ignore[arg-type]
    if path.ended is not Ended.COMPLETE:
        return StoredMotion(name, direction, frequency, fault=path.ended.value)
    window = period if 1 <= period <= WINDOW else 1 if period == -1 else WINDOW
    curve = phase_portrait(path, output, periods=window, points=max(120, 480 // window))
    section = stroboscopic_section(path, output, periods=FLOWN)
    begin = path.t_end - window * turn
    hits = impacts_within(path, begin, path.t_end)
    return StoredMotion(
        name,
        direction,
        frequency,
        window,
        (curve.time - curve.time[0]) / turn,
        curve.displacement,
        curve.velocity,
        np.column_stack([(hits[:, 0] - begin) / turn, hits[:, 1]]),
        np.column_stack([section.displacement, section.velocity]),
        _lines(path, output, turn),
        modal_participation(path, output, periods=window).energy_share,
        _deflection(path, rig.stations, np.linspace(begin, path.t_end, FRAMES, endpoint=False)),
    )


def _lines(path: Trajectory, output: str, turn: float) -> Array:
    """Amplitudes of the output at multiples of 1/FLOWN of the drive frequency: of a whole number of periods, no window.

    A motion that does not repeat within them leaks; its lines are those of this record.
    """
    samples = 8 * LINES * FLOWN
    times = path.t_end + (np.arange(samples) - samples) * (FLOWN * turn / samples)
    return spectrum_of(times, path.at(times, output), window="boxcar").amplitude[: LINES * FLOWN + 1]


def _deflection(path: Trajectory, places: Mapping[str, float], times: Array) -> Array:
    if not places:
        return np.empty((0, 0))
    rows = np.stack([path.system.output(name) for name in places])
    return np.asarray(path.modes_at(times)[:, 0] @ rows.T)
