"""Random rigs: case files with all effects, laws and drives, over wide but physical ranges, by seed and number."""

from __future__ import annotations

from typing import Any

import numpy as np
from draws import chosen, log
from numpy.random import Generator
from rig_drives import drive, weight
from rig_stops import contact, stop

from vibeam.casefile.toml_writing import toml_text

Table = dict[str, Any]

MODES = (1, 1, 2, 2, 3, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48, 60)
FEW = 20  # elements up to which all of them may be kept: 60 coordinates with torsion
ALONE = 0.06  # share of rigs that are one degree of freedom in their own units


def random_rig(seed: int, number: int) -> str:
    """The text of a case file."""
    return toml_text({"units": "SI"} | random_tables(np.random.default_rng([seed, number])))


def random_tables(rng: Generator) -> Table:
    """A case's tables: plain numbers, in SI units."""
    if rng.random() < ALONE:
        return sdof(rng)
    case: Table = {"beam": beam(rng)}
    size = case["beam"]
    if rng.random() < 0.9:
        case["mass"] = mass(rng, size)
        massless(rng, case)
    if rng.random() < 0.2:
        case["added_mass"] = [
            {"mass": weight(size) * log(rng, 0.01, 3), "position": size["length"] * rng.uniform(0.1, 1.0)}
            for _ in range(rng.integers(1, 4))
        ]
    if rng.random() < 0.25:
        case["clamp"] = {"stiffness": _bending(size) / size["length"] * log(rng, 0.1, 1e4)}
    if rng.random() < 0.3:
        case["gravity"] = gravity(rng)
    if "mass" in case and rng.random() < 0.25:
        case["torsion"] = torsion(rng, case)
    case["sensor"] = {"position": size["length"] * rng.uniform(0.05, 1.0)}
    stiffness, frequency = _mode(case)
    frequency *= log(rng, 0.25, 6)
    motion = size["length"] * log(rng, 1e-6, 1e-2)
    case |= drive(rng, case, motion, frequency, stiffness)
    case["stop"] = stop(rng, case, motion, frequency, stiffness)
    case["sweep"] = sweep(rng, frequency)
    if rng.random() < 0.08:
        case["measurement"] = measurement(rng, frequency, motion)
    case["fidelity"] = {"flown": fidelity(rng, 1 if "massless" in size else size["elements"])}
    return case


def sdof(rng: Generator) -> Table:
    """One degree of freedom, nondimensional: what a beam's stop and drive may be, in its units."""
    motion, ratio = log(rng, 1e-5, 1.0), log(rng, 0.3, 6)
    own: Table = {"sdof": {"damping_ratio": float(chosen(rng, 0.0, log(rng, 1e-4, 0.1), log(rng, 0.05, 3)))}}
    own["drive"] = {"amplitude": motion}
    own["stop"] = contact(rng, motion, ratio / (2 * np.pi), 1.0)
    own["stop"].pop("restitution_of", None)
    own["sweep"] = sweep(rng, ratio / (2 * np.pi)) | {"output": "contact"}
    return own | {"fidelity": {"flown": {"reduction": "static_mode"}}}


def beam(rng: Generator) -> Table:
    """2 cm to 1 m, of plastics to tungsten, hardly to heavily damped."""
    length, kind = log(rng, 0.02, 1.0), chosen(rng, "constant", "constant", "stiffness", "rayleigh", "list")
    ratio: Any = chosen(rng, 0.0, log(rng, 1e-4, 0.05), log(rng, 1e-3, 0.1), log(rng, 1e-3, 0.1), log(rng, 0.1, 3))
    own: Table = {
        "length": length, "width": length * log(rng, 0.02, 0.4), "thickness": length * log(rng, 2e-3, 0.05),
        "youngs_modulus": log(rng, 1e9, 4e11), "density": log(rng, 900, 2e4), "elements": int(rng.integers(4, 61)),
    }  # fmt: skip
    if kind == "list":
        return own | {"damping": [log(rng, 1e-4, 0.2) for _ in range(rng.integers(1, 5))]}
    if kind == "rayleigh":
        first = log(rng, 1e-3, 0.1)
        return own | {"damping": kind, "damping_ratio": [first, first * rng.uniform(0.5, 5)]}
    return own | {"damping": kind, "damping_ratio": ratio}


