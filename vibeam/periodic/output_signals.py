"""Output over a span of a periodic motion, read-off quantities, and their exact derivatives by parameters.

Without a filter it is that of ``orbit_signal``. With a low-pass filter of gain F it is summed from its
harmonics kΩ/n, which are known in closed form,

    u_k = (2p/T) Σ o_i c_i/(ω_i² − ν_k² + 2iσ_iν_k) + (the drive's phasor at k = n),   ν_k = kΩ/n,

each times F(ν_k): the filter lets few of them pass. Their extremes are found from samples on by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.periodic.orbit_derivatives import Struck, contracted, driven, offset_of, struck
from vibeam.periodic.orbit_signal import OrbitSignal, Sampled, highest, sampled, signal_of
from vibeam.periodic.tangents import ModalData, Poles, Tangents, green_at
from vibeam_models.arrays import Array, Complex

Gain = Callable[[Array], Complex]  # of a filter, at frequencies in Hz
HARMONICS = 256  # a drive period, of a filtered displacement
STEPS = 6  # of Newton's method at an extreme of it, at most
CLOSE = 1e-9  # share of the span by which the last step moves it: the value is then known to its square


class OrbitOutput:
    """Displacement of a row over one span, from the modes' Green's functions (``orbit_signal``)."""

    def __init__(
        self, data: ModalData, tangents: Tangents, row: Array, by_row: Array, omega: Array, periods: int,
        found: Struck, gain: Gain | None,
    ) -> None:  # fmt: skip
        self.omega, self.found, self.tangents, self.gain = omega, found, tangents, gain
        self.span, self.periods = 2 * np.pi * periods / omega, periods
        self.data, self.weight = data, row * data.contact
        self.by_weight = by_row * data.contact + row * tangents.contact
        self.rest, self.by_rest = offset_of(data, tangents, row, by_row)
        self.driven = driven(data, tangents, row, by_row, omega)
        self.known = np.flatnonzero(np.isfinite(found.phase + found.impulse))

    @cached_property
    def signal(self) -> OrbitSignal:
        """Displacement after the impact, of the points with a motion."""
        data, known, found = self.data, self.known, self.found
        return signal_of(
            data.omega, data.zeta, self.weight[:, None] * found.impulse[known],
            self.driven.value[known] * np.exp(1j * found.phase[known]), self.rest, self.omega[known], self.span[known],
        )  # fmt: skip

    @cached_property
    def sampled(self) -> Sampled:
        """The signal on its grid of times."""
        return sampled(self.signal)

    def extreme(self, sign: float) -> tuple[Array, Array]:
        """Largest (sign 1) or smallest (−1) value (points,), and its derivatives (P, points); NaN without a motion."""
        value, times = np.full(len(self.omega), np.nan), np.zeros(len(self.omega))
        if len(self.known):
            value[self.known], times[self.known] = highest(self.sampled, sign)
        return sign * value, self.by(times)

    def samples(self, count: int) -> Array:
        """Displacement (points, count + 1) at even times over the span, an exponential a mode; NaN without a motion."""
        found, values = self.signal, np.full((len(self.omega), count + 1), np.nan)
        start = np.vstack([found.weights, -1j * found.drive])
        rates = np.vstack([np.broadcast_to(found.rates[:, None], found.weights.shape), 1j * found.omega])
        turns = np.concatenate(
            [start[None], np.broadcast_to(np.exp(rates * found.span / count), (count, *start.shape))]
        )
        values[self.known] = found.constant + np.cumprod(turns, axis=0).real.sum(axis=1).T
        return values

    def by(self, times: Array) -> Array:
        """Derivatives (P, points) of the displacement at constant times after the impact, one a point."""
        turn = np.exp(1j * (self.found.phase + self.omega * times))
        drive = (self.driven.by * turn + 1j * self.driven.value * turn * self.found.by_phase).imag
        poles = Poles.of(self.data.omega, self.data.zeta)
        value, by = contracted(
            green_at(poles, self.span[:, None], times[:, None]), self.weight, self.by_weight, self.tangents
        )
        return np.asarray(self.by_rest[:, None] + drive + self.found.by_impulse * value + self.found.impulse * by)


class FilteredOutput(OrbitOutput):
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

    def extreme(self, sign: float) -> tuple[Array, Array]:
        """As of ``OrbitOutput``: Newton's method from the best of samples fine enough for every harmonic."""
        count = 4 * HARMONICS * self.periods
        padded = np.concatenate([np.zeros((len(self.nu), 1)), self.phasors], axis=1) * count / 2
        values, step = sign * np.fft.irfft(np.nan_to_num(padded), n=count, axis=1), self.span / count
        start = np.argmax(values, axis=1) * step
        low, high = np.maximum(start - step, 0.0), np.minimum(start + step, self.span)
        value, times = self.at(start)[0] * sign, start
        for _ in range(STEPS):
            _, slope, bend = (sign * each for each in self.at(times))
            move = np.where(bend < 0, -slope / np.where(bend < 0, bend, 1.0), np.sign(slope) * step / 4)
            before, times = times, np.clip(times + move, low, high)
            if not np.any(np.abs(times - before) > CLOSE * self.span):
                break
        after = sign * self.at(times)[0]
        times = np.where(after >= value, times, start)
        return sign * np.maximum(after, value), self.by(times)

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Displacement, velocity and acceleration (points,) at times after the impact."""
        turned = self.phasors * np.exp(1j * self.nu * times[:, None])
        powers = (turned, turned * 1j * self.nu, -turned * self.nu**2)
        value, slope, bend = (each.real.sum(axis=1) for each in powers)
        return self.level + value, slope, bend

    def by(self, times: Array) -> Array:
        """As of ``OrbitOutput``."""
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
    kind = OrbitOutput if gain is None else FilteredOutput
    signal = kind(data, tangents, row, by_row, omega, periods, found, gain)
    if samples and gain is None:
        values, no = signal.samples(samples * periods), np.zeros_like(found.by_impulse)
        ends: tuple[Both, Both] = (values.max(axis=1), no), (values.min(axis=1), no)
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
