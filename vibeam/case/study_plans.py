"""Plans of studies, each of which declares the keys of its table; registry of those whose table has their name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vibeam_models import keys as declare
from vibeam_models.registry import Home, Registry

EXTENTS = ("peak", "peak_frequency", "period_one_from", "period_one_to")  # of a whole branch
ERRORS = ("amplitude_error", "frequency_error", "kind_width")  # of a fidelity against the finest of its rig
OF_INFLUENCE = (*EXTENTS, "ringing", "ringing_frequency", "apparent_restitution")
MOST_ELEMENTS = 2000
MOST_POINTS = 1_000_000


@dataclass(frozen=True)
class CostPlan:
    """Plan of ``vibeam verdict --only solvers``: frequencies in Hz, ``budget`` in CPU seconds; None: the defaults."""

    frequency: tuple[float, ...] | None = declare.quantity(
        "Hz",
        "drive frequencies; absent = nine of the sweep's",
        ["14 Hz", "15 Hz", "16 Hz"],
        None,
        above=0,
        several=True,
        ascending=True,
    )
    settle: int | None = declare.count(
        0, MOST_POINTS, "drive periods left out; absent = the sweep's, 100 at most", 100, None
    )
    hold: int | None = declare.count(1, MOST_POINTS, "drive periods read; absent = the sweep's, 10 at most", 10, None)
    solvers: tuple[str, ...] | None = declare.text("those compared; absent = all", ["flight", "orbit", "direct"], None)
    budget: float = declare.quantity("s", "CPU time of all of it, where --budget says none", "3 s", 3.0, above=0)


@dataclass(frozen=True)
class ModesNeededPlan:
    """Plan of ``vibeam verdict --only modes``: errors allowed against all modes, largest number of modes tried."""

    accuracy: float = declare.quantity(
        "", "share by which the amplitude may be off that of all modes", "5 %", 0.05, above=0, most=1
    )
    frequency_accuracy: float | None = declare.quantity(
        "", "of frequencies at which branches end; absent = a fifth of accuracy", "1 %", None, above=0, most=1
    )
    most: int = declare.count(1, 2 * MOST_ELEMENTS, "largest number of modes tried", 128, 128)


@dataclass(frozen=True)
class InfluencePlan:
    """Plan of ``vibeam verdict --only effects``: frequencies in Hz; None: the defaults."""

    fidelity: str | None = declare.text("whose effects are taken away; absent = the one with most modes", "beam", None)
    quantities: tuple[str, ...] | None = declare.word(
        OF_INFLUENCE,
        "what must stay as it is beside the response; absent = nothing",
        ["peak", "ringing"],
        None,
        several=True,
    )
    frequency: float | None = declare.quantity(
        "Hz",
        "where ringing and apparent restitution are read; absent = at the peak, each model's own",
        "15.3 Hz",
        None,
        above=0,
    )
    tolerance: float = declare.quantity(
        "", "amplitude error that is allowed, under a record error of the peaks", "5 %", 0.01, above=0
    )
    frequency_accuracy: float | None = declare.quantity(
        "", "frequency error of ends of branches that is allowed; absent = a fifth of tolerance", "1 %", None, above=0
    )
    points: int = declare.count(
        3,
        MOST_POINTS,
        "drive frequencies, of the sweep's, at most; ends of branches are bracketed between them",
        31,
        31,
    )
    settle: int | None = declare.count(0, MOST_POINTS, "drive periods left out; absent = the sweep's", 300, None)
    hold: int | None = declare.count(1, MOST_POINTS, "drive periods read; absent = the sweep's", 50, None)


@dataclass(frozen=True)
class Uncertain:
    """Uncertain input at a dotted ``key``, in SI.

    ``"normal"`` of mean ``first`` and standard deviation ``second``, or ``"uniform"`` between the two.
    """

    key: str
    kind: Literal["normal", "uniform"]
    first: float
    second: float

    @property
    def middle(self) -> float:
        """Mean."""
        return self.first if self.kind == "normal" else (self.first + self.second) / 2

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return self.second if self.kind == "normal" else float((self.second - self.first) / 12**0.5)


@dataclass(frozen=True)
class FitKey:
    """Estimated ``key`` of a case, between ``low`` and ``high``, SI; ``start``: the case's own value, within these.

    ``unit``: of SI, empty of a plain number.
    """

    key: str
    low: float
    high: float
    start: float
    unit: str


@dataclass(frozen=True)
class FitPlan:
    """Plan of ``vibeam fit``: estimated keys, the references by name, those with points on unstable branches."""

    keys: tuple[FitKey, ...] = declare.text(
        "what is estimated: dotted keys of the case with [lowest, highest]",
        {"drive.gain": ["3e-4", "9e-4"], "stop.restitution": [0.5, 0.95]},
    )
    references: tuple[str, ...] = declare.text(
        "the [reference.NAME] that it is estimated from; absent = all", ["laser"], None, several=True
    )
    unstable: tuple[str, ...] = declare.text(
        "those of them measured by control-based continuation: their points may lie on unstable branches",
        ["controlled"],
        None,
        several=True,
    )


@dataclass(frozen=True)
class StageDeclaration:
    """Stage of a verdict that an extension brings: its ``question``, and the stem ``file`` of its files.

    ``run`` (case, plan, progress) gives its record, ``sheet`` (record) the sheet: ``"module:function"``, imported when
    it is asked for. ``spatial``: it joins the usual stages where a fidelity is a body of three-dimensional elasticity.
    """

    name: str
    question: str
    file: str
    run: str
    sheet: str
    spatial: bool = False


FURTHER_STAGES: Registry[StageDeclaration] = Registry("stage of a verdict")
USUAL_STAGES = ("modes", "effects", "solvers", "map")
STAGES = (*USUAL_STAGES, *FURTHER_STAGES)
STAGE_BUDGET = 20.0  # s of CPU time that a stage may take where nothing is said


@dataclass(frozen=True)
class VerdictPlan:
    """Plan of ``vibeam verdict``: the errors allowed, stages, plane, ``budget`` in CPU seconds.

    ``budget`` None: ``allowed``, and of the solvers what ``CostPlan`` says.
    """

    accuracy: float = declare.quantity(
        "", "largest error of the amplitude that is allowed", "5 %", 0.05, above=0, most=1
    )
    frequency_accuracy: float | None = declare.quantity(
        "", "largest error allowed of where branches end, by jumps or otherwise; absent = a fifth of accuracy", "1 %",
        None,
        above=0, most=1,
    )  # fmt: skip
    only: tuple[str, ...] = declare.word(
        STAGES,
        "stages: modes, effects, solvers, map or solid; repeatable, absent = all, solid where a fidelity is one",
        ["modes"],
        USUAL_STAGES,
        several=True,
        alone=True,
    )
    over: str = declare.text("second key of the plane beside the frequency", "gap", "gap")
    points: int = declare.count(2, MOST_POINTS, "values of each key of the plane", 11, 11)
    budget: float | None = declare.quantity(
        "s", "CPU time of each stage: modes, effects, solvers, plane, steps to a solid; absent = 20 s, of solvers 3 s",
        "20 s", None, above=0,
    )  # fmt: skip

    @property
    def allowed(self) -> float:
        """CPU time of a stage, s."""
        return STAGE_BUDGET if self.budget is None else self.budget


@dataclass(frozen=True)
class UncertaintyPlan:
    """Plan of ``vibeam uncertainty``: ``samples``, a power of two, and ``seed``."""

    samples: int = declare.count(16, MOST_POINTS, "runs an input, a power of two", 128, 128)
    seed: int = declare.count(0, 2**31 - 1, "of the samples", 0, 0)


@dataclass(frozen=True)
class DerivePlan:
    """Plan of ``vibeam derive``: the ``speed`` m/s of an impact on the stop; None: no choice."""

    speed: float | None = declare.quantity(
        "m/s", "of the impact; absent = the law's, else 0.1 m/s", "0.1 m/s", None, above=0
    )


#: plans of studies whose table bears their name, in the order of the case file
STUDY_PLANS: Registry[Home] = Registry(
    "plan of a study",
    Home("derive", DerivePlan),
    Home("modes_needed", ModesNeededPlan),
    Home("uncertainty", UncertaintyPlan),
    Home("verdict", VerdictPlan),
)
