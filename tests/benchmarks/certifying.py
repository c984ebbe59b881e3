"""What a certificate costs: the same motion with and without, in turn, for 1, 4 and 8 modes.

python tests/benchmarks/certifying.py
"""

from __future__ import annotations

import time

import numpy as np

import vibeam

REPEATS = 7


def seconds(system: vibeam.ImpactSystem, certify: bool) -> float:
    """CPU time of one motion."""
    begun = time.thread_time()
    vibeam.simulate(system, vibeam.Drive(2.9, 1.0), 4000.0, certify=certify)
    return time.thread_time() - begun


def main() -> None:
    """Print the ratio of medians."""
    for modes in (1, 4, 8):
        k = np.arange(modes)
        system = vibeam.ImpactSystem.from_modes((1 + 2.2 * k) ** 1.3, 0.015, 0.8**k, 0.6**k, gap=0.1, restitution=0.8)
        seconds(system, True)
        times = np.array([(seconds(system, False), seconds(system, True)) for _ in range(REPEATS)])
        plain, certified = np.median(times, axis=0)
        print(f"{modes} modes: {plain:.4f} s, certified {certified:.4f} s: {certified / plain:.2f} times")


if __name__ == "__main__":
    main()
