"""Numbers of each fidelity as functions of a key, a + b·key, with the proof that the key changes nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.faults import CaseError
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity, Model
    from vibeam.system.impact_system import ImpactSystem

Affine = tuple[float, float]  # a and b of a + b·key
Read = Callable[["ImpactSystem"], float | None]
SAME = 1e-12  # relative difference that is round-off
PROBED = 4  # systems, beside the case's own: two that make a number of a key, others that have to lie on it


def gap(system: ImpactSystem) -> float:
    """Gap at the contact, m."""
    return system.gap


def restitution(system: ImpactSystem) -> float | None:
    """R at the contact, or the coefficient of a law that has one; None where the law has none."""
    if system.law is None:
        return system.restitution
    try:
        return system.law.kernel_numbers().values.get("coefficient")
    except ValueError:
        return None


def own_number(case: Case, name: str, key: str, read: Read, probes: Iterable[float]) -> Affine | None:
    """The number that ``read`` takes of a fidelity's system, as a + b·key; b is 0 where the fidelity says the key.

    The first two ``probes`` that the model may have make it; the case's own value and a third one have to lie on it.
    None: the fidelity says the key and has no such number. ValueError, with the reason, where the numbers do not lie on
    it, or where anything else of the system changes.
    """
    fidelity, model = case.fidelities[name], case.model(name)
    base = model.system()
    here, value = read(base), case.keys.value(key)
    if says(fidelity, key):
        return None if here is None else (here, 0.0)
    if here is None:
        law = base.law.name if base.law else ""
        raise ValueError(f'the law "{law}" has no coefficient that {key} moves in proportion')
    if REDUCTIONS[fidelity.reduction].flown:
        raise ValueError(f"its modes are those of a flight, and {key} changes that")
    probed = ((each, made) for each in probes if (made := system_at(model, {key: each})) is not None)
    found = list(islice(probed, PROBED))
    if len(found) < 3:
        raise ValueError(f"{key} has no room to move in")
    (low, first), (high, last), *others = found
    ends = [_read(read, each) for each in (first, last)]
    slope = (ends[1] - ends[0]) / (high - low)
    start = ends[0] - slope * low
    for place, made in ((value, base), *others):
        if not np.isclose(start + slope * place, _read(read, made), rtol=SAME, atol=SAME * max(map(abs, ends))):
            raise ValueError(f"its contact does not follow {key} in proportion")
    if changed := next((each for _, made in found for each in changes(base, made, read)), None):
        raise ValueError(f"{key} changes its {changed}")
    return start, slope


def damping_factor(case: Case, name: str, keys: Mapping[str, float]) -> Affine:
    """Factor on the damping of a fidelity as a + b·factor on ``keys``; b is 0 where the fidelity says them all.

    ValueError, with the reason, where twice the keys are not twice its damping, or change anything else.
    """
    fidelity, model = case.fidelities[name], case.model(name)
    mine = {key: 2 * value for key, value in keys.items() if not says(fidelity, key)}
    if not mine:
        return 1.0, 0.0
    if REDUCTIONS[fidelity.reduction].flown:
        raise ValueError("its modes are those of a flight, and damping changes that")
    base = model.system()
    if base.beyond_plain:  # the page flies it by regimes, at its own damping, and refuses any other
        return 0.0, 1.0
    twice = system_at(model, mine)
    if twice is None:
        raise ValueError("twice its damping is refused")
    if not _near(2 * base.zeta, twice.zeta):
        raise ValueError("it has damping that the case's ratios do not say")
    if changed := next(iter(changes(base, twice, None, "zeta")), None):
        raise ValueError(f"damping changes its {changed}")
    return 0.0, 1.0


def says(fidelity: Fidelity, key: str) -> bool:
    """Test whether a fidelity has a key of its own, or leaves it out."""
    mine = [*_dotted(fidelity.changes), *fidelity.without]
    return any(key == each or key.startswith(f"{each}.") for each in mine)


def _dotted(tables: Mapping[str, Any], above: str = "") -> Iterator[str]:
    for name, value in tables.items():
        yield from _dotted(value, f"{above}{name}.") if isinstance(value, Mapping) else (f"{above}{name}",)


def system_at(model: Model, values: Mapping[str, float]) -> ImpactSystem | None:
    """System with keys at other values; None where that is refused."""
    try:
        return model.at(values).checked().system()
    except (CaseError, ValueError):
        return None


def _read(read: Read, system: ImpactSystem) -> float:
    found = read(system)
    return float("nan") if found is None else found


def changes(base: ImpactSystem, made: ImpactSystem, read: Read | None, *known: str) -> Iterator[str]:
    """Parts of a system that are not the same in another: not counting what is ``read``, and those ``known``."""
    aside = {*known, *(("gap",) if read is gap else ("restitution", "law") if read is restitution else ())}
    for each in fields(base):
        if each.name not in aside and not _near(getattr(base, each.name), getattr(made, each.name)):
            yield each.name
    if read is restitution and not _same_law(base.law, made.law):
        yield "law"


def _same_law(one: Any, two: Any) -> bool:
    """Test whether two laws differ in their coefficient alone."""
    if one is None or two is None:
        return one is two
    first, second = one.kernel_numbers(), two.kernel_numbers()
    mine, theirs = ({**each.values, "coefficient": 0.0} for each in (first, second))
    return first.formula == second.formula and _near(mine, theirs) and _near(first.table, second.table)


def _near(one: Any, two: Any) -> bool:
    """Test whether two parts of a system are the same to round-off."""
    if isinstance(one, Mapping) and isinstance(two, Mapping):
        return one.keys() == two.keys() and all(_near(one[key], two[key]) for key in one)
    if one is None or two is None or not isinstance(one, np.ndarray | float):
        return bool(one == two)
    scale = float(np.max(np.abs(one), initial=0.0))
    return np.shape(one) == np.shape(two) and bool(np.all(np.abs(np.subtract(one, two)) <= SAME * scale))
