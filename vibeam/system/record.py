"""Record: a load over time, sampled, of a shape or random, as a piecewise polynomial."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system import record_pieces as pieces
from vibeam.system.record_random import RandomRecords
from vibeam.system.record_samples import ERRORS, SampledRecords, ascent_faults, extent
from vibeam.system.record_shapes import ShapedRecords
from vibeam_models.arguments import floats, number, read_only, refuse, require, word
from vibeam_models.arrays import Array, ValueRecord

#: what a record drives by: unit, and the sign with which it multiplies the modes' load row
QUANTITIES = {"acceleration": ("m/s²", -1.0), "force": ("N", 1.0), "moment": ("N m", 1.0)}
UNIFORM = 8  # units in the last place of the largest time, by which knots may be off equal steps


@dataclass(frozen=True, eq=False, repr=False)
class Record(SampledRecords, ShapedRecords, RandomRecords, ValueRecord):
    """A load over time u(t): u(times[i] + s) = Σ_j coefficients[i, j] sʲ, a cubic in each piece; 0 outside its span.

    - ``times`` (K + 1,), s, ascending; ``coefficients`` (K, 4), in the unit of ``quantity`` over sʲ;
    - ``quantity``: ``"acceleration"`` of the base b̈ (m/s²), ``"force"`` (N) or ``"moment"`` (N m);
    - ``initial``: velocity and displacement of the base at the start (m/s, m), which no motion depends on;
    - ``samples``: what the samples were that it interpolates, ``"linear"`` or ``"cubic"`` between values of the load,
      ``"velocity"`` or ``"displacement"`` of the base; None: the pieces are the load itself; ``taken``: of a file, how.

    A system moves by η'' + 2ζωη' + ω²η = load · (∓u) + static, with − for an acceleration: where ``Drive`` has
    Ω²B sin Ωt, it is −b̈. ``sampled``, ``random``, ``half_sine`` … make records; ``scaled``, ``shifted``, ``then`` and
    ``+`` others. ValueError names all that is wrong: times that do not ascend, what is not finite, other shapes.

    >>> import vibeam
    >>> ramp = vibeam.Record([0.0, 0.5], [[0.0, 2.0, 0.0, 0.0]], "force")
    >>> ramp.at(0.25), ramp.peak, ramp.duration
    (0.5, 1.0, 0.5)
    """

    times: Array
    coefficients: Array
    quantity: str = "acceleration"
    initial: tuple[float, float] = (0.0, 0.0)
    samples: str | None = None
    taken: Any = field(default=None, init=False, compare=False)

    def __post_init__(self) -> None:
        faults: list[str] = []
        times, coefficients = read_only(self.times), read_only(self.coefficients)
        word("quantity", self.quantity, QUANTITIES, faults)
        if self.samples is not None:
            word("samples", self.samples, ERRORS, faults)
        if times is None or times.ndim != 1 or len(times) < 2:
            faults.append("times: must be two or more numbers, s")
        else:
            faults.extend(ascent_faults(times))
        shape = (np.size(self.times) - 1, 4)
        if coefficients is None or coefficients.shape != shape or not np.isfinite(coefficients).all():
            faults.append("coefficients: must be (K, 4) finite numbers for K + 1 times")
        start = read_only(self.initial)
        if start is None or start.shape != (2,) or not np.isfinite(start).all():
            faults.append("initial: must be two numbers, velocity (m/s) and displacement (m)")
        refuse("record", faults)
        self.__dict__.update(times=times, coefficients=coefficients, initial=tuple(np.ravel(self.initial).tolist()))

    def __repr__(self) -> str:
        unit, joined = QUANTITIES[self.quantity][0], f", samples {self.samples}" if self.samples else ""
        span = f"{self.start:g} … {self.end:g} s, {len(self.coefficients)} pieces"
        return f"Record({self.quantity}, {span}, peak {self.peak:.6g} {unit}{joined})"

    @property
    def start(self) -> float:
        """Time at which it begins, s."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time from which on there is no load, s."""
        return float(self.times[-1])

    @property
    def duration(self) -> float:
        """Time from its start to its end, s."""
        return self.end - self.start

    @cached_property
    def spacing(self) -> float | None:
        """Length of all pieces, s, where they are equal to round-off of the times; else None."""
        mean, close = self.duration / len(self.coefficients), UNIFORM * np.spacing(np.max(np.abs(self.times)))
        parts = ((part, np.arange(part.start, part.stop)) for part in pieces.blocks(len(self.times)))
        even = all(np.max(np.abs(self.times[part] - (self.start + mean * i))) <= close for part, i in parts)
        return mean if even else None

    @property
    def omega(self) -> float:
        """0, as of no drive: a record has no frequency and no period."""
        return 0.0

    @property
    def sign(self) -> float:
        """Sign of u in what multiplies the modes' load row: −b̈, or the force or moment."""
        return QUANTITIES[self.quantity][1]

    @cached_property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value between its start and end."""
        return pieces.bounds(self.times, self.coefficients)

    @property
    def peak(self) -> float:
        """Largest |u|, between the knots too."""
        return max(-self.bounds[0], self.bounds[1])

    @cached_property
    def digest(self) -> str:
        """SHA-256 of times, coefficients and quantity, in hexadecimal: a key of what is computed under it."""
        made = sha256(self.quantity.encode())
        for each in (self.times, self.coefficients):
            for part in pieces.blocks(len(each)):
                made.update((each[part] + 0.0).astype("<f8").tobytes())
        return made.hexdigest()

    def at(self, t: ArrayLike) -> Any:
        """u at times ``t`` (s) of any shape: 0 before the start and after the end."""
        return self._evaluated(t, 0)

    def load_at(self, t: Array) -> Array:
        """Factor of the modes' load row at times ``t``: ∓u, by its ``sign``."""
        return np.asarray(self.sign * self._evaluated(t, 0))

    def velocity_at(self, t: ArrayLike) -> Any:
        """Velocity of the base at times ``t``, m/s: the exact integral; ValueError for a force or moment.

        >>> import vibeam
        >>> pulse = vibeam.Record.trapezoid(100.0, 0.02, rise=0.005)
        >>> print(f"{pulse.velocity_at(0.02):.6f} m/s, {pulse.displacement_at(0.02):.6f} m")
        1.500000 m/s, 0.015000 m
        """
        return self._evaluated(t, 1)

    def displacement_at(self, t: ArrayLike) -> Any:
        """Displacement of the base at times ``t``, m: the exact double integral; ValueError for a force or moment."""
        return self._evaluated(t, 2)

    @property
    def drift(self) -> tuple[float, float]:
        """Velocity and displacement of the base at the end, m/s and m; ValueError for a force or moment."""
        return float(self.velocity_at(self.end)), float(self.displacement_at(self.end))

    def without(self, remove: str | None) -> Self:
        """The record without drift: ``"mean"``, ``"velocity"``, ``"displacement"``, or None, as it is.

        ``"mean"`` takes off the mean over time: a base ends with the velocity that it began with. ``"velocity"``: the
        slope of the straight line that fits the base's velocity best (least squares over time), which then has no mean
        and no trend. ``"displacement"``: constant and slope of the acceleration, so that velocity and displacement are
        0 at the end. ValueError for another name, and for a force, of which the mean alone can be taken off.

        >>> import vibeam
        >>> record = vibeam.Record.sampled([0.0, 1.0, 3.0, 1.0, 0.5], rate=100.0, remove="displacement")
        >>> all(abs(left) < 1e-15 for left in record.drift)
        True
        """
        if remove is None:
            return self
        faults: list[str] = []
        word("remove", remove, pieces.BASELINES, faults)
        refuse("record", faults)
        if remove != "mean":
            self._require_base(f"remove = {remove!r}")
        constant, slope, velocity = pieces.BASELINES[remove](self.duration, *self._knots)
        kept = pieces.without_line(self.times, self.coefficients, constant, slope)
        return replace(self, coefficients=kept, initial=(self.initial[0] - velocity, self.initial[1]))

    def scaled(self, level: float = 1.0, speed: float = 1.0) -> Record:
        """``level`` times as large, and played ``speed`` times as fast: its frequencies are ``speed`` times as high.

        >>> import vibeam
        >>> vibeam.Record.half_sine(500.0, 0.011).scaled(level=2.0, speed=0.5)
        Record(acceleration, 0 … 0.022 s, 457 pieces, peak 1000 m/s²)
        """
        faults: list[str] = []
        level, speed = number("level", level, faults), extent("speed", speed, faults)
        refuse("record", faults)
        times = self.times if speed == 1 else self.start + (self.times - self.times[0]) / speed
        initial = (self.initial[0] * level / speed, self.initial[1] * level / speed**2)
        coefficients = self.coefficients * (level * speed**pieces.POWERS)
        coefficients.setflags(write=False)
        return replace(self, times=times, coefficients=coefficients, initial=initial)

    def shifted(self, by: float) -> Record:
        """The same load ``by`` seconds later."""
        faults: list[str] = []
        by = number("by", by, faults)
        refuse("record", faults)
        return replace(self, times=self.times + by)

    def then(self, rest: Record) -> Record:
        """This record and, from its end on, another of the same quantity, whose own times do not count.

        >>> import vibeam
        >>> down = vibeam.Record.saw_tooth(100.0, 0.01)
        >>> abs(down.then(vibeam.Record.step(0.0, 0.05)).then(down.scaled(level=-1)).drift[0]) < 1e-15
        True
        """
        self._require_like(rest)
        times = np.concatenate([self.times, self.end + (rest.times[1:] - rest.times[0])])
        coefficients = np.concatenate([self.coefficients, rest.coefficients])
        return replace(self, times=times, coefficients=coefficients, samples=_coarser(self.samples, rest.samples))

    def __add__(self, other: Record) -> Record:
        """Sum of two loads of one quantity, each at its own times, on the knots of both."""
        self._require_like(other)
        knots = np.union1d(self.times, other.times)
        one, two = (pieces.on_knots(each.times, each.coefficients, knots) for each in (self, other))
        initial = (self.initial[0] + other.initial[0], self.initial[1] + other.initial[1])
        return Record(knots, one + two, self.quantity, initial, _coarser(self.samples, other.samples))

    def _evaluated(self, t: ArrayLike, order: int) -> Any:
        """u, or the first or second integral of it at times of any shape; past the ends the base coasts."""
        asked = floats("t", t)
        flat = np.clip(asked.ravel(), self.start, self.end)
        piece, s = pieces.place(self.times, flat)
        found = pieces.integrated(self.coefficients[piece], s, order)
        if order == 0:
            found = np.where(flat == asked.ravel(), found, 0.0)
        else:
            self._require_base("motion of the base")
            one, two, _ = self._knots
            found = found + (one[piece] if order == 1 else two[piece] + one[piece] * s)
            if order == 2 and np.any(beyond := asked.ravel() - flat):
                found = found + beyond * self._evaluated(flat, 1)
        return found.reshape(asked.shape) if asked.ndim else float(found[0])

    @cached_property
    def _knots(self) -> tuple[Array, Array, Array]:
        return pieces.knot_integrals(self.times, self.coefficients, self.initial)

    def _require_base(self, what: str) -> None:
        if self.quantity != "acceleration":
            raise ValueError(f"record: {what} goes with an acceleration alone, this one is a {self.quantity}")

    def _require_like(self, other: Any) -> None:
        require("record", other, Record)
        if other.quantity != self.quantity:
            raise ValueError(f"record: {other.quantity} and {self.quantity} are no loads of one kind")


def _coarser(one: str | None, other: str | None) -> str | None:
    """Kind of the samples of two records joined: the one of which more are needed."""
    order = [None, "cubic", "velocity", "displacement", "linear"]
    return order[max(order.index(one), order.index(other))]
