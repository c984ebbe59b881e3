"""Transfer functions of a full and a reduced structure and their errors, estimated too; and the contact's pulse."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from vibeam_models.arrays import Array, Complex
from vibeam_models.laws.mechanics import Spring
from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction

COUPLED = 1e-6  # share of off-diagonal modal damping from which it counts
INSTANTS = 65  # of a contact at which the half-sine pulse is looked at
HOLLOW = 0.01  # of the largest value in the band: what an error is relative to in an antiresonance


@dataclass(frozen=True, eq=False)
class ModalForm:
    """A structure in its natural modes: ``omega`` (n,) rad/s, modal ``damping`` (n, n), ``shapes`` (size, n)."""

    structure: Structure
    omega: Array
    damping: Array
    shapes: Array

    @classmethod
    def of(cls, structure: Structure) -> ModalForm:
        """The modal form, all modes."""
        modes = structure.modes()
        return cls(structure, modes.omega, structure.congruent("C", modes.shapes), modes.shapes)

    @cached_property
    def coupled(self) -> bool:
        """Test whether damping couples the modes."""
        scale = np.sqrt(np.abs(np.outer(np.diag(self.damping), np.diag(self.damping))))
        beside = np.abs(self.damping - np.diag(np.diag(self.damping)))
        return bool(np.any(beside > COUPLED * np.where(scale > 0, scale, 1.0)))

    def row(self, row: Array) -> Array:
        """A row of the structure on its modes."""
        return np.asarray(row @ self.shapes)

    def stiffness(self, omega: Array) -> Complex:
        """Dynamic stiffness ω_i² − ω² + iωC at ``omega`` (F,): (F, n), or (F, n, n) where modes couple."""
        plain = self.omega**2 - omega[:, None] ** 2
        if not self.coupled:
            return np.asarray(plain + 1j * omega[:, None] * np.diag(self.damping))
        return plain[:, :, None] * np.eye(len(self.omega)) + 1j * omega[:, None, None] * self.damping

    def response(self, load: Array, omega: Array) -> Complex:
        """Modal amplitudes (F, n) under a harmonic ``load`` (n,) of size 1."""
        stiffness = self.stiffness(omega)
        if not self.coupled:
            return np.asarray(load / stiffness)
        return np.asarray(np.linalg.solve(stiffness, np.broadcast_to(load, stiffness.shape[:2])[..., None])[..., 0])


@dataclass(frozen=True, eq=False)
class TransferErrors:
    """Errors (F,) of a transfer function over the band, relative to the full model's at the same frequency.

    Named as pyMOR's reduction_error_analysis names them: ``errors``, ``estimates`` (bounds that need the reduced
    solution and the full model's frequencies alone), ``effectivities`` = estimates / errors, the ``max_…`` over the
    band and where it falls, ``…_mu`` in Hz.
    """

    mus: Array
    errors: Array
    estimates: Array

    @property
    def effectivities(self) -> Array:
        """Estimates over errors (F,); NaN where the error is round-off."""
        sound = self.errors > 1e-12
        return np.where(sound, self.estimates / np.where(sound, self.errors, 1.0), np.nan)

    @property
    def max_error(self) -> float:
        """Largest error in the band."""
        return float(self.errors.max())

    @property
    def max_error_mu(self) -> float:
        """Frequency of the largest error, Hz."""
        return float(self.mus[np.argmax(self.errors)])

    @property
    def max_estimate(self) -> float:
        """Largest estimate in the band."""
        return float(self.estimates.max())

    @property
    def max_estimate_mu(self) -> float:
        """Frequency of the largest estimate, Hz."""
        return float(self.mus[np.argmax(self.estimates)])


@dataclass(frozen=True, eq=False)
class TransferStudy:
    """Transfer functions of a ``full`` model over frequencies ``mus`` (F,) in Hz: from the drive to contact, sensor."""

    full: ModalForm
    mus: Array

    @cached_property
    def omega(self) -> Array:
        """The frequencies in rad/s."""
        return 2 * np.pi * self.mus

    @cached_property
    def load(self) -> Array:
        """The drive's load on the full model's modes."""
        return self.full.row(self.full.structure.load)

    @cached_property
    def _solution(self) -> Complex:
        return self.full.response(self.load, self.omega)

    @cached_property
    def _weights(self) -> Array:
        """Modal stiffness (n,) by which residuals are measured, with the first elastic one added for a free body."""
        squared = self.full.omega**2
        elastic = squared[squared > 1e-9 * squared[-1]]
        return squared if len(elastic) == len(squared) else squared + elastic[0]

    @cached_property
    def stability(self) -> Array:
        """Least singular value (F,) of the dynamic stiffness in the measure of the weights: the inf-sup constant."""
        stiffness, scale = self.full.stiffness(self.omega), np.sqrt(self._weights)
        if not self.full.coupled:
            return np.asarray(np.abs(stiffness / self._weights).min(axis=1))
        return np.asarray(np.linalg.svd(stiffness / np.outer(scale, scale), compute_uv=False)[:, -1])

    def errors_of(self, reduction: Reduction, small: ModalForm, name: str) -> TransferErrors:
        """Errors of a reduction in the transfer function from the drive to ``"contact"`` or an output of the name."""
        row, own = (_row(each, name) for each in (self.full, small))
        exact, found = self._solution @ row, small.response(small.row(small.structure.load), self.omega) @ own
        size = np.maximum(np.abs(exact), HOLLOW * np.abs(exact).max())
        carried = self.full.shapes.T @ (self.full.structure.M @ (reduction.basis @ small.shapes))
        primal = self._residual(self.load, carried, small.response(small.row(small.structure.load), self.omega))
        dual = self._residual(row, carried, small.response(own, self.omega))
        return TransferErrors(self.mus, np.abs(found - exact) / size, primal * dual / self.stability / size)

    def _residual(self, load: Array, carried: Array, amplitudes: Complex) -> Array:
        """‖f − A Φq‖ (F,), measured by the inverse of the weights."""
        moved = amplitudes @ carried.T
        stiffness: Any = self.full.stiffness(self.omega)
        borne = np.einsum("fij,fj->fi", stiffness, moved) if self.full.coupled else stiffness * moved
        return np.asarray(np.sqrt(np.sum(np.abs(load - borne) ** 2 / self._weights, axis=1)))


def _row(form: ModalForm, name: str) -> Array:
    return form.row(form.structure.contact if name == "contact" else form.structure.outputs[name])


def contact_time(form: ModalForm, law: Spring) -> float:
    """Contact time in s of a linear stop on a structure, without the stop's damping.

    With the spring k at the contact row c the modes are those of diag(ω²) + k cᵀc; the share of mode i's energy that
    is in the spring is k (cφ_i)²/ω_i². T = π/ω of the one with the largest share.
    """
    c = form.row(form.structure.contact)
    squared, shapes = np.linalg.eigh(np.diag(form.omega**2) + law.stiffness * np.outer(c, c))
    shares = law.stiffness * (c @ shapes) ** 2 / squared
    return float(np.pi / np.sqrt(squared[np.argmax(shares)]))


@dataclass(frozen=True)
class ContactPulse:
    """A half-sine force at the contact for ``duration`` s, on a stop of ``stiffness`` N/m (∞: rigid)."""

    duration: float
    stiffness: float = inf

    def deflection(self, omega: Array, c: Array, flexibility: float = 0.0) -> Array:
        """Displacement (INSTANTS,) of the contact in m per N, undamped modes, from rest.

        η'' + ω²η = c sin νt, ν = π/T: η = c (sin νt − (ν/ω) sin ωt)/(ω² − ν²). ``flexibility``: without mass, m/N.
        """
        nu, times = np.pi / self.duration, np.linspace(0, self.duration, INSTANTS)[:, None]
        apart = omega**2 - nu**2
        near = np.abs(apart) < 1e-9 * nu**2
        swung = times * np.sinc(omega * times / np.pi)
        usual = (np.sin(nu * times) - nu * swung) / np.where(near, 1.0, apart)
        resonant = (np.sin(nu * times) - nu * times * np.cos(nu * times)) / (2 * nu**2)
        return np.asarray(np.where(near, resonant, usual) @ c**2 + flexibility * np.sin(nu * times[:, 0]))

    def error(self, full: Array, found: Array) -> float:
        """Largest difference of two such deflections, relative to the largest approach of beam and stop together."""
        approach = full + np.sin(np.pi * np.linspace(0, 1, INSTANTS)) / self.stiffness
        return float(np.abs(found - full).max() / np.abs(approach).max())
