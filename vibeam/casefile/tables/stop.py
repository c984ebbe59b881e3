"""What the keys of [stop] say together: the contact law and what it needs, a gap that drifts, wear."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint, as_shown_in_message
from vibeam.casefile import quantities as units
from vibeam.casefile.field_lists import Several
from vibeam.casefile.fields import NOT_NEGATIVE, POSITIVE, Quantity, Word
from vibeam.casefile.tables.table import LAWS, Frequency, Place, Speed, Table, Unity, key
from vibeam.solvers import SOLVERS

NEEDS = {  # keys that a contact law must have; those that it may have
    "restitution": (("restitution",), ()),
    "velocity restitution": (("restitution", "velocity"), ("exponent",)),
    "table": (("speeds", "restitutions"), ()),
    "linear": (("stiffness",), ("damping", "restitution")),
    "hertz": (("hertz_stiffness",), ("exponent",)),
    "hunt-crossley": (("hertz_stiffness", "restitution", "velocity"), ("exponent",)),
}

EXAMPLES = {
    "restitution": ("speed after over speed before an impact", "restitution = 0.72"),
    "velocity": ("at which the restitution holds", 'velocity = "0.1 m/s"'),
    "stiffness": ("force over penetration", 'stiffness = "1e6 N/m"'),
    "hertz_stiffness": ("N/m^exponent", "hertz_stiffness = 1e9"),
    "speeds": ("of the table", 'speeds = ["0.02 m/s", "0.2 m/s"]'),
    "restitutions": ("at the speeds", "restitutions = [0.8, 0.6]"),
}

NONDIMENSIONAL = EXAMPLES | {
    "velocity": ("at which the restitution holds", "velocity = 0.01"),
    "stiffness": ("force over mass and penetration", "stiffness = 400"),
    "hertz_stiffness": ("force over mass and penetration^exponent", "hertz_stiffness = 1e4"),
    "speeds": ("of the table", "speeds = [0.002, 0.02]"),
}


def stop_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the stop of a beam, or of a single degree of freedom, in whose units examples are then."""
    examples, metres = (EXAMPLES, " m") if hasattr(case, "beam") else (NONDIMENSIONAL, "")
    yield from _law(case.stop, examples, metres)
    yield from _drift(case.stop)
    yield from _wear(case)


def _law(stop: SimpleNamespace, examples: Mapping[str, tuple[str, str]], metres: str) -> Iterator[Complaint]:
    law = stop.law or "restitution"
    tabled = law == "velocity restitution" and (stop.speeds is not None or stop.restitutions is not None)
    needed, allowed = NEEDS["table" if tabled else law]
    for name in needed:
        if getattr(stop, name) is None:
            meaning, example = examples[name]
            yield ("stop", name), f"missing ({meaning}): write {example}"
    every = {name for names in NEEDS.values() for part in names for name in part}
    for name in sorted(every - {*needed, *allowed}):
        if getattr(stop, name) is not None:
            yield ("stop", name), f'does not go with law = "{law}"{" and a table" if tabled else ""}: take it out'
    if law == "linear" and (stop.damping is None) == (stop.restitution is None):
        said = "is not said" if stop.damping is None else "is said twice"
        yield ("stop", "damping"), f"the loss of the linear stop {said}: write damping, or restitution"
    if (law == "hunt-crossley" and stop.restitution == 0) or (law == "linear" and stop.restitution == 0):
        yield ("stop", "restitution"), f'0 is more than law = "{law}" can lose: write a number above 0'
    if law == "velocity restitution" and not tabled and stop.restitution == 0:
        yield ("stop", "restitution"), "0 leaves nothing to fall with the velocity: write a number above 0"
    if law in ("hertz", "hunt-crossley") and stop.exponent is not None and stop.exponent < 1:
        yield ("stop", "exponent"), f"{stop.exponent:g} is below 1: the stop would be infinitely stiff at first touch"
    if tabled and stop.speeds and stop.restitutions and (len(stop.speeds) != len(stop.restitutions)):
        yield ("stop", "restitutions"), f"{len(stop.restitutions)} numbers for {len(stop.speeds)} speeds"
    elif tabled and stop.speeds and len(stop.speeds) < 2:
        yield ("stop", "speeds"), "one speed makes no table: write two or more"
    if law not in ("restitution",) and getattr(stop, "restitution_of", None) == "first mode":
        yield ("stop", "restitution_of"), f'"first mode" does not go with law = "{law}": the loss is the contact\'s'
    if stop.second_gap is not None and stop.gap is not None and stop.second_gap <= -stop.gap:
        least = 0.0 - stop.gap
        yield ("stop", "second_gap"), f"must be above −gap = {least:g}{metres}, or nothing fits between the stops"


def _drift(stop: SimpleNamespace) -> Iterator[Complaint]:
    if stop.drift is None and stop.drift_frequency is None:
        return
    for name, other in (("drift", "drift_frequency"), ("drift_frequency", "drift")):
        if getattr(stop, name) is None:
            yield ("stop", name), f"missing: {other} needs it beside it"
            return
    if len(stop.drift) != len(stop.drift_frequency):
        yield ("stop", "drift"), f"{len(stop.drift)} numbers for {len(stop.drift_frequency)} frequencies"


