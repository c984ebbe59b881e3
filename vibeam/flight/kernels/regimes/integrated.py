"""Readout of contact that is integrated, its steps made anew: poses in it, extremes, energies; for either engine."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import Watch
from vibeam.flight.kernels.readout import hull
from vibeam.flight.kernels.regimes.contact_integration import (
    BEGIN,
    END,
    EPSILON,
    MOST_STEPS,
    ROUNDS,
    Kernel,
    next_step,
)
from vibeam.flight.kernels.roots.bounds import PanelEnds
from vibeam_models.arrays import Array

FINEST = 1e-6  # share of a segment of integrated contact below which a step is taken as it is


def carrying_kernel(first_step: Kernel, step: Kernel, take: Kernel) -> Kernel:
    """The kernel that integrates anew, of an engine with these; ``at``: what else its steps need."""

    @kernel
    def carry_on(engine: Any, at: Any, clock: float, duration: float) -> None:
        """state[BEGIN] a ``duration`` later in contact, wherever that ends."""
        h, done, steps = first_step(engine, at), 0.0, 0
        while done < duration and steps < MOST_STEPS:
            h = min(h, duration - done)
            steps += 1
            wrong = step(engine, at, clock + done, h)
            if wrong > 1.0:
                h = next_step(h, wrong)
                if h < 1e-300:
                    break
                continue
            take(engine)
            done = done + h if h < duration - done else duration
            h = next_step(h, wrong)

    return carry_on


def span_kernel(first_step: Kernel, step: Kernel, take: Kernel, read: Kernel, add_energy: Kernel) -> Kernel:
    """The kernel that reads off a segment, of an engine with these; ``read``: value, rate, curvature at a state."""
    watch_step, plain = watching_kernel(step, read), plain_kernel(read)

    @kernel
    def read_span(engine: Any, at: Any, watch: Watch, contact: Array, clock: float, duration: float) -> None:
        """Extremes to round-off, energies by the steps' quadrature, from state[BEGIN] on."""
        result, reach = watch.result, watch.reading >= layout.REACH_TOO
        h, done, steps = first_step(engine, at), 0.0, 0
        while done < duration and steps < MOST_STEPS:
            h, steps = min(h, duration - done), steps + 1
            wrong = step(engine, at, clock + done, h)
            if wrong > 1.0:
                h = next_step(h, wrong)
                continue
            if h > FINEST * duration and not (
                plain(engine, watch.row, h, result[layout.LEAST], result[layout.HIGH])
                and (not reach or plain(engine, contact, h, result[layout.CONTACT_LEAST], np.inf))
            ):
                h *= 0.5
                continue
            if watch.reading >= layout.EVERYTHING:
                add_energy(engine, h, watch.energy)
            least, most = watch_step(engine, at, watch.row, clock + done, h)
            result[layout.LEAST], result[layout.HIGH] = min(result[layout.LEAST], least), max(result[layout.HIGH], most)
            if reach:
                least, _ = watch_step(engine, at, contact, clock + done, h)
                result[layout.CONTACT_LEAST] = min(result[layout.CONTACT_LEAST], least)
            take(engine)
            done = done + h if h < duration - done else duration
            h = next_step(h, wrong)
        if done < duration:
            result[layout.HIGH] = np.inf

    return read_span


def watching_kernel(step: Kernel, read: Kernel) -> Kernel:
    """The kernel of extremes in a step."""

    @kernel
    def watch_step(engine: Any, at: Any, wanted: Array, time: float, h: float) -> tuple[float, float]:
        """(least, most) of row·η over the step just made, which must be ``plain`` for that row.

        Where its rate changes sign the step is shortened by Newton's method until the rate vanishes at its end; then it
        is made anew as it was.
        """
        first, rate, _ = read(engine, wanted, BEGIN, 0)
        end, last, _ = read(engine, wanted, END, 12)
        least, most = min(first, end), max(first, end)
        if rate * last >= 0.0:
            return least, most
        low, high, t = 0.0, h, h * rate / (rate - last)
        for _ in range(ROUNDS):
            step(engine, at, time, t)
            value, slope, bend = read(engine, wanted, END, 12)
            least, most = min(least, value), max(most, value)
            if slope * slope <= EPSILON * abs(bend * value) or high - low <= EPSILON * h:
                break
            if (slope > 0.0) == (rate > 0.0):
                low = t
            else:
                high = t
            t = t - slope / bend if bend != 0.0 else 0.5 * (low + high)
            if not low < t < high:
                t = 0.5 * (low + high)
        step(engine, at, time, h)
        return least, most

    return watch_step


def plain_kernel(read: Kernel) -> Kernel:
    """The kernel of steps that are simple enough for ``watching_kernel``."""

    @kernel
    def plain(engine: Any, wanted: Array, h: float, least: float, most: float) -> bool:
        """True where the rate of row·η changes sign at most once over the step just made, or that matters nothing.

        By the signs of the Bernstein coefficients of its cubic Hermite interpolant (Descartes); it matters nothing
        where the hull of row·η itself lies well within (least, most).
        """
        p0, s0, c0 = read(engine, wanted, BEGIN, 0)
        p1, s1, c1 = read(engine, wanted, END, 12)
        low, high = hull(PanelEnds(p0, s0, p1, s1), h)
        margin = 0.25 * (high - low)
        if low - margin >= least and high + margin <= most:
            return True
        b1, b2 = s0 + h * c0 / 3.0, s1 - h * c1 / 3.0
        changes = (1 if s0 * b1 < 0.0 else 0) + (1 if b1 * b2 < 0.0 else 0) + (1 if b2 * s1 < 0.0 else 0)
        return changes <= 1

    return plain
