"""Parameters of eq. 38–47 for the case cases/paper/eq38.toml, worked out in 30 digits from the formulas alone.

python tests/independent/make_eq38.py    # writes eq38.json beside this file
"""

from __future__ import annotations

import json
from pathlib import Path

from mpmath import mp, mpf, quad, sqrt

TARGET = Path(__file__).with_suffix("").with_name("eq38.json")


def parameters() -> dict[str, float]:
    """Parameters by their names in ``vibeam derive``, and the further ones of the case's head."""
    mp.dps = 30
    given = ("0.18", "0.132", "0.1", "0.02", "0.001034", "210e9", "0.2", "0.017", "1.5e-3", "1e-4", "0.6")
    length, at, seen, width, depth, young, mass, beta, gain, gap, volts = map(mpf, given)
    inertia, scale = width * depth**3 / 12, seen**2 * (3 * at - seen)
    shape = 2 * at**3 / scale
    stiffness = young * inertia * quad(lambda x: (6 * (at - x) / scale) ** 2, [0, at])
    moving = mass * shape**2
    omega = sqrt(stiffness / moving)
    found = {
        "second moment of area": inertia,
        "shape at the mass": shape,
        "stiffness": stiffness,
        "mass, massless beam": moving,
        "circular frequency, massless beam": omega,
        "frequency, massless beam": omega / (2 * mp.pi),
        "damping time": 2 * beta / omega,
        "damping ratio": beta,
        "gap": gap / length,
        "gain": gain,
        "base per volt": gain * shape * length,
        "drive": gain * volts,
    }
    return {name: float(value) for name, value in found.items()}


if __name__ == "__main__":
    TARGET.write_text(json.dumps(parameters(), indent=1) + "\n", encoding="utf-8")
