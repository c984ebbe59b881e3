"""Models of a map: the fidelities that its picture suits, each model once, and the reasons of those left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import require_one_harmonic
from vibeam.case.grid_keys import LEVELS, MapPlan
from vibeam.runs.comparison.differences import listed
from vibeam.runs.systems import Systems

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem

MOST = 101, 161  # usual points of a stability map: of another key, and of the frequency
CELL, MODE = 10e-3, 4e-3  # s of CPU time of a point whose motions are shot at, about, and for each mode
SECONDS = 300.0  # of CPU time of a map by shooting, about, that says no number of points


@dataclass(frozen=True)
class MappedModels:
    """Names of distinct models, the ``twins`` of each among the fidelities, and sentences on those left out."""

    twins: dict[str, tuple[str, ...]]
    notes: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """One fidelity of each model."""
        return tuple(self.twins)


def models_of(case: Case, plan: MapPlan) -> MappedModels:
    """Models of a map.

    ValueError for an unknown fidelity, and of a fidelity map where fewer than two models remain.
    """
    unknown = [name for name in plan.fidelities if name not in case.fidelities]
    if unknown:
        raise ValueError(f"no fidelity {', '.join(map(repr, unknown))}: there are {', '.join(case.fidelities)}")
    find = {"verdict": _compared, "stability": _known}.get(plan.picture)
    if find is None:
        return MappedModels({name: (name,) for name in plan.fidelities or case.fidelities})
    called = "a fidelity map" if plan.picture == "verdict" else "a stability map"
    require_one_harmonic(case, called, plan.fidelities)
    return find(case, plan)


def _compared(case: Case, plan: MapPlan) -> MappedModels:
    """Models that fly, those alone that change the rig no more than others do unless they are named."""
    built, found, notes = Systems(case), dict[str, list[str]](), list[str]()
    usual = min((len(case.fidelities[name].rig) for name in case.fidelities), default=0)
    for name, fidelity in case.fidelities.items():
        if plan.fidelities and name not in plan.fidelities:
            continue
        twin = next((other for other in found if built[name].moves_as(built[other])), None)
        if twin is not None:
            notes.append(f"{name}: the same model as {twin}")
            found[twin].append(name)
        elif fidelity.solver != "flight":
            notes.append(f'{name}: left out, for its solver is "{fidelity.solver}" and not flight')
        elif not plan.fidelities and len(fidelity.rig) > usual:
            tables = Counter(key.partition(".")[0] for key in fidelity.rig)
            keys = [key for key in fidelity.rig if tables[key.partition(".")[0]] == 1]
            changed = ", ".join([*keys, *(table for table, count in tables.items() if count > 1)])
            notes.append(f"{name}: left out, for it changes the rig ({changed}): name it by --fidelity")
        else:
            found[name] = [name]
    if len(found) < 2:
        raise ValueError(
            "; ".join([f"a fidelity map compares two models or more, and the case has {len(found)}", *notes])
        )
    return MappedModels({name: tuple(names) for name, names in found.items()}, tuple(notes))


def usual_points(systems: Iterable[ImpactSystem]) -> tuple[int, int]:
    """Numbers of points of a stability map that says none: fewer where motions of models are shot at."""
    price = sum(CELL + MODE * each.size for each in systems if each.beyond_plain) * prod(MOST) / SECONDS
    share = 1 / np.sqrt(max(price, 1.0))
    return 1 + round((MOST[0] - 1) * share), 1 + round((MOST[1] - 1) * share)


def _known(case: Case, plan: MapPlan) -> MappedModels:
    """Models each under its own drive; by shooting where no closed form knows one."""
    systems, found, shot = dict[str, "ImpactSystem"](), dict[str, list[str]](), dict[str, list[str]]()
    omega = 2 * np.pi * np.array(plan.axes[-1].values)
    for name in plan.fidelities or case.fidelities:
        system = case.system(name)
        if system.beyond_plain:
            shot.setdefault(" or ".join(system.beyond_plain), []).append(name)
        drive = case.amplitude_of(name, omega)
        twin = next(
            (
                other
                for other in found
                if systems[other].moves_as(system) and np.array_equal(case.amplitude_of(other, omega), drive)
            ),
            None,
        )
        systems[name] = system
        found.setdefault(twin or name, []).append(name)
    told = (
        "by shooting, for no closed form knows {}: motions with any number of contacts, some of which may not be "
        "found, and no boundaries"
    )
    notes = [f"{listed(names)}: {told.format(why)}" for why, names in shot.items()]
    rows, columns = usual_points(systems[name] for name in found)
    if (rows, columns) == tuple(len(axis.values) for axis in plan.axes[-2:]) != MOST:
        notes.append(f"{rows} by {columns} points, so that shooting takes a few minutes: --points says how many")
    key = plan.axes[-2].key
    apart = [name for name in found if key in LEVELS and case.model(name).value(key) is None]
    notes += [f"{listed(found[name])}: no map, for its drive is not said by {key}" for name in apart]
    return MappedModels({name: tuple(found[name]) for name in found if name not in apart}, tuple(notes))
