"""Elastic bars that strike with their ends, as modes: longitudinal waves in free and in clamped bars.

A contact holds there without restitution: the bar itself throws back what strikes it. The modes of a bar are no bar:
the first impact takes S⁻¹v²/2 of the energy, S = Σ contact², an error like 1/N of N modes. Numbers of N and of 2N modes
are extrapolated to N → ∞.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import vibeam
from tests.others.systems import STILL, modes, motion
from vibeam_models.arrays import Array


def extrapolated(numbers: Callable[[int], Array], count: int = 40) -> Array:
    """Numbers of ``count`` and twice as many modes, their 1/N taken away."""
    return 2 * np.asarray(numbers(2 * count)) - np.asarray(numbers(count))


def bar(count: int, length: float, wave_speed: float, mass: float, gravity: float = 0.0) -> vibeam.ImpactSystem:
    """The lowest modes of a free elastic bar that hits with one end; R = 0 there: the bar itself throws it back."""
    k = np.arange(count)
    contact = np.where(k == 0, 1.0, np.sqrt(2.0)) / np.sqrt(mass)
    rigid = np.eye(1, count)[0]
    return modes(
        k * np.pi * wave_speed / length, 0.0, contact, 0.0, restitution=0.0, static=gravity * np.sqrt(mass) * rigid,
        outputs={"middle": rigid / np.sqrt(mass), "far": contact * (-1.0) ** k},
    )  # fmt: skip


def falling_bar(count: int) -> Array:
    """First contact, its end, speed of the centre at 1.7 s, second contact, its end, height of the centre at 16/3 s."""
    rigid = np.eye(1, count)[0]
    path = motion(bar(count, 10.0, 30.0, 10.0, 10.0), 16 / 3, -5 * np.sqrt(10.0) * rigid, 0 * rigid)
    (first, over), (again, last) = path.rests[0], path.rests[-1]
    return np.array([first, over, -path.velocity_at(1.7, "middle"), again, last, -path.at(16 / 3, "middle")])


def steel_bar(count: int) -> Array:
    """Siconos' bar: first contact, duration of all, speed of its centre after it over that before."""
    rigid, mass, speed = np.eye(1, count)[0], 7800 * 3.14e-4, np.sqrt(210e9 / 7800)
    path = motion(bar(count, 1.0, speed, mass), 1.5e-3, -5e-5 * np.sqrt(mass) * rigid, 0.1 * np.sqrt(mass) * rigid)
    begun = path.rests[0, 0]
    return np.array([begun, path.rests[-1, 1] - begun, -path.velocity_at(1.5e-3, "middle") / 0.1])


def bar_on_wall(count: int) -> Array:
    """SDNV100: places of both ends of a bar at 100 m/s, 2 mm from a wall, at the printed times; velocity after it."""
    rigid, mass = np.eye(1, count)[0], 8000 * 0.2 * 0.02**2
    path = motion(bar(count, 0.2, 5000.0, mass), 1.4e-4, -2e-3 * np.sqrt(mass) * rigid, 100 * np.sqrt(mass) * rigid)
    near = [-2e-3 - path.at(time, "contact") for time in (2e-5, 1e-4)]
    far = [-2e-3 - path.at(time, "far") for time in (2e-5, 4e-5)]
    return np.array([*near, *far, -path.velocity_at(1.2e-4, "middle")])


def two_bars(count: int) -> Array:
    """SDNL111: place of the struck end after 0.2, 0.4 … 1 ms; a free bar at 1 m/s meets one that is clamped behind."""
    speed, mass = np.sqrt(2e11 / 7800), 7800 * 0.02**2
    k = np.arange(count)
    free = np.where(k == 0, 1.0, np.sqrt(2.0)) / np.sqrt(mass)
    clamped = np.full(count, np.sqrt(2.0 / mass))
    omega = np.concatenate([k, k + 0.5]) * np.pi * speed
    system = modes(
        omega, 0.0, np.concatenate([free, -clamped]), 0.0, restitution=0.0,
        outputs={"struck": np.concatenate([free, 0 * k])},
    )  # fmt: skip
    thrown = np.eye(1, 2 * count)[0] * np.sqrt(mass)
    path = vibeam.simulate(system, STILL, 1.02e-3, vibeam.State(0 * thrown, thrown))
    return -path.at(np.array([0.2, 0.4, 0.6, 0.8, 1.0]) * 1e-3, "struck")
