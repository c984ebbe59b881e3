"""What a certificate costs: the same motion with and without, in turn: plain with 1, 4 and 8 modes, and of every law.

python tests/benchmarks/certifying.py
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import vibeam
from vibeam_models.laws.compliant import Hertz, LinearStop
from vibeam_models.laws.restitution import TableRestitution

REPEATS = 7

DRIVE = vibeam.Drive(2.9, 1.0)

COUPLING = np.array([[0.06, 0.02, 0.0, 0.01], [0.02, 0.3, 0.05, 0.0], [0.0, 0.05, 0.4, 0.0], [0.01, 0.0, 0.0, 0.5]])

LAWS: dict[str, dict[str, Any]] = {
    "second stop": {"restitution": 0.8, "second_gap": 0.5},
    "coupled damping": {"restitution": 0.8, "coupling": COUPLING},
    "R(v)": {"law": TableRestitution((0.1, 1.0), (0.9, 0.7))},
    "linear stop": {"law": LinearStop(300.0)},
    "linear stop, damped": {"law": LinearStop(300.0, 6.0)},
    "linear stops, damped, coupled": {"law": LinearStop(300.0, 6.0), "second_gap": 0.5, "coupling": COUPLING},
    "Hertz": {"law": Hertz(1e4)},
}


def system(modes: int, **more: Any) -> vibeam.ImpactSystem:
    """So many modes of a beam, about."""
    k = np.arange(modes)
    return vibeam.ImpactSystem.from_modes((1 + 2.2 * k) ** 1.3, 0.015, 0.8**k, 0.6**k, gap=0.1, **more)


def seconds(own: vibeam.ImpactSystem, end: float, certify: bool) -> float:
    """CPU time of one motion."""
    begun = time.thread_time()
    vibeam.simulate(own, DRIVE, end, certify=certify)
    return time.thread_time() - begun


def compare(name: str, own: vibeam.ImpactSystem, end: float) -> None:
    """Print the ratio of medians."""
    seconds(own, end, True)
    times = np.array([(seconds(own, end, False), seconds(own, end, True)) for _ in range(REPEATS)])
    plain, certified = np.median(times, axis=0)
    print(f"{name}: {plain:.4f} s, certified {certified:.4f} s: {certified / plain:.2f} times")


def main() -> None:
    """Plain systems, then one of four modes with each law."""
    for modes in (1, 4, 8):
        compare(f"{modes} modes", system(modes, restitution=0.8), 4000.0)
    for name, more in LAWS.items():
        compare(name, system(4, **more), 1000.0)


if __name__ == "__main__":
    main()
