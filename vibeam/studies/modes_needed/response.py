"""Error of a reduced model's response over a case's sweep, against all modes: in closed form, else flown.

Motions with one impact a drive period, and those without any, are known in closed form at every frequency. Where all
modes have none of these at some frequency, or the stop has no closed forms, the sweep itself is flown: all modes once,
of reduced models as many as it takes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import nan
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift, gap_wear, system_of
from vibeam.case.reduced_structure import static_at_contact
from vibeam.periodic.motions import FREE, KINDS, closed_amplitudes, unsuited
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.estimate.of_case import LARGEST
from vibeam.runs.sweep import march
from vibeam.studies.modes_needed.losses import ALIKE, UNKNOWN, Amplitudes, ResponseError, response_error
from vibeam.system.curves import evenly
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import periodic
from vibeam_models.arrays import Array, Index
from vibeam_models.structure import Structure

COUNTS = (31, 7)  # frequencies of a sweep that is flown in place of a longer one; fewer where those cost too much
BUDGET = 6e7  # evaluations of the contact × modes that all modes' sweep may cost: about ten seconds
ENOUGH = 0.5  # share of the frequencies at which the full model's motion must be known for a recommendation
COLUMNS = 18  # of amplitudes by period: 0, which stays empty, 1 … 16, and −1, no contact, as the last

CHAOS = (
    "more than half of the motions of all modes do not repeat, and nothing can be claimed of their amplitudes; sweep "
    "where they repeat, or compare means over the plane by vibeam map --picture verdict"
)

COSTLY = (
    "the flight of all modes over a few frequencies takes more than ten seconds; write fewer periods (sweep.settle, "
    "sweep.hold) or fewer elements"
)


@dataclass(frozen=True)
class Claim:
    """Claim of a recommendation: it is of the amplitude at the ``frequencies`` of a sweep, against all ``modes``.

    Motions of all modes are known in ``closed`` form at so many of them, with impacts at ``struck``; at ``flown``
    points the sweep was flown, and ``repeating`` of its motions repeat. ``why_flown``: there are no closed forms.
    ``refused``: why nothing can be recommended by them.
    """

    modes: int = 0
    frequencies: int = 0
    closed: int = 0
    struck: int = 0
    flown: int = 0
    repeating: int = 0
    why_flown: str = ""
    refused: str = ""


@dataclass(frozen=True, eq=False)
class FullResponse:
    """Response of all modes of a case's ``structure`` over its sweep, with which reduced models are compared."""

    case: Case
    structure: Structure

    def system(self, small: Structure) -> ImpactSystem:
        """Impact system of the case with a structure in place of its own; ValueError for an impossible one."""
        scene: Any = self.case.scene
        return system_of(scene, small, self._static)

    def errors(self, structures: Sequence[Structure | None], accuracy: float) -> list[ResponseError]:
        """Error with each of the ``structures`` of a basis, the smaller first; flown until two in turn are within."""
        models = [self._tried(small) for small in structures]
        found = [UNKNOWN if model is None else self._error(model) for model in models]
        off = [i for i, each in enumerate(found) if each.total and not each.within(accuracy)]
        before = False
        for i in range(max(off, default=-1) + 1, len(models)):
            model = models[i]
            if model is None or found[i].complete:
                continue
            found[i] = self._error(model, accuracy)
            if before and found[i].within(accuracy):
                break
            before = found[i].within(accuracy)
        return found

    def in_closed_form(self, structures: Sequence[Structure | None]) -> list[ResponseError]:
        """Error with each of the ``structures`` at the motions that are known in closed form."""
        return [UNKNOWN if model is None else self._error(model) for model in map(self._tried, structures)]

    def _tried(self, small: Structure | None) -> ImpactSystem | None:
        """Impact system; None where there is none."""
        try:
            return None if small is None else self.system(small)
        except ValueError:  # a restitution of mode 1 that no contact gives, a contact without mass
            return None

    def _error(self, model: ImpactSystem, accuracy: float | None = None) -> ResponseError:
        """Error of a model in closed form; with an ``accuracy`` of its sweep too, up to where it is off by more."""
        suited, whole = not unsuited(model), None if accuracy is None or self._sweep[1] else self._sweep[0]
        try:
            pairs = [(self._in_closed_form(model), self.closed)] if self.share and suited else []
            if whole is not None and accuracy is not None:
                flight = self._flown(model, whole.which, partial(_near, whole, accuracy))
                pairs.append((flight, whole))
        except ValueError:  # a model that no flight can be made of
            return UNKNOWN
        given_up = any(found.done < len(found.values) for found, _ in pairs)
        complete = whole is not None or (self.share == 1 and suited)
        found = response_error(pairs)
        return replace(found, complete=complete, given_up=given_up, peak=nan if given_up else found.peak)

    @cached_property
    def known(self) -> Claim:
        """Claim by the closed forms alone."""
        known, struck = self.closed.points, np.isfinite(self.closed.values[:, :FREE]).any(axis=1)
        why, counts = self.no_closed_forms, (len(known), int(known.sum()), int(struck.sum()))
        return Claim(self.full.size, *counts, why_flown=why)

    @property
    def claim(self) -> Claim:
        """Claim by what is known of all modes, flown where the closed forms do not tell all."""
        if "_sweep" not in self.__dict__ and self.share == 1:
            return self.known
        sweep, refused = self._sweep
        return replace(self.known, flown=len(sweep.which), repeating=int(sweep.points.sum()), refused=refused)

    @cached_property
    def full(self) -> ImpactSystem:
        """System of all modes; ValueError where the case has none."""
        return self.system(self.structure)

    @cached_property
    def no_closed_forms(self) -> str:
        """Reason why there are no closed forms; empty where there are."""
        scene: Any = self.case.scene
        many = f"{self.full.size} modes are too many" if self.full.size > LARGEST else ""
        return without_closed_forms(scene, self._omega) or many or unsuited(self.full)

    @cached_property
    def closed(self) -> Amplitudes:
        """Closed-form motions of all modes at all frequencies."""
        if not self.no_closed_forms:
            return self._in_closed_form(self.full)
        every = np.arange(len(self._omega))
        return Amplitudes(every, self.case.sweep.frequency, np.full((len(every), len(KINDS)), np.nan), len(every))

    @cached_property
    def share(self) -> float:
        """Share of the frequencies with a closed-form motion of all modes."""
        return float(self.closed.points.mean())

    @cached_property
    def _sweep(self) -> tuple[Amplitudes, str]:
        """Sweep of all modes, and why it is of no use; empty where it is."""
        least = 0.0 if self.share >= ENOUGH else ENOUGH
        for most in COUNTS:
            which = self._thinned(most)
            found = self._flown(self.full, which, partial(_repeats, least * len(which)))
            if found.cost <= BUDGET or found.cost / found.done * len(self._thinned(COUNTS[-1])) > BUDGET:
                break
        too_few = np.count_nonzero(found.points) < least * len(which)
        return found, COSTLY if found.cost > BUDGET else CHAOS if too_few else ""

    def _thinned(self, most: int) -> Index:
        """Points of the sweep in the order flown, ``most`` frequencies evenly spread."""
        up = evenly(0, len(self._omega) - 1, most)
        return np.concatenate({"up": (up,), "down": (up[::-1],), "both": (up, up[::-1])}[self.case.sweep.direction])

    @cached_property
    def _static(self) -> float:
        return static_at_contact(self.structure)

    @cached_property
    def _omega(self) -> Array:
        return 2 * np.pi * self.case.sweep.frequency

    def _in_closed_form(self, system: ImpactSystem) -> Amplitudes:
        base = np.broadcast_to(np.asarray(self.case.amplitude(self._omega), dtype=float), self._omega.shape)
        values = closed_amplitudes(system, self._omega, base, self.case.sweep.output)
        return Amplitudes(np.arange(len(values)), self.case.sweep.frequency, values, len(values))

    def _flown(self, system: ImpactSystem, which: Index, goes_on: Callable[[Amplitudes], bool]) -> Amplitudes:
        """Amplitudes by period of the case's sweep at the points ``which``, as long as it ``goes_on``."""
        plan, scene, omega = self.case.sweep, self.case.scene, self._omega[which]
        values, first, cost = np.full((len(omega), COLUMNS), np.nan), 0, 0.0
        for response, _ in march(
            system, omega, self.case.amplitude(omega), settle=plan.settle, hold=plan.hold, output=plan.output,
            drift=gap_drift(scene, omega), wear=gap_wear(scene), harmonics=scene.harmonics,
        ):  # fmt: skip
            rows = np.flatnonzero(periodic(response))
            values[first + rows, response.period[rows]] = response.amplitude[rows]
            first, cost = first + len(response), cost + float(response.evaluations.sum()) * system.size
            found = Amplitudes(which, plan.frequency[which], values, first, cost)
            if not goes_on(found):
                break
        return found


def _repeats(least: float, found: Amplitudes) -> bool:
    """Test whether at least so many of the points can still repeat, within the budget."""
    still = len(found.values) - found.done + int(found.points.sum())
    return found.cost <= BUDGET and still >= least


def _near(whole: Amplitudes, accuracy: float, found: Amplitudes) -> bool:
    """Test whether a model can still be within the accuracy of the sweep of all modes."""
    ours, theirs = (replace(part, values=part.values[: found.done]) for part in (found, whole))
    error, missable = response_error([(ours, theirs)]), (1 - ALIKE) * int(whole.points.sum())
    return not abs(error.worst) > accuracy and error.total - error.points <= missable
