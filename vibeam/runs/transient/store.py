"""Results file of a case under a record: one row a motion, found by its key; blocks beside it while a run is under way.

A motion is stored under the key of all that decides it. So a file goes on when seeds, values or fidelities are added,
and what another case decides otherwise is not there.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.store.adaptation import Requirements, case_text, write_case
from vibeam.runs.store.figures import HOME, sheets_of
from vibeam.runs.store.image import bytes_of, opened_image
from vibeam.runs.store.records import Kept, KeyedRecord, keep, kept
from vibeam.runs.transient.layout import read_group, write_group
from vibeam.runs.transient.motions import Realisation
from vibeam.runs.transient.reading import Reading
from vibeam.runs.transient.signals import TransientSignal
from vibeam.store.blocks import read_block, write_block
from vibeam.store.errors import ANEW, ELSEWHERE, StoreError, reading
from vibeam.store.hdf5 import content_of, fixed, in_memory, text_of
from vibeam.store.place import Place, Tell, locked, place_of
from vibeam.store.provenance import note_continued, write_provenance

if TYPE_CHECKING:
    import h5py

    from vibeam.case.case import Case
    from vibeam.figures.sheet import Sheet

FORMAT = "vibeam transient 1"
OTHER = f"is no result of a case with [record]: {ELSEWHERE}, or delete it"
WRITE_EVERY = 0.5  # s between two blocks: a killed run loses no more, and the motions under way


@dataclass(frozen=True)
class StoredRun:
    """Content of a results file: motions, the case as TOML, what computed them, what decides the numbers."""

    known: KnownMotions
    whole: str
    provenance: Mapping[str, str]
    numbers: str
    figures: h5py.File

    def shown(self, case: Case) -> dict[str, tuple[Sheet, ...]]:
        """Data of the case's figures, as far as the file has them."""
        found = {name: kept(self.figures, sheets_of(plan), plan.key) for name, plan in case.shows.items()}
        return {name: sheets for name, sheets in found.items() if sheets is not None}


@dataclass
class StoredModel:
    """Model of one fidelity in the file: its signals and its first natural period, s."""

    signals: tuple[TransientSignal, ...]
    period: float


@dataclass
class KnownMotions:
    """Motions that are known, by key, each with what it is, and the models of their fidelities."""

    motions: dict[str, tuple[Realisation, Reading]] = field(default_factory=dict)
    models: dict[str, StoredModel] = field(default_factory=dict)

    def add(self, found: Mapping[str, Any], models: Mapping[str, StoredModel]) -> None:
        """Add motions and models."""
        self.motions |= found
        self.models |= models


class TransientStore:
    """Open results file, safe to write from several threads; made by ``opened``. ``path`` None: nothing is kept.

    Motions are written as blocks every ``WRITE_EVERY`` s, the file when it is closed; the first block puts a file in
    place, so that a reader knows of which case they are.
    """

    def __init__(self, case: Case, place: Place | None, known: KnownMotions, file: h5py.File | None = None) -> None:
        self.case, self.known = case, known
        self._place, self._beside = place, in_memory() if file is None else file
        self._lock, self._due = threading.Lock(), monotonic() + WRITE_EVERY
        self._fresh: list[str] = []
        self._blocks, self._begun, self._changed = 0, False, False

    def keep(self, motion: Realisation, found: Reading, model: StoredModel) -> None:
        """Keep a motion; StoreError where the disk fails."""
        with self._lock:
            self.known.add({motion.key: (motion, found)}, {motion.fidelity: model})
            self._fresh.append(motion.key)
            if self._place is not None and monotonic() >= self._due:
                self._write()

    def sheets(self, record: KeyedRecord[Kept], key: str, make: Callable[[], Kept]) -> Kept:
        """Data of a figure that the file keeps under ``key``, else what ``make`` makes, which it keeps from now on."""
        found = kept(self._beside, record, key)
        if found is None:
            found, self._changed = make(), True
            keep(self._beside, record, key, found)
        return found

    def _write(self) -> None:
        assert self._place is not None
        if not self._begun:
            self._gather()
        else:
            file = self._place.folder / f"motions-{self._blocks:09d}.npz"
            write_block(self._place.path, file, FORMAT, _packed(self.known, self._fresh))
            self._blocks += 1
        self._fresh.clear()
        self._due = monotonic() + WRITE_EVERY

    def _gather(self) -> None:
        assert self._place is not None
        with _file_of(self.case, self.known, self._beside) as file:
            self._place.replace(content_of(file))
        self._place.discard()
        self._begun, self._changed = True, False

    def close(self, changed: bool) -> None:
        """Gather all blocks into the file, where there is anything new."""
        if self._place is not None and (self._fresh or self._blocks or (changed and self._changed)):
            self._gather()


