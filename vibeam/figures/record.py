"""Record cases for figures: what they ask of a result, units and labels of its signals, the motion that is drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from vibeam.case.case import Case, plan_of_record
from vibeam.system.number_text import ACCELERATIONS, LENGTHS, OF_QUANTITY, SPEEDS, STRAINS, Steps, prefixed

if TYPE_CHECKING:
    from vibeam.case.plans import ShowPlan
    from vibeam.flight.trajectory import Trajectory
    from vibeam.observe.decimation import History

FORCES: Steps = ((1e4, "kN", 1e-3), (1e-1, "N", 1.0), (0.0, "mN", 1e3))
ENERGIES: Steps = ((1e-1, "J", 1.0), (1e-4, "mJ", 1e3), (1e-7, "µJ", 1e6), (0.0, "nJ", 1e9))
ANGLES, TURNING = OF_QUANTITY["slope"]
OF_SI: Mapping[str, Steps] = {
    "m": LENGTHS, "m s-1": SPEEDS, "m s-2": ACCELERATIONS, "N": FORCES, "rad": ANGLES, "rad s-1": TURNING,
    "1": STRAINS, "J": ENERGIES,
}  # fmt: skip
COLUMNS = 400  # of a panel over time
INPUTS = {"force": ("force", "N"), "moment": ("moment", "N m")}


class RecordResult(Protocol):
    """Transients of every fidelity by name, as a mapping, with what the figures of a record case need beside them."""

    @property
    def case(self) -> Case:
        """Case of the run."""

    @property
    def factors(self) -> tuple[float, ...]:
        """Values of the factor that the case varies."""

    @property
    def over(self) -> str:
        """Name of what the values are of."""

    @property
    def input(self) -> Mapping[str, History]:
        """Load of the motion whose histories are kept: of each fidelity, or one (empty name) of all."""

    def __getitem__(self, fidelity: str, /) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...


def unit_of_signal(case: Case, unit: str, largest: float) -> tuple[str, float]:
    """Unit in which values of an SI ``unit`` are shown, the largest of them known, and the factor to it."""
    if case.scene.natural_unit is not None:
        return "", 1.0
    steps = OF_SI.get(unit, ((0.0, unit, 1.0),))
    return prefixed(steps, largest, min(1, len(steps) - 1))


def input_of(case: Case) -> tuple[str, str]:
    """Label of the input of a case, and its SI unit; one that is measured as a motion acts by its acceleration."""
    plan = next(iter(case.inputs.values()), None)
    return INPUTS.get((plan and plan.quantity) or "", ("base acceleration", "m s-2"))


def kept_place(result: RecordResult) -> int:
    """Index of the value whose motion, of the first seed, has its histories kept: of a level the nearest to 1."""
    return int(np.argmin(np.abs(np.asarray(result.factors) - 1.0))) if result.over in ("level", "speed") else 0


def drawn_motion(result: RecordResult) -> str:
    """Sentence on the motion that is drawn of several; empty of one alone."""
    seeds, parts = plan_of_record(result.case).seeds, []
    if len(result.factors) > 1:
        parts.append(f"{result.over} {result.factors[kept_place(result)]:g}")
    if len(seeds) > 1:
        parts.append(f"seed {seeds[0]}")
    return f"drawn: the motions at {', '.join(parts)}" if parts else ""


def signals_of_all(result: RecordResult, names: Sequence[str]) -> dict[str, Any]:
    """Signals by name that any of the fidelities has histories of, in their order."""
    return {each.name: each for name in names for each in result[name].signals if each.name in result[name].history}


def label_of(signal: Any) -> str:
    """Label of a signal: ``sensor``, ``velocity of sensor``, ``largest contact force``."""
    return str(signal.long_name)


def record_motion(case: Case, name: str, plan: ShowPlan, seed: int | None = None) -> Trajectory:
    """Motion of a fidelity under the input as the case writes it, by flight; NoMotion where there is no output or end.

    ``seed``: of the realisation, the case's first where None.
    """
    from vibeam.figures.sheet import NoMotion
    from vibeam.flight.trajectory import simulate
    from vibeam.system.response import Ended

    system, record = case.system(name), plan_of_record(case)
    if plan.output not in ("contact", *system.outputs, *system.derivatives):
        raise NoMotion(f"there is no {plan.output} in this model")
    load = case.input(name, *(record.seeds[:1] if seed is None else (seed,)))
    path = simulate(system, load, record.duration, case.start(name))
    if path.ended is not Ended.COMPLETE:
        raise NoMotion(path.ended.value)
    return path
