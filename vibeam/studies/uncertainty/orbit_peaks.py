"""Peaks by orbits: a control variate for the peak of a sweep, of systems that no closed form takes.

The case is swept once at its own values. At others, Newton's method leads from the states at some of its frequencies to
the orbits there, and from the highest of these to its neighbours, until they are next to it on the grid. The peak is
that of the highest stable orbit with impacts: which of the motions a sweep would be on is not asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from time import thread_time
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift, system
from vibeam.flight.solver import exact_solver
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import near
from vibeam.periodic.shooting import NoOrbit, shoot
from vibeam.periodic.stroboscopic import MotionEnded, StroboscopicMap
from vibeam.runs.estimate.of_case import without_orbits
from vibeam.runs.sweep import march
from vibeam.studies.uncertainty.samples import EVERY, Responses, known
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case


def orbits_known(case: Case, fidelity: str) -> bool:
    """Test whether a fidelity's peaks are known by orbits, and not in closed form."""
    scene, omega = case.scene_of(fidelity), 2 * np.pi * case.sweep.frequency
    refused = without_orbits(scene) or gap_drift(scene, omega) is not None
    readable = case.system(fidelity).derivative(case.sweep.output) is None
    return not refused and readable and case.fidelities[fidelity].solver == "flight" and not known(case, fidelity)


Start = tuple[int, State, int]  # place in the sweep's frequencies, state at the drive's phase 0, periods


@dataclass(frozen=True)
class OrbitPeaks:
    """Peaks of a case by orbits at other values of its uncertain inputs, over the frequencies of its sweep.

    ``starts``: by fidelity, motions at the case's own values, and the CPU time that their sweep took, s.
    """

    case: Case
    keys: tuple[str, ...]
    starts: dict[str, tuple[tuple[Start, ...], float]] = field(default_factory=dict)

    def begun(self, fidelity: str) -> float:
        """Sweep at the case's own values, unless it was made before: the CPU time that it took, s."""
        if fidelity not in self.starts:
            begin = thread_time()
            self.starts[fidelity] = tuple(self._swept(fidelity)), thread_time() - begin
        return self.starts[fidelity][1]

    def _swept(self, fidelity: str) -> Iterator[Start]:
        plan, omega = self.case.sweep, self._omega
        points = march(
            self.case.system(fidelity), omega, self.case.amplitude_of(fidelity, omega), settle=plan.settle,
            hold=plan.hold, output=plan.output,
        )  # fmt: skip
        for place, (response, state) in enumerate(points):
            if place % EVERY == 0 and response.period[0] > 0:
                yield place, state, int(response.period[0])

    @property
    def _omega(self) -> Array:
        return np.sort(2 * np.pi * self.case.sweep.frequency)

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d): their peaks alone; NaN where none of the orbits is left."""
        self.begun(fidelity)
        model, peak, seconds = self.case.model(fidelity), np.empty(len(inputs)), np.empty(len(inputs))
        for number, values in enumerate(inputs):
            begin = thread_time()
            scene = model.at(dict(zip(self.keys, values, strict=True))).scene()
            base = np.broadcast_to(np.asarray(drive_amplitude(scene, self._omega), dtype=float), self._omega.shape)
            curve = _OrbitsOverSweep(system(scene, model.fidelity), self._omega, base, self.case.sweep.output)
            peak[number] = curve.peak(self.starts[fidelity][0])
            seconds[number] = thread_time() - begin
        return Responses.of_peaks(fidelity, inputs, peak, seconds)


class _OrbitsOverSweep:
    """Stable orbits with impacts of one system at drives ``omega`` (points,) rad/s, ``base`` m, as they are found."""

    def __init__(self, made: ImpactSystem, omega: Array, base: Array, output: str) -> None:
        self._runner, self._omega, self._base, self._output = exact_solver(made, float(omega[0])), omega, base, output
        self._heights: dict[int, float] = {}
        self._orbits: dict[int, Orbit] = {}

    def peak(self, starts: tuple[Start, ...]) -> float:
        """Height of the highest orbit, NaN without any."""
        for place, state, periods in starts:
            with suppress(NoOrbit, MotionEnded):
                self._note(place, near(self._section(place), state, periods))
        step = EVERY // 2
        while step and self._heights:
            top = max(self._heights, key=lambda place: self._heights[place])
            for place in (top - step, top + step):
                self._follow(place, self._orbits[top])
            step //= 2
        return max(self._heights.values(), default=np.nan)

    def _section(self, place: int) -> StroboscopicMap:
        drive = Drive(float(self._omega[place]), float(self._base[place]))
        return StroboscopicMap(self._runner.system, drive, runner=self._runner)

    def _follow(self, place: int, beside: Orbit) -> None:
        """Note the orbit at a place on the grid from one beside it."""
        if 0 <= place < len(self._omega) and place not in self._heights:
            section = self._section(place)
            phase = beside.time * beside.drive.omega
            with suppress(NoOrbit, MotionEnded):
                self._note(place, shoot(section.at(phase / section.drive.omega), beside.state, beside.periods))

    def _note(self, place: int, orbit: Orbit) -> None:
        if orbit.stable and len(orbit.times):
            self._heights[place], self._orbits[place] = orbit.amplitude(self._output), orbit
