"""Numbers of one model on the way from the beam to the solid: natural frequencies, contact, restitution; its sweep."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import nan

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import system_of
from vibeam.case.reduced_structure import reduced_structure
from vibeam.extensions.solid.verdict.pairing import bending, inertias_along, partners
from vibeam.extensions.solid.verdict.steps import LadderStep
from vibeam.studies.modes import restitutions
from vibeam.studies.variants import Ensemble, swept, usual_numbers
from vibeam_models.arrays import Array
from vibeam_models.effects.field_points import FieldPoints, output_names
from vibeam_models.scene import Scene
from vibeam_models.structure import Structure, in_coordinates

FIRST = 3  # natural frequencies that are shown
PLACES = 25  # along each beam, at which shapes are compared
UNSEEN = 1e-6  # of the contact's row times √(moving mass): a mode that the contact does not see
TWIST = 0.02  # the same, from which a mode that does not bend the mean line is one of twist


@dataclass(frozen=True, eq=False)
class SteppedModel:
    """A model being read: its ``step``, reduced to so many ``modes``, which are paired with those of the ``beam``."""

    step: LadderStep
    modes: int
    beam: SteppedModel | None = field(default=None, repr=False)

    @cached_property
    def pointed(self) -> Scene:
        """The scene with outputs along its mean lines."""
        scene = self.step.scene
        lengths = (scene.beam.length, *(each.beam(scene).length for each in scene.named("opposite")))
        points = FieldPoints(*(tuple(np.linspace(0, length, PLACES).tolist()) for length in lengths))
        return replace(scene, effects=(*scene.effects, points))

    @cached_property
    def found(self) -> tuple[Structure, float]:
        """Structure in the lowest modes, with what they leave of the contact's flexibility; its static deflection."""
        try:
            return reduced_structure(self.pointed, "massless_boundary", self.modes)
        except ValueError:  # a free body has no static deflection
            return reduced_structure(self.pointed, "modal", self.modes)

    @property
    def reduced(self) -> Structure:
        """Structure in the lowest modes, more of a solid, of which some do not bend the mean line."""
        return self.found[0]

    @cached_property
    def omega(self) -> Array:
        """Angular natural frequencies (modes,), rad/s."""
        return np.asarray(np.sqrt(np.maximum(np.diag(self.reduced.K) / np.diag(self.reduced.M), 0.0)))

    @cached_property
    def shapes(self) -> Array:
        """Deflections and slopes (k, modes) of the mean lines, times the roots of what inertia each moves."""
        rows, scene = [], self.step.scene
        for name in ("beam", *("opposite" for _ in scene.named("opposite"))):
            for order, inertias in enumerate(inertias_along(scene, name, PLACES)):
                named = output_names(name, order, PLACES)
                rows += [size * self.reduced.outputs[each] for each, size in zip(named, np.sqrt(inertias), strict=True)]
        return np.array(rows)

    @cached_property
    def partners(self) -> tuple[np.ndarray, Array]:
        """Places of the modes that are those of the beam, −1 without one, and their likeness."""
        if self.beam is None:
            own = np.flatnonzero(bending(self.shapes))
            return own, np.ones(len(own))
        places = self.beam.partners[0]
        known = places >= 0
        found, near = np.full(len(places), -1), np.full(len(places), nan)
        found[known], near[known] = partners(self.beam.shapes[:, places[known]], self.shapes)
        return found, near

    @cached_property
    def kept(self) -> Structure:
        """Structure in the modes that the contact sees, up to the partner of the beam's last."""
        last = int(self.partners[0].max(initial=0))
        seen = np.abs(self.reduced.contact) * np.sqrt(self.step.scene.moving_mass) > UNSEEN
        chosen = np.flatnonzero(seen[: last + 1])
        return in_coordinates(self.reduced, np.eye(self.reduced.size)[:, chosen]).with_(contact_flexibility=0.0)

    @property
    def twisted(self) -> int:
        """Number of the first mode that moves the contact and not the mean line; 0 of a model without torsion."""
        moved = np.abs(self.reduced.contact) * np.sqrt(self.step.scene.moving_mass) > TWIST
        turned = ~bending(self.shapes) & moved
        return 1 + int(np.argmax(turned)) if self.step.scene.named("torsion") and turned.any() else 0

    def linear(self) -> dict[str, float]:
        """Its numbers without a drive; NaN of what it does not have, ValueError for an impossible model.

        ``f1`` … of the beam's bending modes and ``twist`` in Hz, ``flexibility`` of the contact in m/N, ``mobility`` of
        it in the modes kept in 1/kg, ``restitution`` of the contact and of mode 1, one of them the case's.
        """
        hertz, twisted, places = self.omega / (2 * np.pi), self.twisted, self.partners[0]
        mobility = float(np.sum(self.kept.contact**2))
        first_r, contact_r = restitutions(self.step.scene, float(self.reduced.contact[places[0]]), mobility)
        bent = {f"f{number}": float(hertz[at]) if at >= 0 else nan for number, at in enumerate(places, 1)}
        return bent | {
            "twist": float(hertz[twisted - 1]) if twisted else nan, "flexibility": self._flexibility(),
            "mobility": mobility, "restitution": contact_r if contact_r <= 1 else nan,
            "first_mode_restitution": first_r,
        }  # fmt: skip

    def ensemble(self, case: Case, fidelity: str) -> Ensemble:
        """Its sweep as that of a fidelity; ValueError for a restitution that no contact has."""
        system = system_of(self.pointed, self.kept, self.found[1])
        return swept(case, fidelity, usual_numbers(case), other=system)

    def _flexibility(self) -> float:
        """Σ c²/ω² of the modes and what these leave; NaN of a free body."""
        if not self.omega[0] > 0:
            return nan
        return float(np.sum((self.reduced.contact / self.omega) ** 2)) + self.reduced.contact_flexibility
