"""Random systems of every kind that the regimes engine takes, for checks of what it certifies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.random import Generator

import vibeam
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution


def modes(rng: Generator) -> dict[str, Any]:
    """One to four modes, lightly to heavily damped."""
    n = int(rng.integers(1, 5))
    omega = np.sort(10 ** rng.uniform(0.0, 1.5, n))
    zeta = 10 ** rng.uniform(-2.5, 0.3, n)
    return {"omega": omega, "zeta": zeta, "contact": rng.normal(size=n), "load": rng.normal(size=n)}


def coupled(rng: Generator, own: dict[str, Any]) -> dict[str, Any]:
    """The same with damping that couples the modes."""
    root = rng.normal(size=(len(own["omega"]),) * 2)
    return own | {"coupling": 0.05 * root @ root.T + np.diag(0.02 * own["omega"])}


def linear(rng: Generator, damped: bool) -> LinearStop:
    """A stop 3 to 300 times as stiff as the slowest mode."""
    stiffness = 10 ** rng.uniform(0.5, 2.5)
    return LinearStop(stiffness, rng.uniform(0.05, 2.0) * np.sqrt(stiffness) if damped else 0.0)


def table(rng: Generator) -> TableRestitution:
    """R that falls with the velocity."""
    return TableRestitution((0.05, 0.3, 2.0), tuple(np.sort(rng.uniform(0.2, 0.9, 3))[::-1]))


KINDS: dict[str, Callable[[Generator, dict[str, Any]], dict[str, Any]]] = {
    "one stop": lambda rng, own: own | {"restitution": rng.uniform(0.1, 1.0)},
    "two stops": lambda rng, own: own | {"restitution": rng.uniform(0.1, 1.0), "second_gap": rng.uniform(0.3, 1.0)},
    "coupled damping": lambda rng, own: coupled(rng, own) | {"restitution": rng.uniform(0.1, 1.0)},
    "pressed, plastic": lambda rng, own: own | {"restitution": 0.0, "gap": -0.1},
    "pressed, two stops, coupled": lambda rng, own: (
        coupled(rng, own) | {"restitution": rng.uniform(0.0, 0.6), "gap": -0.1, "second_gap": 0.5}
    ),
    "table": lambda rng, own: own | {"law": table(rng)},
    "table, pressed": lambda rng, own: own | {"law": table(rng), "gap": -0.1, "second_gap": 0.6},
    "viscous": lambda rng, own: own | {"law": ViscousRestitution(rng.uniform(0.3, 0.9), 0.2), "gap": -0.05},
    "plastic law": lambda rng, own: own | {"law": PlasticRestitution(0.7, 0.2)},
    "linear stop": lambda rng, own: own | {"law": linear(rng, damped=False)},
    "linear stop, damped": lambda rng, own: own | {"law": linear(rng, damped=True)},
    "linear stop, damped, two, coupled": lambda rng, own: (
        coupled(rng, own) | {"law": linear(rng, damped=True), "second_gap": rng.uniform(0.3, 1.0)}
    ),
    "linear stop, pressed": lambda rng, own: own | {"law": linear(rng, damped=True), "gap": -0.1},
    "hertz": lambda rng, own: own | {"law": Hertz(10 ** rng.uniform(1, 4))},
    "hunt-crossley": lambda rng, own: own | {"law": HuntCrossley(10 ** rng.uniform(1, 4), 0.3), "second_gap": 0.8},
}


def rig(kind: str, seed: int, periods: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive, float]:
    """A system, its drive, and a time of that many drive periods."""
    rng = np.random.default_rng([seed, sorted(KINDS).index(kind)])
    own = modes(rng)
    system = vibeam.ImpactSystem.from_modes(**KINDS[kind](rng, {"gap": rng.uniform(0.0, 0.3), **own}))
    omega = float(own["omega"][0] * rng.uniform(0.6, 2.5))
    own_size = np.abs(own["load"] * own["contact"]).max() + 1e-3
    drive = vibeam.Drive(omega, float(rng.uniform(0.5, 2.0) / own_size))
    return system, drive, periods * 2 * np.pi / omega
