"""Access to an open results file from several threads: branches, curves, figure data."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from vibeam.runs.store.branch import Branch, StoredBranch, count_points, read_branch, rows_of, write_rows
from vibeam.runs.store.checksum import sign, verify
from vibeam.runs.store.errors import StoreError, reading
from vibeam.runs.store.estimates import ESTIMATES, key_of_estimates, read_estimates, write_estimates
from vibeam.runs.store.figures import HOME, read_sheets, write_sheets
from vibeam.runs.store.layout import fixed, read_curves, write_curves
from vibeam.runs.store.models import (
    COMPARISON,
    Keyed,
    key_of_comparisons,
    read_comparisons,
    write_comparisons,
    write_models,
)
from vibeam.runs.store.provenance import note_continued
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

if TYPE_CHECKING:
    import h5py

    from vibeam.case.plans import ShowPlan
    from vibeam.figures.sheet import Sheet
    from vibeam.runs.comparison.differences import HeldComparison
    from vibeam.runs.estimate.records import FidelityEstimate
    from vibeam.runs.store.disk import Disk, Image
    from vibeam.system.curves import MotionCurves
    from vibeam.system.quantities import OutputUnits


CURVES = "curves"  # group of all motions known to a solver, beside those of the directions


class Store:
    """Open results file, safe to write from several threads; made by ``vibeam.runs.store.file.opened``.

    ``file`` is open on its ``image`` in memory, from where all changes go to ``disk``; ``units``: of the output;
    ``models``: what the file had of its models when it was opened.
    Every method: StoreError where the file is damaged or cannot be written.
    """

    def __init__(
        self, file: h5py.File, image: Image, disk: Disk, units: OutputUnits, models: Keyed, *, noted: bool
    ) -> None:
        self._file, self._image, self._disk = file, image, disk
        self._lock = threading.Lock()
        self._noted = noted
        self._units = units
        self._failure: StoreError | None = None
        self.path, self.models = disk.path, models
        self.written = 0

    @contextmanager
    def _reading(self, where: str) -> Iterator[h5py.File]:
        with self._lock, reading(self.path, where):
            yield self._file

    @contextmanager
    def _restructuring(self) -> Iterator[h5py.File]:
        """Context for creating, moving or deleting groups: the file on disk is the old one or the new one, whole."""
        with self._lock, self._unless_failed():
            self._note()
            yield self._file
            self._file.flush()
            self._disk.replace(self._image.getvalue())

    @contextmanager
    def _unless_failed(self) -> Iterator[None]:
        """Context that refuses writes after a failed one, which would build on data not on the disk."""
        if self._failure is not None:
            raise self._failure
        try:
            yield
        except StoreError as failure:
            self._failure = failure
            raise

    def restore(self, branch: Branch) -> StoredBranch:
        """Stored part of one branch."""
        with self._reading(f"/{branch.group}") as file:
            return read_branch(file[branch.group], branch)

    def write(self, branch: Branch, start: int, block: FrequencyResponse, states: Sequence[State]) -> None:
        """Put ``block`` at the points from ``start`` on, and the ``states`` after its last ones.

        In two steps, the values and then the count of points that are there: a run that is killed between the two
        leaves points that nobody counts, and the next run writes them again.
        """
        with self._lock, self._unless_failed():
            self._note()
            group = self._file[branch.group]
            write_rows(group, start, rows_of(block, states))
            self._overwrite()
            count_points(group, start + len(block))
            self._overwrite()
            self.written += len(block)

    def _overwrite(self) -> None:
        self._file.flush()
        self._disk.overwrite(self._image.changes())

    def _note(self) -> None:
        """Note once what continues the file."""
        if not self._noted:
            note_continued(self._file["provenance"])
            self._noted = True

    def curves(self, fidelity: str, key: str) -> MotionCurves | None:
        """Motions of one fidelity stored for ``key``, of all that decides them; None without any."""
        place = f"{fidelity}/{CURVES}"
        with self._reading(f"/{place}") as file:
            if place not in file or file[place].attrs.get("key", b"") != key.encode():
                return None
            verify(file[place])
            return read_curves(file[place])

    def write_curves(self, fidelity: str, key: str, curves: MotionCurves) -> None:
        """Replace the stored motions of one fidelity."""
        place = f"{fidelity}/{CURVES}"
        with self._restructuring() as file:
            if place in file:
                del file[place]
            group = file.create_group(place)
            write_curves(group, curves, self._units)
            group.attrs["key"] = fixed(key)
            sign(group)

    def comparisons(self, key: str) -> tuple[HeldComparison, ...] | None:
        """Comparisons stored for ``key``, of all that decides them; None without any."""
        with self._reading(f"/{COMPARISON}") as file:
            return read_comparisons(file) if key and key_of_comparisons(file) == key else None

    def write_comparisons(self, key: str, found: Sequence[HeldComparison]) -> None:
        """Replace the stored comparisons."""
        with self._restructuring() as file:
            write_comparisons(file, key, found)

    def estimates(self, key: str) -> dict[str, FidelityEstimate] | None:
        """Error estimates stored for ``key``, of all that decides them; None without any."""
        with self._reading(f"/{ESTIMATES}") as file:
            return read_estimates(file) if key and key_of_estimates(file) == key else None

    def write_estimates(self, key: str, found: Mapping[str, FidelityEstimate]) -> None:
        """Replace the stored error estimates."""
        with self._restructuring() as file:
            write_estimates(file, key, found)

    def write_models(self, models: Keyed) -> None:
        """Replace the properties of all models, unless they are the same."""
        before, now = ({name: repr(each) for name, each in some.items()} for some in (self.models, models))
        if before != now:  # as text: NaN is not itself
            with self._restructuring() as file:
                write_models(file, models)

    def shown(self, plan: ShowPlan) -> tuple[Sheet, ...] | None:
        """Stored data of ``plan``, None where they must be computed."""
        with self._reading(f"/{HOME}/{plan.name}") as file:
            return read_sheets(file, plan)

    def show(self, plan: ShowPlan, sheets: tuple[Sheet, ...], units: OutputUnits) -> None:
        """Store ``sheets``; ``units``: of the output that they show."""
        with self._restructuring() as file:
            write_sheets(file, plan, sheets, units)
