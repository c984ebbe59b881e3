"""Mode 1's share of an impact: the restitution that a sensor shows of a contact, and the contact that it needs.

Of a rigid stop R₁ = (1 + R) c₁²/S − 1. Of one that yields one impact of the modes is flown: mode 1 moves toward the
stop, all others are at rest. R is then that of a free mass 1/S.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import nan
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from vibeam.case.source import of_source
from vibeam.casefile.tables.table import plan_with
from vibeam.extensions.dictionary.plan import ModeSharePlan
from vibeam.extensions.dictionary.terms import ContactTerm, contact_terms
from vibeam.solvers.collision import struck
from vibeam.studies.contact_time import NODE, contacts, counting
from vibeam.studies.derive import beam_of, speed_of
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.base import Base
from vibeam_models.beam import assemble
from vibeam_models.laws.restitution import first_mode_restitution, needed_restitution
from vibeam_models.laws.yielding import Linear

if TYPE_CHECKING:
    from vibeam.studies.contact_time import ContactAtSpeed
    from vibeam_models.arrays import Array
    from vibeam_models.laws import ContactLaw
    from vibeam_models.scene import Scene
    from vibeam_models.structure import Structure

MOST = 32  # modes with a rigid stop, before all of the mesh
LEAST = 0.02  # restitution below which none is looked for
WITHIN = 1e-6  # of the restitution that is
REPEATS = 3  # until stiffness and restitution go together


@dataclass(frozen=True)
class ModeShare:
    """Model of so many ``modes``: mode 1's ``share`` c₁²/S of the contact's mobility S, and the ``mass`` 1/S, kg.

    ``seen``: the R₁ that a sensor shows of mode 1 with the contact of the case, NaN where that is no impact but lasts
    more than a quarter of mode 1's period; ``needed``: the contact's R where a sensor shows the case's coefficient, NaN
    where none in [0, 1] does. Of a linear stop the ``damping``, N s/m, that gives ``needed``; NaN of others.
    """

    modes: int
    share: float
    mass: float
    seen: float
    needed: float
    damping: float = nan


@dataclass(frozen=True)
class SharedImpact:
    """Impact on the stop at ``speed`` m/s that lasts ``contact_time`` s, 0 of a rigid stop; ``shares``: by the modes.

    ``restitution``: the case's coefficient, which ``seen`` and ``needed`` start from; of a stop that yields the R of a
    free mass 1/S of the last model, whose modes are those that count. ``terms``: that contact in the terms of other
    programs, by form; empty of a rigid stop.
    """

    speed: float
    contact_time: float
    restitution: float
    shares: tuple[ModeShare, ...]
    terms: Mapping[str, ContactTerm] = field(default_factory=dict)


@of_source
def mode_share(
    case_or_scene: Any, *, contact_time: float | str | None = None, speed: float | str | None = None
) -> SharedImpact:
    """Share of mode 1 in an impact on the stop of a case or a scene, in models with more and more modes.

    ``contact_time`` and ``speed``: of the impact, in SI or with units, in place of the case's ``ModeSharePlan``.
    TypeError and ValueError as ``derive``; ValueError for the contact time of a stop that yields, which has its own.

    >>> import vibeam
    >>> four = vibeam.mode_share("cases/dtu_neutral.toml").shares[2]  # R₁ by R = 0.72 at the contact, R for R₁ = 0.72
    >>> four.modes, round(four.seen, 3), round(four.needed, 3)
    (4, 0.628, 0.818)
    """
    asked = getattr(case_or_scene, "asked", {}).get("mode_share") or ModeSharePlan()
    plan, scene = plan_with(asked, {"contact_time": contact_time, "speed": speed}), beam_of(case_or_scene)
    rate = speed_of(scene, plan.speed)
    found = contacts(scene, rate)
    return shared_impact(scene, plan.contact_time, rate, found[1] if found else None)


def shared_impact(scene: Scene, contact_time: float | None, speed: float, own: ContactAtSpeed | None) -> SharedImpact:
    """Impact on a scene's stop, ``own`` where that yields; a rigid one may be asked for with a ``contact_time``.

    With that it is taken as linear, of the stiffness which a free mass 1/S of the modes that count meets for so long.
    ValueError for a stop that yields, which has its own.
    """
    structure, law = assemble(replace(scene, base=Base())), scene.stop.law
    if own is not None and law is not None:
        if contact_time is not None:
            raise ValueError(f"contact_time: this stop yields, and lasts {1e3 * own.duration:.4g} ms by itself")
        shares = tuple(yielding_shares(structure, law, own.speed, own.modes))
        terms = contact_terms(own.restitution, mass=own.mass, contact_time=own.duration, speed=own.speed)
        return SharedImpact(own.speed, own.duration, own.restitution, shares, terms)
    given = scene.stop.usual_restitution if law is None else law.contact(1.0).at(speed)
    if contact_time is None:
        return SharedImpact(speed, 0.0, given, tuple(rigid_shares(structure, given)))
    last = counting(structure, contact_time)
    free = 1 / float(np.sum((structure.contact @ structure.modes(last).shapes) ** 2))
    asked = {"mass": free, "contact_time": contact_time, "speed": speed}
    of_contact, at_contact = scene.stop.restitution_of == "contact", given
    for _ in range(1 if of_contact else REPEATS):  # the stiffness goes with R, and R₁ needs another one
        stiffness = contact_terms(at_contact, **asked)["linear"].parameters["stiffness"]
        shares = tuple(yielding_shares(structure, Linear(stiffness, None, given), speed, last))
        at_contact = given if of_contact else shares[-1].needed
        if not at_contact > 0:
            return SharedImpact(speed, contact_time, given, shares)
    return SharedImpact(speed, contact_time, given, shares, contact_terms(at_contact, **asked))


def counts_up_to(last: int) -> tuple[int, ...]:
    """Numbers 1, 2, 4 …, and the last one."""
    return (*(2**k for k in range((last - 1).bit_length())), last)


def rigid_shares(structure: Structure, restitution: float) -> Iterator[ModeShare]:
    """Shares with a rigid stop, up to all modes of the mesh: it is met in no time, and every mode counts."""
    contact = structure.contact @ structure.modes().shapes
    first = _first(contact)
    for n in sorted({*counts_up_to(min(MOST, len(contact))), len(contact)}):
        mobility, struck = float(np.sum(contact[:n] ** 2)), float(contact[first])
        if n > first:
            needed = needed_restitution(restitution, struck, mobility)
            seen = first_mode_restitution(restitution, struck, mobility)
            yield ModeShare(n, struck**2 / mobility, 1 / mobility, seen, needed if needed <= 1 else nan)


def yielding_shares(structure: Structure, law: ContactLaw, speed: float, last: int) -> Iterator[ModeShare]:
    """Shares with a stop that yields, of models with up to ``last`` modes, at a ``speed`` of the contact, m/s."""
    modes = structure.modes(last)
    contact = structure.contact @ modes.shapes
    ratios = np.diag(structure.congruent("C", modes.shapes)) / (2 * modes.omega)
    first = _first(contact)
    for n in (each for each in counts_up_to(last) if each > first):
        model = ImpactSystem.from_modes(modes.omega[:n], ratios[:n], contact[:n], np.zeros(n))
        yield _flown(model, law, speed, first)


def _flown(model: ImpactSystem, law: ContactLaw, speed: float, first: int) -> ModeShare:
    """Share of one model, and by the root of its flights the contact that it needs."""
    from scipy.optimize import brentq

    def seen(restitution: float | None = None) -> float:
        own: Any = law if restitution is None else replace(cast(Any, law), restitution=restitution)
        try:
            return struck(replace(model, law=own.contact(model.mobility)), speed, first).mode_restitution
        except ValueError:  # a contact of more than a quarter period: no impact
            return nan

    given, needed, damping = getattr(law, "restitution", None), nan, nan
    if given is not None and seen(LEAST) < given < seen(1.0):
        needed = float(brentq(lambda restitution: seen(restitution) - given, LEAST, 1.0, xtol=WITHIN))
        spring = replace(cast(Any, law), restitution=needed).contact(model.mobility).spring
        damping = nan if spring is None else float(spring.damping)
    share = float(model.contact[first] ** 2) / model.mobility
    return ModeShare(model.size, share, 1 / model.mobility, seen(), needed, damping)


def _first(contact: Array) -> int:
    """Place of the first mode that moves the contact."""
    return int(np.flatnonzero(contact**2 > NODE * np.sum(contact**2))[0])
