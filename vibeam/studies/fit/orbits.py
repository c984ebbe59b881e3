"""Periodic motions that measured points lie on where no closed form knows them: shot, and followed as the keys move.

With P(y, p) the map of the modal state y over the motion's n drive periods at keys p, flown exactly, M = ∂P/∂y its
tangent map and r(y, p) what is read off these periods, the motion y = P(y, p) and its reading have the derivatives

    dy/dp = (1 − M)⁻¹ ∂P/∂p,    dr/dp = ∂r/∂y dy/dp + ∂r/∂p.

∂P/∂p is a central difference of two flights from y with the model at moved keys, or of one side where the other cannot
be flown; dr/dp is one of two readings there, from y moved by dy/dp. A motion is followed to other keys by Newton's
method on P(y) = y from where its derivative leads; what that corrects must be less than what the derivative moved, else
the way is halved, and where that does not help the motion is lost: its value goes on as its tangent does, so that a
misfit has no jump, and it counts as none of the model.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from vibeam.periodic.shooting import NoOrbit, Reason
from vibeam.studies.fit.flights import LIMIT, FlyingModel, OrbitModel
from vibeam.studies.fit.points import Points
from vibeam.system.quantities import Ended
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array

STEP = 3e-5  # of a difference quotient, share of the bounds
ALLOWED = 0.02  # share of the motion's size by which a correction may exceed what the derivative moved
STEADY = 1 + 1e-9  # modulus of a multiplier up to which a motion is stable
SAMPLES = 8192  # a period, of what is filtered: an impact's kink reaches high harmonics


@dataclass
class MotionKind:
    """Motion at a measured point: ``period`` drive periods until it repeats (0: not within 16), its ``impacts``.

    ``impacts``, or touches of a stop that yields, are those of the whole ``period``. ``rest``: share of the time at
    rest on a rigid stop; ``resting``: at the drive's phase 0. ``value``: of the reference's quantity, SI; NaN where it
    is not comparable.
    """

    period: int
    impacts: int
    rest: float
    resting: bool
    value: float

    @property
    def called(self) -> str:
        """The motion in words."""
        if self.rest > 0:
            return "a rest on the stop in every period"
        if self.period == 0:
            return "no repeat within 16 periods"
        if not self.impacts:
            return "no contact"
        return f"{counted(self.impacts, 'impact')} {'a period' if self.period == 1 else f'in {self.period} periods'}"


@dataclass
class OtherMotion(MotionKind):
    """Motion that a flight settles on, outside the family.

    ``cost``: squared residual of the measured point; ``number``: of the motion as it is followed, where it can be.
    """

    cost: float
    number: int | None = None


@dataclass(frozen=True, eq=False)
class Shooting:
    """Shooting at ``omega``, rad/s, of measured point number ``point`` or beside it; ``points``: its group."""

    model: OrbitModel
    points: Points
    omega: float
    point: int

    def orbit(self, x: Array, start: Array, like: MotionKind) -> FollowedOrbit:
        """Periodic motion at shares ``x`` that Newton's method finds from a state; NoOrbit without.

        It has the periods of the motion ``like``, and rests where that does.
        """
        made, periods = self.model.at(x), max(like.period, 1)
        orbit = made.orbit(self.omega, made.state(start, like.resting), periods)
        found, _ = made.over(np.array([self.omega]), [orbit.state], periods, {self.points.quantity})
        if found.ended[0] != Ended.COMPLETE.code:
            raise NoOrbit(Reason.ENDED, Ended.of_code(int(found.ended[0])).value)
        value = float(quantities(made, [self], found, [orbit.state], periods)[0])
        impacts = round(float(found.impacts_per_period[0]) * periods)
        rest, state, tangent = made.rest(found)[0], made.row(orbit.state), made.tangent(orbit)
        return FollowedOrbit(periods, impacts, rest, like.resting, value, self, x, state, tangent)

    def further(self, near: FollowedOrbit, x: Array) -> FollowedOrbit:
        """The motion at shares ``x`` from where its derivative leads; NoOrbit where Newton's method leaves it."""
        return self.orbit(x, near.predicted(x), near).beside(near.predicted(x), near)

    def settled(self, x: Array, state: State, like: MotionKind) -> FollowedOrbit:
        """Periodic motion that a flight has settled on, or nearly; NoOrbit where there is none so near."""
        start = self.model.at(x).row(state)
        return self.orbit(x, start, like).beside(start)


