"""Decays in records that have more than them: found and cut out, with their truth; what is none is refused.

Records are sums of e^(−ζωt) cos(ω√(1−ζ²) t + φ) from an instant on, sampled at 500 Hz.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import vibeam

FREQUENCY, RATIO = 7.0, 0.02
TIME = np.arange(0, 3.2, 1 / 500)


def free(start: float = 0.0, phase: float = 0.0, frequency: float = FREQUENCY, ratio: float = RATIO) -> np.ndarray:
    """Motion from ``start`` on, 0 before."""
    omega, since = 2 * np.pi * frequency, np.maximum(TIME - start, 0.0)
    return np.where(
        start - 1e-12 <= TIME,
        np.exp(-ratio * omega * since) * np.cos(omega * np.sqrt(1 - ratio**2) * since + phase),
        0.0,
    )


def before(start: float, motion: np.ndarray | float) -> np.ndarray:
    return np.where(start - 1e-12 > TIME, motion, 0.0)


#: record, where the decay begins and ends in s, words about what is cut
RECORDS: dict[str, tuple[Callable[[], np.ndarray], float, float, str]] = {
    "whole": (free, 0.0, 3.2, ""),
    "0.2 s at rest": (lambda: free(0.2), 0.2, 3.2, "before it is rest, or another motion"),
    "1 s at rest": (lambda: free(1.0), 1.0, 3.2, "before it is rest, or another motion"),
    "10 samples at rest": (lambda: free(0.02), 0.02, 3.2, "before it is rest, or another motion"),
    "struck": (lambda: free(1.0, -np.pi / 2), 1.0, 3.2, "before it is rest, or another motion"),
    "held": (lambda: free(0.6) + before(0.6, 1.0), 0.6, 3.2, "before it is rest, or another motion"),
    "driven at 5 Hz": (
        lambda: free(1.0) + before(1.0, np.cos(10 * np.pi * (TIME - 1))),
        1.0,
        3.2,
        "before it is rest, or another motion",
    ),
    "driven a little": (
        lambda: free(1.0) + before(1.0, 0.3 * np.cos(22 * np.pi * TIME)),
        1.0,
        3.2,
        "before it is rest, or another motion",
    ),
    "a pulse": (
        lambda: free(0.5) + 5 * np.exp(-(((TIME - 0.47) / 0.006) ** 2)),
        0.5,
        3.2,
        "before it is rest, or another motion",
    ),
    "an equal event": (lambda: free() + free(1.5), 0.0, 1.5, "another event follows: it is cut"),
    "a small event": (lambda: free() + 0.3 * free(1.2, -1.5), 0.0, 1.2, "another event follows: it is cut"),
    "rest and event": (lambda: free(0.4) + 0.4 * free(2.0, -1.5), 0.4, 2.0, "another event follows: it is cut"),
}


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("name", RECORDS)
def test_the_free_part_is_found_and_what_is_cut_is_said(name: str, noise: float) -> None:
    made, start, end, said = RECORDS[name]
    found = vibeam.identify_decay(TIME - 0.2, made() + noise * np.random.default_rng(1).standard_normal(len(TIME)))
    frequency, ratio = found.rows
    assert frequency.value == pytest.approx(FREQUENCY, rel=1e-9 if not noise else 3e-4, abs=2e-4)
    assert ratio.value == pytest.approx(RATIO, rel=0.012)
    assert found.stretch is not None
    assert np.array(found.stretch) + 0.2 == pytest.approx([start, end], abs=0.05)
    assert said in "; ".join(found.notes)


def test_samples_that_are_cut_off_are_left_out() -> None:
    shown = np.clip(free() + 0.01 * np.random.default_rng(0).standard_normal(len(TIME)), -0.5, 0.6)
    found = vibeam.identify_decay(TIME, shown)
    assert found["damping ratio"].value == pytest.approx(RATIO, rel=0.01)
    assert any("samples cut off at an end of the range: left out" in note for note in found.notes)
    with pytest.raises(ValueError, match="cut off at an end of the range: lower the gain"):
        vibeam.identify_decay(TIME, np.clip(free(ratio=1e-3), -0.1, 0.1))


@pytest.mark.parametrize(("other", "noise"), [(7.4, 0.01), (7.2, 0.0), (19.0, 0.01)])
def test_two_modes_are_two(other: float, noise: float) -> None:
    shown = free() + 0.7 * free(frequency=other) + noise * np.random.default_rng(0).standard_normal(len(TIME))
    found = vibeam.identify_decay(TIME, shown)
    assert [row.name for row in found.rows][::2] == ["natural frequency 1", "natural frequency 2"]
    assert [row.value for row in found.rows] == pytest.approx([7.0, 0.02, other, 0.02], rel=0.01 if noise else 1e-6)


def test_a_tone_beside_a_decay_is_no_part_of_it() -> None:
    """Of a steady tone the damping is as good as 0."""
    found = vibeam.identify_decay(TIME, free() + 0.2 * np.cos(100 * np.pi * TIME))
    assert [row.value for row in found.rows[:3]] == pytest.approx([7.0, 0.02, 50.0], rel=1e-6)


def test_what_is_no_decay_is_refused() -> None:
    grown = free()[::-1]
    steady = np.cos(2 * np.pi * 7 * TIME) + np.cos(2 * np.pi * 11 * TIME**2)
    for shown in (grown, steady, np.random.default_rng(0).standard_normal(len(TIME))):
        with pytest.raises(ValueError, match=r"not a free decay|does not decay"):
            vibeam.identify_decay(TIME, shown)


@pytest.mark.parametrize("start", [0.0, 0.3])
def test_intervals_hold_in_a_few_sets(start: float) -> None:
    """At least 15 of 20: fewer have a probability of 0.03 % where 95 % hold."""
    counts = np.zeros(2, dtype=int)
    for seed in range(20):
        shown = free(start)[::4] + 0.01 * np.random.default_rng(seed).standard_normal(len(TIME[::4]))
        rows = vibeam.identify_decay(TIME[::4], shown).rows
        counts += [row.low <= truth <= row.high for row, truth in zip(rows, (FREQUENCY, RATIO), strict=True)]
    assert counts.min() >= 15
