"""Output over a span of a periodic motion, read-off quantities, and their exact derivatives by parameters.

Without a filter it is summed from the modes' Green's functions. With a low-pass filter of gain F it is summed from its
harmonics kΩ/n, which are known in closed form,

    u_k = (2p/T) Σ o_i c_i/(ω_i² − ν_k² + 2iσ_iν_k) + (the drive's phasor at k = n),   ν_k = kΩ/n,

each times F(ν_k): the filter lets few of them pass. Extremes are searched from samples on by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.periodic.orbit_derivatives import Struck, contracted, driven, offset_of, struck
from vibeam.periodic.tangents import ModalData, Poles, Tangents, green_at
from vibeam_models.arrays import Array, Complex, Index

Gain = Callable[[Array], Complex]  # of a filter, at frequencies in Hz
SAMPLES = 192  # a drive period
HARMONICS = 256  # a drive period, of a filtered displacement
STEPS = 6  # of Newton's method at an extreme, at most
CLOSE = 1e-9  # share of the span by which the last step moves it: the value is then known to its square
RESOLVED = 0.5  # turn of a mode between two samples, rad, up to which they show its extremes
MOST_PARTS = 64  # of an interval between two samples
NEAR = 0.1  # share of the bound on fast modes by which a sample may be below the best and still lead to it


class SampledOutput:
    """Displacement of a row over one span, from the Green's functions.

    A mode's is Re Σ a e^{sτ}: one exponential of one that swings, two of one that does not (``rates`` s, (parts,), and
    ``start`` a, the impulses in it, (points, parts)).
    """

    def __init__(
        self, data: ModalData, tangents: Tangents, row: Array, by_row: Array, omega: Array, periods: int,
        found: Struck, gain: Gain | None,
    ) -> None:  # fmt: skip
        self.omega, self.found, self.tangents, self.gain = omega, found, tangents, gain
        self.poles, self.span, self.periods = Poles.of(data.omega, data.zeta), 2 * np.pi * periods / omega, periods
        self.data, self.weight = data, row * data.contact
        self.by_weight = by_row * data.contact + row * tangents.contact
        self.rest, self.by_rest = offset_of(data, tangents, row, by_row)
        self.driven = driven(data, tangents, row, by_row, omega)
        over, share = ~self.poles.under, self.weight / (self.poles.first - self.poles.second)
        self.rates = np.concatenate([self.poles.first, self.poles.second[over]])
        parts = np.concatenate([np.where(over, 1, 2) * share, -share[over]])
        self.start = found.impulse[:, None] * parts / -np.expm1(self.rates * self.span[:, None])

    def extreme(self, sign: float) -> tuple[Array, Array]:
        """Largest (sign 1) or smallest (−1) value (points,), and its derivatives (P, points)."""
        which, times, reach = self.candidates(sign)
        low, high = np.maximum(times - reach, 0.0), np.minimum(times + reach, self.span[which])
        start, before = times, sign * self.at(which, times, 1)[0]
        for _ in range(STEPS):
            _, slope, bend = (sign * each for each in self.at(which, times, 3))
            move = np.where(bend < 0, -slope / np.where(bend < 0, bend, 1.0), np.sign(slope) * reach / 4)
            moved = np.clip(times + move, low, high)
            times, far = moved, np.abs(moved - times)
            if np.all(far <= CLOSE * self.span[which]):
                break
        after = sign * self.at(which, times, 1)[0]
        times, value = np.where(after >= before, times, start), np.maximum(after, before)
        order = np.lexsort((-value, which))
        best = order[np.searchsorted(which[order], np.arange(len(self.omega)))]
        return sign * value[best], self.by(times[best])

    def candidates(self, sign: float) -> tuple[Index, Array, Array]:
        """Points (m,), times (m,) near which the extreme may lie, one or more a point, and within which distance.

        An interval of samples is sampled again where its slow modes with a bound on its fast ones reach the best value.
        """
        count, step = SAMPLES * self.periods, self.span / (SAMPLES * self.periods)
        values, slow, bound = self.sampled
        best, slow = np.nan_to_num(sign * values, nan=-np.inf).max(axis=1), sign * slow
        bend = np.abs(np.diff(slow, 2, axis=1)).max(axis=1, initial=0.0)[:, None]
        hopeful = np.maximum(slow[:, 1:], slow[:, :-1]) + bend / 4 + bound[:, :-1] >= best[:, None]
        which, interval = np.nonzero(hopeful | np.isnan(slow[:, 1:]) & (np.arange(count) == 0))
        parts = int(np.clip(np.ceil(self.data.omega.max() * step.max() / RESOLVED), 2, MOST_PARTS))
        times = (interval[:, None] + np.arange(parts + 1) / parts) * step[which, None]
        again = np.nan_to_num(sign * self.at(which, times, 1)[0])
        top = np.full(len(self.omega), -np.inf)
        np.maximum.at(top, which, again.max(axis=1))
        near = np.where(np.isfinite(top), top - NEAR * bound[:, 0], 0)
        ends = np.full((len(again), 1), -np.inf)
        padded = np.concatenate([ends, again, ends], axis=1)
        peak = again >= np.maximum(padded[:, :-2], padded[:, 2:])
        row, column = np.nonzero(peak & (again >= near[which, None]) | (again >= top[which, None]))
        return which[row], times[row, column], step[which[row]] / parts

    @cached_property
    def sampled(self) -> tuple[Array, Array, Array]:
        """Displacement (points, samples), its part without the fast modes, and a bound on that of these."""
        shares = np.linspace(0.0, 1.0, SAMPLES * self.periods + 1)
        fast = np.abs(self.rates) * (self.span / SAMPLES / self.periods).max() > RESOLVED
        slow = self.steady(shares) + self.summed(shares, self.rates[~fast], self.start[:, ~fast])
        ringing = self.summed(shares, self.rates[fast].real, np.abs(self.start[:, fast]))
        return slow + self.summed(shares, self.rates[fast], self.start[:, fast]), slow, ringing

    def samples(self, shares: Array) -> Array:
        """Displacement (points, samples) at even shares of the span."""
        return self.steady(shares) + self.summed(shares, self.rates, self.start)

    def steady(self, shares: Array) -> Array:
        """Displacement by the drive alone and by static forces (points, samples)."""
        phase = self.found.phase[:, None] + self.omega[:, None] * self.span[:, None] * shares
        return np.asarray(self.rest + (self.driven.value[:, None] * np.exp(1j * phase)).imag)

    def summed(self, shares: Array, rates: Complex | Array, start: Complex | Array) -> Array:
        """Re Σ a e^{sτ} (points, samples) at even shares of the span, by multiplication: an exponential a part."""
        turns = np.empty((len(shares), *start.shape), dtype=start.dtype)
        turns[0], turns[1:] = start, np.exp(rates * (self.span / (len(shares) - 1))[:, None])
        return np.asarray(np.cumprod(turns, axis=0, out=turns).real.sum(axis=2).T)

    def at(self, which: Index, times: Array, count: int) -> tuple[Array, ...]:
        """Displacement, velocity, … (m, …), so many, of the points ``which`` (m,) at times after the impact."""
        wide = (slice(None), *(None,) * (times.ndim - 1))
        omega, phase = self.omega[which][wide], self.found.phase[which][wide]
        drive = self.driven.value[which][wide] * np.exp(1j * (phase + omega * times))
        parts = self.start[which][wide] * np.exp(self.rates * times[..., None])
        found = [self.rest + drive.imag + parts.real.sum(axis=-1)]
        for _ in range(count - 1):
            drive, parts = 1j * omega * drive, parts * self.rates
            found.append(drive.imag + parts.real.sum(axis=-1))
        return tuple(found)

    def by(self, times: Array) -> Array:
        """Derivatives (P, points) of the displacement at constant times after the impact, one a point."""
        turn = np.exp(1j * (self.found.phase + self.omega * times))
        drive = (self.driven.by * turn + 1j * self.driven.value * turn * self.found.by_phase).imag
        value, by = contracted(
            green_at(self.poles, self.span[:, None], times[:, None]), self.weight, self.by_weight, self.tangents
        )
        return np.asarray(self.by_rest[:, None] + drive + self.found.by_impulse * value + self.found.impulse * by)


class FilteredOutput(SampledOutput):
    """Displacement behind a low-pass filter, from its harmonics."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        assert self.gain is not None
        order = np.arange(1, HARMONICS * self.periods + 1)
        self.nu = self.omega[:, None] * order / self.periods
        self.gains = self.gain(self.nu / (2 * np.pi))
        self.driven_at = order == self.periods
        natural, sigma = self.data.omega, self.data.sigma
        self.share = 1 / (natural**2 - self.nu[..., None] ** 2 + 2j * sigma * self.nu[..., None])
        self.train = 2 * self.gains / self.span[:, None]
        turned = self.driven.value * np.exp(1j * self.found.phase)
        push = self.train * (self.share @ self.weight) * self.found.impulse[:, None]
        self.phasors = push + np.where(self.driven_at, -1j * turned[:, None] * self.gains, 0.0)
        still = float(np.abs(self.gain(np.zeros(1)))[0])
        self.still, mean = still, self.found.impulse / self.span * float((self.weight / natural**2).sum())
        self.level = still * (self.rest + mean)

    def candidates(self, sign: float) -> tuple[Index, Array, Array]:
        """As of ``SampledOutput``: the best of samples fine enough for every harmonic."""
        count = 4 * HARMONICS * self.periods
        padded = np.concatenate([np.zeros((len(self.nu), 1)), self.phasors], axis=1) * count / 2
        values = sign * np.fft.irfft(np.nan_to_num(padded), n=count, axis=1)
        step = self.span / count
        return np.arange(len(self.nu)), np.argmax(values, axis=1) * step, step

    def at(self, which: Index, times: Array, count: int) -> tuple[Array, ...]:
        """As of ``SampledOutput``."""
        nu = self.nu[which]
        turned = self.phasors[which] * np.exp(1j * nu * times[:, None])
        found = [self.level[which] + turned.real.sum(axis=1)]
        for _ in range(count - 1):
            turned = turned * 1j * nu
            found.append(turned.real.sum(axis=1))
        return tuple(found)

    def by(self, times: Array) -> Array:
        """As of ``SampledOutput``."""
        natural, tangents, p = self.data.omega, self.tangents, self.found.impulse
        turn = np.exp(1j * self.nu * times[:, None])
        carried = (self.train * turn)[..., None] * self.share  # (points, k, n)
        square = carried * self.share
        value, by_omega = carried.sum(axis=1).real, -2 * natural * square.sum(axis=1).real
        by_sigma = -(square * 2j * self.nu[..., None]).sum(axis=1).real
        by = self.by_weight @ value.T + (self.weight * tangents.omega) @ by_omega.T
        by = by + (self.weight * tangents.sigma) @ by_sigma.T
        soft = self.weight / natural**2
        by_soft = (self.by_weight / natural**2).sum(axis=1) - 2 * tangents.omega @ (soft / natural)
        mean = self.found.by_impulse * soft.sum() + p * by_soft[:, None]
        at_drive = np.where(self.driven_at, self.gains * turn, 0.0).sum(axis=1) * np.exp(1j * self.found.phase)
        drive = (self.driven.by * at_drive + 1j * self.driven.value * at_drive * self.found.by_phase).imag
        pushed = self.found.by_impulse * (value @ self.weight) + p * by
        return np.asarray(self.still * (self.by_rest[:, None] + mean / self.span) + drive + pushed)


QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impact_velocity")


@dataclass(frozen=True)
class OutputValue:
    """Quantity (points,) and its derivatives (P, points); ``beyond`` and its own: see ``Struck``."""

    value: Array
    by: Array
    beyond: Array
    by_beyond: Array


def of_orbits(
    data: ModalData, tangents: Tangents, omega: Array, periods: int, root: int, quantity: str, gain: Gain | None = None,
    samples: int = 0,
) -> OutputValue:  # fmt: skip
    """Quantity of one root, at drives ``omega`` (points,) rad/s; NaN where it has no motion at any drive.

    ``samples``: extremes are the largest and least of so many values a period (of an unfiltered output); 0: exact.
    """
    found = struck(data, tangents, omega, np.full(len(omega), periods), root)
    if quantity == "impact_velocity":
        return OutputValue(*_velocity(data, tangents, found), found.beyond, found.by_beyond)
    row, by_row = (data.contact, tangents.contact) if quantity == "reach" else (data.row, tangents.row)
    kind = SampledOutput if gain is None else FilteredOutput
    signal = kind(data, tangents, row, by_row, omega, periods, found, gain)
    if samples and gain is None:
        sampled, no = signal.samples(np.linspace(0.0, 1.0, samples * periods + 1)), np.zeros_like(found.by_impulse)
        ends: tuple[Both, Both] = (sampled.max(axis=1), no), (sampled.min(axis=1), no)
    else:
        high = signal.extreme(1.0) if quantity in ("amplitude", "maximum") else (0.0, 0.0)
        ends = high, signal.extreme(-1.0) if quantity != "maximum" else (0.0, 0.0)
    return OutputValue(*_read(quantity, data, tangents, *ends), found.beyond, found.by_beyond)


