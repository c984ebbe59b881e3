"""Validation of the arguments of an ImpactSystem: all faults at once; otherwise floats and read-only arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from vibeam.system.rows import Contact, TimeDerivative, checked_law
from vibeam_models.arguments import number, read_only, real, refuse, shown
from vibeam_models.arrays import Array

ROWS = ("omega", "zeta", "contact", "load", "static")
MOST_CONTACTS = 50  # further ones
LEAST, MOST = 1e-300, 1e300  # smallest Σ contact², a divisor
SYMMETRIC = 1e-9  # share of the largest damping: tolerance for asymmetry and negative eigenvalues


def checked(system: Any) -> dict[str, Any]:
    """Return the fields as floats and read-only arrays; ValueError with every fault."""
    faults: list[str] = []
    clean: dict[str, Any] = {name: read_only(getattr(system, name)) for name in ROWS}
    clean["outputs"] = outputs = _outputs(system.outputs, faults)
    if not _rows_valid([*clean.values()][: len(ROWS)], outputs.values()):
        _check_rows({name: clean[name] for name in ROWS}, outputs, faults)
    clean["law"], restitution = checked_law(system.law, system.restitution, faults)
    clean["restitution"] = number("restitution", restitution, faults, least=0.0, most=1.0)
    clean["gap"] = number("gap", system.gap, faults)
    if system.coupling is not None:
        clean["coupling"] = _coupling(system.coupling, np.size(clean["omega"]), faults)
    if system.derivatives:
        _check_derivatives(system.derivatives, outputs, np.size(clean["omega"]), faults)
    if system.second_gap is not None:
        clean["second_gap"] = _second_gap(system.gap, system.second_gap, faults)
    if system.further is not None:
        clean["further"] = _further(system.further, clean["law"], np.size(clean["omega"]), faults)
    refuse("", faults)
    return clean


def _further(given: Any, law: Any, n: int, faults: list[str]) -> tuple[Any, ...] | None:
    """Check the further contacts; none are None."""
    found = tuple(given) if isinstance(given, Sequence) else (given,)
    for each in found:
        if not isinstance(each, Contact):
            faults.append(f"further: {shown(each)} is no Contact")
        elif each.row.shape != (n,):
            faults.append(f"further: the row of a contact must be {n} finite numbers, one a mode")
    laws = [law, *(getattr(each, "law", None) for each in found)]
    yielding = any(getattr(each, "yields", False) for each in laws)
    most = MOST_CONTACTS // 2 if yielding else MOST_CONTACTS
    if len(found) > most:
        faults.append(f"further: {len(found)} contacts, at most {most}")
    return found or None


def _outputs(given: Any, faults: list[str]) -> dict[str, Array | None]:
    if not isinstance(given, Mapping):
        faults.append(f"outputs: {shown(given)} must be a mapping from names to rows")
        return {}
    for name in given:
        if not isinstance(name, str):
            faults.append(f"outputs: the name {shown(name)} must be text")
    return {name: read_only(row) for name, row in given.items()}


def _check_derivatives(given: Any, outputs: Mapping[str, Any], n: int, faults: list[str]) -> None:
    if not isinstance(given, Mapping):
        faults.append(f"derivatives: {shown(given)} must be a mapping from names to TimeDerivative")
        return
    for name, each in given.items():
        if not isinstance(each, TimeDerivative) or each.row.shape != (n,):
            faults.append(f"derivatives[{name!r}]: must be a TimeDerivative whose row is {n} numbers, one a mode")
        if name == "contact" or name in outputs:
            faults.append(f"derivatives[{name!r}]: is the name of another output")


def _rows_valid(rows: Sequence[Any], outputs: Iterable[Any]) -> bool:
    """Quick test whether all rows are valid; False where it cannot tell, for example where squares overflow."""
    omega, _, contact, *_ = rows
    every = [*rows, *outputs]
    if any(row is None or row.ndim != 1 or len(row) != len(omega) for row in every) or not len(omega):
        return False
    whole = np.concatenate(every)
    with np.errstate(over="ignore", invalid="ignore"):
        plain = isfinite(whole.dot(whole)) and LEAST <= contact.dot(contact) <= MOST
    return plain and bool(np.minimum.reduce(whole[: 2 * len(omega)]) >= 0)


def _check_rows(rows: Mapping[str, Array | None], outputs: Mapping[str, Array | None], faults: list[str]) -> None:
    omega = rows["omega"]
    n = len(omega) if omega is not None and omega.ndim == 1 else 0
    size = f"{n} finite numbers, one a mode" if n else "one or more finite numbers, one a mode"
    named = {**rows, **{f"outputs[{name!r}]": row for name, row in outputs.items()}}
    wrong = [name for name, row in named.items() if not _fits(row, n)]
    faults.extend(f"{name}: must be {size}" for name in (wrong if n else ["omega"]))
    for name, what in (("omega", "frequency"), ("zeta", "damping ratio")):
        row = rows[name]
        if row is not None and row.size and np.min(row) < 0:
            faults.append(f"{name}: a {what} is negative")
    if rows["contact"] is not None:
        _check_contact(rows["contact"], faults)


def _fits(row: Array | None, n: int) -> bool:
    return row is not None and row.shape == (n,) and bool(np.isfinite(row).all())


def _check_contact(contact: Array, faults: list[str]) -> None:
    largest = float(np.max(np.abs(contact), initial=0.0))
    if contact.size and largest == 0:
        faults.append("contact: no mode moves the contact point")
    elif contact.size and isfinite(largest) and not LEAST <= largest * largest <= MOST:
        faults.append(
            f"contact: Σ contact² of values up to {largest:g} is beyond what a float can hold: take other units"
        )


def _coupling(given: Any, n: int, faults: list[str]) -> Array | None:
    damper = read_only(given)
    if damper is None or damper.shape != (n, n) or not np.isfinite(damper).all():
        faults.append(f"coupling: must be {n} × {n} finite numbers")
        return damper
    size = float(np.max(np.abs(damper), initial=0.0))
    if np.max(np.abs(damper - damper.T), initial=0.0) > SYMMETRIC * size:
        faults.append("coupling: must be symmetric")
    elif np.min(np.linalg.eigvalsh(damper), initial=0.0) < -SYMMETRIC * size:
        faults.append("coupling: feeds energy into the motion (it has a negative eigenvalue)")
    return damper


def _second_gap(gap: Any, second_gap: Any, faults: list[str]) -> float | None:
    first, second = real(gap), real(second_gap)
    if second is not None and (first is None or second > -first):
        return second
    above = "" if first is None else f" and above −gap = {0.0 - first}, or nothing fits between the stops"
    faults.append(f"second_gap: {shown(second_gap)} must be finite{above}")
    return second
