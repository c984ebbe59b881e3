"""What a case is held to, reference curves and expected numbers, together with what it sweeps and shows."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace

from vibeam.checks.names import NAME, named_fidelity
from vibeam.faults import cure, shown
from vibeam.lines import KeyPath
from vibeam.reading import Complaint
from vibeam.reference_files import file_fault
from vibeam.schema import EXTENTS, QUANTITIES
from vibeam.show import KINDS, LIMITS, READ


def reference_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about every [reference.NAME]; files are looked for from ``folder``."""
    for name, reference in case.reference.items():
        yield from named_fidelity(case, ("reference", name, "fidelity"), reference.fidelity)
        if reference.file is not None and (fault := _file_fault(folder, reference.file)):
            yield ("reference", name, "file"), fault
        yield from _swept(case, ("reference", name, "direction"), reference.direction)


def expectation_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [expect.NAME]."""
    for name, expect in case.expect.items():
        path: KeyPath = ("expect", name)
        yield from named_fidelity(case, (*path, "fidelity"), expect.fidelity)
        yield from named_fidelity(case, (*path, "against"), expect.against)
        yield from _swept(case, (*path, "direction"), expect.direction)
        if expect.show is not None or expect.number is not None or expect.quantity in READ:
            yield from _of_a_figure(case, path, expect)
        elif expect.quantity in EXTENTS and expect.frequency is not None:
            yield (*path, "frequency"), f'"{expect.quantity}" is of a whole branch: leave the frequency away'
        elif expect.quantity in QUANTITIES + LIMITS and expect.frequency is None:
            yield (*path, "frequency"), f'missing: "{expect.quantity}" is read at one frequency'


def _of_a_figure(case: SimpleNamespace, path: KeyPath, expect: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about an [expect.NAME] that is, or should be, read off a figure."""
    if expect.show is None:
        what = f"[show.NAME] that {shown(expect.quantity)} is read off" if expect.quantity else "[show.NAME]"
        yield (*path, "show"), f"missing: name the {what}"
        return
    if expect.show not in case.show:
        yield (*path, "show"), f"no [show.{expect.show}]; {cure(expect.show, filter(NAME.fullmatch, case.show))}"
        return
    show = case.show[expect.show]
    if show.kind is None or expect.quantity is None:
        return
    kind = KINDS[show.kind]
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


def _swept(case: SimpleNamespace, path: KeyPath, way: str | None) -> Iterator[Complaint]:
    swept = case.sweep.direction
    if way and swept and swept not in ("both", way):
        yield path, f'"{way}" is not swept: sweep.direction is "{swept}"'


def _file_fault(folder: File, name: str) -> str | None:
    fault = file_fault(folder / name)
    if fault == "no such file" or "\0" in name:
        return f"no file {shown(name)} in the case file's folder"
    return fault and f"{shown(name)} {fault}"