def _wear(case: SimpleNamespace) -> Iterator[Complaint]:
    """A fidelity that leaves the wear out is judged by itself, without it."""
    for name, fidelity in case.fidelity.items() if case.stop.wear is not None else ():
        if (
            fidelity.solver is not None
            and SOLVERS[fidelity.solver].stationary
            and not {"stop.wear", "stop"} & {*(fidelity.without or ())}
        ):
            yield (
                ("fidelity", name, "solver"),
                f"{as_shown_in_message(fidelity.solver)} counts no impacts, so stop.wear has nothing to go by: "
                'write solver = "flight", or without = ["stop.wear"]',
            )


class StopTable(Table):
    """The stop: what it is depends on its law; keys of other laws are refused."""

    gap: Annotated[float, Quantity(units.LENGTH)] = key(
        "gap at rest; negative = the beam is pressed against the stop", "0 mm"
    )
    gap_at: Annotated[str, Word(("contact", "sensor"))] = key(
        "where the gap was measured: at the contact, or as grazing amplitude at the sensor", "contact", "contact"
    )
    restitution: Annotated[float | None, Unity] = key("speed after over speed before an impact", 0.72, None)
    restitution_of: Annotated[str, Word(("contact", "first mode"))] = key(
        "whose it is: the contact's, or mode 1's (each fidelity's own is then derived)", "contact", "contact"
    )
    position: Annotated[float | None, Place] = key(
        "effect: of the contact, from the clamp; absent = at the mass, if there is one",
        "132 mm",
        None,
        written=False,
    )
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.STIFFNESS, POSITIVE)] = key(
        "of law linear: force over penetration", "1e6 N/m", None, written=False
    )
    damping: Annotated[float | None, Quantity(units.VISCOUS, NOT_NEGATIVE)] = key(
        "of law linear: force over velocity; absent = what gives the restitution to a free mass 1/S, S the contact's "
        "mobility",
        "10 N s/m",
        None,
        written=False,
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of laws hertz and hunt-crossley: force over penetration^exponent, in N/m^exponent", 1e9, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; in velocity restitution the n of R = R0 (v/v0)^-n, absent = 0.25",
        1.5,
        None,
        written=False,
    )
    velocity: Annotated[float | None, Speed] = key(
        "of impact, v0, at which the restitution holds; for laws hunt-crossley and velocity restitution",
        "0.1 m/s",
        None,
        written=False,
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Speed, ascending=True)] = key(
        "of impact, of a table for law velocity restitution, instead of restitution and velocity",
        ["0.02 m/s", "0.2 m/s"],
        None,
        written=False,
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at these speeds, monotone cubics between them", [0.8, 0.6], None, written=False
    )
    second_gap: Annotated[float | None, Quantity(units.LENGTH)] = key(
        "effect: gap to a second stop on the other side; absent = none", "1 mm", None, written=False
    )
    drift_frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "effect: drive frequencies between which the gap drifts; absent = it stays",
        ["14 Hz", "17 Hz"],
        None,
        written=False,
    )
    drift: Annotated[tuple[float, ...] | None, Several(Quantity(units.LENGTH))] = key(
        "what is added to the gap at these frequencies, linear between them", ["0 mm", "0.02 mm"], None, written=False
    )
    wear: Annotated[float | None, Quantity(units.LENGTH, NOT_NEGATIVE)] = key(
        "effect: what each impact adds to the gap at the contact, from point to point; absent = none",
        "0.1 nm",
        None,
        written=False,
    )


class SdofStopTable(Table):
    """The stop of the single degree of freedom."""

    gap: Annotated[float, Quantity(units.RATIO)] = key("gap at rest Δ, in the unit of the motion", 0.0)
    restitution: Annotated[float | None, Unity] = key("speed after over speed before an impact", 0.9, None)
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of a linear stop: force over mass and penetration", 400, None, written=False
    )
    damping: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "of a linear stop, force over mass and velocity; absent = what gives the restitution", 2.5, None, written=False
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of hertz and hunt-crossley, force over mass and penetration^exponent", 1e4, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25", 1.5, None, written=False
    )
    velocity: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "at which the restitution holds, for hunt-crossley and velocity restitution", 0.01, None, written=False
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO, POSITIVE), ascending=True)] = key(
        "of a table of restitutions, instead of restitution and velocity", [0.002, 0.02], None, written=False
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at the speeds", [0.8, 0.6], None, written=False
    )
    second_gap: Annotated[float | None, Quantity(units.RATIO)] = key(
        "effect: gap to a second stop on the other side; absent = none", 0.01, None, written=False
    )
    drift_frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "effect: drive frequencies between which the gap drifts; absent = it stays",
        ["1.5 rad/s", "2.5 rad/s"],
        None,
        written=False,
    )
    drift: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO))] = key(
        "what is added to the gap at these frequencies, linear between them", [0.0, 1e-4], None, written=False
    )
    wear: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "effect: what each impact adds to the gap, from point to point; absent = none", 1e-8, None, written=False
    )
