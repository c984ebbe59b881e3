"""Numbers of one model on the way from the beam to the solid: natural frequencies, contact, restitution, peak."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import nan

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import system_of
from vibeam.case.reduced_structure import reduced_structure
from vibeam.periodic.motion_kind import IRREGULAR, UNKNOWN
from vibeam.runs.comparison.beyond import response_of
from vibeam.runs.comparison.places import SweptPlace
from vibeam.runs.comparison.responses import Response
from vibeam.studies.solid.pairing import bending, inertias_along, partners
from vibeam.studies.solid.steps import LadderStep
from vibeam.studies.swept_numbers import CHANCE, refined_peak
from vibeam_models.arrays import Array
from vibeam_models.effects.field_points import FieldPoints, output_names
from vibeam_models.laws.restitution import first_mode_restitution, needed_restitution
from vibeam_models.scene import Scene
from vibeam_models.structure import Structure, in_coordinates

FIRST = 3  # natural frequencies that are judged and shown
PLACES = 25  # along each beam, at which shapes are compared
UNSEEN = 1e-6  # of the contact's row times √(moving mass): a mode that the contact does not see
TWIST = 0.02  # the same, from which a mode that does not bend the mean line is one of twist


@dataclass(frozen=True)
class LadderModel:
    """One model: natural ``frequencies`` (Hz) of the beam's bending modes, their ``likeness``; NaN without.

    ``numbers``: of these modes among all. ``twist``: first natural frequency of torsion, Hz, mode ``twist_number``.
    ``flexibility``: of the contact, m/N; ``mobility``: of it in the ``modes`` up to the partner of the beam's last,
    1/kg; ``restitution`` of the contact and of mode 1, one of them the case's. ``peak`` (m) of the sweep at
    ``peak_frequency`` (Hz); ``rms``: of its amplitudes from the solid's at the same drive frequencies. NaN: not known,
    ``why`` or ``why_no_peak``.
    ``unread``: keys of the case that it does not read.
    """

    name: str
    cause: str
    frequencies: tuple[float, ...] = ()
    likeness: tuple[float, ...] = ()
    numbers: tuple[int, ...] = ()
    twist: float = nan
    twist_number: int = 0
    flexibility: float = nan
    mobility: float = nan
    modes: int = 0
    restitution: float = nan
    first_mode_restitution: float = nan
    peak: float = nan
    peak_frequency: float = nan
    rms: float = nan
    cpu_seconds: float = 0.0
    why: str = ""
    why_no_peak: str = ""
    unread: tuple[str, ...] = ()

    def value(self, quantity: str) -> float:
        """Value of a quantity: ``"f1"`` … of the natural frequencies, else the field of that name."""
        if quantity[0] == "f" and quantity[1:].isdecimal():
            place = int(quantity[1:]) - 1
            return self.frequencies[place] if place < len(self.frequencies) else nan
        found: float = getattr(self, quantity)
        return found


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

    def linear(self) -> LadderModel:
        """Its numbers but the peak; ValueError for an impossible model."""
        scene = self.step.scene
        omega = np.sqrt(np.maximum(np.diag(self.reduced.K) / np.diag(self.reduced.M), 0.0))
        places, alike = self.partners
        mobility = float(np.sum(self.kept.contact**2))
        contact_r, first_r = _restitutions(scene, float(self.reduced.contact[places[0]]), mobility)
        return LadderModel(
            self.step.name,
            self.step.cause,
            tuple(float(omega[at]) / (2 * np.pi) if at >= 0 else nan for at in places),
            tuple(alike.tolist()),
            tuple((places + 1).tolist()),
            *self._twist(omega),
            self._flexibility(omega),
            mobility,
            self.kept.size,
            contact_r,
            first_r,
            unread=self.step.keys,
        )

    def response(self, case: Case, fidelity: str) -> Response:
        """Its sweep, as that of a fidelity; ValueError for a restitution that no contact has."""
        made = response_of(case, fidelity, system_of(self.pointed, self.kept, self.found[1]), len(case.sweep.frequency))
        assert made is not None  # its work is not bounded
        return made

    def _twist(self, omega: Array) -> tuple[float, int]:
        """Frequency and number of the first mode that moves the contact and not the mean line; NaN and 0 of none."""
        moved = np.abs(self.reduced.contact) * np.sqrt(self.step.scene.moving_mass) > TWIST
        turned = ~bending(self.shapes) & moved
        if not (self.step.scene.named("torsion") and turned.any()):
            return nan, 0
        first = int(np.argmax(turned))
        return float(omega[first]) / (2 * np.pi), first + 1

    def _flexibility(self, omega: Array) -> float:
        """Σ c²/ω² of the modes and what these leave; NaN of a free body."""
        if not omega[0] > 0:
            return nan
        return float(np.sum((self.reduced.contact / omega) ** 2)) + self.reduced.contact_flexibility


def _restitutions(scene: Scene, first: float, mobility: float) -> tuple[float, float]:
    """Restitution of the contact, NaN where none in [0, 1] gives that of mode 1, and of mode 1; NaN of other laws."""
    given = scene.stop.usual_restitution
    if scene.stop.law is not None:
        return nan, nan
    if scene.stop.restitution_of == "contact":
        return given, first_mode_restitution(given, first, mobility)
    needed = needed_restitution(given, first, mobility)
    return needed if 0 <= needed <= 1 else nan, given


def with_peak(model: LadderModel, response: Response) -> LadderModel:
    """The model with the peak of its sweep, refined between the points; none where its motion does not repeat."""
    top = refined_peak(response)
    if top.why == CHANCE:
        return replace(model, why_no_peak=CHANCE)
    return replace(model, peak=top.amplitude, peak_frequency=top.frequency, why_no_peak=top.why)


def distance(ours: Response, other: Response) -> float:
    """Rms of the relative distances of amplitudes at the same frequencies, where both repeat; NaN of less than half."""
    pairs = [pair for way, places in other.places.items() for pair in zip(ours.places[way], places, strict=True)]
    off = [one.amplitude / two.amplitude - 1 for one, two in pairs if _repeats(one) and _repeats(two) and two.amplitude]
    return float(np.sqrt(np.mean(np.square(off)))) if 2 * len(off) >= len(pairs) else nan


def _repeats(place: SweptPlace) -> bool:
    return place.kind.periods not in (IRREGULAR, UNKNOWN)
