"""Results on disk: one HDF5 file a run, written as it goes, so that a run that was stopped goes on where it was.

Points are written in two steps, their values and then the count of points that are there, each flushed. A run that is
killed between the two leaves points that nobody counts, and the next run writes them again.
"""

from __future__ import annotations

import errno
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.provenance import note_continued, write_provenance
from vibeam.response import Array, FrequencyResponse
from vibeam.show.keep import HOME, read_sheets, write_sheets
from vibeam.state import State
from vibeam.store_layout import LAYOUT, fixed, read_curves, write_branch, write_curves

if TYPE_CHECKING:
    import h5py

    from vibeam.accuracy.study import Study
    from vibeam.motions import MotionCurves
    from vibeam.show.plan import Sheet, ShowPlan

FORMAT = "vibeam results 1"
CURVES = "curves"  # the group of all motions a solver knows, beside those of the directions
SIGNATURE = b"\x89HDF\r\n\x1a\n"
# what h5py raises where the bytes are not as they were written
_FAULTS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)


class StoreError(ValueError):
    """A results file that cannot be used: the message names the file, what is wrong, and the cure."""


@dataclass(frozen=True)
class Branch:
    """What one group of the file is for: a fidelity swept one way over ``frequency`` (Hz, in the order swept)."""

    fidelity: str
    direction: str
    frequency: Array
    modes: int

    @property
    def group(self) -> str:
        """The group's path in the file."""
        return f"{self.fidelity}/{self.direction}"


@dataclass(frozen=True)
class Kept:
    """What a file holds of a branch: ``done`` points of ``response`` and the state after the last of them."""

    response: FrequencyResponse
    done: int
    state: State | None