@contextmanager
def opened(
    case: Case, wanted: Collection[str], path: Path | None, fresh: bool, tell: Tell
) -> Iterator[TransientStore]:  # fmt: skip
    """Open the results file of a case, made with its first motions where there is none; locked against others.

    ``wanted``: keys of the motions of all fidelities of the case. Where others would be lost, the file as it was is
    kept aside. StoreError as of any results file.
    """
    if path is None:
        yield TransientStore(case, None, KnownMotions())
        return
    with locked(path) as place:
        place.tidy()
        store = TransientStore(case, place, KnownMotions())
        if place.target.exists() and not fresh:
            store = _continued(case, wanted, place, tell)
        elif place.target.exists():
            bytes_of(place, "r+b", FORMAT, OTHER)
        try:
            yield store
        except BaseException:
            store.close(changed=False)
            raise
        store.close(changed=True)


def _continued(case: Case, wanted: Collection[str], place: Place, tell: Tell) -> TransientStore:
    with opened_image(place, "r+b", FORMAT, OTHER) as file:
        known = _known(place, file)
        name, text = text_of(file["case"], "name"), case_text(file, "whole")
        beside = _beside(file)
    lost = [key for key in known.motions if key not in wanted]
    if lost and name != case.path.name:
        raise StoreError(f"{place.path}: holds motions of another case ({name}): {ANEW}")
    if lost:
        kept = len(known.motions) - len(lost)
        said = f"{len(lost)} of its motions are not of the case as it is now, {kept} stay"
        place.replace(content_of(_file_of(case, known, beside, text)))  # with its blocks
        place.discard()
        place.keep_aside(said, tell)
        known.motions = {key: each for key, each in known.motions.items() if key in wanted}
    store = TransientStore(case, place, known, beside)
    store._changed = bool(lost) or text != case.text
    return store


def read_motions(path: Path) -> StoredRun:
    """Content of a results file and of the blocks beside it."""
    place = place_of(path)
    with opened_image(place, "rb", FORMAT, OTHER) as file, reading(path, "its groups"):
        made = {name: str(value) for name, value in file["provenance"].attrs.items()}
        return StoredRun(_known(place, file), case_text(file, "whole"), made, case_text(file, "text"), _beside(file))


def _beside(file: h5py.File) -> h5py.File:
    """Copy in memory of what a file has beside its motions: provenance and figures."""
    made = in_memory()
    for name in ("provenance", HOME):
        if name in file:
            file.copy(name, made)
    return made


def is_transient(path: Path) -> bool:
    """Test whether a file is one of motions under a record; False where it cannot be read."""
    try:
        return bool(bytes_of(place_of(path), "rb", FORMAT, OTHER))
    except StoreError:
        return False


def _known(place: Place, file: h5py.File) -> KnownMotions:
    """Motions of the file and of the blocks beside it; a damaged block is not there."""
    known = KnownMotions()
    for name, group in file.get("motions", {}).items():
        signals, period, rows = read_group(group)
        found = {str(row["key"]): (Realisation(name, **row), own) for row, own in rows}
        known.add(found, {name: StoredModel(signals, period)})
    for block in sorted(place.folder.glob("motions-*.npz")) if place.folder.exists() else ():
        values = read_block(block, FORMAT)
        if values is not None:
            _unpack(values, known)
    return known


def _packed(known: KnownMotions, keys: Sequence[str]) -> dict[str, Any]:
    """Motions as the arrays of a block."""
    chosen = [known.motions[key] for key in keys]
    names = {motion.fidelity for motion, _ in chosen}
    head = {"motions": [asdict(motion) for motion, _ in chosen], "models": {n: asdict(known.models[n]) for n in names}}
    arrays = {f"{at}.{name}": each for at, (_, own) in enumerate(chosen) for name, each in own.items()}
    return {"head": np.frombuffer(json.dumps(head).encode(), dtype=np.uint8), **arrays}


def _unpack(values: Mapping[str, Any], known: KnownMotions) -> None:
    head = json.loads(values["head"].tobytes())
    found: list[Reading] = [{} for _ in head["motions"]]
    for place, each in values.items():
        number, _, name = place.partition(".")
        if name:
            found[int(number)][name] = each
    motions = [Realisation(**each) for each in head["motions"]]
    models = {
        name: StoredModel(tuple(TransientSignal(**one) for one in each["signals"]), each["period"])
        for name, each in head["models"].items()
    }
    known.add({each.key: (each, own) for each, own in zip(motions, found, strict=True)}, models)


def _file_of(case: Case, known: KnownMotions, beside: h5py.File, whole: str | None = None) -> h5py.File:
    """File in memory of all motions, with the figures and the provenance that it had."""
    file = in_memory()
    file.attrs["format"] = fixed(FORMAT)
    for name in beside:
        beside.copy(name, file)
    if "provenance" not in file:
        write_provenance(file.create_group("provenance"))
    elif whole is None:
        note_continued(file["provenance"])
    said = case.text if whole is None else whole
    write_case(file, Requirements(case.numbers, case.key, case.shared, (), said, case.path.name))
    for name, model in known.models.items():
        own = [each for each in known.motions.values() if each[0].fidelity == name]
        write_group(file.create_group(f"motions/{name}"), model.signals, model.period, own)
    return file
