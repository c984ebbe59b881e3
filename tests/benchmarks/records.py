"""What a motion under a record costs, over linear stepping and over scipy's DOP853 with events, in the same run.

python tests/benchmarks/records.py

Eight modes of a cantilever (7.6 Hz to 1.7 kHz), R = 0.7, a base shaken by noise. CPU time, least of ``ROUNDS`` that
take turns; memory by tracemalloc, which sees numpy's arrays. The linear stepping is each mode's exact recursion for
lines between samples, by scipy.signal.lfilter, without a stop: no motion with one can cost less. The peer is what its
user writes: solve_ivp, DOP853, the load by np.interp, the stop as a terminal event, rtol = 1e-8.
"""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import vibeam

ROUNDS, MOST = 3, 100_000  # repeats; impacts
RATE = 10_000.0
MODES = np.arange(1, 9)
OMEGA, ZETA = 47.75 * (2.0 * MODES - 1) ** 2, np.full(8, 0.01)
CONTACT, LOAD = 2.0 * (-1.0) ** MODES, 1.5 / (2 * MODES - 1.0)
SYSTEM = vibeam.ImpactSystem.from_modes(OMEGA, ZETA, CONTACT, LOAD, gap=2e-4, restitution=0.7)


def samples(seconds: float, seed: int = 0) -> np.ndarray:
    """Acceleration of the base: noise of 5 m/s² up to about 2 kHz."""
    values = np.random.default_rng(seed).normal(size=round(seconds * RATE) + 1)
    values = lfilter([0.4], [1.0, -0.6], values)
    values *= 5.0 / values.std()
    values[0] = 0.0  # linear stepping begins at rest without a jump
    return values


def cost(work: Callable[[], Any]) -> float:
    """CPU time of all threads."""
    begun = time.process_time()
    work()
    return time.process_time() - begun


def linear(values: np.ndarray) -> np.ndarray:
    """Contact displacement without a stop at the samples: each mode's recursion for lines between them, exactly."""
    h, total = 1.0 / RATE, np.zeros(len(values))
    for w, z, c, load in zip(OMEGA, ZETA, CONTACT, LOAD, strict=True):
        damped = w * np.sqrt(1 - z * z)
        e, angle = np.exp(-z * w * h), damped * h
        a = [1.0, -2 * e * np.cos(angle), e * e]
        # Smallwood's ramp-invariant filter: its numerator is what makes the response to a ramp exact at the samples
        ramp = [_ramp(w, z, damped, k * h) for k in range(4)]
        ramped = np.convolve(a, ramp)[:4]
        b = np.convolve(ramped, [1.0, -2.0, 1.0])[1:4] / h
        total += lfilter(-load * c * b, a, values)
    return total


def _ramp(w: float, z: float, damped: float, t: float) -> float:
    late = 2 * z / w
    turn = np.exp(-z * w * t) * (late * np.cos(damped * t) + (2 * z * z - 1) / damped * np.sin(damped * t))
    return (t - late + turn) / w**2


def dop853(values: np.ndarray, end: float) -> list[float]:
    """Impacts by scipy, as its user would write it."""
    times = np.arange(len(values)) / RATE
    n, t, y, hits = len(OMEGA), 0.0, np.zeros(2 * len(OMEGA)), list[float]()

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        pull = -LOAD * np.interp(t, times, values) - 2 * ZETA * OMEGA * y[n:] - OMEGA**2 * y[:n]
        return np.concatenate([y[n:], pull])

    def stop(t: float, y: np.ndarray) -> float:
        return float(CONTACT @ y[:n] - SYSTEM.gap)

    stop.terminal, stop.direction = True, 1  # type: ignore[attr-defined]
    for _ in range(MOST):
        if t >= end:
            break
        run = solve_ivp(rate, (t, end), y, method="DOP853", rtol=1e-8, atol=1e-12, events=stop)
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        if run.status == 1:
            hits.append(t)
            y[n:] -= CONTACT * (1 + SYSTEM.restitution) * (CONTACT @ y[n:]) / (CONTACT @ CONTACT)
    return hits


