"""Results of a solver: reason of the end, one steady point, one frequency-response curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from vibeam.system.curves import Difference as Difference
from vibeam.system.curves import MotionCurves
from vibeam.system.curves import Peak as Peak
from vibeam.system.labelled import LabelledData, LabelledPart
from vibeam.system.quantities import VELOCITIES_KEPT as VELOCITIES_KEPT
from vibeam.system.quantities import Ended as Ended
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, Flags, Index, ValueRecord

SINGLE = (  # one number a point, NaN where unknown
    "amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest", "cpu_seconds",
)  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse(ValueRecord, LabelledData):
    """One branch of a frequency-response curve: one entry a point, in the order in which it was swept.

    SI units. A failed point is NaN with its reason in ``ended``. Shapes: (points,) but for ``impact_velocities``
    (points, 16) and ``mode_energy`` (points, modes).

    ``mode_energy`` is exact in flight: a closed form, or quadrature that resolves the mode (1e-13 of itself; the DTU
    rig's eighth mode at 15.3 Hz, which rings between impacts: 1e-15). At rest on the stop it is Gauss's quadrature with
    at most 1024 samples a segment, with laws and damping beyond the plain ones 128: to round-off as long as the fastest
    mode turns no more than 40 and 5 times in it, to 1e-3 for four times as many.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> up = vibeam.sweep(system, omega=[1.9, 2.0, 2.1], amplitude=0.1)
    >>> up.period.tolist(), up.peak.point  # period 1 everywhere, highest at Ω = 2 ω
    ([1, 1, 1], 2)
    """

    frequency: Array  #: drive frequency, Hz
    amplitude: Array  #: ½(max − min) of the chosen output over the hold
    reach: Array  #: gap − min of the contact displacement: how far the contact point swings away from the stop, m
    maximum: Array  #: max of the chosen output
    minimum: Array  #: min of the chosen output
    impacts_per_period: Array  #: impacts a drive period, over the hold
    impact_velocity: Array  #: mean contact velocity just before impact, m/s (NaN where there is none)
    impact_velocities: Array  #: the last 16 impact velocities of the hold, oldest first, NaN where there are fewer
    period: Index  #: least number of drive periods after which the motion repeats (1…16), 0 none, −1 no contact
    rest: Array  #: share of the time at rest on the stop, 0…1
    mode_energy: Array  #: time-mean energy of each mode over the hold, J (see above)
    ended: Index  #: code of ``Ended``
    impacts: Index  #: impacts computed, settling included
    evaluations: Index = field(compare=False)  #: evaluations of the contact displacement
    cpu_seconds: Array = field(compare=False)  #: CPU time of the point

    @property
    def omega(self) -> Array:
        """Drive frequency in rad/s."""
        return 2 * np.pi * self.frequency

    @property
    def peak(self) -> Peak:
        """Highest complete point, whether its motion repeats or not: see ``Peak``."""
        done = complete(self) & np.isfinite(self.amplitude)
        if not done.any():
            return Peak()
        top = int(np.argmax(np.where(done, self.amplitude, -np.inf)))
        return Peak(float(self.amplitude[top]), float(self.frequency[top]), "", top, bool(periodic(self)[top]))

    @property
    def period_one(self) -> tuple[float, float] | None:
        """Ends (Hz) of the contiguous period-1 range with impacts around its largest amplitude; None without one."""
        found = self.period_one_points
        return None if found is None else (float(min(self.frequency[[*found]])), float(max(self.frequency[[*found]])))

    @property
    def period_one_points(self) -> tuple[int, int] | None:
        """First and last point of the range ``period_one``."""
        inside = complete(self) & (self.period == 1) & (self.impacts_per_period > 0)
        if not inside.any():
            return None
        top = int(np.argmax(np.where(inside, self.amplitude, -np.inf)))
        outside = np.flatnonzero(~inside)
        last = int(min(outside[outside > top], default=len(self))) - 1
        return int(max(outside[outside < top], default=-1)) + 1, last

    def off(self, other: FrequencyResponse) -> Difference:
        """Difference in amplitude from ``other``, at the same frequencies: see ``Branches.off``."""
        return Branches(self).off(Branches(other))

    def __len__(self) -> int:
        return len(self.frequency)

    def __repr__(self) -> str:
        failed = int(np.count_nonzero(self.ended != Ended.COMPLETE.code))
        size, modes = counted(len(self), "point"), counted(self.mode_energy.shape[1], "mode")
        span = f"{self.frequency.min():.6g} … {self.frequency.max():.6g} Hz" if len(self) else "no frequency"
        return f"FrequencyResponse({size}, {span}, {modes}{f', {failed} not complete' if failed else ''})"

    def _parts(self) -> Sequence[LabelledPart]:
        return [LabelledPart({}, {"frequency": self.frequency}, self.quantities)]

    @property
    def quantities(self) -> dict[str, Array]:
        """All but the frequency by name."""
        return {each.name: getattr(self, each.name) for each in fields(self) if each.name != "frequency"}

    @classmethod
    def empty(cls, frequency: Array, modes: int) -> FrequencyResponse:
        """Response with no point run yet: NaN, 0 and ``Ended.NOT_RUN``."""
        n = len(frequency)
        blank: dict[str, Any] = dict(zip(SINGLE, np.full((len(SINGLE), n), np.nan), strict=True))
        blank |= {name: np.zeros(n, dtype=np.int64) for name in ("period", "impacts", "evaluations")}
        blank |= {"frequency": np.asarray(frequency, dtype=float), "ended": np.full(n, Ended.NOT_RUN.code)}
        blank |= {
            "impact_velocities": np.full((n, VELOCITIES_KEPT), np.nan),
            "mode_energy": np.full((n, modes), np.nan),
        }
        return cls(**blank)


@dataclass(frozen=True, eq=False, repr=False)
class Branches(ValueRecord, LabelledData):
    """Branches of a sweep; None where a direction was not asked for.

    ``curves``: all motions of the solver's kind, beyond the stable ones it sweeps, where the solver knows them.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> both = vibeam.sweep(system, omega=[1.9, 2.0], amplitude=0.1, direction="both", settle=20, hold=2)
    >>> {direction: response.frequency.round(3).tolist() for direction, response in both.items()}
    {'up': [0.302, 0.318], 'down': [0.318, 0.302]}
    """

    up: FrequencyResponse | None = None
    down: FrequencyResponse | None = None
    curves: MotionCurves | None = None

    def __repr__(self) -> str:
        parts = [f"{direction}={response!r}" for direction, response in self.items()]
        parts += [] if self.curves is None else [f"curves={self.curves!r}"]
        return f"Branches({', '.join(parts)})"

    def _parts(self) -> Sequence[LabelledPart]:
        return [
            LabelledPart({"direction": direction}, {"frequency": response.frequency}, response.quantities)
            for direction, response in self.items()
        ]

    @property
    def peak(self) -> Peak:
        """Highest complete point of all branches, whether its motion repeats or not: see ``Peak``."""
        each = (replace(response.peak, direction=direction) for direction, response in self.items())
        known = [peak for peak in each if peak.point >= 0]
        return max(known, key=lambda peak: (peak.amplitude, peak.frequency, peak.direction), default=Peak())

    def off(self, other: Branches) -> Difference:
        """Difference in amplitude from ``other`` over the branches that both have, at the same frequencies.

        Compared are the points where both motions are periodic and the other moves; the peaks wherever this one has
        a complete point at the other's.
        """
        ours, top = dict(self.items()), other.peak
        pairs = [(ours[direction], response) for direction, response in other.items() if direction in ours]
        relative = [_relative(*pair) for pair in pairs]
        known = top.amplitude > 0 and top.direction in ours and complete(ours[top.direction])[top.point]
        peak = self.peak.amplitude / top.amplitude - 1 if known else float("nan")
        return Difference.of(np.concatenate([np.empty(0), *relative]), sum(len(each) for _, each in pairs), peak)

    def items(self) -> Iterator[tuple[str, FrequencyResponse]]:
        """Direction and response of each branch present, up first."""
        both = (("up", self.up), ("down", self.down))
        return ((direction, response) for direction, response in both if response is not None)


def modes_of(branches: Branches) -> int:
    """Number of modes of a fidelity."""
    return max(int(response.mode_energy.shape[1]) for _, response in branches.items())


def complete(response: FrequencyResponse) -> Flags:
    """Mask (points,) of the points that ran to the end."""
    return np.asarray(response.ended == Ended.COMPLETE.code)


def periodic(response: FrequencyResponse) -> Flags:
    """Mask (points,) of the points with a periodic motion, with impacts or without."""
    return np.asarray(complete(response) & (response.period != 0))


def _relative(ours: FrequencyResponse, other: FrequencyResponse) -> Array:
    both = periodic(ours) & periodic(other) & (other.amplitude > 0)
    return np.asarray(ours.amplitude[both] / other.amplitude[both] - 1)


def join(parts: list[FrequencyResponse]) -> FrequencyResponse:
    """Concatenate consecutive points to one response."""
    if len(parts) == 1:
        return parts[0]
    values = {f.name: np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(FrequencyResponse)}
    return FrequencyResponse(**values)
