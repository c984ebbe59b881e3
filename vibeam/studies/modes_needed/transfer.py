"""Transfer functions of a full and a reduced structure and their errors; and the contact's pulse."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np

from vibeam_models.arrays import Array, Complex
from vibeam_models.laws.mechanics import Spring
from vibeam_models.structure import Structure

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

    def response(self, load: Array, omega: Array) -> Complex:
        """Modal amplitudes q (F, n) under a harmonic ``load`` f (n,) at ``omega`` (F,): (ω_i² − ω² + iωC) q = f."""
        plain = self.omega**2 - omega[:, None] ** 2
        if not self.coupled:
            return np.asarray(load / (plain + 1j * omega[:, None] * np.diag(self.damping)))
        stiffness = plain[:, :, None] * np.eye(len(self.omega)) + 1j * omega[:, None, None] * self.damping
        return np.asarray(np.linalg.solve(stiffness, np.broadcast_to(load, plain.shape)[..., None])[..., 0])


@dataclass(frozen=True, eq=False)
class TransferStudy:
    """Transfer functions of a ``full`` model over frequencies ``mus`` (F,) in Hz: from the drive to contact, sensor."""

    full: ModalForm
    mus: Array

    @cached_property
    def exact(self) -> dict[str, Complex]:
        """Transfer functions (F,) of the full model."""
        return _transfers(self.full, self.mus)

    def errors_of(self, small: ModalForm) -> dict[str, Array]:
        """Errors (F,) of a reduced model in the transfer functions from the drive to ``"contact"`` and ``"sensor"``."""
        size = {name: np.maximum(np.abs(each), HOLLOW * np.abs(each).max()) for name, each in self.exact.items()}
        return {
            name: np.asarray(np.abs(found - self.exact[name]) / size[name])
            for name, found in _transfers(small, self.mus).items()
        }


def _transfers(form: ModalForm, mus: Array) -> dict[str, Complex]:
    rows = {"contact": form.structure.contact, "sensor": form.structure.outputs["sensor"]}
    solution = form.response(form.row(form.structure.load), 2 * np.pi * mus)
    return {name: solution @ form.row(row) for name, row in rows.items()}


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
