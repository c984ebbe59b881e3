"""Plans of a case: sweep, references, measured numbers, studies."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.curves.record import ReferenceForm

if TYPE_CHECKING:
    from vibeam.exchange.curves.record import Point, ReferenceCurve

Direction = Literal["up", "down", "both"]


@dataclass(frozen=True, kw_only=True)
class Reading:
    """Number of a result: ``quantity`` of ``fidelity`` at ``frequency`` (Hz; None: of the whole branch).

    With ``against``, its relative difference to that fidelity. With ``show`` the quantity is read off that figure: its
    mean, or the entry of mode or order ``number``.
    """

    name: str
    fidelity: str
    quantity: str
    frequency: float | None
    against: str | None
    direction: Direction
    show: str | None = None
    number: float | None = None


@dataclass(frozen=True, kw_only=True)
class Expectation(Reading):
    """Number that must be ``value``.

    ``tolerance`` is relative to the value; of the number itself with ``against`` or where the value is 0. ``source``:
    who derived the value; empty: an earlier result of the model itself.
    """

    value: float
    tolerance: float
    source: str = ""


@dataclass(frozen=True, kw_only=True)
class Measured(Reading):
    """Number that was measured as ``value``, in ``unit`` (m, m/s, Hz, 1/s, 1), from ``source``.

    ``scatter`` is of the measurement, in the same unit; None: not given. ``chose``: keys of the fidelity's model whose
    values this number chose: the model is calibrated by it, else predicts it.
    """

    value: float
    unit: str
    scatter: float | None
    source: str
    chose: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """Sweep: ``frequency`` in Hz, ascending, shape (points,); ``settle`` and ``hold`` in drive periods.

    ``output`` is the observed displacement: ``"sensor"``, ``"contact"``, ``"tip"`` or ``"platform"``.
    """

    frequency: NDArray[np.float64]
    direction: Direction
    settle: int
    hold: int
    output: str


@dataclass(frozen=True)
class Reference:
    """Reference curve: ``quantity`` of ``fidelity``, within a relative ``tolerance``; ``file`` is absolute.

    ``tolerance`` None: compared without a verdict, as ``measured`` curves may be. ``form``: columns, units,
    scale of the file; ``curve``: the curve itself, in place of the file.

    ``quote``: messages may quote the file's content; False where it lies outside the case's folder.
    """

    name: str
    file: Path
    fidelity: str
    quantity: str
    tolerance: float | None
    direction: Direction
    quote: bool = True
    form: ReferenceForm = field(default_factory=ReferenceForm)
    measured: bool = False
    source: str = ""
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
class CostPlan:
    """Plan of ``vibeam cost``: frequencies in Hz, ``budget`` in CPU seconds; None: the defaults."""

    frequency: tuple[float, ...] | None = None
    settle: int | None = None
    hold: int | None = None
    solvers: tuple[str, ...] | None = None
    modes: tuple[int, ...] | None = None
    reference: str | None = None
    repeats: int = 3
    budget: float = 60.0


@dataclass(frozen=True)
class InfluencePlan:
    """Plan of ``vibeam influence``: frequencies in Hz; None: the defaults."""

    fidelity: str | None = None
    quantities: tuple[str, ...] = ()
    frequency: float | None = None
    tolerance: float = 0.01
    frequency_tolerance: float = 0.1
    restitution_tolerance: float = 0.01
    points: int = 31
    settle: int | None = None
    hold: int | None = None
    repeats: int = 3


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
    """Estimated ``key`` of a case, between ``low`` and ``high``, SI; ``start``: the case's own value, within these."""

    key: str
    low: float
    high: float
    start: float


@dataclass(frozen=True)
class FitPlan:
    """Plan of ``vibeam fit``: estimated keys, the references by name, those with points on unstable branches."""

    keys: tuple[FitKey, ...]
    references: tuple[str, ...]
    unstable: tuple[str, ...] = ()


@dataclass(frozen=True)
class AccuracyPlan:
    """Plan of ``accuracy``: relative error ``within`` of the ``quantities`` against the full model."""

    within: float
    quantities: tuple[str, ...] = ("amplitude",)


@dataclass(frozen=True)
class FigurePlan:
    """Plan of the figure files: endings, ``width`` in m (None: by the number of panels), whether with a title."""

    format: tuple[str, ...] = ("png", "svg")
    width: float | None = None
    title: bool = True


@dataclass(frozen=True)
class ShowPlan:
    """Plan of one [show.NAME] table: frequencies in Hz (none: the sweep's), ``periods`` after ``settle`` drive periods.

    ``fidelities``: their names, in order; ``quantity``: of the kinds ``curve`` and ``boundaries``; ``output``: whose
    displacement; ``near`` (Hz): of ``ringing``; ``highest``, ``subdivision``: of ``harmonics``; ``start`` (m): of
    ``decay``; ``velocity`` (m/s): of ``impact``; ``rate`` (Hz/s) and ``direction``: of ``chirp``, and the branch of
    ``animation`` (both: from rest), ``frames`` a drive period and files' ``format`` of that. ``key``: of all that
    decides the numbers.
    """

    name: str
    kind: str
    fidelities: tuple[str, ...]
    frequency: tuple[float, ...]
    periods: int | None
    settle: int
    quantity: str | None
    key: str
    output: str = "sensor"
    near: float | None = None
    highest: int | None = None
    subdivision: int | None = None
    start: float | None = None
    velocity: tuple[float, ...] = ()
    rate: float | None = None
    direction: Direction = "both"
    frames: int | None = None
    format: tuple[str, ...] = ()


@dataclass(frozen=True)
class AxisPlan:
    """Axis of a map: a dotted key and its values in ``unit``, that of its SI (empty: a plain number)."""

    key: str
    values: tuple[float, ...]
    unit: str


@dataclass(frozen=True)
class MapPlan:
    """Plan of one [map.NAME] table: quantities over ``axes``, the last of which is swept ``direction``.

    ``direction``: "up", "down" or "both", the state carried; "apart": every point from its own start. ``frequency`` in
    Hz, where it is no axis; ``settle`` and ``hold`` in drive periods; ``strobes``: how many values at the end of a
    period; ``starts`` at random, from ``seed``, within ``spread`` (m). ``picture`` and the ``quantity`` that it shows;
    ``boundaries``: whether exact ones are laid over it.
    """

    name: str
    fidelities: tuple[str, ...]
    axes: tuple[AxisPlan, ...]
    direction: Literal["up", "down", "both", "apart"]
    frequency: float | None
    settle: int
    hold: int
    output: str
    quantities: tuple[str, ...]
    picture: str
    quantity: str
    strobes: int = 0
    starts: int | None = None
    seed: int = 1
    spread: float | None = None
    boundaries: bool = True