class Store:
    """An open results file, safe to write from several threads; made by ``opened``."""

    def __init__(self, file: h5py.File, path: Path, made: bool) -> None:
        self._file = file
        self._lock = threading.Lock()
        self._noted = made
        self.path = path
        self.written = 0

    def restore(self, branch: Branch) -> Kept:
        """What is there of one branch; StoreError where the file does not hold it as it was laid out."""
        with self._lock:
            try:
                return _kept(self._file[branch.group], branch)
            except _FAULTS as fault:
                raise _damaged(self.path, f"/{branch.group}", fault) from None

    def write(self, branch: Branch, start: int, block: FrequencyResponse, state: State) -> None:
        """Put ``block`` at the points from ``start`` on, and the state after its last point; StoreError if it fails."""
        with self._lock:
            try:
                self._write(self._file[branch.group], start, start + len(block), block, state)
            except OSError as fault:
                text = f"{self.path}: cannot be written ({_reason(fault)}): make room, then run again to go on"
                raise StoreError(text) from None

    def curves(self, fidelity: str) -> MotionCurves | None:
        """All motions of one fidelity that the file holds, None without; StoreError where they cannot be read."""
        with self._lock:
            try:
                return read_curves(self._file[fidelity][CURVES]) if CURVES in self._file[fidelity] else None
            except _FAULTS as fault:
                raise _damaged(self.path, f"/{fidelity}/{CURVES}", fault) from None

    def write_curves(self, fidelity: str, curves: MotionCurves, unit: str) -> None:
        """Keep them; under another name until they are whole. StoreError if it fails."""
        with self._lock:
            try:
                group, part = self._file[fidelity], f".{CURVES}"
                if part in group:
                    del group[part]
                write_curves(group.create_group(part), curves, unit)
                group.move(part, CURVES)
                self._file.flush()
            except OSError as fault:
                text = f"{self.path}: cannot be written ({_reason(fault)}): make room, then run again to go on"
                raise StoreError(text) from None

    def study(self, branches: Sequence[Branch]) -> Study | None:
        """The study whose ``branches`` the file holds, None where they are not all there; StoreError as ``restore``."""
        kept = {branch.direction: self.restore(branch) for branch in branches}
        if any(part.done < len(part.response) for part in kept.values()):
            return None
        from vibeam.accuracy.keep import HOME as group
        from vibeam.accuracy.keep import read_study

        with self._lock:
            try:
                return read_study(self._file[group], {way: part.response for way, part in kept.items()})
            except _FAULTS as fault:
                raise _damaged(self.path, f"/{group}", fault) from None

    def write_study(self, study: Study) -> None:
        """Keep what a study says beside its branches, before these; StoreError if it fails."""
        from vibeam.accuracy.keep import HOME as group
        from vibeam.accuracy.keep import write_study

        with self._lock:
            try:
                write_study(self._file[group], study)
                self._file.flush()
            except OSError as fault:
                text = f"{self.path}: cannot be written ({_reason(fault)}): make room, then run again to go on"
                raise StoreError(text) from None

    def shown(self, plan: ShowPlan) -> tuple[Sheet, ...] | None:
        """What the file holds for ``plan``, None where it must be made; StoreError where the file is damaged."""
        with self._lock:
            try:
                return read_sheets(self._file, plan)
            except _FAULTS as fault:
                raise _damaged(self.path, f"/{HOME}/{plan.name}", fault) from None

    def show(self, plan: ShowPlan, sheets: tuple[Sheet, ...], unit: str) -> None:
        """Keep ``sheets``; StoreError if that fails."""
        with self._lock:
            try:
                write_sheets(self._file, plan, sheets, unit)
            except OSError as fault:
                text = f"{self.path}: cannot be written ({_reason(fault)}): make room, then run again to go on"
                raise StoreError(text) from None

    def _write(self, group: h5py.Group, start: int, stop: int, block: FrequencyResponse, state: State) -> None:
        if not self._noted:
            note_continued(self._file["provenance/continued"])
            self._noted = True
        for name in LAYOUT:
            if name != "frequency":
                group[name][start:stop] = getattr(block, name)
        group["state_displacement"][stop - 1] = state.displacement
        group["state_velocity"][stop - 1] = state.velocity
        group["state_resting"][stop - 1] = int(state.resting)
        self._file.flush()
        group.attrs.modify("done", np.int64(stop))  # in place: an attribute made anew could be lost half-way
        self._file.flush()
        self.written += stop - start


@contextmanager
def opened(path: Path, *, text: str, key: str, branches: Sequence[Branch], unit: str = "m") -> Iterator[Store]:
    """The results file of one case, made where there is none; ``unit``: of the outputs.

    StoreError where ``path`` is something else, belongs to another case, is damaged or cannot be written. A file that
    is made here and gets no point is taken away again.
    """
    if path.is_dir():
        raise StoreError(f"{path}: is a folder: name a file in it")
    made = not path.exists()
    if made:
        _make(path, text, key, branches, unit)
    written = 0
    try:
        with _open(path, "r+") as file:
            _same_case(file, path, text, key)
            store = Store(file, path, made)
            try:
                yield store
            finally:
                written = store.written
    finally:
        if made and not written:
            path.unlink(missing_ok=True)


def read(path: Path) -> dict[tuple[str, str], FrequencyResponse]:
    """Every branch a results file holds, by fidelity and direction; points that were not run are NaN."""
    with _open(path, "r") as file:
        try:
            return {(fidelity, way): _response(group) for fidelity, way, group in _branches(file)}
        except _FAULTS as fault:
            raise _damaged(path, "its groups", fault) from None


def _branches(file: h5py.File) -> Iterator[tuple[str, str, h5py.Group]]:
    for fidelity, ways in file.items():
        for way, group in ways.items() if fidelity != HOME else ():
            if "done" in group.attrs:
                yield fidelity, way, group