def mass(rng: Generator, size: Table) -> Table:
    """A point mass, or one with inertia, or rigid over part of the beam."""
    length = size["length"]
    own: Table = {"mass": weight(size) * log(rng, 0.02, 50), "position": length * rng.uniform(0.3, 1.0)}
    if rng.random() < 0.4:
        own["rotary_inertia"] = own["mass"] * (length * log(rng, 0.003, 0.15)) ** 2
    room = min(own["position"], length - own["position"])
    if rng.random() < 0.3 and room > 0.05 * length:
        own["rigid_half_width"] = room * rng.uniform(0.1, 0.8)
    return own


def massless(rng: Generator, case: Table) -> None:
    """Now and then the beam's own mass is neglected: then modes are few."""
    if rng.random() < 0.05:
        case["beam"]["massless"] = True


def gravity(rng: Generator) -> Table:
    """All three directions; standing beams may buckle, and are refused then."""
    direction = chosen(rng, "hanging", "standing", "transverse", "transverse")
    if direction == "transverse":
        return {"direction": direction, "acceleration": float(chosen(rng, 9.80665, -9.80665, rng.normal() * 3))}
    return {"direction": direction}


def torsion(rng: Generator, case: Table) -> Table:
    """A contact beside the beam's axis."""
    own = {
        "eccentricity": float(case["beam"]["width"] * chosen(rng, 0.0, rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5))),
        "polar_inertia": case["mass"]["mass"] * (case["beam"]["width"] * log(rng, 0.2, 3)) ** 2,
    }
    if rng.random() < 0.5:
        return own | {"poissons_ratio": rng.uniform(0.0, 0.5)}
    return own | {"shear_modulus": case["beam"]["youngs_modulus"] / rng.uniform(2.0, 3.0)}


def sweep(rng: Generator, frequency: float) -> Table:
    """A few points, both ways."""
    step = frequency * log(rng, 1e-3, 0.2)
    return {
        "frequency": {"from": frequency, "to": frequency + step, "points": int(rng.integers(2, 5))},
        "direction": chosen(rng, "up", "down", "both"), "settle": int(rng.integers(0, 30)),
        "hold": int(rng.integers(1, 9)), "output": chosen(rng, "sensor", "contact", "tip"),
    }  # fmt: skip


def measurement(rng: Generator, frequency: float, motion: float) -> Table:
    """A filter, a converter, noise: or none of them."""
    own: Table = {"sampling": frequency * log(rng, 8, 200)}
    if rng.random() < 0.5:
        own |= {
            "low_pass": "bessel",
            "order": int(rng.integers(1, 7)),
            "cut_off": own["sampling"] * rng.uniform(0.05, 0.4),
        }
    if rng.random() < 0.5:
        own["quantisation"] = motion * log(rng, 1e-5, 1e-1)
    if rng.random() < 0.5:
        own |= {"noise": motion * log(rng, 1e-5, 1e-1), "seed": int(rng.integers(1000))}
    return own


def fidelity(rng: Generator, elements: int) -> Table:
    """1 to 60 modes, the static mode, or all of the elements."""
    kind = chosen(rng, "static_mode", *["modal"] * 7, "full")
    if kind == "modal" or (kind == "full" and elements > FEW):
        return {"reduction": "modal", "modes": min(int(rng.choice(MODES)), 2 * elements)}
    return {"reduction": kind}


def _bending(size: Table) -> float:
    return float(size["youngs_modulus"] * size["width"] * size["thickness"] ** 3 / 12)


def _mode(case: Table) -> tuple[float, float]:
    """About the first mode's stiffness at the mass or tip, N/m, and its frequency, Hz."""
    size, attached = case["beam"], case.get("mass", {})
    at = attached.get("position", size["length"])
    soft = at**3 / (3 * _bending(size))
    if "clamp" in case:
        soft += at**2 / case["clamp"]["stiffness"]
    heavy = attached.get("mass", 0.0) + 0.24 * weight(size)
    return 1 / soft, float(np.sqrt(1 / (soft * heavy)) / (2 * np.pi))
