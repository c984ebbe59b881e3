"""What the keys of [show.NAME] say together, by the kind of figure."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.checks.effects import platform_output
from vibeam.checks.names import named_fidelity
from vibeam.lines import KeyPath
from vibeam.reading import Complaint
from vibeam.schema import QUANTITIES
from vibeam.show import KEYS, KINDS, LIMITS, Kind
from vibeam.solvers import EXACT


def figure_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [show.NAME]."""
    for name, show in case.show.items():
        path: KeyPath = ("show", name)
        for index, fidelity in enumerate(show.fidelities or ()):
            yield from named_fidelity(case, (*path, "fidelities", index), fidelity)
        if show.kind is not None:
            yield from _keys(path, show, KINDS[show.kind])
            yield from _exact(case, path, show, KINDS[show.kind])
            yield from _output(case, (*path, "output"), show.output)


def _keys(path: KeyPath, show: SimpleNamespace, kind: Kind) -> Iterator[Complaint]:
    for key in KEYS:
        given = getattr(show, key) is not None
        if given and key not in kind.needs + kind.takes:
            yield (*path, key), f'kind = "{show.kind}" has no use for it: leave it away'
        elif key in kind.needs and not given:
            yield (*path, key), f'missing: kind = "{show.kind}" needs it'
    limits = show.kind == "boundaries"
    if "quantity" in kind.needs and show.quantity is not None and (show.quantity in LIMITS) != limits:
        words = " | ".join(f'"{word}"' for word in (LIMITS if limits else QUANTITIES))
        yield (*path, "quantity"), f'kind = "{show.kind}" shows {words}'
    if show.periods and show.subdivision and show.periods % show.subdivision:
        multiple = f"write a multiple of subdivision = {show.subdivision}"
        yield (*path, "periods"), f"{show.periods} drive periods hold no whole number of the longest ones: {multiple}"


def _exact(case: SimpleNamespace, path: KeyPath, show: SimpleNamespace, kind: Kind) -> Iterator[Complaint]:
    """Kinds that integrate along a motion, and the measuring chain, want one that is known at any time."""
    measured = case.measurement is not None and show.kind in ("history", "portrait")
    if not (kind.exact or measured):
        return
    who = f'kind = "{show.kind}"' if kind.exact else "[measurement]"
    for name in show.fidelities or tuple(case.fidelity):
        solver = case.fidelity[name].solver if name in case.fidelity else None
        if solver is not None and solver not in EXACT:
            cured = f"name in fidelities those by {', '.join(EXACT)}"
            yield (*path, "fidelities"), f'{who} needs an exact motion, "{solver}" of {name} gives samples: {cured}'


def _output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    if hasattr(case, "beam"):
        yield from platform_output(case, path, output)
    elif output not in ("sensor", "contact", None):
        yield path, f'a single degree of freedom has no "{output}": write "sensor"'
