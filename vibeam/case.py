"""The case: what a case file says, checked and in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.plans import AccuracyPlan, CostPlan, Direction, FigurePlan, InfluencePlan, Reference, SweepPlan
from vibeam.scenes import scene_of

if TYPE_CHECKING:
    from vibeam.expect import Expectation
    from vibeam.fidelity import Fidelity
    from vibeam.observe.measurement import Chain
    from vibeam.schema import BeamCase, SdofCase, SweepTable
    from vibeam.show.plan import ShowPlan
    from vibeam.system import ImpactSystem
    from vibeam_models.scene import Scene, SdofScene

RIPPLE, ATTENUATION = 0.1, 60.0  # dB, of an elliptic filter that does not say
#: tables that change no sweep, and keys of the tables that do
NOT_NUMBERS = frozenset(
    {"title", "source", "reference", "expect", "show", "figure", "cost", "influence", "measurement", "fidelity.*.label"}
)
#: tables and keys that are no physics either
NOT_PHYSICS = NOT_NUMBERS | {"fidelity", "sweep", "accuracy", "accuracy_of"}
GRID = frozenset({"frequency", "direction"})  # of a sweep
NOT_OWN = frozenset({"label", "set", "without"})  # of a fidelity: a name, and what is in its scene already


@dataclass(frozen=True, eq=False)
class Case:
    """A scene, the fidelities that model it, their sweep and what they are checked against.

    ``text`` is the case in canonical form, SI units and overrides included: it loads as the same case. ``numbers`` is
    the part of it that decides what the sweeps compute (no title, source, checks, figures): two cases compute the same
    where that text, or ``key``, is the same. ``shared`` is the part of that which no fidelity has for itself, ``own``
    for each fidelity all that decides its numbers at given frequencies. ``scenes`` has the scenes of the fidelities
    that change the case's, ``chains`` their measuring chains (None: exact).
    """

    path: Path
    text: str
    numbers: str
    shared: str
    own: Mapping[str, str]
    title: str
    source: str
    scene: Scene | SdofScene
    fidelities: dict[str, Fidelity]
    sweep: SweepPlan
    references: dict[str, Reference]
    scenes: Mapping[str, Scene | SdofScene] = field(default_factory=dict)
    expectations: Mapping[str, Expectation] = field(default_factory=dict)
    shows: Mapping[str, ShowPlan] = field(default_factory=dict)
    cost: CostPlan = field(default_factory=CostPlan)
    influence: InfluencePlan = field(default_factory=InfluencePlan)
    figure: FigurePlan = field(default_factory=FigurePlan)
    chain: Chain | None = None
    chains: Mapping[str, Chain | None] = field(default_factory=dict)
    accuracy: AccuracyPlan | None = None

    def __repr__(self) -> str:
        grid = self.sweep.frequency
        swept = f"{len(grid)} frequencies {grid.min():.6g} … {grid.max():.6g} Hz {self.sweep.direction}"
        return f"Case({self.title!r}, {str(self.path)!r}, fidelities {', '.join(self.fidelities)}, {swept})"

    @cached_property
    def key(self) -> str:
        """SHA-256 of ``numbers``, in hexadecimal."""
        return sha256(self.numbers.encode()).hexdigest()

    def everywhere(self) -> Case:
        """The same case without its ``accuracy``: every fidelity at every frequency."""
        text, numbers = _without_accuracy(self.text), _without_accuracy(self.numbers)
        return replace(self, accuracy=None, text=text, numbers=numbers)

    @property
    def base_amplitude(self) -> float:
        """Amplitude of the base motion in m (of a SdofScene: in its own unit).

        ValueError on a platform, where it depends on the frequency: ``amplitude`` has it there too.
        """
        from vibeam.fidelity import base_amplitude

        return base_amplitude(self.scene)

    def amplitude(self, omega: NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Amplitude of the drive for a sweep over ``omega`` (rad/s): one for all, or on a platform one each."""
        from vibeam.fidelity import drive_amplitude

        return drive_amplitude(self.scene, omega)

    def scene_of(self, name: str) -> Scene | SdofScene:
        """The scene of one fidelity, with what it changes; KeyError names those there are."""
        if name not in self.fidelities:
            raise KeyError(f"no fidelity {name!r}: there are {', '.join(self.fidelities)}")
        return self.scenes.get(name, self.scene)

    def chain_of(self, name: str) -> Chain | None:
        """The measuring chain through which one fidelity's motion is seen; None: none, it is exact."""
        return self.chains.get(name, self.chain)

    def amplitude_of(self, name: str, omega: NDArray[np.float64] | None = None) -> float | NDArray[np.float64]:
        """As ``amplitude``, of one fidelity (``omega`` None: as ``base_amplitude``); KeyError as in ``scene_of``."""
        from vibeam.fidelity import base_amplitude, drive_amplitude

        scene = self.scene_of(name)
        return base_amplitude(scene) if omega is None else drive_amplitude(scene, omega)

    def system(self, name: str) -> ImpactSystem:
        """What a solver gets of one fidelity; KeyError names those there are."""
        from vibeam.fidelity import system

        return system(self.scene_of(name), self.fidelities[name])


