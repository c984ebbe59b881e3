"""Fig. 27: what a counted frequency says of the ringing that it was counted in, and the odds that 103 Hz then give.

    python tests/benchmarks/ringing.py     # about a minute; writes results/ringing.json

``misses``: counted − true frequency of the ringing (Hz) at every reading of ``fig27_drive`` and, at 15 Hz, of
``fig27_damping``. At 15 Hz all of mode 2 have one sign: the count is biased there, so that a density about the true
frequency would be no likelihood. ``read``: what each rig is counted as at 15 Hz, of mode 2 the mean over its dampings;
``scatter``: the standard deviation between the intervals of one reading (``fig27``), ``spread``: that over the
dampings, ``error``: both together (root of the sum of squares). ``odds`` of one rig against another: ratio of normal
densities of that width about what is read of each, at 103 Hz, one interval read, nothing else known of either.
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


def odds(read: float, other: float, error: float) -> float:
    """Odds, at the measured frequency, of a rig that reads ``read`` against one that reads ``other``."""
    return float(np.exp(0.5 * (((MEASURED - other) / error) ** 2 - ((MEASURED - read) / error) ** 2)))


def main() -> None:
    found = readings()
    true = {name: float(np.mean(sheet["ringing_frequency"])) for name, sheet in found.items()}
    counted = {name: float(np.mean(sheet["counted_frequency"])) for name, sheet in found.items()}
    misses = {name: counted[name] - true[name] for name in found}
    of_mode = [name for name in found if name.endswith(" 15.0") and "at_105" not in name]
    at_15 = sorted(misses[name] for name in of_mode)
    scatter = float(reading("fig27", "beam", 15.0)["counted_scatter"][0])
    spread = float(np.std([counted[name] for name in of_mode]))
    error = float(np.hypot(spread, scatter))
    heavier = reading("fig27_mass", "gram_4_4", 15.0)
    read = {
        "mode 2": float(np.mean([counted[name] for name in of_mode])),
        "105 Hz": counted["fig27_drive at_105 15.0"],
        "4.4 g": float(np.mean(heavier["counted_frequency"])),
    }
    frequencies = {
        "mode 2": true["fig27_drive beam 15.0"],
        "at 105 Hz": true["fig27_drive at_105 15.0"],
        "4.4 g": float(np.mean(heavier["ringing_frequency"])),
        "7th harmonic at 14.4 Hz": 7 * 14.4,
        "at 15 Hz": 105,
        "at 15.3 Hz": 7 * 15.3,
        "between": 7 * 0.9,
    }
    pairs = (("105 Hz", "mode 2"), ("4.4 g", "mode 2"), ("4.4 g", "105 Hz"))
    rows = {
        "measured": MEASURED,
        "accelerometer, g": HEAVIER,
        "readings of mode 2 at 15 Hz": len(at_15),
        "misses of mode 2 at 15 Hz": [at_15[0], at_15[-1]],
        "scatter": scatter,
        "spread": spread,
        "error": error,
        "read": read,
        "frequencies": frequencies,
        "odds": {f"{one} against {other}": odds(read[one], read[other], error) for one, other in pairs},
        "misses": misses,
    }
    text = json.dumps(rows, indent=1)
    RESULTS.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
