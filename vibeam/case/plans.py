"""Plans of a case: sweep, references, expected and measured numbers, figures; each declares the keys of its table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from vibeam.case.study_plans import MOST_POINTS
from vibeam.exchange.curves.record import Point, ReferenceCurve, ReferenceForm
from vibeam_models import keys as declare
from vibeam_models.arrays import ValueRecord

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.state import State

Direction = Literal["up", "down", "both"]
DIRECTIONS = ("up", "down", "both")
FORMATS = ("png", "svg", "pdf")  # of figures


@dataclass(frozen=True, kw_only=True)
class ResultNumber:
    """Number of a result: ``quantity`` of ``fidelity`` at ``frequency`` (Hz; None: of the whole branch).

    With ``against``, its relative difference to that fidelity. With ``show`` the quantity is read off that figure: its
    mean, or the entry of mode or order ``number``. ``output``, ``at`` (SI), ``seed``: of a record.
    """

    name: str
    fidelity: str = declare.text("the fidelity whose number it is", "sdof")
    quantity: str = declare.text(
        "what is compared; of those after largest_gap: that of a figure, with show", "amplitude"
    )
    frequency: float | None = declare.quantity(
        "Hz",
        "where, one of the sweep's (of a limit or a figure anywhere); none for the peak, the range of period 1, modes",
        "15.3 Hz",
        None,
        above=0,
    )
    show: str | None = declare.text(
        "the [show.NAME] that is read, its mean unless number chooses one; of modes none is needed", "ringing", None
    )
    number: float | None = declare.quantity(
        "", "number of the mode, or order of the harmonic, that is read", 2, None, least=0
    )
    against: str | None = declare.text(
        "another fidelity: the value is then the relative difference to it", "beam", None
    )
    direction: Literal["up", "down", "both"] = declare.word(
        DIRECTIONS, "the branches compared; absent = all that are swept", "up", None
    )
    output: str | None = declare.text(
        "of a record the signal that is read: an output, or NAME_velocity, NAME_acceleration, contact_force; absent = "
        "the first of record.outputs", "sensor_acceleration", None,
    )  # fmt: skip
    at: float | None = declare.text(
        "of a record the value of what it varies, one of record.values; absent = the first", "0.1 mm", None
    )
    seed: int | None = declare.count(0, 2**31 - 1, "of a record the realisation; absent = the mean of all", 1, None)


@dataclass(frozen=True, kw_only=True)
class Expectation(ResultNumber):
    """Number that must be ``value``.

    ``tolerance`` is relative to the value; of the number itself with ``against`` or where the value is 0. ``source``:
    who derived the value; empty: an earlier result of the model itself.
    """

    value: float = declare.quantity("", "the number expected, with its unit", "34 %")
    tolerance: float = declare.quantity(
        "",
        "largest difference: relative to the value, or, with against or where the value is 0, of the number itself",
        "1 %",
        above=0,
    )
    source: str = declare.text(
        "who derived the value; absent = it is an earlier result of the model, a regression value",
        "closed form, Babitsky 1998",
        "",
    )


@dataclass(frozen=True, kw_only=True)
class MeasuredNumber(ResultNumber):
    """Number that was measured as ``value``, in ``unit`` (m, m/s, Hz, 1/s, 1), from ``source``.

    ``uncertainty`` is of the measurement, in the same unit; None: not given. ``chose``: keys of the fidelity's model
    whose values this number chose: the model is calibrated by it, else predicts it.
    """

    value: float = declare.quantity("", "the number measured, with its unit", "0.39 mm")
    uncertainty: float | None = declare.quantity(
        "", "standard one of the measurement, in its unit or as a percentage; absent = not given", "5 %", None, above=0
    )
    source: str = declare.text("figure, table or section that gives it", "Fig. 31(b)")
    unit: str
    chose: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SweepPlan(ValueRecord):
    """Sweep: ``frequency`` in Hz, ascending, shape (points,); ``settle`` and ``hold`` in drive periods.

    ``output`` is the observed displacement: ``"sensor"``, ``"contact"``, ``"tip"`` or ``"platform"``.
    """

    frequency: NDArray[np.float64]
    direction: Literal["up", "down", "both"] = declare.word(
        DIRECTIONS, "which way the frequencies are run", "both", "both"
    )
    settle: int = declare.count(0, MOST_POINTS, "drive periods left out before the reading", 300)
    hold: int = declare.count(1, MOST_POINTS, "drive periods read", 50)
    output: str = declare.text("the output that is read", "sensor", "sensor")


@dataclass(frozen=True, kw_only=True)
class RecordPlan:
    """Run of every fidelity through one input over time, ``duration`` s from t = 0 on.

    ``seeds``: of the realisations of a random input; empty where it is not random. ``over``: ``"level"``, ``"speed"``
    or a key of the rig, which goes through ``values`` (SI).
    """

    duration: float = declare.quantity(
        "s", "how long the motion is followed; absent = as long as the file of drive.file", "0.5 s", None, above=0
    )
    outputs: tuple[str, ...] = declare.text(
        "the outputs whose displacement, velocity and acceleration are kept", ["sensor", "contact"], ("sensor",),
        several=True, alone=True,
    )  # fmt: skip
    rate: float | None = declare.quantity(
        "Hz", "samples a second of the histories kept; absent = least and greatest of many short spans, no peak lost",
        "10 kHz", None, above=0,
    )  # fmt: skip
    realisations: int = declare.count(
        1, MOST_POINTS, "of a random input: seeds drive.seed, drive.seed + 1, …, the same for all fidelities", 50, 1
    )
    over: str = declare.text(
        "what is varied: level (size of the input), speed (how fast it goes by), or a key of the rig",
        "stop.gap",
        "level",
    )
    values: tuple[float, ...] = declare.text("its values, each run", ["0.1 mm", "0.2 mm"], (1.0,), several=True)
    certify: bool = declare.flag("prove that no impact was missed, or say where that is not proved", True, False)
    seeds: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class StartPlan:
    """State at t = 0: ``displacement`` or ``force`` in the static shape of a force at ``output``, and velocities.

    All None: settled, in static equilibrium. ``base_velocity``: of the rig as a whole, whose base then stops at once.
    ``settled`` gives the static equilibrium of a system.
    """

    displacement: float | None = declare.quantity(
        "m", "plucked: what the output reads, in the static shape of a force there", "2 mm", None,
        plain=("of the one mode, positive toward the stop", 1e-3, ""),
    )  # fmt: skip
    force: float | None = declare.quantity(
        "N", "plucked: the force at the output that holds it, positive toward the stop, in place of displacement",
        "5 N", None, plain=("over the mass, that holds it, in place of displacement", 1e-3, ""),
    )  # fmt: skip
    velocity: float | None = declare.quantity(
        "m/s", "moving: of the output, all else in proportion to that static shape", "1 m/s", None,
        plain=("of the one mode, positive toward the stop", 1e-3, ""),
    )  # fmt: skip
    output: str = declare.text("where displacement, force and velocity are: an output by name", "sensor", "contact")
    height: float | None = declare.quantity(
        "m", "dropped: free fall of the whole rig, stop below, before its base stops at once", "0.5 m", None, above=0
    )
    base_velocity: float | None = declare.quantity(
        "m/s", "dropped: velocity of the whole rig when its base stops at once, positive toward the stop", "3 m/s",
        None, plain=("of base and mass, when the base stops at once", 1e-3, ""),
    )  # fmt: skip
    settled: Callable[[ImpactSystem], State] | None = field(default=None, compare=False, repr=False)


def moving(start: Any) -> tuple[str, ...]:
    """Keys of a start, a plan or its table, by which it is any other than the static equilibrium."""
    keys = declare.keys_of(StartPlan)
    return tuple(name for name in keys if name != "output" and getattr(start, name, None) is not None)


@dataclass(frozen=True)
class Reference:
    """Reference curve: ``quantity`` of ``fidelity``, within a relative ``tolerance``; ``file`` is absolute.

    ``tolerance`` None: compared without a verdict, as ``measured`` curves may be. ``form``: columns, units,
    scale of the file; ``curve``: the curve itself, in place of the file.

    ``quote``: messages may quote the file's content; False where it lies outside the case's folder.
    """

    name: str
    file: Path = declare.text(
        "from the case file's folder: CSV or other text, MATLAB, HDF5, TDMS, universal file (.uff, .unv)",
        "references/dtu_neutral_sdof.csv",
    )
    fidelity: str = declare.text("the fidelity that must meet it", "sdof")
    quantity: str = declare.text("the column compared", "amplitude")
    tolerance: float | None = declare.quantity(
        "", "largest relative difference; may be absent where measured = true: then without a verdict", "0.0001 %",
        None, above=0,
    )  # fmt: skip
    direction: Direction = declare.word(DIRECTIONS, "the branches compared; absent = all that are swept", "both", None)
    quote: bool = True
    form: ReferenceForm = field(default_factory=ReferenceForm)
    measured: bool = declare.flag("whether the curve was measured", True, False)
    source: str = declare.text("where the curve comes from", "Fig. 31(b)", "")
    curve: ReferenceCurve | None = None

    def read(self) -> ReferenceCurve:
        """Curve of all points, given or in the file; CaseError where that cannot be read."""
        from vibeam.exchange.curves.reference import read_curve

        if self.curve is not None:
            return self.curve
        curve = read_curve(self.file, self.quantity, self.form, quote=self.quote)
        if self.direction == "both":
            return curve
        known = tuple(replace(each, direction=each.direction or self.direction) for each in curve.points)
        return replace(curve, points=known)

    def points(self) -> list[Point]:
        """Points on the branches compared; CaseError as ``read``."""
        return self.read().along(("up", "down") if self.direction == "both" else (self.direction,))


@dataclass(frozen=True)
class FigurePlan:
    """Plan of the figure files: endings, ``width`` in m (None: by the number of panels), whether with a title."""

    format: tuple[str, ...] = declare.word(
        FORMATS, "file format, or several", ["png", "svg"], ("png", "svg"), several=True, alone=True
    )
    width: float | None = declare.quantity(
        "m", "of each figure; absent = by its number of panels", "140 mm", None, least=0.04, most=1.0
    )
    title: bool = declare.flag("whether it has a title", False, True)


@dataclass(frozen=True, kw_only=True)
class ShowPlan:
    """Plan of one [show.NAME] table: frequencies in Hz (none: the sweep's), ``periods`` after ``settle`` drive periods.

    ``fidelities``: their names, in order; ``quantity``: of the kinds ``curve`` and ``boundaries``; ``output``: whose
    motion; ``near`` (Hz): of ``ringing``. ``own``: values of the keys that kinds of figure declare. ``key``: of all
    that decides the numbers.
    """

    name: str
    kind: str
    key: str
    fidelities: tuple[str, ...] = declare.text("whose; absent = all", ["sdof"], None)
    frequency: tuple[float, ...] = declare.quantity(
        "Hz", "drive frequency, or several, a panel each", "15.3 Hz", None, above=0, several=True
    )
    periods: int | None = declare.count(
        1, MOST_POINTS, "drive periods shown, of decay natural ones; absent = as many as the kind needs", 4, None
    )
    settle: int = declare.count(0, MOST_POINTS, "drive periods left out before; absent = the sweep's", 500, None)
    quantity: str | None = declare.text(
        "of a curve one of the response's, of boundaries one of the last two", "reach", None
    )
    output: str = declare.text("the output that is shown; absent = the sweep's output", "contact", None)
    near: float | None = declare.quantity(
        "Hz", "of ringing: where it is looked for; modes below two thirds of it are taken off", "101 Hz", None, above=0
    )
    own: Mapping[str, Any] = field(default_factory=dict, hash=False)
