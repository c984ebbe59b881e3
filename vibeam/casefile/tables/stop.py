"""Table [stop]: the gap, the contact law with its keys, a gap that drifts, wear; rules between them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from vibeam.casefile.fields import Word
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.declared import Table, key, table
from vibeam.casefile.tables.table import declared_entry, declared_key, less, plan_keys
from vibeam.casefile.toml_writing import to_fill_in
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.solvers import SOLVERS
from vibeam_models.keys import Key, defaults_of, keys_of
from vibeam_models.laws import CONSTANT, LAWS, ContactLaw, declarations
from vibeam_models.laws.hertz import KEYS as OF_BODIES
from vibeam_models.registry import Home
from vibeam_models.stop import Stop


def stop_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the stop of a beam, or of a single degree of freedom, in whose units examples are then."""
    plain = KINDS[case.kind].plain
    yield from _law(case.stop, not plain, getattr(case, "beam", None))
    yield from _second(case, "" if plain else " m")
    yield from _drift(case.stop)
    yield from _wear(case)


def law_of(stop: Any) -> type[ContactLaw]:
    """The declaration of the law that a stop has, in the form in which it is said."""
    law: type[ContactLaw] = LAWS[stop.law or CONSTANT].load()
    return law.form_of(stop)


def contact_law(stop: Any, beam: Any = None) -> ContactLaw | None:
    """The law of a checked stop, as declared; None where it is one coefficient of restitution.

    ``beam``: the table whose material is that of the body that meets the stop; None without one.
    """
    law = law_of(stop)
    if law.name == CONSTANT:
        return None
    own = {name: getattr(stop, name) for name in keys_of(law)}
    return law(**own | {name: getattr(beam, of) for name, of in law.of_beam.items() if own[name] is None})


def _law(stop: SimpleNamespace, with_units: bool, beam: Any) -> Iterator[Complaint]:
    law = law_of(stop)
    own, named = keys_of(law), f'law = "{law.name}"'
    for name in [each for each in own if each not in defaults_of(law)]:
        if getattr(stop, name) is None:
            yield ("stop", name), _missing(name, own[name], with_units)
    for name, of in law.of_beam.items():
        if getattr(stop, name) is None and getattr(beam, of, None) is None:
            where = f"; or {of} in [beam]" if beam is not None else ""
            yield ("stop", name), f"{_missing(name, own[name], with_units)}{where}"
    for name in sorted(law_keys().keys() - own.keys()):
        if getattr(stop, name, None) is not None:
            yield ("stop", name), f"does not go with {named}{law.form}: take it out"
    for name, message in law.faults(stop):
        yield ("stop", name), message
    if law.name != CONSTANT and with_units and stop.restitution_of == "first mode":
        yield ("stop", "restitution_of"), f'"first mode" does not go with {named}: the loss is the contact\'s'


def _missing(name: str, declared: Key, with_units: bool) -> str:
    meaning, example, missing = declared.meaning, declared.example, declared.missing
    if not with_units:
        said, example, missing = declared.plain or ("", declared_entry(declared).parse(example), missing)
        meaning = said or meaning
    return f"missing ({missing or meaning}): write {name} = {to_fill_in(example)}"


def _second(case: SimpleNamespace, metres: str) -> Iterator[Complaint]:
    stop, where = case.stop, "−gap"
    if stop.second_gap is None or stop.gap is None:
        return
    drifted = _least_drift(stop, getattr(case.sweep, "frequency", None)) if stop.second_gap > -stop.gap else 0.0
    where += f" less the drift, {drifted:g}{metres}," if drifted < 0 else ""
    if stop.second_gap <= -(stop.gap + drifted):
        least = 0.0 - (stop.gap + drifted)
        yield ("stop", "second_gap"), f"must be above {where} = {least:g}{metres}, or nothing fits between the stops"


def _least_drift(stop: SimpleNamespace, grid: SimpleNamespace | tuple[float, ...] | None) -> float:
    """The least drift from the first to the last of the sweep's frequencies; 0 where either could not be read."""
    ends = grid or (None,) if grid is None or isinstance(grid, tuple) else (grid.from_, grid.to)
    given = stop.drift_frequency or ()
    if None in ends or not given or len(given) != len(stop.drift or ()):
        return 0.0
    low, high = min(ends), max(ends)
    swept = [low, high, *(each for each in given if low < each < high)]
    return min(float(each) for each in np.interp(swept, given, stop.drift))


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
        stationary = fidelity.solver is not None and SOLVERS[fidelity.solver].stationary
        if stationary and not {"stop.wear", "stop"} & {*(fidelity.without or ())}:
            said = f"{as_shown_in_message(fidelity.solver)} counts no impacts, so stop.wear has nothing to go by"
            yield ("fidelity", name, "solver"), f'{said}: write solver = "flight", or without = ["stop.wear"]'


AT_REST = ("gap", "gap_at", "restitution", "restitution_of", "position")  # keys before those of the law
OF_RIG = ("gap_at", "restitution_of", "position")  # without a meaning for a single degree of freedom


def law_keys() -> dict[str, Key]:
    """The keys of all contact laws by name; those of stops that yield stand first."""
    laws = sorted(declarations().values(), key=lambda law: not law.compliant)
    return {name: each for law in laws for form in law.forms() for name, each in keys_of(form).items()}


def stop_table() -> type[Table]:
    """The stop of a beam, with the contact laws that are registered now."""
    return _stop_table(tuple(LAWS.items()))


def sdof_stop_table() -> type[Table]:
    """The stop of a single degree of freedom, with the contact laws that are registered now."""
    return _sdof_stop_table(tuple(LAWS.items()))


@lru_cache(maxsize=8)
def _stop_table(laws: tuple[tuple[str, Home], ...]) -> type[Table]:
    meaning = "what the stop does; absent = restitution, the same at every velocity"
    keys = {"law": key(Word(tuple(LAWS)), meaning, "linear", None)}
    keys |= {name: declared_key(each, None, "law") for name, each in law_keys().items() if name != "restitution"}
    doc = "The stop: what it is depends on its law; keys of other laws are refused."
    own = plan_keys(Stop) | {"position": declared_key(keys_of(Stop)["position"], None)}
    at_rest = {name: own.pop(name) for name in AT_REST}
    return table("StopTable", doc, at_rest, keys, own)


@lru_cache(maxsize=8)
def _sdof_stop_table(laws: tuple[tuple[str, Home], ...]) -> type[Table]:
    doc = "The stop of the single degree of freedom."
    return less(stop_table(), "SdofStopTable", doc, *OF_RIG, *OF_BODIES, plain=True)
