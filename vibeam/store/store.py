"""What an open results file gives and takes, from several threads: branches, curves, a study, what is shown."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.provenance import note_continued
from vibeam.response import FrequencyResponse
from vibeam.show.keep import HOME, read_sheets, write_sheets
from vibeam.state import State
from vibeam.store.branch import Branch, Kept, read_branch, write_points
from vibeam.store.faults import reading, writing
from vibeam.store.layout import read_curves, write_curves

if TYPE_CHECKING:
    import h5py

    from vibeam.accuracy.study import Study
    from vibeam.motions import MotionCurves
    from vibeam.show.plan import Sheet, ShowPlan

CURVES = "curves"  # the group of all motions a solver knows, beside those of the directions


class Store:
    """An open results file, safe to write from several threads; made by ``vibeam.store.file.opened``.

    ``unit``: of the outputs. Every method: StoreError where the file does not hold what was written or takes no more.
    """

    def __init__(self, file: h5py.File, path: Path, made: bool, unit: str) -> None:
        self._file = file
        self._lock = threading.Lock()
        self._noted = made
        self._unit = unit
        self.path = path
        self.written = 0

    @contextmanager
    def _reading(self, where: str) -> Iterator[h5py.File]:
        with self._lock, reading(self.path, where):
            yield self._file

    @contextmanager
    def _writing(self) -> Iterator[h5py.File]:
        with self._lock, writing(self.path):
            yield self._file

    def restore(self, branch: Branch) -> Kept:
        """What is there of one branch."""
        with self._reading(f"/{branch.group}") as file:
            return read_branch(file[branch.group], branch)

    def write(self, branch: Branch, start: int, block: FrequencyResponse, state: State) -> None:
        """Put ``block`` at the points from ``start`` on, and the state after its last point."""
        with self._writing() as file:
            group = file[branch.group]
            if not self._noted:
                note_continued(file["provenance/continued"])
                self._noted = True
            write_points(group, start, block, state)
            self.written += len(block)

    def curves(self, fidelity: str) -> MotionCurves | None:
        """All motions of one fidelity that the file holds, None without."""
        with self._reading(f"/{fidelity}/{CURVES}") as file:
            return read_curves(file[fidelity][CURVES]) if CURVES in file[fidelity] else None

    def write_curves(self, fidelity: str, curves: MotionCurves) -> None:
        """Keep them; under another name until they are whole."""
        with self._writing() as file:
            group, part = file[fidelity], f".{CURVES}"
            if part in group:
                del group[part]
            write_curves(group.create_group(part), curves, self._unit)
            group.move(part, CURVES)
            file.flush()

    def study(self, branches: Sequence[Branch]) -> Study | None:
        """The study whose ``branches`` the file holds, None where they are not all there."""
        kept = {branch.direction: self.restore(branch) for branch in branches}
        if any(part.done < len(part.response) for part in kept.values()):
            return None
        from vibeam.accuracy.keep import HOME as group
        from vibeam.accuracy.keep import read_study

        with self._reading(f"/{group}") as file:
            return read_study(file[group], {way: part.response for way, part in kept.items()})

    def write_study(self, study: Study) -> None:
        """Keep what a study says beside its branches, before these."""
        from vibeam.accuracy.keep import HOME as group
        from vibeam.accuracy.keep import write_study

        with self._writing() as file:
            write_study(file[group], study)
            file.flush()

    def shown(self, plan: ShowPlan) -> tuple[Sheet, ...] | None:
        """What the file holds for ``plan``, None where it must be made."""
        with self._reading(f"/{HOME}/{plan.name}") as file:
            return read_sheets(file, plan)

    def show(self, plan: ShowPlan, sheets: tuple[Sheet, ...]) -> None:
        """Keep ``sheets``."""
        with self._writing() as file:
            write_sheets(file, plan, sheets, self._unit)
