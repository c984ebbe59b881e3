"""Energies of modes under several harmonics, whose solver sees them without their steady responses.

What moves is η + f, f = Im(H e^{iνt}) for each ν = jΩ. Over whole periods T the mean energy is that of η, which the
solver gives, |H|²(ν² + ω²)/4, and between them Im(iνH V* + ω²H X*)/T with the Fourier integrals X of η and V of η'
at ν. The modes' equation gives X: (ω² − ν² + iνD) X = c F − Δη' − (iν + D) Δη. F, of the contact force, is what that
leaves in an oscillator without damping at ν that starts from nothing, so light that the motion does not feel it.

At rest the exact solvers would have two modes of one frequency at the contact, which their closed form cannot tell
apart. Periods with a rest, and stops that yield, are integrated along the motion instead.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from vibeam.flight.trajectory import simulate
from vibeam.observe.quadrature import integral
from vibeam.solvers import SOLVERS, solver
from vibeam.solvers.several_harmonics import SeveralHarmonics, solved
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex
from vibeam_models.laws.compliant import CompliantStop


class ModeEnergies:
    """Mean energies of the modes of ``several.plain``, drive period by drive period."""

    def __init__(self, several: SeveralHarmonics, solver_name: str, slowest: float, options: Mapping[str, Any]) -> None:
        self.several, self.many = several, len(several.harmonics)
        self.exact = SOLVERS[solver_name].motion == "exact"
        self.yields = several.plain.law is not None and isinstance(several.plain.law, CompliantStop)
        nothing, own = np.zeros(self.many), several.system
        self.listening = replace(
            own,
            omega=np.concatenate([own.omega, several.rates]),
            zeta=np.concatenate([own.zeta, nothing]),
            contact=np.concatenate([own.contact, nothing + several.light]),
            load=np.concatenate([own.load, nothing]),
            static=np.concatenate([own.static, nothing]),
            outputs={},
            derivatives={},
            coupling=None if own.coupling is None else np.pad(own.coupling, (0, self.many)),
        )
        self.solver = solver(solver_name, self.listening, slowest, **options)

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
