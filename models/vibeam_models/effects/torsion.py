"""The strip twists when the stop meets it off its axis: St Venant torsion beside the bending."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.elements import assembled, basis_of
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure, side_by_side

TERMS = 40  # of the series, where tanh is 1 and the rest of Σ n⁻⁵ is below 10⁻⁹


@dataclass(frozen=True)
class Torsion(Effect):
    """The stop meets the beam off its axis and twists it; absent = on the axis.

    The modes of torsion count among the beam's, for damping ratios and for fidelities.
    """

    eccentricity: float = quantity("m", "of the contact, across the beam", "1 mm")
    polar_inertia: float = quantity("kg m^2", "of the attached mass about the beam's axis", "2.988e-5 kg m^2", above=0)
    poissons_ratio: float | None = quantity(
        "", "of the beam, gives its shear modulus; absent = beam's, or say that", 0.3, None, least=0, most=1
    )
    shear_modulus: float | None = quantity("Pa", "of the beam, instead of Poisson's ratio", "80 GPa", None, above=0)

    name: ClassVar[str] = "torsion"
    inertias: ClassVar[int] = 1
    modes_per_element: ClassVar[int] = 2

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: one shear modulus, said once, a contact on the beam, a mass that twists."""
        if case.mass is None:
            yield "", "has the polar inertia of the attached mass: add [mass], or take [torsion] out"
        given = [name for name in ("poissons_ratio", "shear_modulus") if getattr(table, name) is not None]
        if len(given) == 2:
            yield "poissons_ratio", "shear_modulus says it already: keep one of the two"
        elif not given and case.beam.poissons_ratio is None:
            yield "poissons_ratio", "missing (or shear_modulus): write poissons_ratio = 0.3"
        elif table.poissons_ratio is not None and case.beam.poissons_ratio not in (None, table.poissons_ratio):
            yield "poissons_ratio", f"beam.poissons_ratio says {case.beam.poissons_ratio:g}: leave it out here"
        elif table.poissons_ratio is not None and table.poissons_ratio > 0.5:
            yield "poissons_ratio", f"{table.poissons_ratio:g} is above 0.5, where the volume grows under pressure"
        if (case.beam.shape or "rectangle") != "rectangle" or case.section or case.plate or case.beam.ends:
            yield "", "is that of a uniform rectangular cantilever: take [torsion] out"
        width = case.beam.width
        if table.eccentricity is not None and width is not None and abs(table.eccentricity) > width / 2:
            yield "eccentricity", f"{table.eccentricity:g} m is beside the beam: beam.width is {width:g} m"

    def modulus(self, beam: Beam) -> float:
        """The shear modulus in Pa: as given, or E/2(1 + ν) with ν of its own, else the beam's."""
        if self.shear_modulus is not None:
            return self.shear_modulus
        ratio = beam.poissons_ratio if self.poissons_ratio is None else self.poissons_ratio
        return beam.youngs_modulus / (2 * (1 + (ratio or 0.0)))

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """The structure and, uncoupled but for the contact's row w + eθ, the twist of the beam held at x = 0.

        ValueError in a scene without an attached mass, and of a beam that is not uniform and rectangular.
        """
        twist = self._twist(space.nodes, scene)
        contact = np.concatenate([structure.contact, self.eccentricity * twist.contact])
        return side_by_side(structure, twist, contact), space.widened(twist.size)

    def _twist(self, nodes: Array, scene: Scene) -> Structure:
        """The twist alone, quadratic elements of scikit-fem on the same nodes; the contact row reads its angle."""
        basis = basis_of(nodes, "ElementLineP2", order=4)
        mass_at = scene.attached(self.name).position
        free = _elimination(basis.doflocs[0], mass_at, scene.rigid_half_width, scene.beam.length)
        inertia = assembled(basis, lambda u, v, _: u * v) * inertia_per_length(scene.carrier)
        stiffness = assembled(basis, lambda u, v, _: u.grad[0] * v.grad[0]) * self.rigidity(scene.carrier)
        at_mass = _row(basis, mass_at) @ free
        mass = free.T @ inertia @ free + self.polar_inertia * np.outer(at_mass, at_mass)
        none, angle = np.zeros(len(mass)), _row(basis, scene.stop.position) @ free
        return Structure(
            _symmetric(mass), np.zeros_like(mass), _symmetric(free.T @ stiffness @ free), none, none, angle
        )

    def rigidity(self, beam: Beam) -> float:
        """GJ_t of ``beam`` in N m²."""
        section = _section(beam)
        return self.modulus(beam) * torsion_constant(section.width, section.thickness)


def inertia_per_length(beam: Beam) -> float:
    """ρI_p in kg m: b² + t² over 12 of the mass per length."""
    section = _section(beam)
    return float(beam.mass_per_length * (section.width**2 + section.thickness**2) / 12)


def _section(beam: Beam) -> Rectangle:
    if not (beam.is_uniform and isinstance(beam.shape, Rectangle)):
        raise ValueError("torsion: is that of a uniform rectangular beam")
    return beam.shape


def _elimination(places: Array, mass_at: float, rigid_half_width: float, length: float) -> Array:
    """All angles by the free ones: none at the clamp, one for the whole rigid zone."""
    within = np.abs(places - mass_at) <= rigid_half_width + 1e-8 * length
    first = int(np.argmin(np.abs(places - mass_at)))
    full = np.eye(len(places))
    if rigid_half_width > 0:
        full[within] = np.eye(len(places))[first]
    gone = (places == 0) | (within & (np.arange(len(places)) != first) & (rigid_half_width > 0))
    return np.asarray(full[:, ~gone])


def _row(basis: Any, x: float) -> Array:
    """Row that reads the angle at ``x`` m."""
    return np.asarray(basis.probes(np.array([[x]])).toarray()[0])


def torsion_constant(width: float, thickness: float) -> float:
    """J_t in m⁴ of a rectangle, St Venant's series: bt³/3 (1 − 192t/(π⁵b) Σ tanh(nπb/2t)/n⁵), n odd, b ≥ t."""
    b, t = max(width, thickness), min(width, thickness)
    n = np.arange(1, 2 * TERMS, 2)
    series = float(np.sum(np.tanh(n * np.pi * b / (2 * t)) / n**5.0))
    return b * t**3 / 3 * (1 - 192 * t / (np.pi**5 * b) * series)


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)
