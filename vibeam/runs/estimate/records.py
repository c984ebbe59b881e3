"""Records of error estimates: of one branch, of one fidelity, and what each is of; their cells and sentences."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.system.number_text import percent
from vibeam.system.quantities import CodedEnum
from vibeam.system.response import FrequencyResponse, complete, periodic
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, ValueRecord


class Basis(CodedEnum):
    """The value says in words what an estimate is of, or why there is none; the order is the code in arrays."""

    ORBIT = "along the exact orbit"
    NO_ORBIT = "the full model has no such motion near: too close to a fold, or beyond it"
    STRIKES = "the full model strikes the stop in between"
    UNSTABLE = "the full model's motion is unstable there"
    TOUCHES = "the full model touches the stop, this one does not"
    APERIODIC = "the motion does not repeat, and of its means nothing can be claimed without flying the full model"
    RESTS = "the motion rests on the stop"
    SEVERAL = "too many impacts before the motion repeats"
    UNSETTLED = "no exact orbit agrees with the point"
    FAILED = "the point failed"
    RESONANT = "an undamped mode is driven at a resonance"
    FREE = "clear of the stop, as the full model"
    ANOTHER = "the full model makes another motion"
    REACHED = "along the orbit that the full model comes to from this motion"
    LEFT_OUT = "not computed: between points whose orbits are"
    DEAR = "not computed: flights of the full model take too long"
    BESIDE = "beside the full model of the same run"
    IRREGULAR = "one of the two motions does not repeat"


KNOWN = (Basis.ORBIT, Basis.REACHED, Basis.FREE, Basis.BESIDE)  # those with an estimate
NOT_COMPUTED = (Basis.LEFT_OUT, Basis.DEAR)
WITHOUT_IMPACTS = (Basis.FREE, Basis.FAILED, *NOT_COMPUTED)  # neither model is known to touch the stop


QUANTITIES = ("amplitude", "reach", "impact_velocity")
NAN = float("nan")


@dataclass(frozen=True, eq=False, repr=False)
class ErrorEstimate(ValueRecord):
    """Estimated error of a response against a fuller model, (points,) in the order swept; shares of its value there.

    ``amplitude``, ``reach``, ``impact_velocity``: this model's over the fuller one's, less 1; the same with ``_bound``:
    the estimate of the error's size, which has the uncertainty of the estimate on top. NaN where ``basis``, the code of
    a ``Basis``, is none of ``KNOWN``, and velocities also without impacts. ``correction``: size of the first
    Newton correction of the impacts, rad and share of the impulse, or of the state, share of the motion's size: it
    grows without bound toward a fold.
    """

    frequency: Array
    amplitude: Array
    reach: Array
    impact_velocity: Array
    amplitude_bound: Array
    reach_bound: Array
    impact_velocity_bound: Array
    correction: Array
    basis: NDArray[np.int64]

    @property
    def known(self) -> NDArray[np.bool_]:
        """Points (points,) with an estimate."""
        return np.isin(self.basis, [each.code for each in KNOWN])

    @property
    def impacting(self) -> NDArray[np.bool_]:
        """Points (points,) at which this model or the full one touches the stop."""
        return ~np.isin(self.basis, [each.code for each in WITHOUT_IMPACTS])

    @property
    def reasons(self) -> dict[Basis, int]:
        """Number of impacting points without an estimate, by the reason."""
        return counted_reasons([self.basis[self.impacting & ~self.known]])


def difference(own: FrequencyResponse, full: FrequencyResponse) -> ErrorEstimate:
    """Error of a response against that of the full model: their difference, wherever both motions repeat."""
    both = periodic(own) & periodic(full)
    clear, failed = (own.period == -1) & (full.period == -1), ~(complete(own) & complete(full))
    codes = [each.code for each in (Basis.FAILED, Basis.FREE, Basis.BESIDE)]
    basis = np.select([failed, clear, both], codes, Basis.IRREGULAR.code)
    errors = {name: np.where(both, getattr(own, name) / getattr(full, name) - 1, NAN) for name in QUANTITIES}
    bounds = {f"{name}_bound": np.abs(each) for name, each in errors.items()}
    return ErrorEstimate(own.frequency, **errors, **bounds, correction=np.full(len(own), NAN), basis=basis)


@dataclass(frozen=True, eq=False)
class FidelityEstimate:
    """Estimates of one fidelity, by direction; ``why``: there is none at all.

    Against a full model of ``modes`` modes; ``whole``: it is that model itself. ``swept``: its own sweep tells where
    it makes another motion. ``short``: coordinates that stand for all modes of a large structure.
    """

    modes: int
    branches: Mapping[str, ErrorEstimate]
    why: str = ""
    whole: bool = False
    cpu_seconds: float = 0.0
    swept: bool = True
    short: bool = False


WHOLE = "it is the full model"
COLUMN = "est. off"

CAPTION = f"{COLUMN}: largest error against the full model; (k/n): known at k of n points with impacts"
MANY = 41  # coordinates that stand for all modes of a large structure
STAND = f"{MANY - 1} modes and the rest of the contact's flexibility stand for the full model"
LEAST = 0.5  # share of the points with impacts at which an error must be known to be one of the curve


@dataclass(frozen=True)
class EstimateSummary:
    """Estimated error in amplitude of one fidelity against the full model of ``modes`` modes.

    ``worst``, ``rms``: over the ``points`` at which it is known, of ``total`` at which one of the models touches the
    stop; NaN where that is less than half of them. ``unknown``: number of the others by reason; ``left_out``: points
    that were not computed; ``why``: there is no estimate at all; ``swept`` as in ``FidelityEstimate``.
    """

    fidelity: str
    modes: int
    worst: float
    rms: float
    points: int
    total: int
    unknown: Mapping[str, int]
    why: str = ""
    cpu_seconds: float = 0.0
    left_out: int = 0
    swept: bool = True

    @property
    def cell(self) -> str:
        """Largest error, and its coverage unless it is known everywhere, for a table."""
        if self.why or not self.total:
            return "full" if self.why == WHOLE else "–" if self.why else "no impact"
        return percent(self.worst) + f" ({self.points}/{self.total})" * (self.points < self.total)


@dataclass(frozen=True)
class EstimateTexts:
    """Estimates in words, for the terminal and the page: ``cells`` by fidelity, empty where nothing is estimated.

    ``caption``: the meaning of their head; ``sentences``: on what is not known, and why; ``unknown``: those
    without a number.
    """

    rows: tuple[EstimateSummary, ...]
    cells: Mapping[str, str]
    sentences: tuple[str, ...]
    unknown: tuple[str, ...] = ()
    caption: str = CAPTION


def estimate_texts(found: Mapping[str, FidelityEstimate]) -> EstimateTexts:
    """Cells and sentences of the estimates of every fidelity."""
    rows = tuple(summary(name, each) for name, each in found.items())
    known = any(row.total or row.why == WHOLE for row in rows)
    cells = {row.fidelity: row.cell for row in rows if known}
    unknown = tuple(row.fidelity for row in rows if known and row.why != WHOLE and row.total and not row.worst >= 0)
    short = [name for name, each in found.items() if each.short and not each.why]
    stand = f"; of {', '.join(short)} {STAND}" if short else ""
    return EstimateTexts(rows, cells, tuple(_sentences(rows)), unknown, caption=CAPTION + stand)


def summary(name: str, found: FidelityEstimate) -> EstimateSummary:
    """Summarise the estimates of one fidelity."""
    if found.whole:
        return EstimateSummary(name, found.modes, 0.0, 0.0, 0, 0, {}, WHOLE)
    parts = list(found.branches.values())
    bounds = np.concatenate([np.zeros(0), *(part.amplitude_bound[part.known & part.impacting] for part in parts)])
    total = sum(int(np.count_nonzero(part.impacting)) for part in parts)
    reasons = counted_reasons(part.basis[part.impacting & ~part.known] for part in parts)
    unknown = {basis.value: count for basis, count in reasons.items()}
    worst, rms = NAN, NAN
    if len(bounds) and len(bounds) >= LEAST * total:
        worst, rms = float(bounds.max()), float(np.sqrt(np.mean(bounds**2)))
    left_out = sum(int(np.count_nonzero(np.isin(part.basis, [each.code for each in NOT_COMPUTED]))) for part in parts)
    return EstimateSummary(
        name, found.modes, worst, rms, len(bounds), total, unknown, found.why, found.cpu_seconds, left_out, found.swept
    )  # fmt: skip


def counted_reasons(bases: Iterable[NDArray[np.int64]]) -> dict[Basis, int]:
    """Number of points by the reason, of the codes of several branches."""
    codes, counts = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *bases]), return_counts=True)
    return {Basis.of_code(int(code)): int(count) for code, count in zip(codes, counts, strict=True)}


def _sentences(rows: Sequence[EstimateSummary]) -> Iterator[str]:
    """Sentences on where nothing is estimated, and why; fidelities with the same reason together."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if row.why and row.why != WHOLE:
            reasons.setdefault(row.why, []).append(row.fidelity)
    for why, names in reasons.items():
        yield f"{', '.join(names)}: not estimated against the full model ({why})"
    yield from _of_cost(rows)
    for row in rows:
        if row.unknown:
            listed = "; ".join(f"{reason}: {count}" for reason, count in row.unknown.items())
            few = "" if row.points >= LEAST * row.total else ", too few to say how far off it is"
            yield (
                f"{row.fidelity} against the full model: known at {row.points} of {row.total} points with impacts{few} "
                f"({listed})"
            )


def _of_cost(rows: Sequence[EstimateSummary]) -> Iterator[str]:
    """Sentences on estimates that took flights of the full model: at which points, for how long, and not swept."""
    few = [row for row in rows if row.left_out]
    if few:
        seconds, modes = sum(row.cpu_seconds for row in few), " or ".join(map(str, sorted({row.modes for row in few})))
        at = ", ".join(
            f"{row.fidelity} at {counted(row.total, 'point')} ({row.left_out} others not computed)" for row in few
        )
        yield (
            f"{COLUMN} by orbits of the full model ({modes} modes), the peak first, then evenly spread: {at}; "
            f"{seconds:.2g} s of CPU time"
        )
    if unswept := [row.fidelity for row in rows if not row.swept]:
        yield (
            f"{', '.join(unswept)}: {COLUMN} is of the same motion in the full model; whether a sweep of that is on it "
            "was not flown, for that takes longer"
        )
