"""What the keys of [stop] say together: the contact law and what it needs, a gap that drifts, wear."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace

from vibeam.faults import shown
from vibeam.reading import Complaint
from vibeam.solvers import STATIONARY

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
        if fidelity.solver in STATIONARY and not {"stop.wear", "stop"} & {*(fidelity.without or ())}:
            yield (
                ("fidelity", name, "solver"),
                f"{shown(fidelity.solver)} counts no impacts, so stop.wear has nothing to go by: "
                'write solver = "flight", or without = ["stop.wear"]',
            )