def load(path: str | PathLike[str], set: Mapping[str, Any] | None = None) -> Case:
    """The case in a file, with the keys in ``set`` put in the place of the file's.

    ``set`` maps dotted keys to values as in a case file (``{"sweep.frequency.points": 31, "stop.gap": "0.1 mm"}``);
    None takes a key away. CaseError has every fault of file and overrides.
    """
    from vibeam.case_text import read_text

    return parse(read_text(Path(path)), path, set)


def parse(text: str, path: str | PathLike[str] = "case.toml", set: Mapping[str, Any] | None = None) -> Case:
    """The case that ``text`` says, as ``load``; ``path`` is what faults call it, references lie in its folder."""
    from vibeam.canonical import canonical_text
    from vibeam.verdict import accepted

    file = Path(path)
    declared, changed = accepted(text, file, set or {})
    sweep = _sweep(declared.sweep)
    return Case(
        path=file,
        text=canonical_text(declared),
        numbers=canonical_text(declared, without=NOT_NUMBERS),
        shared=_shared(declared, declared.sweep),
        own=_own_numbers(declared, changed),
        title=declared.title or file.stem,
        source=declared.source,
        scene=scene_of(declared),
        fidelities=_fidelities(declared),
        sweep=sweep,
        references=_references(declared, file.parent, sweep.direction),
        scenes={name: scene_of(own) for name, own in changed.items()},
        expectations=_expectations(declared, sweep.direction),
        shows=_shows(declared, changed, sweep),
        cost=CostPlan(**dict(declared.cost)),
        influence=InfluencePlan(**dict(getattr(declared, "influence", ()))),
        figure=FigurePlan(**dict(declared.figure)),
        chain=_chain(declared),
        chains={name: _chain(own) for name, own in changed.items()},
        accuracy=_accuracy(declared),
    )


def _shared(case: BeamCase | SdofCase, sweep: SweepTable) -> str:
    """The physics of a case and how it is swept, its frequencies aside."""
    from vibeam.canonical import canonical_text

    return canonical_text(case, NOT_PHYSICS) + "\n[sweep]\n" + canonical_text(sweep, GRID)


def _own_numbers(case: BeamCase | SdofCase, changed: Mapping[str, BeamCase | SdofCase]) -> dict[str, str]:
    """For each fidelity its physics, how it is swept, and its table."""
    from vibeam.canonical import canonical_text

    tables: Any = case.fidelity
    return {
        name: _shared(changed.get(name, case), case.sweep) + "\n[fidelity]\n" + canonical_text(table, NOT_OWN)
        for name, table in tables.items()
    }


def _without_accuracy(text: str) -> str:
    lines = text.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(("accuracy = ", "accuracy_of = "))).lstrip("\n")