def _make(path: Path, text: str, key: str, branches: Sequence[Branch], unit: str) -> None:
    """Lay the file out under another name and rename it, so that ``path`` is whole from its first moment."""
    import h5py

    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with h5py.File(part, "w-") as file:
            file.attrs["format"] = fixed(FORMAT)
            file.create_group("case").attrs["key"] = fixed(key)
            file["case"]["text"] = fixed(text)
            write_provenance(file.create_group("provenance"))
            for branch in branches:
                write_branch(file.create_group(branch.group), branch.frequency, branch.modes, unit)
        os.replace(part, path)
    except OSError as fault:
        raise StoreError(f"{path}: cannot be written ({_reason(fault)}): choose another --out") from None
    finally:
        part.unlink(missing_ok=True) if part.parent.is_dir() else None


def _open(path: Path, mode: str) -> h5py.File:
    import h5py

    try:
        with path.open("rb") as raw:
            known = raw.read(len(SIGNATURE)) == SIGNATURE  # h5py would take an empty file for a new one
        file = h5py.File(path, mode) if known else None
    except BlockingIOError:
        raise StoreError(f"{path}: another run is writing it: wait for it, or choose another --out") from None
    except OSError as fault:
        raise _refused(path, fault) from None
    if file is not None and _format(file, path) == FORMAT:
        return file
    raise StoreError(f"{path}: is no vibeam result: choose another --out, or delete it")


def _format(file: h5py.File, path: Path) -> str | None:
    """What the file says it is; it is left open only if that is a vibeam result."""
    try:
        found = file.attrs["format"].decode() if "format" in file.attrs else None
    except _FAULTS as fault:
        file.close()
        raise _damaged(path, "it", fault) from None
    if found != FORMAT:
        file.close()
    return found


def _refused(path: Path, fault: OSError) -> StoreError:
    if fault.errno in (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT):
        return StoreError(f"{path}: cannot be opened ({_reason(fault)}): choose another --out")
    return _damaged(path, "it", fault)


def _same_case(file: h5py.File, path: Path, text: str, key: str) -> None:
    try:
        there, kept = (value.decode() for value in (file["case"].attrs["key"], file["case/text"][()]))
    except _FAULTS as fault:
        raise _damaged(path, "/case", fault) from None
    if there != key:
        raise StoreError(
            f"{path}: holds another case ({_first_difference(kept, text)}): choose another --out, or delete it"
        )


def _first_difference(there: str, here: str) -> str:
    pairs = zip_longest(there.splitlines(), here.splitlines(), fillvalue="nothing")
    differing = next(((old, new) for old, new in pairs if old != new), ("its key", "another"))
    return f"{differing[0] or 'nothing'!r} there, {differing[1] or 'nothing'!r} here"


def _kept(group: h5py.Group, branch: Branch) -> Kept:
    response, done = _response(group), int(group.attrs["done"])
    expected = (len(branch.frequency), branch.modes)
    if response.mode_energy.shape != expected or not 0 <= done <= expected[0]:
        raise ValueError(f"{response.mode_energy.shape} points and modes with {done} done, not {expected}")
    if not np.array_equal(response.frequency, branch.frequency):
        raise ValueError("other frequencies than the case's")
    return Kept(response, done, _state(group, done - 1) if done else None)


def _response(group: h5py.Group) -> FrequencyResponse:
    return FrequencyResponse(**{name: group[name][()] for name in LAYOUT})


def _state(group: h5py.Group, point: int) -> State:
    displacement, velocity = group["state_displacement"][point], group["state_velocity"][point]
    return State(displacement, velocity, resting=bool(group["state_resting"][point]))


def _damaged(path: Path, where: str, fault: BaseException) -> StoreError:
    return StoreError(
        f"{path}: {where} cannot be read ({_reason(fault)}): the file is damaged: delete it and run again"
    )


def _reason(fault: BaseException) -> str:
    if isinstance(fault, OSError) and fault.errno:
        return os.strerror(fault.errno).lower()
    return (str(fault).splitlines() or [type(fault).__name__])[0]
