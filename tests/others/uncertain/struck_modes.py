"""Peaks over drive frequencies of beams that meet a rigid stop once a drive period, of many samples at once.

A mode struck once a period T by the impulse p answers, with λ = −ζω + iω_d, by p c Im(e^{λτ}/(1 − e^{λT}))/ω_d at the
time τ after it (the sum of its answers to all earlier impulses, a geometric series), and to the drive by
Im(D e^{iψ} e^{iΩτ}). Contact at the gap Δ and Newton's law v⁺ = −R v⁻, that is p S = −(1 + R) v⁻ with S = Σ c², are

    Im(H e^{iψ}) = Δ − p G₀,    Ω Re(H e^{iψ}) = p κ,    κ = R S/(1 + R) − G₁,    H = Σ c D,

G₀ and G₁ the contact's displacement and velocity just after the impact for p = 1. The sum of their squares is a
quadratic in p. The motion of a sweep is the root of the larger impulse, where the contact stays clear of the stop in
between and the linearised motion decays from impact to impact (with the saltation matrix of the impact).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.others.uncertain.plain_samples import Modes

Array = Any
TOGETHER = 500  # samples computed at once, which stay in the processor's cache
COARSE = (1,) * 24  # steps of a period, of equal parts: to choose frequencies by
FINE = (1,) * 256 + (2,) * 128 + (4,) * 128 + (8,) * 128 + (16,) * 128  # to find extremes by: fast modes ring at first
HIGHEST = 3  # frequencies that are looked at closely
SQUARINGS = 12  # of the monodromy matrix: stable where its 4096th power vanishes


def struck_peaks(modes: Modes, gap: Array, restitution: Array, omega: Array, base: Array) -> Array:
    """Peaks (m,) at ``omega`` (k,) rad/s, ``base`` (m, k) m, with ``gap`` and ``restitution`` (m,); NaN without one."""
    found = np.empty(len(gap))
    for first in range(0, len(found), TOGETHER):
        part = slice(first, first + TOGETHER)
        rig = Struck(modes.at(part), gap[part], restitution[part])
        heights = rig.orbits(np.broadcast_to(omega, base[part].shape), base[part]).swing()
        best = np.full(len(heights), np.nan)
        for place in np.argsort(-np.nan_to_num(heights), axis=1)[:, :HIGHEST].T:
            at = (np.arange(len(place)), place)
            orbits = rig.orbits(omega[place][:, None], base[part][at][:, None])
            clear, amplitude = orbits.watched()
            best = np.fmax(best, np.where(clear & orbits.stable(), amplitude, np.nan))
        found[part] = best
    return found


@dataclass(frozen=True)
class Struck:
    """Modes of m samples with their stop."""

    modes: Modes
    gap: Array
    restitution: Array

    def orbits(self, omega: Array, base: Array) -> Orbits:
        """Motions of the larger impulse at drives (m, k): NaN where there is none."""
        w, zeta, contact = (row[:, None] for row in (self.modes.omega, self.modes.zeta, self.modes.contact))
        drive, turns = omega[..., None], w * np.sqrt(1 - zeta**2)
        rates = -zeta * w + 1j * turns
        kernel = contact / (turns * (1 - np.exp(rates * (2 * np.pi / drive))))
        steady = self.modes.load[:, None] * drive**2 * base[..., None] / (w**2 - drive**2 + 2j * zeta * w * drive)
        reach, mobility = np.sum(contact * steady, axis=2), np.sum(contact**2, axis=2)
        g0, g1 = np.sum(contact * kernel.imag, axis=2), np.sum(contact * (rates * kernel).imag, axis=2)
        gap, restitution = self.gap[:, None], self.restitution[:, None]
        slope = (mobility * restitution / (1 + restitution) - g1) / omega
        a, b, c = g0**2 + slope**2, -gap * g0, gap**2 - np.abs(reach) ** 2
        with np.errstate(invalid="ignore"):
            impulse = -(b + np.sqrt(b * b - a * c)) / a
            impulse = np.where(impulse < 0, impulse, np.nan)
        turned = (impulse * slope + 1j * (gap - impulse * g0)) / reach
        return Orbits(self, omega, rates, kernel * impulse[..., None], steady * turned[..., None], impulse)


@dataclass(frozen=True)
class Orbits:
    """Motions of m samples at k drives: η(τ) = Im(``struck`` e^{λτ} + ``driven`` e^{iΩτ}), (m, k, n); λ: ``rates``."""

    rig: Struck
    omega: Array
    rates: Array
    struck: Array
    driven: Array
    impulse: Array

    def _steps(self, parts: tuple[int, ...]) -> Iterator[Array]:
        """Modes (m, k, n) from just after the impact on, at the beginning of each part of the period."""
        period = 2 * np.pi / self.omega[..., None]
        struck, driven, step = self.struck, self.driven, 0
        for part in parts:
            yield struck.imag + driven.imag
            if part != step:
                share, step = part / sum(parts), part
                decay, turn = np.exp(self.rates * (period * share)), np.exp(2j * np.pi * share)
            struck, driven = struck * decay, driven * turn

    def swing(self) -> Array:
        """Half of what the output covers at coarse instants (m, k)."""
        shown = np.stack([np.einsum("mkn,mn->mk", each, self.rig.modes.output) for each in self._steps(COARSE)])
        return np.ptp(shown, axis=0) / 2

    def watched(self) -> tuple[Array, Array]:
        """Of the first drive (m,): test whether the contact keeps clear between impacts; ½(max − min) of the output."""
        rows = np.stack([self.rig.modes.contact, self.rig.modes.output], axis=2)
        reach, shown = np.stack([(each @ rows)[:, 0] for each in self._steps(FINE)], axis=2).transpose(1, 2, 0)
        clear = np.all(reach[1:] < self.rig.gap, axis=0)
        return clear, (self._extreme(shown, 1.0) - self._extreme(shown, -1.0)) / 2

    def _extreme(self, shown: Array, sign: float) -> Array:
        """Largest or smallest output: Newton's method from the highest instant, unless that is the impact itself."""
        instants = np.cumsum([0, *FINE]) / sum(FINE)
        top, period = np.argmax(sign * shown, axis=0), 2 * np.pi / self.omega[:, 0]
        low, time, high = (instants[np.maximum(top + each, 0)] * period for each in (-1, 0, 1))
        for _ in range(3):
            first, second = (self._output(time, order) for order in (1, 2))
            time = np.clip(time - first / second, low, high)
        return sign * np.fmax(sign * self._output(time, 0), sign * np.take_along_axis(shown, top[None], axis=0)[0])

    def _output(self, time: Array, order: int) -> Array:
        return np.sum(self.rig.modes.output * self._derivative(time, order), axis=1)

    def _derivative(self, time: Array, order: int) -> Array:
        """Modes' displacement, velocity or acceleration (m, n) at a time after the impact (m,) of the first drive."""
        at, drive = time[:, None], 1j * self.omega[:, :1]
        struck = self.struck[:, 0] * self.rates[:, 0] ** order * np.exp(self.rates[:, 0] * at)
        return (struck + self.driven[:, 0] * drive**order * np.exp(drive * at)).imag

    def stable(self) -> Array:
        """Motions of the first drive (m,) whose disturbances decay."""
        power = self._monodromy()
        power = np.where(np.isfinite(power).all(axis=(1, 2))[:, None, None], power, 2 * np.eye(power.shape[1]))
        for _ in range(SQUARINGS):
            power = np.clip(power @ power, -1e50, 1e50)
        return np.abs(power).max(axis=(1, 2)) < 1

    def _monodromy(self) -> Array:
        """Matrix (m, 2n, 2n) of a disturbance from before one impact to before the next one."""
        modes, period = self.rig.modes, 2 * np.pi / self.omega[:, 0]
        contact, size = modes.contact, modes.contact.shape[1]
        after, rates = self._derivative(np.zeros(len(period)), 1), self.rates[:, 0]
        given = contact * self.impulse[:, :1]  # what the impact adds to the modes' velocities
        turned = 2 * modes.zeta * modes.omega * given  # and takes from their accelerations
        speed = np.sum(contact * (after - given), axis=1)
        jump = np.tile(np.eye(2 * size), (len(period), 1, 1))
        share = (1 + self.rig.restitution) / np.sum(contact**2, axis=1)
        jump[:, size:, size:] -= share[:, None, None] * contact[:, :, None] * contact[:, None, :]
        # what is met earlier by δt leaves with the later flow: f⁺ − J f⁻ along the contact, over its speed
        before = np.concatenate([after - given, self._before(given, turned)], axis=1)
        flow = np.concatenate([after, self._derivative(np.zeros(len(period)), 2)], axis=1)
        late = (flow - np.einsum("mij,mj->mi", jump, before)) / speed[:, None]
        jump[:, :, :size] += late[:, :, None] * contact[:, None, :]
        return _free(rates, period) @ jump

    def _before(self, given: Array, turned: Array) -> Array:
        """Accelerations just before the impact: those after it, without what its velocities are damped by."""
        return self._derivative(np.zeros(len(given)), 2) + turned


def _free(rates: Array, period: Array) -> Array:
    """Free motion of every mode over a period, (m, 2n, 2n)."""
    sigma, turns, size = -rates.real, rates.imag, rates.shape[1]
    decay, angle = np.exp(-sigma * period[:, None]), turns * period[:, None]
    sine, cosine = decay * np.sin(angle) / turns, decay * np.cos(angle)
    found = np.zeros((len(period), 2 * size, 2 * size))
    place = np.arange(size)
    found[:, place, place], found[:, place, size + place] = cosine + sigma * sine, sine
    found[:, size + place, place] = -(sigma**2 + turns**2) * sine
    found[:, size + place, size + place] = cosine - sigma * sine
    return found
