"""Record of a case: the content of a case file, validated and in SI units; what its outputs are."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.case.plans import FigurePlan, RecordPlan, Reference, SweepPlan
from vibeam.case.study_plans import CostPlan, FitPlan, InfluencePlan
from vibeam.exchange.faults import CaseError, Complaint, Fault
from vibeam.system.labelled import Viewed
from vibeam.system.public_names import handed_in
from vibeam.system.quantities import PLAIN, OutputUnits
from vibeam_models.outputs import DISPLACEMENT, OutputQuantity

if TYPE_CHECKING:
    from vibeam.case.fidelity import Fidelity, Model
    from vibeam.case.grid_keys import MapPlan
    from vibeam.case.input_plan import InputPlan
    from vibeam.case.plans import Expectation, MeasuredNumber, ShowPlan, StartPlan
    from vibeam.case.study_plans import Uncertain
    from vibeam.exchange.curves.record import ReferenceCurve
    from vibeam.observe.measuring_chain import Chain
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.record import Record
    from vibeam.system.state import State
    from vibeam_models.scene import AnyScene


class Keys(Protocol):
    """Keys of a case, as its file declares them."""

    def model(self, fidelity: str) -> Model:
        """Model of one fidelity."""

    def case(self, settings: Mapping[str, Any]) -> Case:
        """The case with keys at other values, SI where they have no unit; CaseError for what it may not have."""

    def alone(self, fidelity: str) -> Case:
        """The case with one fidelity and nothing that is asked of it."""

    def value(self, key: str) -> Any:
        """Value of a key of the case itself, SI; None where it has none."""

    def unit(self, key: str) -> str:
        """SI unit of a key that holds a number, empty of a plain one; ValueError where it holds none."""

    def number(self, key: str, given: str | float) -> float:
        """Number of a key, given with its unit or in SI; ValueError where it is none, or the key holds none."""


OF_A_SWEEP = (
    "takes the place of [sweep], and what is asked for goes over drive frequencies: vibeam run, verdict, map and "
    "uncertainty take it"
)


@dataclass(frozen=True, eq=False)
class Case(Viewed):
    """Scene, fidelities, sweep, references and measured numbers of a case; equal where all that they say is.

    ``text`` is the case as TOML, SI units and overrides included: it loads as the same case. ``numbers`` is the part of
    it that decides what the sweeps compute (no title, source, checks, figures), ``key`` its SHA-256: two cases compute
    the same where it is equal. ``shared`` is the part of ``numbers`` common to all fidelities, ``own`` the key of all
    that decides the numbers of each at given frequencies. ``scenes`` has the scenes of the fidelities that change the
    case's, ``chains`` their measuring chains (None: exact). ``keys``: what any key is, and the case with other values
    of them. ``sweep`` or ``record``: how they run; ``inputs``, ``starts``: of each through a record.
    ``asked`` has the plans of ``STUDY_PLANS`` by name. ``locate`` finds the line of a complaint.

    >>> import vibeam
    >>> case = vibeam.Case.of({
    ...     "sdof": {"natural_frequency": "1 rad/s", "damping_ratio": 0.02}, "stop": {"gap": 0, "restitution": 0.7},
    ...     "drive": {"amplitude": 1e-3}, "sweep": {"frequency": ["2 rad/s"], "settle": 100, "hold": 20},
    ...     "fidelity": {"one": {}},
    ... })
    >>> case.system("one").omega.tolist()
    [1.0]
    """

    path: Path
    text: str
    numbers: str
    key: str
    shared: str
    own: Mapping[str, str]
    title: str
    source: str
    scene: AnyScene
    keys: Keys
    fidelities: dict[str, Fidelity]
    swept: SweepPlan | None
    references: dict[str, Reference]
    scenes: Mapping[str, AnyScene] = field(default_factory=dict)
    expectations: Mapping[str, Expectation] = field(default_factory=dict)
    measured: Mapping[str, MeasuredNumber] = field(default_factory=dict)
    shows: Mapping[str, ShowPlan] = field(default_factory=dict)
    cost: CostPlan = field(default_factory=CostPlan)
    influence: InfluencePlan = field(default_factory=InfluencePlan)
    asked: Mapping[str, Any] = field(default_factory=dict)
    figure: FigurePlan = field(default_factory=FigurePlan)
    chain: Chain | None = None
    chains: Mapping[str, Chain | None] = field(default_factory=dict)
    maps: Mapping[str, MapPlan] = field(default_factory=dict)
    uncertain: tuple[Uncertain, ...] = ()
    fit: FitPlan | None = None
    record: RecordPlan | None = None
    starts: Mapping[str, StartPlan] = field(default_factory=dict)
    inputs: Mapping[str, InputPlan] = field(default_factory=dict)
    locate: Callable[[Complaint], Fault] | None = None

    def __eq__(self, other: object) -> bool:
        return self._said == other._said if isinstance(other, Case) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.text, self.key))

    @property
    def _said(self) -> list[object]:
        """All but the file and where its keys stand, which has no part in equality."""
        return [value for name, value in vars(self).items() if name not in ("path", "keys", "locate")]

    @property
    def about(self) -> dict[str, str]:
        """Title, source and key, as attributes of data made of the case."""
        return {"title": self.title, "source": self.source, "case_key": self.key}

    @classmethod
    def of(cls, tables: Mapping[str, Any], set: Mapping[str, Any] | None = None) -> Case:
        """Case of tables as Python's own, as ``vibeam.load``; files that they name lie in the working directory."""
        made: Case = handed_in("load")(tables, set)
        return made

    def fault(self, *path: str | int, message: str) -> Fault:
        """Fault of a key, at its line of the file or in the override that set it where that is known."""
        if self.locate is None:
            return Fault(str(self.path), None, ".".join(map(str, path)), message)
        return self.locate((path, message))

    def __repr__(self) -> str:
        if self.swept is None:
            swept = f"a record of {self.record.duration:g} s" if self.record else "no run"
        else:
            grid = self.swept.frequency
            swept = f"{len(grid)} frequencies {grid.min():.6g} … {grid.max():.6g} Hz {self.swept.direction}"
        return f"Case({self.title!r}, {str(self.path)!r}, fidelities {', '.join(self.fidelities)}, {swept})"

    @property
    def sweep(self) -> SweepPlan:
        """Sweep; CaseError, at its line, of a case that has [record] in its place."""
        if self.swept is None:
            raise CaseError([self.fault("record", message=OF_A_SWEEP)])
        return self.swept

    def input(self, name: str, seed: int | None = None, level: float = 1.0, speed: float = 1.0) -> Record:
        """Input over time of one fidelity, ``level`` times as large and ``speed`` times as fast.

        ``seed``: of a random input, None: its first. CaseError of a faulty file, or of a case with [sweep]; else errors
        as in ``scene_of``.

        >>> import vibeam
        >>> tables = {
        ...     "sdof": {"natural_frequency": "1 rad/s", "damping_ratio": 0.02}, "stop": {"gap": 1, "restitution": 0.7},
        ...     "drive": {"shape": "half_sine", "acceleration": 2.0, "duration": "3 s"}, "record": {"duration": "30 s"},
        ...     "fidelity": {"one": {}},
        ... }
        >>> pulse = vibeam.Case.of(tables).input("one", level=2.0)
        >>> print(f"{pulse.at(1.5):.9f}")
        4.000000000
        """
        self.scene_of(name)
        if self.record is None:
            said = "is a sine at one frequency after the other, no input over time: write [record] in place of [sweep]"
            raise CaseError([self.fault("drive", message=said)])
        try:
            return self.inputs[name].record(self.record.duration, seed, level, speed)
        except CaseError:
            raise
        except ValueError as error:
            raise CaseError([self.fault("drive", message=str(error).removeprefix("record: "))]) from None

    def start(self, name: str) -> State:
        """State of one fidelity at the start of a record, as [start] says it; CaseError where it is impossible."""
        from vibeam.case.start import start_of

        try:
            return start_of(self.system(name), self.starts[name])
        except ValueError as error:
            said = f"of fidelity {name}, {str(error).removeprefix('start: ')}"
            raise CaseError([self.fault("start", message=said)]) from None

    def _amplitude(self, scene: AnyScene, omega: NDArray[np.float64] | None = None) -> Any:
        """Amplitude of a scene's drive, or of its base; CaseError of a record case, whose input has none."""
        from vibeam_models.base_motion import base_amplitude, drive_amplitude

        if self.record is not None:
            said = "has an input over time and no amplitude at a frequency: case.input(fidelity) is its record"
            raise CaseError([self.fault("record", message=said)])
        return base_amplitude(scene) if omega is None else drive_amplitude(scene, omega)

    @property
    def base_amplitude(self) -> float:
        """Amplitude of the base motion in m (of a SdofScene: in its own unit).

        ValueError where it depends on the frequency, as on a platform: ``amplitude`` has it there too.
        """
        return float(self._amplitude(self.scene))

    def amplitude(self, omega: NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Drive amplitude for a sweep over ``omega`` (rad/s): one for all, or one each where it depends on that."""
        found: float | NDArray[np.float64] = self._amplitude(self.scene, omega)
        return found

    def scene_of(self, name: str) -> AnyScene:
        """Scene of one fidelity, with its changes; KeyError names the known fidelities."""
        if name not in self.fidelities:
            raise KeyError(f"no fidelity {name!r}: there are {', '.join(self.fidelities)}")
        return self.scenes.get(name, self.scene)

    def chain_of(self, name: str) -> Chain | None:
        """Measuring chain of one fidelity's motion; None: none, the motion is exact."""
        return self.chains.get(name, self.chain)

    def amplitude_of(self, name: str, omega: NDArray[np.float64] | None = None) -> float | NDArray[np.float64]:
        """Drive amplitude of one fidelity; without ``omega`` its ``base_amplitude``. Errors as in ``scene_of``."""
        found: float | NDArray[np.float64] = self._amplitude(self.scene_of(name), omega)
        return found

    def with_reference(self, name: str, curve: ReferenceCurve, fidelity: str, tolerance: float | None = None) -> Case:
        """Same case with a reference ``curve`` of ``fidelity``; ``tolerance`` None: compared without a verdict.

        KeyError names the known fidelities.
        """
        self.scene_of(fidelity)
        given = Reference(name, Path(curve.source), fidelity, curve.quantity, tolerance, "both", curve=curve)
        return replace(self, references=self.references | {name: replace(given, measured=tolerance is None)})

    def system(self, name: str) -> ImpactSystem:
        """Impact system of one fidelity; KeyError names the known fidelities."""
        from vibeam.case.fidelity import system

        return system(self.scene_of(name), self.fidelities[name])

    def model(self, fidelity: str) -> Model:
        """Model of one fidelity as a function of keys: ``case.model("beam").at({"stop.gap": 1e-4}).system()``.

        KeyError names the known fidelities.
        """
        self.scene_of(fidelity)
        return self.keys.model(fidelity)

    def with_keys(self, settings: Mapping[str, Any]) -> Case:
        """Case with keys at other values, as ``set`` of ``vibeam.load``; its references stay. CaseError as there."""
        return replace(self.keys.case(settings), references=self.references, locate=self.locate)

    def alone(self, fidelity: str) -> Case:
        """Case with one fidelity, whose changes are its rig's own, and nothing that is asked of it or names others.

        KeyError names the known fidelities.
        """
        self.scene_of(fidelity)
        return replace(self.keys.alone(fidelity), locate=self.locate)


def plan_of_record(case: Case) -> RecordPlan:
    """Record of a case that has one; ValueError of a case with [sweep]."""
    if case.record is None:
        raise ValueError("the case has a [sweep], and this is of a [record]")
    return case.record


def quantity_of(case: Case, output: str) -> OutputQuantity:
    """Quantity that an output reads; a displacement where it is none of the case's own."""
    return next((each.kind for each in case.scene.outputs if each.name == output), DISPLACEMENT)


def units_of_output(case: Case, output: str) -> OutputUnits:
    """SI units of an output and of its rate; those of a model without dimensions where the case is one."""
    if case.scene.natural_unit is not None:
        return PLAIN
    found = quantity_of(case, output)
    return OutputUnits("m", found.unit, found.unit_of_rate)


def require_one_harmonic(case: Case, what: str, fidelities: Collection[str] = ()) -> None:
    """CaseError, at its line, where one of these fidelities (none: all) has several harmonics, unknown to ``what``."""
    several = [name for name in fidelities or case.fidelities if case.scene_of(name).harmonics]
    message = f"{what} knows a drive of one harmonic: take drive.harmonic away"
    if case.scene.harmonics and several:
        raise CaseError([case.fault("drive", "harmonic", message=message)])
    if several:
        raise CaseError([case.fault("fidelity", name, message=message) for name in several])
