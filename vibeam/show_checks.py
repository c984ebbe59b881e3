"""What the keys of a case say together about its figures, the numbers expected of them and the measuring chain."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.faults import cure, shown
from vibeam.lines import Path
from vibeam.reading import Complaint
from vibeam.show import KEYS, KINDS, LIMITS, Kind
from vibeam.solvers import EXACT

NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")


def named_fidelity(case: SimpleNamespace, path: Path, name: str | None) -> Iterator[Complaint]:
    """A complaint where a fidelity is named that is not there."""
    if name is not None and name not in case.fidelity:
        yield path, f"no fidelity {shown(name)}; {cure(name, filter(NAME.fullmatch, case.fidelity))}"


def show_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [show.NAME]."""
    for name, show in case.show.items():
        path: Path = ("show", name)
        for index, fidelity in enumerate(show.fidelities or ()):
            yield from named_fidelity(case, (*path, "fidelities", index), fidelity)
        if show.kind is not None:
            yield from _keys(path, show, KINDS[show.kind])
            yield from _exact(case, path, show, KINDS[show.kind])
            yield from _output(case, (*path, "output"), show.output)


def _keys(path: Path, show: SimpleNamespace, kind: Kind) -> Iterator[Complaint]:
    from vibeam.schema import QUANTITIES

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


def _exact(case: SimpleNamespace, path: Path, show: SimpleNamespace, kind: Kind) -> Iterator[Complaint]:
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


def _output(case: SimpleNamespace, path: Path, output: str | None) -> Iterator[Complaint]:
    if output is None:
        return
    if not hasattr(case, "beam"):
        if output not in ("sensor", "contact"):
            yield path, f'a single degree of freedom has no "{output}": write "sensor"'
    elif output == "platform" and (case.platform is None or case.platform.coupling == "one-way"):
        yield path, 'the platform has no motion of its own: add [platform] with coupling = "two-way"'


def expectation_of_a_figure(case: SimpleNamespace, path: Path, expect: SimpleNamespace) -> Iterator[Complaint]:
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


def measurement_checks(chain: SimpleNamespace | None) -> Iterator[Complaint]:
    """Complaints about the filter and the noise of [measurement]."""
    if chain is None:
        return
    path = ("measurement",)
    for name, example in (("order", "4"), ("cut_off", '"500 Hz"')):
        given = getattr(chain, name) is not None
        if chain.low_pass is None and given:
            yield (*path, name), 'goes with a filter: write low_pass = "bessel", or leave it away'
        elif chain.low_pass is not None and not given:
            yield (*path, name), f"missing: the filter needs it; write {name} = {example}"
    for name in ("ripple", "attenuation"):
        if getattr(chain, name) is not None and chain.low_pass != "elliptic":
            yield (*path, name), 'goes with low_pass = "elliptic" alone: leave it away'
    if chain.ripple is not None and chain.attenuation is not None and chain.ripple >= chain.attenuation:
        yield (*path, "ripple"), f"{chain.ripple:g} dB is not below attenuation, {chain.attenuation:g} dB"
    if chain.noise is not None and chain.seed is None:
        yield (*path, "seed"), "missing: the noise needs one; write seed = 1"
    elif chain.noise is None and chain.seed is not None:
        yield (*path, "seed"), "goes with noise: leave it away"
