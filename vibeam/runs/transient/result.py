"""Result of a case under a record: the transients of every fidelity, their comparison with the finest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.case.fineness import alike, finest
from vibeam.case.held import held_of
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.runs.result import FidelityResults
from vibeam.runs.transient.comparison import TransientComparison, compared
from vibeam.runs.transient.reading import Reading
from vibeam.runs.transient.transient import Transient
from vibeam.system.labelled import DataNames, LabelledPart

if TYPE_CHECKING:
    from xarray import Dataset

    from vibeam.case.case import Case
    from vibeam.figures.sheet import Sheet
    from vibeam.observe.decimation import History


class TransientResult(FidelityResults[Transient]):
    """Result of a run under a record: ``result[fidelity].peak``; ``found`` motions of ``total`` were in the file.

    ``factors`` (v,): values of what the case varies (``over``), ``seeds`` (s,) of its realisations; arrays of a
    ``Transient`` begin with these two dimensions. ``periods``: first natural period of each
    fidelity at the first value, s. ``input``:
    history of the load of the motion whose histories are kept. ``twins``: by fidelity and value, the motion of the
    first seed under a load larger by 1e-6. ``shown``: the numbers of the case's [show.NAME] tables, by name. Equal to
    another where the case is and all numbers are, CPU times aside.
    """

    def __init__(
        self,
        case: Case,
        fidelities: Mapping[str, Transient],
        path: Path | None = None,
        found: int = 0,
        periods: Mapping[str, float] | None = None,
        twins: Mapping[str, Mapping[int, Reading]] | None = None,
        input: Mapping[str, History] | None = None,
        shown: Mapping[str, tuple[Sheet, ...]] | None = None,
    ) -> None:
        self.case, self.path, self.found = case, path, found
        self.input, self.shown = dict(input or {}), dict(shown or {})
        self.periods, self.twins = dict(periods or {}), dict(twins or {})
        self._fidelities = dict(fidelities)

    @property
    def over(self) -> str:
        """Name of what the values are of: "level", "speed" or a key."""
        return plan_of_record(self.case).over

    @property
    def factors(self) -> tuple[float, ...]:
        """Values of the factor that the case varies."""
        return plan_of_record(self.case).values

    @property
    def seeds(self) -> tuple[int, ...]:
        """Seeds of the realisations, empty of a load that is not random."""
        return plan_of_record(self.case).seeds

    @property
    def total(self) -> int:
        """Number of motions of all fidelities."""
        return sum(each.ended.size for each in self.values())

    @property
    def missing(self) -> int:
        """Number of motions that were not run yet."""
        return sum(int(np.count_nonzero(~each.run)) for each in self.values())

    @property
    def finest(self) -> dict[str, str]:
        """Reference of each fidelity: the finest, the first of several, among those of the same rig."""
        return {
            name: finest(self.case, {each: self[each].modes for each in alike(self.case, self, name)}) for name in self
        }

    @cached_property
    def comparison(self) -> dict[str, TransientComparison]:
        """Comparison of each fidelity with its finest; the finest have none."""
        finest = self.finest
        return {
            name: compared(self[name], self[top], self.periods.get(top, float("nan")), self.twins.get(top, {}))
            for name, top in finest.items()
            if name != top
        }

    @property
    def held(self) -> str:
        """Coefficient of restitution held in its comparisons; empty without any."""
        return ", ".join(dict.fromkeys(held_of(self.case.scene_of(name)).label for name in self.comparison))

    def __repr__(self) -> str:
        where = "" if self.path is None else f" in {self.path}"
        return "\n".join([f"TransientResult of {self.case.title!r}{where}", *(f"  {each!r}" for each in self.values())])

    def _parts(self) -> Sequence[LabelledPart]:
        axes = {self.over: np.array(self.factors), "seed": np.array(self.seeds or (0,))}
        return [LabelledPart({"fidelity": name}, axes, _columns(each)) for name, each in self.items()]

    def to_xarray(self) -> Dataset:
        """Data set over fidelity, value and seed: the numbers of all motions, each with its unit; needs xarray."""
        made, (_, units) = super().to_xarray(), self.columns()
        for name, unit in units.items():
            made[name].attrs["units"] = unit
        return made

    def columns(self) -> tuple[list[dict[str, Any]], dict[str, str]]:
        """Columns of ``to_dataframe`` of each fidelity, and the units of those that have one."""
        parts, _ = super().columns()
        units = {name: each for own in self.values() for name, each in _units(own).items()}
        return parts, {name: unit for name, unit in units.items() if unit != "1"}

    @property
    def _names(self) -> DataNames:
        return DataNames(axes={}, about=self.case.about)


READ = ("peak", "peak_time", "least", "greatest", "mean", "rms")
WHOLE = tuple(name for name, each in QUANTITIES.items() if each.of in ("impacts", "energy"))


def _columns(of: Transient) -> dict[str, Any]:
    """Numbers (v, s) of every motion by name."""
    found = {f"{each.name}_{name}": of.of(name, each.name) for each in of.signals for name in READ}
    found |= {name: of.of(name) for name in WHOLE}
    return found | {"residual": of.residual, "ended": of.ended, "cpu_seconds": of.cpu_seconds}


def _units(of: Transient) -> dict[str, str]:
    """SI units of these columns."""
    plain = of.signals[0].unit == "1"
    named = {"c/s": "s-1" if plain else "m s-1", "E": "s-2" if plain else "J"}
    found = {f"{each.name}_{name}": "s" if name == "peak_time" else each.unit for each in of.signals for name in READ}
    return (
        found | {name: named.get(QUANTITIES[name].unit, QUANTITIES[name].unit) for name in WHOLE} | {"cpu_seconds": "s"}
    )
