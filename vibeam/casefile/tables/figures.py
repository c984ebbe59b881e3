"""Tables of further figures and of the measuring chain; rules between their keys."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from vibeam.case.plans import FigurePlan, ShowPlan
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import TEXT, Count, Each, Quantity, Several, Word
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import POSITIVE
from vibeam.casefile.tables.declared import Field, Table, key, table
from vibeam.casefile.tables.outputs import OUTPUT_NAME, shown_output
from vibeam.casefile.tables.table import QUANTITIES, Frequency, Length, declared_key, named_fidelity, plan_keys
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam.figures import COMMON, FIGURES, OF_OUTPUT, own_keys, quantities_shown
from vibeam.figures.declaration import FigureKind
from vibeam.observe.measuring_chain import FAMILIES, HIGHEST_ORDER
from vibeam.solvers import SOLVERS


def figure_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [show.NAME]."""
    for name, show in case.show.items():
        path: KeyPath = ("show", name)
        for index, fidelity in enumerate(show.fidelities or ()):
            yield from named_fidelity(case, (*path, "fidelities", index), fidelity)
        if show.kind is not None:
            yield from _keys(path, show, FIGURES[show.kind], case.record is not None)
            yield from _exact(case, path, show, FIGURES[show.kind])
            if FIGURES[show.kind].of_beam:
                yield from _of_beam(case, path, show)
            yield from KINDS[case.kind].output_complaints(case, (*path, "output"), show.output)
            yield from shown_output(case, path, show, FIGURES[show.kind])


def _keys(path: KeyPath, show: SimpleNamespace, kind: FigureKind, record: bool) -> Iterator[Complaint]:
    if show.window is not None and len(show.window) != 2:
        yield (*path, "window"), f'{len(show.window)} times: write two, as in window = ["0.20 s", "0.35 s"]'
    for name in (*COMMON, *own_keys()):
        given = getattr(show, name) is not None
        if given and name not in kind.allowed(record):
            yield (*path, name), f'kind = "{show.kind}" has no use for it: leave it away'
        elif name in kind.needed(record) and not given:
            yield (*path, name), f'missing: kind = "{show.kind}" needs it'
    shown = tuple(kind.quantities) or QUANTITIES + OF_OUTPUT
    if "quantity" in kind.needs and show.quantity is not None and show.quantity not in shown:
        words = " | ".join(f'"{word}"' for word in shown)
        yield (*path, "quantity"), f'kind = "{show.kind}" shows {words}'
    if show.periods and show.subdivision and show.periods % show.subdivision:
        multiple = f"write a multiple of subdivision = {show.subdivision}"
        yield (*path, "periods"), f"{show.periods} drive periods hold no whole number of the longest ones: {multiple}"


def _of_beam(case: SimpleNamespace, path: KeyPath, show: SimpleNamespace) -> Iterator[Complaint]:
    """A kind that shows the beam at one frequency, on one branch."""
    if case.kind != "beam":
        yield (*path, "kind"), f'"{show.kind}" shows a beam, and this case has none: leave the table away'
    if show.frequency is not None and len(show.frequency) > 1:
        said = f'{len(show.frequency)} frequencies, and "{show.kind}" shows one: write a table for each'
        yield (*path, "frequency"), said
    if show.direction == "both":
        yield (*path, "direction"), f'"{show.kind}" shows one motion: write "up" or "down", or leave it away'


def _exact(case: SimpleNamespace, path: KeyPath, show: SimpleNamespace, kind: FigureKind) -> Iterator[Complaint]:
    """Kinds that integrate along a motion, and the measuring chain, want one that is known at any time."""
    yield from _transient(case, path, show, kind)
    measured = case.measurement is not None and show.kind in ("history", "portrait")
    if not (kind.exact or measured):
        return
    who = f'kind = "{show.kind}"' if kind.exact else "[measurement]"
    for name in show.fidelities or tuple(case.fidelity):
        solver = case.fidelity[name].solver if name in case.fidelity else None
        if solver is not None and SOLVERS[solver].samples:
            cured = (
                f"name in fidelities those by {', '.join(name for name, each in SOLVERS.items() if not each.samples)}"
            )
            yield (*path, "fidelities"), f'{who} needs an exact motion, "{solver}" of {name} gives samples: {cured}'


def _transient(case: SimpleNamespace, path: KeyPath, show: SimpleNamespace, kind: FigureKind) -> Iterator[Complaint]:
    """A kind that flies a transient wants no solver of settled motions alone."""
    for name in show.fidelities or tuple(case.fidelity) if kind.transient else ():
        solver = case.fidelity[name].solver if name in case.fidelity else None
        if solver is not None and SOLVERS[solver].stationary:
            said = f'kind = "{show.kind}" flies a transient, "{solver}" of {name} knows settled motions alone'
            yield (*path, "fidelities"), f"{said}: name in fidelities the others"


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


@lru_cache(maxsize=8)
def show_table(name: str, kinds: tuple[str, ...], output: Field | None = None) -> Any:
    """The table of a further figure, with the ``kinds`` that are registered now and their keys.

    ``output``: field in place of that of a beam's outputs.
    """
    meaning = "; ".join(f"{each}: {FIGURES[each].meaning}" for each in kinds)
    known = plan_keys(
        ShowPlan,
        fidelities=Each(TEXT, alone=True, called="fidelities"),
        frequency=Several(Frequency, alone=True, limit=12),
        quantity=Word((*QUANTITIES, *OF_OUTPUT, *quantities_shown())),
        output=OUTPUT_NAME,
    )
    own = {each: declared_key(declared, None) for each, declared in own_keys().items()}
    first = {"kind": key(Word(kinds), meaning, "portrait")}
    given = {} if output is None else {"output": output}
    doc = "A further figure beside the frequency-response curves, one table each."
    return table(name, doc, first | known | own | given)


FigureTable = table("FigureTable", "Format of all figures of the case; absent = the defaults.", plan_keys(FigurePlan))


class MeasurementTable(Table):
    """The measuring chain through which histories, portraits, spectra, ringing and restitution are seen; absent = they
    are exact. Velocities are central differences of the record.
    """

    sampling = key(Frequency, "samples a second", "5 kHz")
    low_pass = key(Word(FAMILIES), "analog filter before sampling; absent = none", "bessel", None)
    order = key(Count(1, HIGHEST_ORDER), "of the filter", 4, None)
    cut_off = key(
        Frequency, "of the filter: gain 1/√2, or of an elliptic one where it leaves the ripple", "500 Hz", None
    )
    ripple = key(Quantity(units.RATIO, POSITIVE), "dB, of an elliptic filter's pass band; absent = 0.1", 0.1, None)
    attenuation = key(Quantity(units.RATIO, POSITIVE), "dB, of an elliptic filter's stop band; absent = 60", 60, None)
    quantisation = key(Length, "step of the converter; absent = none", "1 µm", None)
    noise = key(Length, "rms, white, on the samples; absent = none", "1 µm", None)
    seed = key(Count(0, 2**31 - 1), "of the noise, which needs one", 1, None)


class SdofMeasurementTable(MeasurementTable):
    """The measuring chain of the single degree of freedom."""

    quantisation = key(
        Quantity(units.RATIO, POSITIVE), "step of the converter, in the unit of the motion; absent = none", 1e-6, None
    )
    noise = key(
        Quantity(units.RATIO, POSITIVE),
        "rms, white, on the samples, in the unit of the motion; absent = none",
        1e-6,
        None,
    )
