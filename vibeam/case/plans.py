"""What a case asks for: its sweep, its references, its studies."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Expectation:
    """``quantity`` of ``fidelity`` at ``frequency`` (Hz; None: of the whole branch) must be ``value``.

    With ``against``, the relative difference to that fidelity must be. ``tolerance``: of that difference itself, else
    relative to the value, or of the number itself where the value is 0. With ``show`` the quantity is read off that
    figure: its mean, or the entry of mode or order ``number``.
    """

    name: str
    fidelity: str
    quantity: str
    frequency: float | None
    against: str | None
    value: float
    tolerance: float
    direction: Direction
    show: str | None = None
    number: float | None = None


Direction = Literal["up", "down", "both"]


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """The sweep: ``frequency`` in Hz, ascending, shape (points,); ``settle`` and ``hold`` in drive periods.

    ``output`` is the displacement that is read: ``"sensor"``, ``"contact"``, ``"tip"`` or ``"platform"``.
    """

    frequency: NDArray[np.float64]
    direction: Direction
    settle: int
    hold: int
    output: str


@dataclass(frozen=True)
class Reference:
    """A curve to check against: ``quantity`` of ``fidelity``, within a relative ``tolerance``; ``file`` is absolute.

    ``quote``: messages may show what the file holds; not where it lies outside the case's folder.
    """

    name: str
    file: Path
    fidelity: str
    quantity: str
    tolerance: float
    direction: Direction
    quote: bool = True


@dataclass(frozen=True)
class CostPlan:
    """What ``vibeam cost`` does: frequencies in Hz, ``budget`` in CPU seconds; None: as its defaults say."""

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
    """What ``vibeam influence`` does: frequencies in Hz; None: as its defaults say."""

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
class AccuracyPlan:
    """``accuracy``: the relative error ``within`` which the ``quantities`` are to be, of the finest fidelity's."""

    within: float
    quantities: tuple[str, ...] = ("amplitude",)


@dataclass(frozen=True)
class FigurePlan:
    """How figures are written: file endings, ``width`` in m (None: by the number of panels), whether with a title."""

    format: tuple[str, ...] = ("png", "svg")
    width: float | None = None
    title: bool = True


@dataclass(frozen=True)
class ShowPlan:
    """One [show.NAME] table: frequencies in Hz (none: the sweep's), ``periods`` shown after ``settle`` drive periods.

    ``fidelities``: their names, in order; ``quantity``: of the kinds ``curve`` and ``boundaries``; ``output``: whose
    displacement; ``near`` (Hz): of ``ringing``; ``highest``, ``subdivision``: of ``harmonics``. ``key``: of all that
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
