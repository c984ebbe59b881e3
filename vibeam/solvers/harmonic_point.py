"""A steady point under several harmonics: settled, then read period by period in the system's own modes.

The light oscillators that carry the further harmonics are larger by far than what they carry, so that a solver that
asks whether its state repeats sees them alone. So every period is watched by itself, and states are compared after
the oscillators are taken out.

Energies of the modes: what moves is η + f, f = Im(H e^{iνt}) for each ν = jΩ. Over whole periods T the mean energy is
that of η, which the solver gives, |H|²(ν² + ω²)/4, and between them Im(iνH V* + ω²H X*)/T with the Fourier integrals X
of η and V of η' at ν. The modes' equation gives X: (ω² − ν² + iνD) X = c F − Δη' − (iν + D) Δη. F, of the contact
force, is what that leaves in an oscillator without damping at ν that starts from nothing, so light that the motion does
not feel it.

At rest the exact solvers would have two modes of one frequency at the contact, which their closed form cannot tell
apart. Periods with a rest, and stops that yield, are integrated along the motion instead.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.trajectory import simulate
from vibeam.observe.motion import integral
from vibeam.observe.periodicity import repetition
from vibeam.solvers import SOLVERS, solver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.quantities import VELOCITIES_KEPT
from vibeam.system.response import Ended, FrequencyResponse, join
from vibeam.system.several_harmonics import SeveralHarmonics, Shares, further, solved, with_oscillators
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex


class ModeEnergies:
    """Mean energies of the modes of ``several.plain``, drive period by drive period."""

    def __init__(self, several: SeveralHarmonics, solver_name: str, slowest: float, options: Mapping[str, Any]) -> None:
        self.several, self.many = several, len(several.harmonics)
        self.exact = SOLVERS[solver_name].motion == "exact"
        self.yields = several.plain.contact_law.yields
        light = np.full(self.many, several.light)
        listening = with_oscillators(several.system, several.rates, light, outputs={}, derivatives={})
        self.solver = solver(solver_name, listening, slowest, **options)

    def of_period(self, free: Array, begin: State, end: State, rest: float) -> Array:
        """Mean energies (n,), J, over a period from phase 0 between two states of ``several.system``.

        ``free``: those of the modes as its solver gives them; ``rest``: share of the period at rest on the stop.
        """
        if self.exact and (rest > 0 or self.yields):
            return self._integrated(begin)
        several, own, n = self.several, self.several.plain, self.several.plain.size
        moved = end.displacement[:n] - begin.displacement[:n]
        faster = end.velocity[:n] - begin.velocity[:n]
        damping = np.diag(2 * own.zeta * own.omega) if own.coupling is None else own.coupling
        total, span = free[:n].copy(), 2 * np.pi / several.drive.omega
        for rate, response, force in zip(several.rates, several.responses, self._forces(begin), strict=True):
            pushed = own.contact * force - faster - 1j * rate * moved - damping @ moved
            place = solved(own, rate, pushed)
            pace = moved + 1j * rate * place
            between = 1j * rate * response * pace.conj() + own.omega**2 * response * place.conj()
            total += between.imag / span + np.abs(response) ** 2 * (rate**2 + own.omega**2) / 4
        return np.asarray(total)

    def _integrated(self, begin: State) -> Array:
        several = self.several
        span = 2 * np.pi / several.drive.omega
        path = simulate(several.system, several.drive, span, begin)

        def energies(times: Array) -> Array:
            moved, pace = several.in_own_modes(path.modes_at(times), times)
            return (pace**2 + (several.plain.omega * moved) ** 2) / 2

        edges = np.unique(np.clip([0.0, span, *path.contacts[:, 0], *path.contacts[:, :2].sum(axis=1)], 0.0, span))
        fastest = float(several.rates.max())
        pieces = [integral(path, low, high, energies, highest=fastest) for low, high in pairwise(edges.tolist())]
        return np.asarray(np.sum(pieces, axis=0) / span)

    def _forces(self, begin: State) -> Complex:
        """F (m,) over the period that begins so."""
        drive, nothing = self.several.drive, np.zeros(self.many)
        start = State(
            np.concatenate([begin.displacement, nothing]), np.concatenate([begin.velocity, nothing]), begin.resting
        )
        _, end = self.solver.steady(np.array([drive.omega]), drive.amplitude, start, 0, 1, "contact")
        swing, pace = end.displacement[-self.many :], end.velocity[-self.many :]
        return np.asarray((pace + 1j * self.several.rates * swing) / self.several.light)


REPEATS = 1e-5  # share of the motion's size by which states one period apart may differ, as in flight


def several_of(system: ImpactSystem, drive: Drive, shares: Shares, solver_name: str) -> SeveralHarmonics:
    """The system under a drive and further harmonics; ValueError for a solver that knows one harmonic alone."""
    if solver_name in SOLVERS and not SOLVERS[solver_name].harmonics:
        able = ", ".join(name for name, declared in SOLVERS.items() if declared.harmonics)
        raise ValueError(f"solver {solver_name!r} knows a drive of one harmonic: {able} take several")
    return SeveralHarmonics(system, drive, further(shares, drive))


def started(system: ImpactSystem, drive: Drive, shares: Shares, solver_name: str) -> tuple[ImpactSystem, State]:
    """The system that moves as this one under several harmonics, and its state at static equilibrium, phase 0."""
    several = several_of(system, drive, shares, solver_name)
    return several.system, several.enter(equilibrium(system))


def steady_point(
    several: SeveralHarmonics, state: State | None, settle: int, hold: int, *, solver_name: str, output: str,
    slowest: float, options: Mapping[str, Any],
) -> tuple[FrequencyResponse, State]:  # fmt: skip
    """One steady point (a response of length 1) and the state after it, both in the modes of ``several.plain``.

    ``settle`` and ``hold``: drive periods left out and read; ``state`` None: static equilibrium, where a point that
    fails leaves it too.
    """
    made = solver(solver_name, several.system, slowest, **options)
    start = equilibrium(several.plain) if state is None else state
    states = [several.enter(start)]
    parts: list[FrequencyResponse] = []
    for turn in range(min(settle, 1) + hold):
        part, after = made.steady(
            np.array([several.drive.omega]), several.drive.amplitude, states[-1],
            max(settle - 1, 0) if turn == 0 else 0, 1, output,
        )  # fmt: skip
        parts.append(part)
        states.append(after)
        if part.ended[0] != Ended.COMPLETE.code:
            return _failed(several, join(parts)), equilibrium(several.plain)
    found = join(parts)
    response = _over(several, found, states[-hold - 1 :], getattr(made, "repeats", REPEATS))
    energies = ModeEnergies(several, solver_name, slowest, options)
    each = [
        energies.of_period(free, begin, end, rest)
        for free, begin, end, rest in zip(
            found.mode_energy[-hold:], states[-hold - 1 : -1], states[-hold:], found.rest[-hold:].tolist(), strict=True
        )
    ]
    response.mode_energy[0] = np.mean(each, axis=0)
    return response, several.leave(states[-1])


def _failed(several: SeveralHarmonics, parts: FrequencyResponse) -> FrequencyResponse:
    """A point without numbers, with the reason and the work."""
    response = FrequencyResponse.empty(parts.frequency[:1], several.plain.size)
    response.ended[0] = parts.ended[-1]
    _work(response, parts)
    return response


def _work(response: FrequencyResponse, parts: FrequencyResponse) -> None:
    for name in ("impacts", "evaluations", "cpu_seconds"):
        getattr(response, name)[0] = getattr(parts, name).sum()


def _over(
    several: SeveralHarmonics, parts: FrequencyResponse, states: list[State], repeats: float
) -> FrequencyResponse:
    """The point over the periods between ``states``, the last of ``parts``."""
    response = FrequencyResponse.empty(parts.frequency[:1], several.plain.size)
    _work(response, parts)
    hold = len(states) - 1
    held = slice(len(parts) - hold, None)
    high, low = parts.maximum[held].max(), parts.minimum[held].min()
    struck, speeds = parts.impacts_per_period[held], parts.impact_velocities[held].ravel()
    response.ended[0] = Ended.COMPLETE.code
    response.maximum[0], response.minimum[0], response.amplitude[0] = high, low, (high - low) / 2
    response.reach[0], response.rest[0] = parts.reach[held].max(), parts.rest[held].mean()
    response.impacts_per_period[0] = struck.mean()
    if struck.any():
        response.impact_velocity[0] = (
            np.sum(np.where(struck > 0, struck * parts.impact_velocity[held], 0)) / struck.sum()
        )
        kept = speeds[np.isfinite(speeds)][-VELOCITIES_KEPT:]
        response.impact_velocities[0, VELOCITIES_KEPT - len(kept) :] = kept
    response.period[0] = _period(several, states, repeats) if struck.any() or response.rest[0] > 0 else -1
    return response


def _period(several: SeveralHarmonics, states: list[State], repeats: float) -> int:
    own = [several.leave(state) for state in states]
    strobes = np.array([[state.displacement, state.velocity] for state in own])
    return repetition(strobes, several.plain.omega, several.drive.omega, repeats)
