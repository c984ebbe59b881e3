"""Random systems of 1 to 30 modes under all laws: every one is known by its seed and number."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import vibeam

SPECIAL_DAMPING = (0.0, 1.0, 1 - 1e-12, 1 + 1e-12, 50.0)
SIZES = (1, 1, 2, 2, 3, 3, 4, 5, 6, 8, 10, 12, 16, 20, 30)


class Case(NamedTuple):
    system: vibeam.ImpactSystem
    drive: vibeam.Drive
    start: vibeam.State


def random_case(seed: int, number: int, size: int | None = None) -> Case:
    """Frequencies over up to three decades, any damping, R and gap of either sign; driven, now and then not."""
    rng = np.random.default_rng([seed, number])
    n = int(rng.choice(SIZES)) if size is None else size
    base = 10 ** rng.uniform(-2, 3)
    omega = base * np.sort(10 ** np.r_[0.0, rng.uniform(0.05, rng.uniform(0.3, 3.0 if n < 10 else 2.0), n - 1)])
    if rng.random() < 0.07:
        omega[0] = 0.0
    zeta = 10 ** rng.uniform(-4, -0.5, n)
    kinds = rng.random(n)
    zeta = np.where(kinds < 0.1, rng.choice(SPECIAL_DAMPING, n), np.where(kinds < 0.2, rng.uniform(0, 8, n), zeta))
    contact = rng.normal(size=n) * (omega.max() / np.maximum(omega, base)) ** 0.2
    contact[0] = rng.uniform(0.3, 1.0) * rng.choice([-1, 1])
    load = rng.normal(size=n)
    restitution = rng.choice([0.0, 1.0, rng.uniform(), rng.uniform(0.5, 0.98), 10 ** rng.uniform(-3, 0)],
                             p=[0.05, 0.1, 0.4, 0.4, 0.05])  # fmt: skip
    ratio = rng.choice(
        [10 ** rng.uniform(-1.3, 1.3), rng.uniform(0.5, 4.0), omega.max() / base or 1.0], p=[0.4, 0.5, 0.1]
    )
    amplitude = 0.0 if rng.random() < 0.08 else 10 ** rng.uniform(-2, 0.5) / ratio**2
    gap = rng.choice([0.0, rng.uniform(-0.5, 0.5), rng.choice([-1e-12, 1e-12])], p=[0.2, 0.7, 0.1])
    static = rng.normal(size=n) * base**2 * 0.3 if rng.random() < 0.5 or omega[0] == 0 else np.zeros(n)
    if omega[0] == 0:
        static[0] = abs(static[0]) * np.sign(contact[0])
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, contact, load, gap=float(gap), restitution=float(restitution), static=static
    )
    soft = base / np.maximum(omega, base)
    x, v = rng.normal(size=n) * soft**1.5 * 0.5, rng.normal(size=n) * base * soft**0.5 * 0.5
    beyond = contact @ x - system.gap + 0.01 * rng.random()
    x -= contact * soft**2 * max(0.0, beyond) / (contact**2 @ soft**2)
    return Case(system, vibeam.Drive(float(base * ratio), float(amplitude)), vibeam.State(x, v))
