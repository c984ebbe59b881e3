"""Keys of further harmonics of the drive, and what does not go with them: what knows one harmonic alone."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.casefile import quantities as units
from vibeam.casefile.field_tables import flat
from vibeam.casefile.fields import Count, Each, Quantity, Several
from vibeam.casefile.tables.table import Ratio
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.figures import FIGURES
from vibeam.solvers import SOLVERS

Orders, Shares, Phases = Each(Count(2, 1000)), Several(Ratio), Several(Quantity(units.ANGLE))
ORDERS = "orders of further harmonics, whole multiples of the drive's frequency; absent = none"
SHARES = "their amplitudes as shares of the first's acceleration, whatever key says that; of a force or a moment, of it"
PHASES = "their phases at the first's zero: sin Ωt + share · sin(order · Ωt + phase); absent = 0"


def harmonic_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about further harmonics: their lists, and what beside them knows one harmonic alone."""
    yield from _lists(case.drive)
    if case.drive.harmonic is not None and getattr(case, "platform", None) is not None:
        said = "[platform] filters each harmonic its own way, which is not computed: take harmonic, or it, away"
        yield ("drive", "harmonic"), said
    elif case.drive.harmonic is not None and getattr(case, "further_stop", None):
        yield ("drive", "harmonic"), "is carried to one contact, and there is a further_stop: take one of the two away"
    driven = _driven(case)
    if driven and case.accuracy is not None:
        yield ("accuracy",), "chooses by closed forms, which know one harmonic: take it, or drive.harmonic, away"
    yield from _solvers(case, driven)
    yield from _figures(case, driven)


def _lists(drive: SimpleNamespace) -> Iterator[Complaint]:
    if drive.harmonic is None:
        if drive.harmonic_share is not None or drive.harmonic_phase is not None:
            yield ("drive", "harmonic"), "missing (the orders that shares and phases are of): write harmonic = [2]"
        return
    if drive.harmonic_share is None:
        yield ("drive", "harmonic_share"), 'missing (how large each is): write harmonic_share = ["5 %"]'
    for name in ("harmonic_share", "harmonic_phase"):
        given = getattr(drive, name)
        if given is not None and len(given) != len(drive.harmonic):
            yield ("drive", name), f"{len(given)} numbers, and harmonic has {len(drive.harmonic)}"


def _driven(case: SimpleNamespace) -> dict[str, SimpleNamespace]:
    """Fidelities that several harmonics drive: those of the case, or of their own."""
    found = {}
    for name, fidelity in case.fidelity.items():
        own = "drive.harmonic" in dict(flat(fidelity.set or {}))
        shared = case.drive.harmonic is not None and "drive.harmonic" not in (fidelity.without or ())
        if own or shared:
            found[name] = fidelity
    return found


def _solvers(case: SimpleNamespace, driven: dict[str, SimpleNamespace]) -> Iterator[Complaint]:
    able = " or ".join(f'"{each}"' for each, declared in SOLVERS.items() if declared.harmonics)
    for name, fidelity in driven.items():
        if fidelity.solver is not None and not SOLVERS[fidelity.solver].harmonics:
            said = f"{as_shown_in_message(fidelity.solver)} knows a drive of one harmonic: write {able}, or take "
            yield ("fidelity", name, "solver"), f"{said}drive.harmonic away"


def _figures(case: SimpleNamespace, driven: dict[str, SimpleNamespace]) -> Iterator[Complaint]:
    for name, show in (case.show or {}).items():
        several = [each for each in show.fidelities or tuple(case.fidelity) if each in driven]
        if show.kind is not None and FIGURES[show.kind].one_harmonic and several:
            said = f'kind = "{show.kind}" knows a drive of one harmonic, and {", ".join(several)} has several'
            yield ("show", name, "kind"), f"{said}: name others in fidelities, or take drive.harmonic away"
