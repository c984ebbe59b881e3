"""Rules for the names of tables, and for keys that refer to them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from types import SimpleNamespace

from vibeam.case.faults import Complaint, KeyPath, as_shown_in_message, suggest

NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")

#: keys by what others call them, in small letters; of a table the keys that it has
CALLED = {
    "section": ("shape",), "profile": ("shape",), "cross_section": ("shape",),
    "material": ("youngs_modulus", "density"), "e": ("youngs_modulus", "restitution"), "modulus": ("youngs_modulus",),
    "rho": ("density",), "nu": ("poissons_ratio",), "zeta": ("damping_ratio",), "l": ("length",), "span": ("length",),
    "b": ("width",), "breadth": ("width",), "h": ("thickness",), "t": ("thickness",), "height": ("thickness",),
    "depth": ("thickness",), "boundary": ("ends",), "boundary_conditions": ("ends",), "supports": ("ends",),
    "mesh": ("elements",), "clearance": ("gap",), "cor": ("restitution",), "k": ("stiffness",), "c": ("damping",),
    "x": ("position",), "location": ("position",), "m": ("mass",), "transient": ("settle",), "periods": ("hold",),
    "method": ("reduction", "solver"), "model": ("reduction",), "n": ("modes",),
}  # fmt: skip


def name_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the names that a case gives."""
    if case.fidelity == {}:
        yield ("fidelity",), "no fidelity: add a table [fidelity.NAME]"
    for kind in ("fidelity", "reference", "expect", "measured", "show", "map"):
        for name in getattr(case, kind):
            if not NAME.fullmatch(name):
                yield (kind, name), f"the name {as_shown_in_message(name)} must be 1 to 64 letters, digits, - or _"
    for group in sorted({"show", "comparison", "models"} & set(case.fidelity)):
        yield ("fidelity", group), f'the name "{group}" is that of a group of the results file: choose another'


def named_fidelity(case: SimpleNamespace, path: KeyPath, name: str | None) -> Iterator[Complaint]:
    """A complaint where a fidelity is named that is not there."""
    if name is not None and name not in case.fidelity:
        yield path, f"no fidelity {not_there(name, case.fidelity)}"


def not_there(name: str, tables: Iterable[str]) -> str:
    """A name that is none of ``tables``, and which of them it may have meant."""
    return f"{as_shown_in_message(name)}; {suggest(name, filter(NAME.fullmatch, tables))}"
