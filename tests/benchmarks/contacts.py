"""What an impact costs among several contacts: beside one stop, and one more on the same row, in the same run.

python tests/benchmarks/contacts.py
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import vibeam
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

REPEATS = 3
DRIVE, END = vibeam.Drive(95.0, 1e-3), 100.0


def system(modes: int, **more: Any) -> vibeam.ImpactSystem:
    """So many modes of a cantilever, about, on their stop."""
    k = np.arange(1, modes + 1)
    return vibeam.ImpactSystem.from_modes(47.7 * k**2, 0.02, 2.0 / k, 0.5 / k, gap=0.0, restitution=0.7, **more)


def contacts(modes: int, count: int, law: Any = None) -> list[vibeam.Contact]:
    """So many further ones, on either side, 0.1 mm and more away."""
    k = np.arange(1, modes + 1)
    rows = [(-1.0) ** j * 1.6 / k * np.cos((j + 1.0) * k) for j in range(count)]
    return [vibeam.Contact(row, 1e-4 * (j + 1), 0.7, law) for j, row in enumerate(rows)]


def microseconds(own: vibeam.ImpactSystem, certify: bool = False) -> tuple[float, int]:
    """CPU time an impact, least of ``REPEATS``, and the impacts."""
    found, impacts = [], 1
    for _ in range(REPEATS):
        begun = time.thread_time()
        impacts = max(1, int(vibeam.simulate(own, DRIVE, END, certify=certify).stats["impacts"]))
        found.append((time.thread_time() - begun) / impacts * 1e6)
    return min(found), impacts


def main() -> None:
    """The table."""
    print("| modes | system | impacts | µs an impact | of one stop | with a certificate |\n|---|---|---|---|---|---|")
    for modes in (1, 2, 8):
        one = system(modes)
        rows = {"one stop": one, "a second one on its row": system(modes, second_gap=4e-4)}
        rows |= {f"{count + 1} contacts": system(modes, further=contacts(modes, count)) for count in (1, 3, 7)}
        rows["rigid and linear"] = system(modes, further=contacts(modes, 1, LinearStop(1e5, 5.0)))
        rows["rigid and Hunt–Crossley"] = system(modes, further=contacts(modes, 1, HuntCrossley(1e8, 0.3)))
        least, _ = microseconds(one)
        for name, own in rows.items():
            cost, impacts = microseconds(own)
            proved, _ = microseconds(own, certify=True)
            print(f"| {modes} | {name} | {impacts} | {cost:.2f} | {cost / least:.1f} | {proved:.2f} |", flush=True)


if __name__ == "__main__":
    main()