@dataclass(eq=False)
class FollowedOrbit(MotionKind):
    """Periodic motion at shares ``x`` of the keys: modal state (2n,) at the drive's phase 0.

    ``tangent``: M in units of velocity. Derivatives of the state (P, 2n) and of the value (P,) are None until they are
    asked for, NaN where flights beside the motion fail on both sides.
    """

    shooting: Shooting
    x: Array
    state: Array
    tangent: Array = field(repr=False)
    state_by: Array | None = field(default=None, repr=False)
    by: Array | None = field(default=None, repr=False)

    @property
    def made(self) -> FlyingModel:
        """The model that it is a motion of."""
        return self.shooting.model.at(self.x)

    @property
    def closing(self) -> Array:
        """(1 − M)⁻¹ (2n, 2n), in units of velocity."""
        return np.asarray(np.linalg.pinv(np.eye(len(self.state)) - self.tangent))

    @property
    def stable(self) -> bool:
        """Test whether every multiplier is within the unit circle."""
        return bool(np.abs(np.linalg.eigvals(self.tangent)).max() <= STEADY)

    @property
    def differentiable(self) -> bool:
        """Test whether its derivatives are known, computing them where they were not asked for yet."""
        differentiate([self])
        return self.by is not None and bool(np.isfinite(self.by).all())

    def apart(self, state: Array) -> float:
        """Distance of a state (2n,), as a share of the motion's size."""
        units = self.made.units
        return float(np.linalg.norm((self.state - state) * units) / np.linalg.norm(self.state * units))

    def predicted(self, x: Array) -> Array:
        """State (2n,) at shares ``x`` to which the derivative leads."""
        assert self.state_by is not None
        return np.asarray(self.state + (x - self.x) @ self.state_by)

    def beside(self, start: Array, near: FollowedOrbit | None = None) -> FollowedOrbit:
        """Itself, where it is as near to the ``start`` of Newton's method as that is to the motion ``near``, or nearly.

        NoOrbit elsewhere: then it may be any other motion.
        """
        if not self.apart(start) <= ALLOWED + (0.0 if near is None else near.apart(start)):
            raise NoOrbit(Reason.LEFT)
        return self


def alike(orbits: list[FollowedOrbit]) -> Iterator[list[FollowedOrbit]]:
    """Motions of one model, at one set of keys and with one number of periods, which are flown together."""
    kinds: dict[tuple[OrbitModel, bytes, int], list[FollowedOrbit]] = {}
    for each in orbits:
        kinds.setdefault((each.shooting.model, each.x.tobytes(), each.period), []).append(each)
    yield from kinds.values()


def differentiate(orbits: list[FollowedOrbit]) -> None:
    """Derivatives of motions, where they are not known yet: those that are flown together at once."""
    for own in alike([each for each in orbits if each.by is None]):
        _differentiate(own)


