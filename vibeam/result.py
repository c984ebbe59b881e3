"""What a run gives: the branches of every fidelity, and what the case asks for beside them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.response import Branches

if TYPE_CHECKING:
    from vibeam.accuracy.study import Study
    from vibeam.case import Case
    from vibeam.motions import MotionCurves
    from vibeam.show.plan import Sheet


class Result(Mapping[str, Branches]):
    """What a run gives: ``result[fidelity].up.amplitude``; ``found`` points of ``total`` were in the file already.

    ``shown``: the numbers of the case's [show.NAME] tables, by name. ``accuracy``: where the case asks for one, what
    was chosen and whether it holds; the one entry is then ``result["accuracy"]``.
    """

    def __init__(
        self,
        case: Case,
        branches: Mapping[str, Branches],
        path: Path | None = None,
        found: int = 0,
        shown: Mapping[str, tuple[Sheet, ...]] | None = None,
        accuracy: Study | None = None,
    ) -> None:
        self.case = case
        self.path = path
        self.found = found
        self.shown = dict(shown or {})
        self.accuracy = accuracy
        self._branches = dict(branches)

    @property
    def total(self) -> int:
        """Points of all branches."""
        return sum(len(response) for branches in self.values() for _, response in branches.items())

    @property
    def curves(self) -> dict[str, MotionCurves]:
        """All motions, unstable ones too, of each fidelity whose solver knows them."""
        return {name: branches.curves for name, branches in self._branches.items() if branches.curves is not None}

    def __getitem__(self, fidelity: str) -> Branches:
        return self._branches[fidelity]

    def __iter__(self) -> Iterator[str]:
        return iter(self._branches)

    def __len__(self) -> int:
        return len(self._branches)