def _accuracy(case: BeamCase | SdofCase) -> AccuracyPlan | None:
    if case.accuracy is None:
        return None
    return AccuracyPlan(case.accuracy, case.accuracy_of or AccuracyPlan.quantities)


def _sweep(table: SweepTable) -> SweepPlan:
    grid: Any = table.frequency
    points = np.array(grid) if isinstance(grid, tuple) else np.linspace(grid.from_, grid.to, grid.points)
    points.setflags(write=False)
    direction: Any = table.direction
    return SweepPlan(points, direction, table.settle, table.hold, table.output)


def _fidelities(case: BeamCase | SdofCase) -> dict[str, Fidelity]:
    from vibeam.fidelity import Fidelity

    tables: Any = case.fidelity
    return {
        name: Fidelity(name=name, changes=dict(table.set), **table.model_dump(exclude={"set"}))
        for name, table in tables.items()
    }


def _chain(case: BeamCase | SdofCase) -> Chain | None:
    table = case.measurement
    if table is None:
        return None
    from vibeam.observe.filters import LowPass
    from vibeam.observe.measurement import Chain

    low_pass: LowPass | None = None
    if table.low_pass is not None:
        family: Any = table.low_pass
        elliptic = (table.ripple or RIPPLE, table.attenuation or ATTENUATION) if family == "elliptic" else ()
        low_pass = LowPass(family, table.order or 0, table.cut_off or 0.0, *elliptic)
    return Chain(table.sampling, low_pass, table.noise, table.seed, table.quantisation)


def _references(case: BeamCase | SdofCase, folder: Path, swept: Direction) -> dict[str, Reference]:
    found = {}
    for name, table in case.reference.items():
        file = (folder / table.file).absolute()
        values = table.model_dump() | {"file": file, "direction": table.direction or swept}
        values["quote"] = file.resolve().is_relative_to(folder.resolve())
        found[name] = Reference(name=name, **values)
    return found


def _expectations(case: BeamCase | SdofCase, swept: Direction) -> dict[str, Expectation]:
    if not case.expect:
        return {}
    from vibeam.expect import Expectation

    values = {name: table.model_dump() | {"direction": table.direction or swept} for name, table in case.expect.items()}
    return {name: Expectation(name=name, **value) for name, value in values.items()}


def _shows(
    case: BeamCase | SdofCase, changed: Mapping[str, BeamCase | SdofCase], sweep: SweepPlan
) -> dict[str, ShowPlan]:
    own = _own_numbers(case, changed)
    seen = {name: f"{own[name]}{_measured(changed.get(name, case))}" for name in own}
    return {name: _show(case, name, sweep, seen) for name in case.show}


def _measured(case: BeamCase | SdofCase) -> str:
    from vibeam.canonical import canonical_text

    return "" if case.measurement is None else canonical_text(case.measurement)


def _show(case: BeamCase | SdofCase, name: str, sweep: SweepPlan, seen: Mapping[str, str]) -> ShowPlan:
    """The plan of one table; its key hangs on the table itself and on what is ``seen`` of its fidelities."""
    from vibeam.canonical import canonical_text
    from vibeam.show.plan import ShowPlan

    table = case.show[name]
    fidelities = table.fidelities or tuple(case.fidelity)
    frequency = tuple(sweep.frequency.tolist()) if table.frequency is None else table.frequency
    physics = [_shared(case, case.sweep), *(seen[each] for each in fidelities)]
    decisive = [*physics, canonical_text(table), repr(fidelities), repr(frequency)]
    return ShowPlan(
        name=name,
        kind=table.kind,
        fidelities=fidelities,
        frequency=frequency,
        periods=table.periods,
        settle=sweep.settle if table.settle is None else table.settle,
        quantity=table.quantity,
        key=sha256("\n".join(decisive).encode()).hexdigest(),
        output=table.output or sweep.output,
        near=table.near,
        highest=table.highest,
        subdivision=table.subdivision,
    )