def _differentiate(orbits: list[FollowedOrbit]) -> None:
    x, model, periods, units = orbits[0].x, orbits[0].shooting.model, orbits[0].period, orbits[0].made.units
    shootings = [each.shooting for each in orbits]
    omega, state = np.array([each.omega for each in shootings]), np.array([each.state for each in orbits])
    closing = np.array([each.closing for each in orbits])
    by, state_by = np.zeros((len(orbits), len(x))), np.zeros((len(orbits), len(x), len(units)))

    value = np.array([each.value for each in orbits])

    def flown(at: Array, starts: Array, read: bool) -> Array:
        """States after the motions from ``starts``, or the quantities that are read off them."""
        try:
            made = model.at(at)
        except ValueError:  # no such system on this side
            return np.full_like(value if read else state, np.nan)
        own = [made.state(row, each.resting) for row, each in zip(starts, orbits, strict=True)]
        found, after = made.over(omega, own, periods, {each.points.quantity for each in shootings} if read else None)
        return quantities(made, shootings, found, own, periods) if read else after

    for k in np.flatnonzero(model.forward.changed).tolist():
        ends = np.clip(x[k] + np.array([-STEP, STEP]), 0.0, 1.0)
        low, high = (np.where(np.arange(len(x)) == k, end, x) for end in ends)
        apart = _slope(ends - x[k], flown(low, state, False), state, flown(high, state, False))
        state_by[:, k] = (closing @ (apart * units)[..., None])[..., 0] / units
        known = np.array([bool(np.isfinite(row).all()) for row in state_by[:, k]])
        starts = [state + (each[k] - x[k]) * np.where(known[:, None], state_by[:, k], 0.0) for each in (low, high)]
        below, above = (flown(each, own, True) for each, own in zip((low, high), starts, strict=True))
        by[:, k] = np.where(known, _slope(ends - x[k], below, value, above), np.nan)
    for each, own, motion in zip(orbits, by, state_by, strict=True):
        each.by, each.state_by = own, motion


def _slope(ends: Array, low: Array, here: Array, high: Array) -> Array:
    """Difference quotient of rows (points, …): from both sides, from one where the other fails, NaN where both do."""
    axes = tuple(range(1, low.ndim))
    below, above = (np.asarray(np.isfinite(each).all(axis=axes, keepdims=True)) for each in (low, high))
    width = np.where(above, ends[1], 0.0) - np.where(below, ends[0], 0.0)
    return np.asarray((np.where(above, high, here) - np.where(below, low, here)) / np.where(width > 0, width, np.nan))


def quantities(
    made: FlyingModel, shootings: list[Shooting], found: FrequencyResponse, starts: list[State], periods: int
) -> Array:
    """Measured quantities (points,) of flights over whole periods; NaN where one fails."""
    values = np.array([getattr(found, each.points.quantity)[k] for k, each in enumerate(shootings)])
    for k, each in enumerate(shootings):
        if each.points.gain is not None and each.points.quantity != "impact_velocity" and np.isfinite(values[k]):
            values[k] = _filtered(made, each, starts[k], periods)
    return values


def _filtered(made: FlyingModel, shooting: Shooting, start: State, periods: int) -> float:
    """Quantity behind the filter, from the harmonics of samples."""
    assert shooting.points.gain is not None
    drive, quantity = made.drive(shooting.omega), shooting.points.quantity
    span = periods * 2 * np.pi / drive.omega
    segments = made.solver.simulate(drive, start, 0.0, span, LIMIT)[3]
    times = np.arange(SAMPLES * periods) * span / (SAMPLES * periods)
    row = made.system.contact if quantity == "reach" else made.system.output(made.output)
    harmonics = np.fft.rfft(made.solver.poses_at(drive, segments, times)[:, 0] @ row)
    harmonics *= shooting.points.gain(np.arange(len(harmonics)) / span)
    signal = np.fft.irfft(harmonics, n=len(times))
    high, low = _peak(signal), -_peak(-signal)
    found = {"amplitude": (high - low) / 2, "maximum": high, "minimum": low, "reach": made.system.gap - low}
    return found[quantity]


def _peak(signal: Array) -> float:
    """Largest value of a periodic signal, by a parabola through the largest sample and its neighbours."""
    k = int(np.argmax(signal))
    before, here, after = (float(signal[each % len(signal)]) for each in (k - 1, k, k + 1))
    bend = before - 2 * here + after
    return here - (after - before) ** 2 / (8 * bend) if bend < 0 else here