def without_contact(
    data: ModalData, tangents: Tangents, omega: Array, quantity: str, gain: Gain | None = None
) -> OutputValue:
    """Quantity of the motion without contact; ``beyond``: ln of how much it exceeds the gap, 0 where it does not."""
    contact = driven(data, tangents, data.contact, tangents.contact, omega)
    static, by_static = offset_of(data, tangents, data.contact, tangents.contact)
    clear, by_clear = data.gap - static, (tangents.gap - by_static)[:, None]
    size, by_size = np.abs(contact.value), (contact.value.conj() * contact.by).real / np.abs(contact.value)
    with np.errstate(invalid="ignore", divide="ignore"):
        over = np.where(clear > 0, np.log(size / clear), np.nan)
        beyond, by_beyond = np.maximum(over, 0.0), np.where(over > 0, by_size / size - by_clear / clear, 0.0)
    if quantity == "impact_velocity":
        return OutputValue(np.zeros(len(omega)), np.zeros_like(by_size), beyond, by_beyond)
    row, by_row = (data.contact, tangents.contact) if quantity == "reach" else (data.row, tangents.row)
    rest, by_rest = offset_of(data, tangents, row, by_row)
    seen = driven(data, tangents, row, by_row, omega)
    passed = 1.0 if gain is None else np.abs(gain(omega / (2 * np.pi)))
    still = 1.0 if gain is None else float(np.abs(gain(np.zeros(1)))[0])
    wide = passed * np.abs(seen.value)
    by_wide = passed * (seen.value.conj() * seen.by).real / np.maximum(np.abs(seen.value), 1e-300)
    middle, by_middle = still * rest, still * by_rest[:, None]
    high, low = (middle + wide, by_middle + by_wide), (middle - wide, by_middle - by_wide)
    return OutputValue(*_read(quantity, data, tangents, high, low), beyond, by_beyond)


Both = tuple[Array | float, Array | float]


def _read(quantity: str, data: ModalData, tangents: Tangents, high: Both, low: Both) -> tuple[Array, Array]:
    if quantity == "amplitude":
        return np.asarray((high[0] - low[0]) / 2), np.asarray((high[1] - low[1]) / 2)
    if quantity == "reach":
        return np.asarray(data.gap - low[0]), np.asarray(tangents.gap[:, None] - low[1])
    return (np.asarray(high[0]), np.asarray(high[1])) if quantity == "maximum" else (
        np.asarray(low[0]), np.asarray(low[1])
    )  # fmt: skip


def _velocity(data: ModalData, tangents: Tangents, found: Struck) -> tuple[Array, Array]:
    """v = −p S/(1 + R)."""
    mobility, lost = float(data.contact @ data.contact), 1 + data.restitution
    by_share = 2 * (tangents.contact @ data.contact) / lost - mobility * tangents.restitution / lost**2
    return -found.impulse * mobility / lost, -found.by_impulse * mobility / lost - found.impulse * by_share[:, None]
