"""Tables of numbers that a model is compared with, expected or measured; rules between them and what is swept."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from vibeam.case.plans import EXTENTS, Direction, Expectation, MeasuredNumber, ResultNumber
from vibeam.casefile.fields import ANY, POSITIVE, Entry, Word
from vibeam.casefile.tables.outputs import of_displacement
from vibeam.casefile.tables.readings import AmountEntry, si_unit
from vibeam.casefile.tables.table import NAME, QUANTITIES, named_fidelity, plan_keys, plan_of, table
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, shortened, suggest
from vibeam.figures import FIGURES, LIMITS, OF_OUTPUT, READ


def expectation_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [expect.NAME]."""
    for name, expect in case.expect.items():
        yield from reading_checks(case, ("expect", name), expect)


def reading_checks(case: SimpleNamespace, path: KeyPath, expect: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about where an [expect.NAME] or [measured.NAME] finds its number."""
    yield from named_fidelity(case, (*path, "fidelity"), expect.fidelity)
    yield from named_fidelity(case, (*path, "against"), expect.against)
    yield from swept_checks(case, (*path, "direction"), expect.direction)
    if expect.quantity in OF_OUTPUT:
        yield from of_displacement(case, (*path, "quantity"), expect.quantity)
    if expect.show is not None or expect.number is not None or expect.quantity in READ:
        yield from _of_a_figure(case, path, expect)
    elif expect.quantity in EXTENTS and expect.frequency is not None:
        yield (*path, "frequency"), f'"{expect.quantity}" is of a whole branch: leave the frequency away'
    elif expect.quantity in QUANTITIES + OF_OUTPUT + LIMITS and expect.frequency is None:
        yield (*path, "frequency"), f'missing: "{expect.quantity}" is read at one frequency'


def _of_a_figure(case: SimpleNamespace, path: KeyPath, expect: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a number that is, or should be, read off a figure."""
    if expect.show is None:
        what = (
            f"[show.NAME] that {as_shown_in_message(expect.quantity)} is read off" if expect.quantity else "[show.NAME]"
        )
        yield (*path, "show"), f"missing: name the {what}"
        return
    if expect.show not in case.show:
        yield (
            (*path, "show"),
            f"no [show.{shortened(expect.show)}]; {suggest(expect.show, filter(NAME.fullmatch, case.show))}",
        )
        return
    show = case.show[expect.show]
    if show.kind is None or expect.quantity is None:
        return
    kind = FIGURES[show.kind]
    if expect.quantity not in kind.reads:
        words = " | ".join(f'"{word}"' for word in kind.reads) or "nothing that can be expected"
        yield (*path, "quantity"), f'kind = "{show.kind}" has {words}'
    if expect.number is None and kind.entries:
        yield (*path, "number"), f'missing: which {kind.entries} of kind = "{show.kind}" is meant; write number = 2'
    elif expect.number is not None and not kind.entries:
        yield (*path, "number"), f'kind = "{show.kind}" is read by its mean: leave it away'
    there = "frequency" in kind.needs + kind.takes
    if there and expect.frequency is None:
        yield (*path, "frequency"), f'missing: kind = "{show.kind}" is read at one frequency'
    elif not there and expect.frequency is not None:
        yield (*path, "frequency"), f'kind = "{show.kind}" has no use for it: leave it away'


def swept_checks(case: SimpleNamespace, path: KeyPath, way: str | None) -> Iterator[Complaint]:
    """A complaint about a direction that is not swept."""
    swept = case.sweep.direction
    if way and swept and swept not in ("both", way):
        yield path, f'"{way}" is not swept: sweep.direction is "{swept}"'


def _reading_table(name: str, plan: type[ResultNumber], meaning: str, **entries: Entry) -> Any:
    compared = Word((*QUANTITIES, *OF_OUTPUT, *EXTENTS, *LIMITS, *READ))
    return table(name, meaning, plan_keys(plan, quantity=compared, **entries))


ExpectTable: Any = _reading_table(
    "ExpectTable", Expectation,
    "A number that a fidelity is checked against, by itself or against another fidelity, one table each.",
    value=AmountEntry(ANY),
)  # fmt: skip
MeasuredTable: Any = _reading_table(
    "MeasuredTable", MeasuredNumber,
    "A number that was measured, which the model is compared with and never judged by, one table each.",
    value=AmountEntry(ANY), scatter=AmountEntry(POSITIVE),
)  # fmt: skip


def expectation(name: str, table: Any, swept: Direction) -> Expectation:
    """Plan of an [expect.NAME]."""
    return plan_of(Expectation, table, name=name, value=table.value.number, direction=table.direction or swept)


def measured_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [measured.NAME]."""
    for name, measured in case.measured.items():
        yield from reading_checks(case, ("measured", name), measured)


def measured_number(name: str, case: Any, swept: Direction, chose: tuple[str, ...]) -> MeasuredNumber:
    """Plan of a [measured.NAME] of a case; ``chose``: the keys that the number chose."""
    table = case.measured[name]
    return plan_of(
        MeasuredNumber, table, name=name, value=table.value.number, scatter=_absolute_scatter(table),
        direction=table.direction or swept, unit=si_unit(case, table), chose=chose,
    )  # fmt: skip


def _absolute_scatter(table: Any) -> float | None:
    """Scatter in the unit of the value; a percentage is of the value, of a difference by itself."""
    if table.scatter is None:
        return None
    relative = table.scatter.percent and table.against is None and table.value.number != 0
    return float(table.scatter.number) * (abs(table.value.number) if relative else 1.0)
