"""Rigs that ``vibeam new`` writes a case of: which kind each is, and what its template shows."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from vibeam_models.registry import Registry

Named = Mapping[str, Mapping[str, Mapping[str, Any]]]


@dataclass(frozen=True)
class Rig:
    """A rig to start from: its ``kind`` of case and its ``meaning`` in a few words.

    ``named``: what the template shows of the tables that have names. ``examples``: values in place of the declared
    examples, by dotted key, each written out; ``shown``: optional tables that are no comments in this one; ``aside``:
    keys and tables that are. ``files``: others that the case needs beside it, by name.
    """

    name: str
    kind: str
    meaning: str
    named: Named
    examples: Mapping[str, Any] = field(default_factory=dict)
    aside: Collection[str] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    shown: Collection[str] = ()


CHECKS: Named = {
    "reference": {"exact": {}},
    "expect": {"two_thirds": {}},
    "measured": {"peak": {}},
    "show": {"motion": {}},
    "map": {"gaps": {}},
}

BEAM_FIDELITIES: Named = {
    "fidelity": {
        "sdof": {"reduction": "static_mode"},
        "two_modes": {"reduction": "modal", "modes": 2},
        "beam": {"reduction": "modal", "modes": 8},
        "point_mass": {
            "reduction": "static_mode",
            "set": {"stop.restitution": 0.7},
            "without": ["mass.rotary_inertia"],
            "label": "point mass",
        },
    }
}

BEAM_OUTPUTS: Named = {
    "output": {
        "gauge": {"position": "5 mm", "quantity": "strain"},
        "accelerometer": {"position": "132 mm", "quantity": "acceleration"},
    }
}

FRAME_FIDELITIES: Named = {
    "fidelity": {
        "sdof": {"reduction": "static_mode"},
        "one_mode": {"reduction": "modal", "modes": 1},
        "whole": {"reduction": "full"},
        "softer": {
            "reduction": "static_mode",
            "set": {"stop.restitution": 0.6},
            "without": ["platform"],
            "label": "softer stop",
        },
    }
}

TUBE_FIDELITIES: Named = {
    "fidelity": {
        "sdof": {"reduction": "static_mode"},
        "four_modes": {"reduction": "modal", "modes": 4},
        "tube": {"reduction": "modal", "modes": 12},
        "dry": {
            "reduction": "modal",
            "modes": 12,
            "set": {"beam.damping_ratio": 0.005},
            "without": ["beam.added_mass_per_length"],
            "label": "without water",
        },
    }
}

TUBE = {
    "title": "heat-exchanger tube in a baffle plate",
    "source": "dimensions of a common tube",
    "beam.length": "1 m",
    "beam.shape": "tube",
    "beam.outer_diameter": "15.875 mm",
    "beam.wall": "1.2 mm",
    "beam.ends": "clamped-pinned",
    "beam.added_mass_per_length": "0.34 kg/m",
    "stop.position": "600 mm",
    "stop.gap": "0.2 mm",
    "stop.second_gap": "0.2 mm",
    "stop.law": "linear",
    "stop.stiffness": "2 kN/mm",
    "stop.gap_at": "contact",
    "stop.damping": "200 N s/m",
    "sensor.position": "600 mm",
    "drive.force": "5 N",
    "drive.at": "400 mm",
    "sweep.frequency": {"from": "30 Hz", "to": "70 Hz", "points": 41},
}

TWO_BEAMS = {
    "title": "two cantilevers with a leaf-spring stop",
    "source": "in kind of Woiwode & Krack 2024",
    "beam.length": "392.5 mm",
    "beam.width": "60 mm",
    "beam.thickness": "6 mm",
    "beam.damping_ratio": 0.0025,
    "added_mass.mass": "13.3 g",
    "added_mass.position": "381 mm",
    "opposite.position": "330 mm",
    "opposite.arm": "51 mm",
    "opposite.shape": "rectangle",
    "added_mass.on": "beam",
    "stop.position": "381 mm",
    "stop.gap": "0.17 mm",
    "stop.gap_at": "contact",
    "stop.law": "leaf spring",
    "stop.leaf_length": "57 mm",
    "stop.leaf_width": "40 mm",
    "stop.leaf_thickness": "1 mm",
    "stop.leaf_modulus": "210 GPa",
    "stop.restitution": 1,
    "sensor.position": "381 mm",
    "drive.acceleration": "0.03 m/s^2",
    "sweep.frequency": {"from": "31 Hz", "to": "35 Hz", "points": 101},
}

BARE_FIDELITIES: Named = {
    "fidelity": {
        "sdof": {"reduction": "static_mode"},
        "two_modes": {"reduction": "modal", "modes": 2},
        "beams": {"reduction": "modal", "modes": 8},
        "damped": {
            "reduction": "modal",
            "modes": 8,
            "set": {"beam.damping_ratio": 0.0035},
            "without": ["added_mass"],
            "label": "more damping, no nut",
        },
    }
}

FRAME = {
    "title": "frame of two storeys, the upper one at a stop",
    "source": "textbook",
    "stop.gap": "1 mm",
    "stop.gap_at": "contact",
    "drive.amplitude": "0.1 mm",
    "sweep.frequency": {"from": "5 Hz", "to": "8 Hz", "points": 61},
}

FRAME_FILES = {
    "M.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
% mass in kg of two storeys, the lower one first
2 2 2
1 1 2.0
2 2 1.5
""",
    "K.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
% stiffness in N/m: 5 kN/m from the base to the lower storey, 4 kN/m from there to the upper one
2 2 3
1 1 9000.0
2 1 -4000.0
2 2 4000.0
""",
}

RIGS = Registry(
    "rig",
    Rig(
        "cantilever",
        "beam",
        "a cantilever with an attached mass, the DTU rig",
        {**BEAM_OUTPUTS, **BEAM_FIDELITIES, **CHECKS},
    ),
    Rig(
        "tube",
        "beam",
        "a heat-exchanger tube with clearance in a baffle plate",
        {**TUBE_FIDELITIES, **CHECKS},
        TUBE,
        (
            "mass",
            "beam.width",
            "beam.thickness",
            "drive.voltage",
            "drive.gain",
            "stop.restitution",
            "stop.restitution_of",
        ),
    ),
    Rig(
        "two-beams",
        "beam",
        "two cantilevers that meet at a leaf spring",
        {**BARE_FIDELITIES, **CHECKS},
        TWO_BEAMS,
        ("mass", "drive.voltage", "drive.gain", "stop.restitution_of"),
        shown=("added_mass", "opposite"),
    ),
    Rig(
        "matrices",
        "matrices",
        "mass and stiffness matrices of one's own, here a frame of two storeys",
        {**FRAME_FIDELITIES, **CHECKS},
        FRAME,
        ("drive.voltage", "stop.restitution_of"),
        FRAME_FILES,
    ),
    Rig(
        "modes",
        "modes",
        "measured or computed modes, here those of the same frame",
        {**FRAME_FIDELITIES, **CHECKS},
        FRAME,
        ("drive.voltage", "stop.restitution_of"),
    ),
)
