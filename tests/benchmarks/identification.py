"""Coverage of the 95 % intervals of linear identification: 100 seeded synthetic sets in each of six scenarios.

    python tests/benchmarks/identification.py    # writes results/identification.json; about 3 min of CPU time

The truth of each set is known by construction: closed forms of one mode, and the finite-element model of the DTU rig.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.studies.fit.linear_estimates import Identification

RESULTS = Path(__file__).parent / "results" / "identification.json"
CASE = Path(__file__).parents[2] / "cases" / "synthetic" / "modes.toml"
SETS = 100
FREQUENCY, RATIO, GAIN = 7.6, 0.017, 1.5e-3
TRUE_KEYS = {"beam.thickness": 1.034e-3, "mass.rotary_inertia": 2.988e-5, "mass.rigid_half_width": 11.7e-3}

Random = np.random.Generator


def motion(time: Any) -> Any:
    """A decay from a displacement and a velocity."""
    omega = 2 * np.pi * FREQUENCY
    return np.exp(-RATIO * omega * time) * np.cos(omega * np.sqrt(1 - RATIO**2) * time + 0.4)


def curve(frequency: Any, power: int = 2) -> Any:
    """Response to a base displacement (power 2) or a force (0), with the gain."""
    r = frequency / FREQUENCY
    return GAIN * r**power / np.hypot(1 - r**2, 2 * RATIO * r)


def decay(random: Random) -> Identification:
    """4 s at 250 Hz, noise of 3 % of the release, an offset."""
    time = np.arange(0, 4, 1 / 250)
    return vibeam.identify_decay(time, motion(time) + 0.02 + 0.03 * random.standard_normal(len(time)))


def spectrum(random: Random) -> Identification:
    """Spectrum of 8 s at 250 Hz, noise of 5 % in time, 5 to 11 Hz."""
    time = np.arange(0, 8, 1 / 250)
    signal = motion(time) + 0.05 * random.standard_normal(len(time))
    lines = np.fft.rfftfreq(len(time), 1 / 250)
    shown = (lines > 5) & (lines < 11)
    return vibeam.identify_spectrum(lines[shown], np.abs(np.fft.rfft(signal))[shown] / 250)


def response(random: Random) -> Identification:
    """40 points, noise that grows with the amplitude and is not known."""
    frequency = np.linspace(7.0, 8.3, 40)
    exact = curve(frequency)
    noise = 0.02 * exact.max() * (0.2 + exact / exact.max()) * random.standard_normal(40)
    return vibeam.identify_response(frequency, exact + noise)


def known(random: Random) -> Identification:
    """40 points with known uncertainties of 2 %."""
    frequency = np.linspace(7.0, 8.3, 40)
    exact = curve(frequency)
    return vibeam.identify_response(
        frequency, exact * (1 + 0.02 * random.standard_normal(40)), uncertainty=0.02 * exact
    )


def force(random: Random) -> Identification:
    """60 points over a wide band of the response to a force, equal noise that is not known, drive of 0.6."""
    frequency = np.linspace(4.0, 11.0, 60)
    exact = 0.6 * curve(frequency, 0)
    amplitude = np.abs(exact + 0.01 * exact.max() * random.standard_normal(60))
    return vibeam.identify_response(frequency, amplitude, drive="force", level=0.6)


def modal(random: Random) -> Identification:
    """Thickness, inertia and rigid zone from five modal frequencies with noise of 0.1 %."""
    case = vibeam.load(CASE, set={"units": "SI"} | TRUE_KEYS)
    exact = [row.frequency for row in vibeam.modes(case, 5).rows]
    found = {
        name: replace(each, value=f * (1 + 1e-3 * random.standard_normal()), uncertainty=1e-3 * f)
        for f, (name, each) in zip(exact, case.measured.items(), strict=True)
    }
    return vibeam.identify_keys(replace(case, measured=found), list(TRUE_KEYS))


TRUTHS = (FREQUENCY, RATIO, GAIN)

SCENARIOS: dict[str, tuple[Callable[[Random], Identification], tuple[float, ...]]] = {
    "decay": (decay, TRUTHS[:2]),
    "spectrum": (spectrum, TRUTHS[:2]),
    "response, noise unknown": (response, TRUTHS),
    "response, noise known": (known, TRUTHS),
    "response to a force": (force, TRUTHS),
    "modal frequencies": (modal, tuple(TRUE_KEYS.values())),
}


def covered(name: str, seeds: range) -> dict[str, int]:
    """For each parameter of a scenario the number of sets whose interval holds the truth."""
    make, truths = SCENARIOS[name]
    counts: dict[str, int] = {}
    for seed in seeds:
        for row, truth in zip(make(np.random.default_rng(seed)).rows, truths, strict=True):
            counts[row.name] = counts.get(row.name, 0) + int(row.low <= truth <= row.high)
    return counts


if __name__ == "__main__":
    found = {name: covered(name, range(SETS)) for name in SCENARIOS}
    RESULTS.write_text(json.dumps({"sets": SETS, "covered": found}, indent=1) + "\n", encoding="utf-8")
    print(RESULTS.read_text(encoding="utf-8"))
