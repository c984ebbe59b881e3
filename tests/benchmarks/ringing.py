"""Fig. 27: how far a counted frequency can be off, and the odds that this gives for what 103 Hz were.

    python tests/benchmarks/ringing.py     # about a minute; writes results/ringing.json

``misses``: counted − true frequency of the ringing (Hz) at every reading of ``fig27_drive`` and, at 15 Hz, of
``fig27_damping``; ``rms`` of them is what is left of the slow part, ``scatter`` the standard deviation between the
intervals of one reading (``fig27``), ``error`` both together (root of the sum of squares). ``odds`` of one frequency
against another: ratio of normal densities of that width at 103 Hz, one interval read, nothing else known of either.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

import vibeam
from vibeam.figures.sheet import Sheet, sheet_at

CASES = Path(__file__).parents[2] / "cases" / "experiment"
RESULTS = Path(__file__).parent / "results" / "ringing.json"
MEASURED = 103.0  # Hz
HEAVIER = 4.4  # g, in fig27_mass
DRIVES = (14.4, 14.7, 15.0, 15.3)
READ = {"fig27_drive": ("beam", "at_105"), "fig27_damping": ("0_1", "0_2", "0_5", "1", "2")}


def reading(case: str, fidelity: str, frequency: float) -> Sheet:
    loaded = vibeam.load(CASES / f"{case}.toml")
    return sheet_at(loaded, loaded.shows["ringing"], fidelity, frequency, ())


def readings() -> dict[str, Sheet]:
    """Readings of mode 2, by case, fidelity and drive frequency."""
    drives = {f"fig27_drive {name} {f}": ("fig27_drive", name, f) for name in READ["fig27_drive"] for f in DRIVES}
    damped = {
        f"fig27_damping {name} 15.0": ("fig27_damping", f"percent_{name}", 15.0) for name in READ["fig27_damping"]
    }
    return {name: reading(*at) for name, at in (drives | damped).items()}


def density(frequency: float, error: float) -> float:
    """Density at the measured frequency of a reading of ``frequency``, up to a factor."""
    return float(np.exp(-0.5 * ((MEASURED - frequency) / error) ** 2))


def main() -> None:
    found = readings()
    true = {name: float(np.mean(sheet["ringing_frequency"])) for name, sheet in found.items()}
    misses = {name: float(np.mean(sheet["counted_frequency"])) - true[name] for name, sheet in found.items()}
    rms = float(np.sqrt(np.mean(np.square(list(misses.values())))))
    scatter = float(reading("fig27", "beam", 15.0)["counted_scatter"][0])
    error = float(np.hypot(rms, scatter))
    mode, other = true["fig27_drive beam 15.0"], true["fig27_drive at_105 15.0"]
    heavier = float(np.mean(reading("fig27_mass", "gram_4_4", 15.0)["ringing_frequency"]))
    odds = {
        "mode 2 against 105 Hz": density(mode, error) / density(other, error),
        "4.4 g against mode 2": density(heavier, error) / density(mode, error),
        "4.4 g against 105 Hz": density(heavier, error) / density(other, error),
    }
    frequencies = {"mode 2": mode, "at 105 Hz": other, "4.4 g": heavier}
    harmonics = {"7th harmonic at 14.4 Hz": 7 * 14.4, "at 15 Hz": 105, "at 15.3 Hz": 7 * 15.3, "between": 7 * 0.9}
    frequencies |= harmonics
    rows = {
        "measured": MEASURED,
        "accelerometer, g": HEAVIER,
        "readings": len(misses),
        "rms": rms,
        "scatter": scatter,
        "error": error,
    }
    text = json.dumps(rows | {"frequencies": frequencies, "odds": odds, "misses": misses}, indent=1)
    RESULTS.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
