"""Three rigs with uncertain inputs: their cases, what is uncertain of them, and the exact peaks of samples by key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from tests.others.uncertain.plain_samples import Input, Modes, interpolated
from tests.others.uncertain.struck_modes import struck_peaks
from tests.others.uncertain.yielding_modes import Yielding
from tests.others.uncertain.yielding_peaks import yielding_peaks
from vibeam.case.fidelity import system
from vibeam_models.base_motion import drive_amplitude

Array = Any
HERE = Path(__file__).parent
CASES = HERE.parents[2] / "cases"


@dataclass(frozen=True)
class Rig:
    """Rig of the book: a case with ``settings``, its ``inputs`` and those of them that change the structure.

    ``exact``: peaks (m,) of the finest fidelity at samples by key.
    """

    name: str
    path: Path
    inputs: tuple[Input, ...]
    exact: Callable[[Assembled, Mapping[str, Array]], Array]
    structural: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)

    def case(self) -> Any:
        """The case with its uncertain inputs."""
        return vibeam.load(self.path, {**self.settings, "uncertain": {each.key: each.text for each in self.inputs}})

    def peaks(self, samples: Mapping[str, Array]) -> Array:
        """Exact peaks (m,) of the finest fidelity."""
        return self.exact(Assembled(self, self.case()), samples)


class Assembled:
    """The finest fidelity of a rig: its systems at any inputs, and what of them is the same for all samples."""

    def __init__(self, rig: Rig, case: Any) -> None:
        self.inputs, self.structural = rig.inputs, rig.structural
        self.name, self.case = list(case.fidelities)[-1], case
        self.model = case.model(self.name)
        self.omega = np.sort(2 * np.pi * case.sweep.frequency)
        scene = self.model.scene()
        self.stop, self.damping_ratio = scene.stop, case.system(self.name).zeta[0]
        self.base = np.broadcast_to(np.asarray(drive_amplitude(scene, self.omega), dtype=float), self.omega.shape)

    def system(self, values: Mapping[str, float]) -> Any:
        """Assembled system at some inputs, the others as in the case."""
        return system(self.model.at(values).scene(), self.model.fidelity)

    def modes(self, samples: Mapping[str, Array]) -> tuple[Modes, Array]:
        """Modes of samples (m,), and by which factor their gaps (m,) are larger at the contact than where measured."""
        output, gap = self.case.sweep.output, 1e-5

        def rows(values: Mapping[str, float]) -> Array:
            made = self.system({**values, "stop.gap": gap})
            return np.stack([*(row[0] for row in astuple(Modes.of(made, output))), np.full(made.size, made.gap / gap)])

        if self.structural:
            found = interpolated(rows, [each for each in self.inputs if each.key in self.structural])(samples)
        else:
            found = np.broadcast_to(rows({}), (len(samples["stop.gap"]), 6, self.case.system(self.name).size))
        omega, zeta, *further, factor = found.transpose(1, 0, 2)
        if (ratio := samples.get("beam.damping_ratio")) is not None:
            zeta = zeta * (ratio / self.damping_ratio)[:, None]
        return Modes(omega, zeta, *further), factor[:, 0]


def struck(model: Assembled, samples: Mapping[str, Array]) -> Array:
    """Peaks with a rigid stop, whose R is that of mode 1 where the case says so: R₁ = (1 + R) c₁²/S − 1."""
    modes, factor = model.modes(samples)
    restitution = samples["stop.restitution"]
    if model.stop.restitution_of != "contact":
        restitution = (1 + restitution) * np.sum(modes.contact**2, axis=1) / modes.contact[:, 0] ** 2 - 1
    base = np.broadcast_to(model.base, (len(factor), len(model.base)))
    return struck_peaks(modes, factor * samples["stop.gap"], restitution, model.omega, base)


def yielding(model: Assembled, samples: Mapping[str, Array]) -> Array:
    """Peaks with a spring and a damper as stop, under a base motion."""
    modes, factor = model.modes(samples)
    law, drive = model.case.system(model.name).law, samples["drive.amplitude"]

    def rig(modes: Modes, gap: Array, stiffness: Array, base: Array) -> Yielding:
        return Yielding(modes, gap, stiffness, np.full(len(gap), law.damping), np.zeros(len(gap)), base)

    own = rig(modes.at([0]), np.array([model.stop.gap]), np.array([law.stiffness]), model.base[:1])
    base = np.broadcast_to(drive[:, None], (len(drive), len(model.omega)))
    every = rig(modes, factor * samples["stop.gap"], samples["stop.stiffness"], drive)
    return yielding_peaks(every, model.omega, base, own)


NEUTRAL = {
    "sweep.frequency": {"from": "15 Hz", "to": "15.5 Hz", "points": 6}, "sweep.direction": "up",
    "sweep.settle": 40, "sweep.hold": 5, "beam.elements": 12, "reference": None, "fidelity.sdof": None,
}  # fmt: skip
RIGS = (
    Rig(
        "DTU rig at its neutral gap, rigid stop",
        CASES / "uncertain" / "neutral.toml",
        (
            Input("stop.restitution", "0.69 … 0.75", "uniform", 0.69, 0.75),
            Input("stop.gap", "-0.02 mm … 0.02 mm", "uniform", -2e-5, 2e-5),
            Input("beam.damping_ratio", "± 10 %", "normal", 0.017, 0.1 * 0.017),
        ),
        struck,
        settings=NEUTRAL,
    ),
    Rig(
        "reed at a loose gap, rigid stop",
        HERE / "reed.toml",
        (
            Input("beam.thickness", "± 1 %", "normal", 1.2e-3, 0.01 * 1.2e-3),
            Input("stop.gap", "± 5 %", "normal", 1e-4, 0.05 * 1e-4),
            Input("stop.restitution", "0.55 … 0.65", "uniform", 0.55, 0.65),
        ),
        struck,
        ("beam.thickness",),
    ),
    Rig(
        "strip whose stop yields",
        HERE / "yielding.toml",
        (
            Input("stop.stiffness", "± 5 %", "normal", 2e4, 0.05 * 2e4),
            Input("stop.gap", "0.01 mm … 0.03 mm", "uniform", 1e-5, 3e-5),
            Input("drive.amplitude", "± 2 %", "normal", 5e-5, 0.02 * 5e-5),
        ),
        yielding,
    ),
)
