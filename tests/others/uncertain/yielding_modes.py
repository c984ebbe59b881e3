"""Motions of beams that meet a stop with a spring and a damper once a drive period, of many samples at once.

Contact begins where the gap closes and ends where the force k d + c d′ would pull. With the flows z ↦ P(z − z*) + z*,
z* the steady motion under the drive, in contact (c) and in flight (f), a motion whose contact begins at the drive's
phase φ and lasts s has before and after it the states

    z₁ = P_c(s) (z₀ − z_c(φ)) + z_c(φ + Ωs),    z₀ = P_f(T − s) (z₁ − z_f(φ + Ωs)) + z_f(φ),

linear in sin φ and cos φ, and so are the two conditions that are left: gap closed at z₀, no force at z₁. They give sine
and cosine, as quotients with one denominator, by the duration alone; that their squares add to 1 is one equation in s:
denominator over the root of the numerators' squares = ±1, the ``side``.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from tests.others.uncertain.plain_samples import Modes

Array = Any
SECANTS, CLOSE = 12, 1e-10  # steps, and the last of them as a share of the duration
HALVINGS = 50
CONTACT, FLIGHT = 24, 128  # instants from which the extremes are found
SQUARINGS = 12  # of the monodromy matrix: stable where its 4096th power vanishes


@dataclass(frozen=True)
class Yielding:
    """Modes of m samples, each under one drive ``omega`` rad/s, ``base`` m; stop at ``gap`` with k and c, (m,) each."""

    modes: Modes
    gap: Array
    stiffness: Array
    damping: Array
    omega: Array
    base: Array

    def at(self, which: Any, **drive: Array) -> Yielding:
        """Some of the samples, under another drive."""
        own = {each.name: getattr(self, each.name) for each in fields(self)[1:]}
        return Yielding(self.modes.at(which), **({name: row[which] for name, row in own.items()} | drive))

    def __len__(self) -> int:
        return len(self.gap)


def block(upper: Array, lower: Array) -> Array:
    """Rows (m, 2n) on displacements and velocities."""
    return np.concatenate([upper, lower], axis=1)


def times(matrix: Array, state: Array) -> Array:
    """Products (m, 2n) of matrices and states."""
    return (matrix @ state[..., None])[..., 0]


class Flow:
    """Flow z′ = A z + b + Im(f e^{iφ}) of m samples: eigenpairs of A; the steady motion is rest + Im(phasor e^{iφ})."""

    def __init__(self, rig: Yielding, stiffness: Array, damping: Array) -> None:
        modes, size = rig.modes, rig.modes.omega.shape[1]
        both, place = modes.contact[:, :, None] * modes.contact[:, None, :], np.arange(size)
        self.matrix, self.omega = np.zeros((len(rig), 2 * size, 2 * size)), rig.omega
        self.matrix[:, place, size + place] = 1.0
        self.matrix[:, size:, :size] = -stiffness[:, None, None] * both
        self.matrix[:, size:, size:] = -damping[:, None, None] * both
        self.matrix[:, size + place, place] -= modes.omega**2
        self.matrix[:, size + place, size + place] -= 2 * modes.zeta * modes.omega
        self.rates, self._vectors = np.linalg.eig(self.matrix)
        self._inverse = np.linalg.inv(self._vectors)
        still = np.zeros_like(modes.load)
        self.rest = -np.linalg.solve(
            self.matrix, block(still, modes.contact * (stiffness * rig.gap)[:, None])[..., None]
        )[..., 0]
        turning = 1j * rig.omega[:, None, None] * np.eye(2 * size) - self.matrix
        drive = block(still, modes.load * (rig.omega**2 * rig.base)[:, None]).astype(complex)
        self.phasor = np.linalg.solve(turning, drive[..., None])[..., 0]

    def over(self, time: Array) -> Array:
        """Matrices e^{At} (m, 2n, 2n)."""
        return ((self._vectors * np.exp(self.rates * time[:, None])[:, None, :]) @ self._inverse).real

    def path(self, start: Array, phase: Array, instants: Array) -> Array:
        """States (m, t, 2n) at ``instants`` (m, t) after ``start`` (m, 2n), where the drive is at a phase (m,)."""
        own = times(self._inverse, start - self.rest - (self.phasor * np.exp(1j * phase)[:, None]).imag)
        free = (own[:, None, :] * np.exp(self.rates[:, None, :] * instants[..., None])) @ self._vectors.swapaxes(1, 2)
        turned = np.exp(1j * (phase[:, None] + self.omega[:, None] * instants))
        return free.real + (self.phasor[:, None, :] * turned[..., None]).imag + self.rest[:, None, :]


class Motions:
    """Motions of a rig with one contact a period, as functions of its duration (m,)."""

    def __init__(self, rig: Yielding) -> None:
        self.rig, self.period = rig, 2 * np.pi / rig.omega
        self.contact, self.flight = Flow(rig, rig.stiffness, rig.damping), Flow(rig, 0 * rig.gap, 0 * rig.gap)
        row = rig.modes.contact
        self.reach, self.rate = block(row, 0 * row), block(0 * row, row)
        self.force = self.reach * rig.stiffness[:, None] + self.rate * rig.damping[:, None]
        self.push = rig.stiffness * rig.gap

    def _conditions(self, lasting: Array) -> tuple[Array, ...]:
        """States before and after, a + Im(p e^{iφ}) each as a, p; numerators of sine and cosine; their denominator."""
        held, free, turn = self.contact.over(lasting), self.flight.over(self.period - lasting), self._turn(lasting)
        repeated = np.eye(held.shape[1]) - free @ held
        back = np.linalg.inv(repeated)
        still = self.contact.rest - times(held, self.contact.rest)
        moving = self.contact.phasor * turn - times(held, self.contact.phasor)
        before = times(back, times(free, still))
        begun = times(back, times(free, moving - self.flight.phasor * turn) + self.flight.phasor)
        after, ended = times(held, before) + still, times(held, begun) + moving
        one, two = np.sum(self.reach * before, axis=1) - self.rig.gap, np.sum(self.force * after, axis=1) - self.push
        first, second = np.sum(self.reach * begun, axis=1), np.sum(self.force * ended, axis=1)
        sine, cosine = two * first.imag - one * second.imag, one * second.real - two * first.real
        sign = np.sign(np.linalg.det(repeated))  # all three have its determinant as denominator
        scale = first.real * second.imag - first.imag * second.real
        return before, begun, after, ended, sign * sine, sign * cosine, sign * scale

    def _turn(self, lasting: Array) -> Array:
        return np.exp(1j * self.rig.omega * lasting)[:, None]

    def quotient(self, lasting: Array) -> Array:
        """Denominator over the root of the numerators' squares (m,): ±1 for a motion."""
        *_, sine, cosine, scale = self._conditions(lasting)
        return scale / np.hypot(sine, cosine)

    def near(self, lasting: Array, side: Array) -> Array:
        """Durations (m,) of motions by the secant method from a guess; NaN where it finds none."""
        low, high = 0.999 * lasting, lasting
        under, over = self.quotient(low) - side, self.quotient(high) - side
        for _ in range(SECANTS):
            with np.errstate(all="ignore"):
                step = np.nan_to_num(over * (high - low) / (over - under), posinf=0.0, neginf=0.0)
            low, under, high = high, over, np.clip(high - np.clip(step, -high / 20, high / 20), 0, self.period)
            if np.all(np.abs(step) < CLOSE * high):
                break
            over = self.quotient(high) - side
        return np.where(np.abs(high - low) < CLOSE * high, high, np.nan)

    def between(self, low: Array, high: Array, side: float) -> Array:
        """Durations (m,) of motions between two at which the quotient is on other sides of ``side``, by bisection."""
        sign = np.sign(self.quotient(low) - side)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            same = np.sign(self.quotient(middle) - side) == sign
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return (low + high) / 2

    def watched(self, lasting: Array) -> Array:
        """½(max − min) of the output (m,), −∞ where the stop would pull or be met in flight, and of unstable ones."""
        before, begun, after, ended, sine, cosine, scale = self._conditions(np.nan_to_num(lasting, nan=1e-3))
        phase = np.arctan2(sine / scale, cosine / scale)
        turned = np.exp(1j * phase)[:, None]
        before, after = before + (begun * turned).imag, after + (ended * turned).imag
        rest = self.period - lasting
        stay = self.contact.path(before, phase, lasting[:, None] * np.linspace(0, 1, CONTACT))
        away = self.flight.path(after, phase + self.rig.omega * lasting, rest[:, None] * np.linspace(0, 1, FLIGHT))
        pushed = np.einsum("mtn,mn->mt", stay, self.force)[:, :-1] > self.push[:, None]
        past = np.einsum("mtn,mn->mt", away, self.reach) > self.rig.gap[:, None]
        again = past[:, 1:-1] & ~past[:, :-2]  # with damping the stop is still pressed in when the contact ends
        right = np.isfinite(lasting) & pushed.all(axis=1) & ~again.any(axis=1) & self._stable(before, lasting)
        paths = (stay, lasting / (CONTACT - 1)), (away, rest / (FLIGHT - 1))
        high, low = (np.fmax(*(self._extreme(sign * path, step) for path, step in paths)) for sign in (1.0, -1.0))
        return np.where(right, (high + low) / 2, -np.inf)

    def _extreme(self, path: Array, step: Array) -> Array:
        """Largest output on a path (m, t, 2n), by cubics through the values and slopes beside the highest."""
        size = path.shape[2] // 2
        shown, slope = (
            np.einsum("mtn,mn->mt", each, self.rig.modes.output) for each in (path[..., :size], path[..., size:])
        )
        top, at = np.argmax(shown, axis=1), np.arange(len(path))
        best = shown[at, top]
        for begin in (np.maximum(top - 1, 0), np.minimum(top, shown.shape[1] - 2)):
            values, slopes = ([each[at, begin], each[at, begin + 1]] for each in (shown, slope * step[:, None]))
            best = np.fmax(best, _highest(*values, *slopes))
        return best

    def _stable(self, before: Array, lasting: Array) -> Array:
        """Motions (m,) whose disturbances decay: the force of the damper begins with a jump, and none ends with one."""
        jump = (
            np.eye(before.shape[1]) - self.rig.damping[:, None, None] * self.rate[:, :, None] * self.reach[:, None, :]
        )
        power = self.flight.over(self.period - lasting) @ self.contact.over(lasting) @ jump
        power[~np.isfinite(power).all(axis=(1, 2))] = 2 * np.eye(before.shape[1])
        for _ in range(SQUARINGS):
            power = np.clip(power @ power, -1e50, 1e50)
        return (np.abs(power).max(axis=(1, 2)) < 1) & (np.sum(self.rate * before, axis=1) > 0)


def _highest(low: Array, high: Array, first: Array, last: Array) -> Array:
    """Largest value inside (0, 1) of the cubic with these values and slopes at both ends; NaN without one."""
    cubic, square = 2 * (low - high) + first + last, 3 * (high - low) - 2 * first - last
    with np.errstate(all="ignore"):
        place = first / (np.sqrt(square**2 - 3 * cubic * first) - square)  # 3 cubic x² + 2 square x + first = 0
    inside = (place > 0) & (place < 1)
    return np.where(inside, low + place * (first + place * (square + place * cubic)), np.nan)