def memory(work: Callable[[], Any]) -> tuple[float, float]:
    """MB at the peak, and kept by what it gives."""
    tracemalloc.start()
    kept = work()
    now, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del kept
    return peak / 1e6, now / 1e6


def long_record(seconds: float, interpolation: str = "linear") -> None:
    """A record, flown, certified and stepped."""
    values = samples(seconds)
    record = vibeam.Record.sampled(values, rate=RATE, interpolation=interpolation)
    impacts = len(vibeam.simulate(SYSTEM, record, record.end).impact_times)
    rows = np.array([
        [
            cost(lambda: vibeam.simulate(SYSTEM, record, record.end)),
            cost(lambda: vibeam.simulate(SYSTEM, record, record.end, certify=True)),
            cost(lambda: linear(values)),
        ]
        for _ in range(ROUNDS)
    ])  # fmt: skip
    flown, certified, stepped = rows.min(axis=0)
    peak, kept = memory(lambda: vibeam.simulate(SYSTEM, record, record.end))
    per, over = 1e6 * flown / len(values), flown / stepped
    print(
        f"{len(values) - 1} samples, {interpolation}, {impacts} impacts: {flown:.3f} s, {per:.2f} µs a sample", end=""
    )
    print(f", {over:.1f} times linear stepping; with a certificate {certified / flown:.2f} times", end="")
    print(f"; memory {peak:.0f} MB, {kept:.0f} MB kept (samples {values.nbytes / 1e6:.0f} MB)", flush=True)


def against_scipy(seconds: float) -> None:
    """The beginning of the record by both, and how far scipy's impacts are off."""
    values = samples(10.0)
    record = vibeam.Record.sampled(values, rate=RATE)
    true = vibeam.simulate(SYSTEM, record, seconds).impact_times
    hits, spent = np.zeros(0), []
    for _ in range(ROUNDS):
        begun = time.process_time()
        hits = np.array(dop853(values, seconds))
        peer = time.process_time() - begun
        spent.append((peer, cost(lambda: [vibeam.simulate(SYSTEM, record, seconds) for _ in range(20)]) / 20))
    peer, flown = np.min(spent, axis=0)
    alike = min(len(hits), len(true))
    off = np.abs(hits[:alike] - true[:alike]).max() if alike else np.nan
    print(f"scipy's DOP853, {seconds} s: {peer:.2f} s, {peer / flown:.0f} times flight ({1e3 * flown:.2f} ms)", end="")
    print(f"; {len(hits)} impacts of {len(true)}, off by {off:.1e} s at most", flush=True)


def batch(count: int, seconds: float) -> None:
    """Realisations by ``simulate_records`` on one and two threads, over one long record of as many samples a piece."""
    records = [vibeam.Record.sampled(samples(seconds, seed), rate=RATE) for seed in range(count)]
    one = vibeam.Record.sampled(samples(10.0), rate=RATE)
    begun, cpu = time.perf_counter(), time.process_time()
    paths = vibeam.simulate_records(SYSTEM, records, seconds, workers=1)
    alone, spent = time.perf_counter() - begun, time.process_time() - cpu
    inside = sum(path.stats["cpu_seconds"] for path in paths)
    kernel = min(cost(lambda: vibeam.simulate(SYSTEM, one, one.end)) for _ in range(ROUNDS)) / 10.0 * seconds * count
    begun = time.perf_counter()
    vibeam.simulate_records(SYSTEM, records, seconds, workers=2)
    both = time.perf_counter() - begun
    share, over = 100 * inside / spent, 100 * kernel / spent
    print(f"{count} realisations of {seconds} s: {spent:.2f} s CPU, of it {share:.0f} % flying", end="")
    print(f"; one long record of that length {kernel:.2f} s: {over:.0f} % of its speed", end="")
    print(f"; two threads {alone / both:.2f} times as fast", flush=True)


def main() -> None:
    """The lines."""
    vibeam.simulate(SYSTEM, vibeam.Record.sampled(samples(0.01), rate=RATE), 0.01)
    for interpolation in ("linear", "cubic"):
        long_record(10.0, interpolation)
    long_record(100.0)
    against_scipy(0.1)
    batch(1000, 0.5)


if __name__ == "__main__":
    main()
