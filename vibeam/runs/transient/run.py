"""Run of a case under its record: every fidelity through the same realisations, stored on disk as it goes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.case.case import plan_of_record
from vibeam.exchange.faults import CaseError, Fault
from vibeam.runs.parallel import PointCount
from vibeam.runs.run_plan import restricted
from vibeam.runs.store.figures import shown_of
from vibeam.runs.stored_result import StoredResult
from vibeam.runs.transient.memory import require_room
from vibeam.runs.transient.motions import MotionMaker, Realisation, histories_of, input_of, motions_of
from vibeam.runs.transient.overview import overview_of_record
from vibeam.runs.transient.result import TransientResult
from vibeam.runs.transient.store import KnownMotions, StoredModel, TransientStore, opened, read_motions
from vibeam.runs.transient.transient import assembled
from vibeam.store.place import Tell
from vibeam.store.shares import are_shared, evaluate_each
from vibeam.system.response import Ended

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.sheet import Sheet
    from vibeam.runs.systems import Overview
    from vibeam.runs.transient.reading import Reading

Told = Callable[[int, int], None]
NONE: Mapping[str, Any] = {}


def run_record(
    case: Case, path: Path | None, told: Told, fresh: bool, tell: Tell,
    before: Callable[[Overview], None] | None = None, show: bool = True,
) -> TransientResult:  # fmt: skip
    """Result of all motions of ``case``; those in the results file already are not flown again.

    ``told`` hears the number of motions that are there, and their total, from any thread; ``before`` gets the overview
    of rig and load where any is missing. ``show``: compute the data of the case's figures.
    """
    every = [list(motions_of(case, name)) for name in case.own]
    twins = [list(motions_of(case, name, twins=True)) for name in case.own]
    wanted = {each.key for some in (*every, *twins) for each in some}
    with opened(case, wanted, path, fresh, tell) as store:
        known = store.known.motions
        asked = [each for some in every for each in some if each.fidelity in case.fidelities]
        missing = [each for each in asked if are_shared() or each.key not in known]
        found = len(asked) - len(missing)
        makers = {name: MotionMaker(case, name) for name in case.fidelities}
        if missing:
            require_room(makers, missing)
        if missing and before:
            before(overview_of_record(makers, len(missing)))
        count = PointCount(found, len(asked), told, "motions")
        try:
            _make("motions", makers, missing, store, count)
            shadows = [each for each in _twins(case, store.known, twins) if each.key not in known]
            _make("twins", makers, shadows, store, None)
        except KeyboardInterrupt:
            raise count.stopped(path) from None
        return result_of(case, store.known, path, found, shown_of(case, store.sheets) if show else {})


def _make(
    what: str, makers: Mapping[str, MotionMaker], motions: Sequence[Realisation], store: TransientStore,
    count: PointCount | None,
) -> None:  # fmt: skip
    """Make motions, several at once, and keep each.

    All fidelities under one load, then under the next: a run that is stopped has some of each. Costly ones come first,
    so that threads end about together.
    """
    faults: list[Fault] = []
    for name in dict.fromkeys(each.fidelity for each in motions):
        try:
            makers[name].warm_up()  # here Ctrl-C can stop a compilation; what is made once is there before threads ask
        except ValueError as refusal:
            own = makers[name].case.fault("fidelity", name, message=str(refusal))
            faults += refusal.faults if isinstance(refusal, CaseError) else [own]
    if faults:
        raise CaseError(faults)

    def keep(motion: Realisation, found: Reading) -> None:
        maker = makers[motion.fidelity]
        store.keep(motion, found, StoredModel(maker.signals, maker.period()))
        if count is not None:
            count.add()

    every = sorted(motions, key=lambda each: (each.seed, each.value, -makers[each.fidelity].system(0)[0].size))
    of = " ".join(each.key for each in every)
    evaluate_each(what, of, every, lambda motion: makers[motion.fidelity].made(motion), keep)


def _twins(case: Case, known: KnownMotions, twins: Sequence[Sequence[Realisation]]) -> Iterator[Realisation]:
    """Twins of the finest fidelities with which others are compared."""
    result = result_of(case, known, None, 0)
    tops = {top for name, top in result.finest.items() if name != top}
    yield from (each for some in twins for each in some if each.fidelity in tops)


def result_of(
    case: Case, known: KnownMotions, path: Path | None, found: int, sheets: Mapping[str, tuple[Sheet, ...]] = NONE
) -> TransientResult:
    """Result of what is known of the motions of a case; others are not run yet. ``sheets``: data of its figures."""
    own = {name: known.models[name] for name in case.fidelities if name in known.models}
    plan = plan_of_record(case)
    shown = {}
    transients, twins = {}, {}
    for name, model in own.items():
        read = _read(known, motions_of(case, name))
        kept = next((each for each in read.values() if "history_edges" in each), None)
        table = [[read.get((i, j)) for j in range(len(plan.seeds) or 1)] for i in range(len(plan.values))]
        histories = {} if kept is None else histories_of(kept, model.signals)
        transients[name] = assembled(name, plan.duration, model.signals, table, histories)
        near = _read(known, motions_of(case, name, twins=True))
        twins[name] = {value: each for (value, _), each in near.items() if each["ended"] == Ended.COMPLETE.code}
        if kept is not None:
            shown[name] = input_of(kept)
    alike = len(set(shown.values())) == 1
    inputs = {"": next(iter(shown.values()))} if alike else shown
    periods = {name: model.period for name, model in own.items()}
    return TransientResult(case, transients, path, found, periods, twins, inputs, sheets)


def _read(known: KnownMotions, motions: Iterable[Realisation]) -> dict[tuple[int, int], Reading]:
    """Readings that are known of ``motions``, by the numbers of value and seed."""
    return {(each.value, each.seed): known.motions[each.key][1] for each in motions if each.key in known.motions}


def read_transient(path: str | Path, parse: Callable[[str], Case]) -> StoredResult:
    """Read a results file, complete or not; ``parse`` makes a case of its text.

    StoreError where it is none, or damaged; CaseError where its case cannot be built any more.
    """
    file = Path(path)
    stored = read_motions(file)
    case = parse(stored.whole)
    case = restricted(case, set(stored.known.models) & set(case.fidelities))
    result = result_of(case, stored.known, file, 0, stored.shown(case))
    result.found = result.total - result.missing
    return StoredResult(result, stored.provenance, result.missing, stored.numbers)
