"""Result of a run: the branches of every fidelity, and the case's further figures and choices."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from vibeam.case.case import Case, units_of_output
from vibeam.case.fidelity import restitutions
from vibeam.case.fineness import alike, finest
from vibeam.case.held import held_of
from vibeam.exchange.faults import suggest
from vibeam.runs.comparison.differences import HeldComparison, both_peaks
from vibeam.runs.systems import ModelProperties, Overview, overview_of
from vibeam.system.labelled import DataNames, LabelledData, LabelledPart
from vibeam.system.response import Branches, modes_of

if TYPE_CHECKING:
    from vibeam.figures.sheet import Sheet
    from vibeam.runs.comparison.errors import Asked, ComparedFidelity
    from vibeam.system.curves import MotionCurves
    from vibeam.system.quantities import OutputUnits
    from vibeam.system.state import StatesAfter


Each = TypeVar("Each")


def finest_of(result: Result, beside: str | None = None) -> str:
    """Finest fidelity, the first of several, among those with the same rig as ``beside`` (None: of all).

    A member of a family of curves (other gaps, other R) is no reference for another one's accuracy.
    """
    names = list(result) if beside is None else alike(result.case, result, beside)
    return finest(result.case, {name: modes_of(result[name]) for name in names})


def output_units(case: Case) -> OutputUnits:
    """Units of the sweep's output of a case."""
    return units_of_output(case, case.sweep.output)


class FidelityResults(Mapping[str, Each], LabelledData):
    """Outcome of each fidelity of a ``case``, by its name; equal to another where the case is and all numbers are."""

    case: Case
    _fidelities: dict[str, Each]

    def __getitem__(self, fidelity: str) -> Each:
        if fidelity not in self._fidelities:
            raise KeyError(f"no fidelity {fidelity!r}: {suggest(str(fidelity), self._fidelities)}")
        return self._fidelities[fidelity]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fidelities)

    def __len__(self) -> int:
        return len(self._fidelities)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        return (self.case, self._fidelities) == (other.case, other._fidelities)

    def __hash__(self) -> int:
        return hash(self.case)


class Result(FidelityResults[Branches]):
    """Result of a run: ``result[fidelity].up.amplitude``; ``found`` points of ``total`` were in the file already.

    ``shown``: the numbers of the case's [show.NAME] tables, by name. ``comparisons``: peaks under both choices of the
    restitution held, one for each finest fidelity, where the run was asked for them; ``compared``: then also each
    fidelity with the finest, and that with a fuller model (``compare``). ``models``: properties of the fidelities'
    models, where they are known already; ``after``: states after the points. Equal to another where the case is and all
    numbers are, CPU times aside.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3})
    >>> result = vibeam.run(case)
    >>> list(result), result["beam"].up.period.tolist()
    (['sdof', 'two_modes', 'beam'], [1, 1, 1])
    >>> result == vibeam.run(case)  # CPU times aside
    True
    """

    def __init__(
        self,
        case: Case,
        branches: Mapping[str, Branches],
        path: Path | None = None,
        found: int = 0,
        shown: Mapping[str, tuple[Sheet, ...]] | None = None,
        comparisons: Sequence[HeldComparison] = (),
        models: Mapping[str, ModelProperties] | None = None,
        compared: Sequence[ComparedFidelity] = (),
        after: Mapping[str, Mapping[str, StatesAfter]] | None = None,
    ) -> None:
        self.case = case
        self.path = path
        self.found = found
        self.shown = dict(shown or {})
        self.comparisons = tuple(comparisons)
        self.compared = tuple(compared)
        self._after = dict(after or {})
        self._fidelities = dict(branches)
        self._models = dict(models or {})

    @property
    def overview(self) -> Overview | None:
        """Sizes, masses, modes and gap of the rig beside the sweep; None where its models are not known."""
        return overview_of(self.case, self._models) if self._models else None

    @property
    def total(self) -> int:
        """Number of points of all branches."""
        return sum(len(response) for branches in self.values() for _, response in branches.items())

    @property
    def finest(self) -> dict[str, str]:
        """Reference fidelity of each fidelity: see ``finest_of``."""
        return {name: finest_of(self, name) for name in self}

    @property
    def asked(self) -> Asked:
        """Errors that its case allows a model that suffices."""
        from vibeam.runs.comparison.errors import asked_of

        return asked_of(self.case)

    def compare(self) -> tuple[ComparedFidelity, ...]:
        """Comparison of each fidelity with the finest of its rig, and of that with a fuller model of it.

        By the errors of ``runs.comparison.responses``. Takes seconds when first asked for: the fuller model is swept.

        >>> import vibeam
        >>> result = vibeam.run(vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 9}))
        >>> [sdof, two, beam] = result.compare()
        >>> two.reference, two.suffices(result.asked), sdof.suffices(result.asked)  # for 5 %, its jumps for 1 %
        ('beam', True, False)
        """
        if not self.compared:
            from vibeam.runs.comparison.of_run import compared_fidelities

            self.compared = compared_fidelities(self.case, self, self.finest, self._after)
        return self.compared

    @property
    def held(self) -> str:
        """Coefficient held in its comparisons and, where known, the peaks with the other choice; empty without any."""
        compared = [name for name, finest in self.finest.items() if name != finest]
        labels = dict.fromkeys(held_of(self.case.scene_of(name)).label for name in compared)
        return "\n".join(filter(None, [", ".join(labels), *map(both_peaks, self.comparisons)]))

    def restitutions(self, fidelity: str) -> tuple[float, float]:
        """Restitution R of the contact and R₁ of mode 1 in one fidelity."""
        known = self._models.get(fidelity)
        if known is None:
            return restitutions(self.case.scene_of(fidelity), self.case.fidelities[fidelity])
        return known.restitution, known.first_mode_restitution

    @property
    def curves(self) -> dict[str, MotionCurves]:
        """All motions, unstable ones included, of each fidelity whose solver knows them."""
        return {name: branches.curves for name, branches in self.items() if branches.curves is not None}

    def __repr__(self) -> str:
        where = "" if self.path is None else f" in {self.path}"
        lines = [f"Result of {self.case.title!r}{where}", *(f"  {name}: {self[name]!r}" for name in self)]
        return "\n".join(lines)

    def _parts(self) -> Sequence[LabelledPart]:
        return [
            LabelledPart({"fidelity": name, "direction": direction}, {"frequency": one.frequency}, one.quantities)
            for name, branches in self.items()
            for direction, one in branches.items()
        ]

    @property
    def _names(self) -> DataNames:
        return DataNames(output_units(self.case), about=self.case.about)
