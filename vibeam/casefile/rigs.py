"""Rigs that ``vibeam new`` writes a case of: which example's values its template has, and what else it shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from vibeam.casefile.examples import beside, tables
from vibeam_models.registry import Registry

Tables = Mapping[str, Mapping[str, Any]]

SHOWN: Mapping[str, Tables] = {
    "output": {
        "gauge": {"position": "5 mm", "quantity": "strain"},
        "accelerometer": {"position": "132 mm", "quantity": "acceleration"},
    },
    "reference": {"exact": {}},
    "expect": {"two_thirds": {}},
    "measured": {"peak": {}},
    "show": {"motion": {}},
    "map": {"gaps": {}},
}  # tables with names, of which a template shows these as comments

OF_A_BEAM: Tables = {"sdof": {"reduction": "static_mode"}, "beam": {"reduction": "modal", "modes": 8}}
OF_GIVEN: Tables = {"one_mode": {"reduction": "modal", "modes": 1}, "whole": {"reduction": "full"}}


@dataclass(frozen=True)
class Rig:
    """A rig to start from: its ``kind`` of case and its ``meaning`` in a few words.

    ``example``: whose values and fidelities the template has; ``changed``: values in their place, by dotted key.
    ``needed``: keys, those of the sweep apart, that suffice for a first run, with values ``instead`` of the example's.
    """

    name: str
    kind: str
    meaning: str
    example: str
    needed: str
    changed: Mapping[str, Any] = field(default_factory=dict)
    instead: Mapping[str, Any] = field(default_factory=dict)

    @property
    def named(self) -> Mapping[str, Tables]:
        """Tables that have names, as the template shows them."""
        return {**SHOWN, "fidelity": tables(self.example)["fidelity"]}

    @property
    def first(self) -> Tables:
        """Fidelities of a first run."""
        return OF_A_BEAM if self.kind == "beam" else OF_GIVEN

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """Values by dotted key, in lists of tables with the index: ``plate.0.start``."""
        return dict(_flat("", tables(self.example))) | dict(self.changed)

    @property
    def short(self) -> Mapping[str, Any]:
        """Values of the keys that a first run needs, by dotted key."""
        keys = [*self.needed.split(), "sweep.frequency", "sweep.settle", "sweep.hold"]
        return {key: self.instead.get(key, self.values.get(key)) for key in keys}

    @property
    def files(self) -> Mapping[str, str]:
        """Texts of others that the case needs beside it, by name."""
        return beside(self.example, tables(self.example).get(self.kind))


def _flat(above: str, part: Any) -> Iterator[tuple[str, Any]]:
    """Values of tables, and tables that hold values alone, by dotted key."""
    items = part.items() if isinstance(part, dict) else enumerate(part)
    for name, value in items:
        yield above + str(name), value
        if isinstance(value, dict) or (isinstance(value, list) and any(isinstance(each, dict) for each in value)):
            yield from _flat(f"{above}{name}.", value)


RIGS = Registry(
    "rig",
    Rig(
        "cantilever", "beam", "a cantilever with an attached mass, the DTU rig", "dtu",
        "beam.length beam.width beam.thickness beam.youngs_modulus beam.density beam.damping_ratio mass.mass"
        " mass.position stop.gap stop.restitution sensor.position drive.amplitude",
        instead={"drive.amplitude": "0.1 mm"},
    ),
    Rig(
        "tube", "beam", "a heat-exchanger tube with clearance in a baffle plate", "tube",
        "beam.length beam.shape beam.outer_diameter beam.wall beam.youngs_modulus beam.density beam.damping_ratio"
        " beam.ends beam.added_mass_per_length stop.position stop.gap stop.second_gap stop.law stop.stiffness"
        " stop.damping sensor.position drive.force drive.at",
    ),
    Rig(
        "two-beams", "beam", "two cantilevers that meet at a leaf spring", "two-beams",
        "beam.length beam.width beam.thickness beam.youngs_modulus beam.density beam.damping_ratio opposite.position"
        " opposite.arm stop.position stop.gap stop.law stop.stiffness"
        " stop.restitution sensor.position drive.force drive.at",
        instead={
            "beam.damping_ratio": 0.0025, "drive.force": "0.1 N", "drive.at": "300 mm", "sweep.settle": 500,
            "sweep.frequency": {"from": "32 Hz", "to": "35 Hz", "points": 61},
        },
    ),
    Rig(
        "matrices", "matrices", "mass and stiffness matrices of one's own, here a frame of two storeys", "frame",
        "matrices.mass matrices.stiffness matrices.units matrices.damping_ratio matrices.contact matrices.sensor"
        " matrices.base stop.gap stop.restitution drive.amplitude",
    ),
    Rig(
        "modes", "modes", "measured or computed modes, here two of the DTU rig", "modes",
        "modes.frequency modes.damping_ratio modes.contact modes.sensor modes.base stop.gap stop.restitution"
        " drive.amplitude",
        changed={"drive.amplitude": "0.0866 mm"},
    ),
)  # fmt: skip
