"""How often 95 % intervals of ``vibeam fit`` hold the truth where the measured points are of several families.

    python tests/benchmarks/fit_families.py [--sets 40]

Rigs drawn at random, of given modes and of finite elements alike. Their points come from a program of its own, which
knows neither closed-form orbits nor the flight solver: modes are carried on exactly from step to step, and a step in
which the contact passes the gap is cut by Newton's method. What is left after 300 periods from rest, one impact a
period or several, repeated or not, is read off over 32 and given normal noise of 1 %. Writes results/fit_families.json.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.curves.record import ReferenceCurve

SETTLE, HOLD = 300, 32  # drive periods

STEPS = 240  # a drive period

HALVINGS = 40

NOISE = 0.01

REPEATS = 1e-4  # share of a motion's size

EXAMPLES = (4, 13, 37)  # sets that are written with their points, for tests

MODES_RIG = """
units = "SI"
[modes]
frequency = ["{first} Hz", "{second} Hz", "{third} Hz"]
damping_ratio = {zeta}
modal_mass = "1 kg"
contact = [1.1, {row}, -0.4]
sensor = [0.8, -0.5, 0.3]
base = [0.9, 0.4, 0.2]
"""

BEAM_RIG = """
units = "SI"
[beam]
length = "200 mm"
width = "15 mm"
thickness = "{thickness} m"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = {zeta}
[mass]
mass = "0.12 kg"
position = "150 mm"
[sensor]
position = "110 mm"
"""

REST = """
[stop]
gap = "{gap} m"
restitution = {restitution}
[drive]
amplitude = "{amplitude} m"
[sweep]
frequency = {{ from = "{low} Hz", to = "{high} Hz", points = 21 }}
direction = "up"
settle = 300
hold = 20
[fidelity.model]
{reduction}
"""


class Record(NamedTuple):
    """Amplitude of the sensor over the hold, impacts in it, and drive periods until it repeats (0: not in 16)."""

    amplitude: np.ndarray
    impacts: np.ndarray
    period: np.ndarray

    @property
    def other(self) -> np.ndarray:
        """Whether the motion has contact, but not one impact a period."""
        return ((self.period != 1) | (self.impacts != HOLD)) & (self.impacts > 0)


def records(system: vibeam.ImpactSystem, omega: np.ndarray, amplitude: float, settle: int = SETTLE) -> Record:
    """Steady motions from rest of a system with underdamped modes, at all drives (points,) rad/s side by side."""
    own, zeta = system.omega, system.zeta
    phasor = amplitude * system.load * omega[:, None] ** 2 / (
        own**2 - omega[:, None] ** 2 + 2j * zeta * own * omega[:, None]
    )  # fmt: skip
    damped, decay = own * np.sqrt(1 - zeta**2), zeta * own

    def carried(x: np.ndarray, v: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Free part of the modes after a time (points, 1)."""
        c, s, e = np.cos(damped * time), np.sin(damped * time), np.exp(-decay * time)
        return (
            e * (x * c + (v + decay * x) / damped * s), e * (v * c - (decay * v + own**2 * x) / damped * s)
        )  # fmt: skip

    def forced(time: np.ndarray, which: Any = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        turned = phasor[which] * np.exp(1j * omega[which] * time)[:, None]
        return turned.imag, (1j * omega[which][:, None] * turned).imag

    step = 2 * np.pi / omega / STEPS
    shape = (len(omega), len(own))
    start = forced(np.zeros(len(omega)))
    x, v = np.zeros(shape) - start[0], np.zeros(shape) - start[1]
    row = system.outputs["sensor"]
    highest, lowest = np.full(len(omega), -np.inf), np.full(len(omega), np.inf)
    strobes: list[np.ndarray] = []
    counts = np.zeros((HOLD, len(omega)), dtype=int)
    whole = np.ones(shape), np.zeros(shape)
    by_place, by_speed = carried(*whole, step[:, None]), carried(*whole[::-1], step[:, None])
    for number in range((settle + HOLD) * STEPS):
        time = number * step
        after = x * by_place[0] + v * by_speed[0], x * by_place[1] + v * by_speed[1]
        there = forced(time + step)
        beyond = np.flatnonzero((after[0] + there[0]) @ system.contact > system.gap)
        for j in beyond.tolist():
            one = slice(j, j + 1)
            left, state, at = float(step[j]), (x[one], v[one]), float(time[j])
            for _ in range(20):  # impacts in a step
                low, high = 0.0, left
                end = carried(*state, np.array([[left]]))[0] + forced(np.array([at + left]), one)[0]
                if (end @ system.contact)[0] <= system.gap:
                    break
                time_of = low
                for _ in range(HALVINGS):  # Newton's method, by halves where it leaves the step
                    place, speed = carried(*state, np.array([[time_of]]))
                    ahead = forced(np.array([at + time_of]), one)
                    over = float(((place + ahead[0]) @ system.contact)[0]) - system.gap
                    slope = float(((speed + ahead[1]) @ system.contact)[0])
                    low, high = (low, time_of) if over > 0 else (time_of, high)
                    further = time_of - over / slope if slope > 0 else np.inf
                    further = further if low < further < high else (low + high) / 2
                    if abs(further - time_of) < 1e-13 * left:
                        break
                    time_of = further
                low = max(time_of - 1e-12 * float(step[j]), 0.0)  # just before the gap
                struck = carried(*state, np.array([[low]]))
                speed = ((struck[1] + forced(np.array([at + low]), one)[1]) @ system.contact)[0]
                if speed <= 0:
                    break
                push = -(1 + system.restitution) * speed / (system.contact @ system.contact)
                state, at, left = (struck[0], struck[1] + push * system.contact), at + low, left - low
                if number >= settle * STEPS:
                    counts[number // STEPS - settle, j] += 1
                    here = float(((state[0] + forced(np.array([at]), one)[0]) @ row)[0])
                    highest[j], lowest[j] = max(highest[j], here), min(lowest[j], here)
            final = carried(*state, np.array([[left]]))
            after[0][one], after[1][one] = final
        x, v = after
        if number >= settle * STEPS:
            value = (x + there[0]) @ row
            highest, lowest = np.maximum(highest, value), np.minimum(lowest, value)
            if (number + 1) % STEPS == 0:
                strobes.append(x + there[0])
    return Record((highest - lowest) / 2, counts.sum(axis=0), _periods(np.array(strobes)))


def _periods(strobes: np.ndarray) -> np.ndarray:
    """Least number of periods after which strobes (periods, points, modes) repeat, 0 where none does."""
    size, found = np.abs(strobes[-17:]).max(axis=(0, 2)), np.zeros(strobes.shape[1], dtype=int)
    for period in range(16, 0, -1):
        off = np.abs(strobes[-1] - strobes[-1 - period]).max(axis=1)
        found = np.where(off < REPEATS * size, period, found)
    return found


def drawn(rng: np.random.Generator, kind: str) -> tuple[str, dict[str, float], dict[str, tuple[float, float]]]:
    """Text of a case at its true values, these of the estimated keys, and their bounds."""
    restitution, zeta = rng.uniform(0.5, 0.85), rng.uniform(0.008, 0.03)
    amplitude, gap = rng.uniform(0.8e-4, 2e-4), rng.uniform(-1.0, 1.5) * 1e-4
    low = rng.uniform(13.0, 20.0)
    values = {"zeta": zeta, "restitution": restitution, "gap": gap, "amplitude": amplitude, "low": low}
    truth = {"stop.restitution": restitution, "stop.gap": gap}
    bounds = {"stop.restitution": (0.3, 0.95), "stop.gap": (gap - 2e-4, gap + 2.4e-4)}
    if kind == "modes":
        values |= {"first": rng.uniform(10.0, 13.0), "second": rng.uniform(50, 80), "third": rng.uniform(150, 210)}
        values |= {"row": rng.uniform(0.3, 0.9)}
        text, reduction = MODES_RIG, 'reduction = "full"'
        truth["drive.amplitude"], bounds["drive.amplitude"] = amplitude, (0.4 * amplitude, 2.2 * amplitude)
    else:
        values |= {"thickness": rng.uniform(0.9e-3, 1.05e-3)}
        text, reduction = BEAM_RIG, 'reduction = "modal"\nmodes = 3'
        truth["beam.thickness"] = values["thickness"]
        bounds["beam.thickness"] = (0.96 * values["thickness"], 1.05 * values["thickness"])
    made = (text + REST).format(**values, high=low + rng.uniform(3.0, 6.0), reduction=reduction)
    return made, truth, bounds


class Measured(NamedTuple):
    """A set: text of its case at the true values, these, bounds and starts of the keys, noisy and exact points."""

    text: str
    truth: dict[str, float]
    bounds: dict[str, tuple[float, float]]
    start: dict[str, float]
    frequency: np.ndarray
    noisy: np.ndarray
    exact: Record

    def case(self) -> vibeam.Case:
        """The case to be fitted: it starts off the truth."""
        keys = ", ".join(f'"{key}" = [{low!r}, {high!r}]' for key, (low, high) in self.bounds.items())
        made = parse(self.text, set=self.start | {"fit.keys": "{" + keys + "}"})
        curve = ReferenceCurve.of(self.frequency, self.noisy, uncertainty=NOISE * self.exact.amplitude)
        assert made.fit is not None
        made = replace(made, fit=replace(made.fit, references=("record",)))
        return made.with_reference("record", curve, "model")


def _mixed(period: np.ndarray, impacts: np.ndarray) -> bool:
    """Whether enough points have one impact a period, some have several, few do not repeat, and none chatters."""
    struck = (period == 1) & (impacts == 1)
    other = (impacts > 0) & ~struck
    return bool(struck.sum() >= 8 and other.sum() >= 2 and (period == 0).sum() <= 3 and (impacts <= 6).all())


def measured(seed: int, kind: str) -> Measured:
    """A set whose points are mixed: drawn until they are."""
    rng = np.random.default_rng(seed)
    while True:
        text, truth, bounds = drawn(rng, kind)
        case = parse(text)
        system, omega = case.system("model"), 2 * np.pi * np.sort(case.sweep.frequency)
        if not 0.4 < omega[0] / system.omega[0] < 3:
            continue
        looked = vibeam.batch(system, omega, float(case.base_amplitude), settle=SETTLE, hold=HOLD)
        if not _mixed(looked.period, looked.impacts_per_period):
            continue
        exact = records(system, omega, float(case.base_amplitude))
        if _mixed(exact.period, exact.impacts / HOLD):
            break
    noisy = exact.amplitude * (1 + NOISE * rng.standard_normal(len(omega)))
    start = {key: float(rng.uniform(*bounds[key])) for key in truth}
    return Measured(text, truth, bounds, start, omega / (2 * np.pi), noisy, exact)


def trial(seed: int, kind: str) -> dict[str, Any]:
    """What a fit of one set says of the truth."""
    given = measured(seed, kind)
    case, truth, exact = given.case(), given.truth, given.exact
    begin = process_time()
    study = vibeam.fit(case)
    seconds = process_time() - begin
    rows = {row.key: row for row in study.rows}
    return {
        "seed": seed, "rig": kind, "points": len(exact.impacts), "of_other_families": int(np.sum(exact.other)),
        "left_out": int(np.sum(~study.minimum.used)), "described": study.judgement.described,
        "withheld": study.judgement.withheld, "outliers": len(study.judgement.outliers),
        "held": [key for key, value in truth.items() if rows[key].low <= value <= rows[key].high],
        "errors": {key: (rows[key].value - value) / (rows[key].high - rows[key].low) for key, value in truth.items()},
        "misfit": study.misfit, "freedom": study.minimum.freedom, "cpu_seconds": seconds,
        "set": given._replace(exact=given.exact.amplitude)._asdict() if seed in EXAMPLES else None,
    }  # fmt: skip


def main() -> None:
    """Run all sets and write the results."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    chosen = parser.parse_args()
    found = []
    for seed in range(chosen.first, chosen.first + chosen.sets):
        found.append(trial(seed, "modes" if seed % 2 else "beam"))
        print({key: each for key, each in found[-1].items() if key != "set"}, flush=True)
    held, total = sum(len(each["held"]) for each in found), sum(len(each["errors"]) for each in found)
    seconds = [each["cpu_seconds"] for each in found]
    summary = {"intervals": total, "held": held, "cpu_seconds_median": float(np.median(seconds)), "most": max(seconds)}
    print(summary)
    path = Path(__file__).parent / "results" / "fit_families.json"
    told = {"summary": summary, "sets": found}
    path.write_text(json.dumps(told, indent=1, default=lambda each: each.tolist()) + "\n")


if __name__ == "__main__":
    main()
