"""Subsets of the effects of a case: the cases that have them, and the search for the smallest sufficient one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fineness import plain
from vibeam.casefile.tables.declared import Table
from vibeam.casefile.validation import physics_keys
from vibeam.system.curves import evenly
from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of
from vibeam_models.effects import parts_of


def effects_of(declared: Table) -> tuple[str, ...]:
    """Dotted keys of the effects in a declared case, in its order; of several tables of a kind each by its index.

    Effects at their neutral value (None, or the default) are left out.
    """
    return tuple(name for field in physics_keys(type(declared)) for name in _named(declared, field))


def companions(declared: Table, name: str) -> tuple[str, ...]:
    """Keys of a declared case that are meaningless without an effect: beside it, or tables that are on it."""
    table, _, key = name.partition(".")
    carried = () if key else tuple(_on(declared, name))
    if carried:
        return carried
    inner = getattr(declared, table, None)
    if not (key and isinstance(inner, Table)):
        return ()
    beside = [other for other, field in inner.KEYS.items() if field.of == key]
    return tuple(f"{table}.{each}" for each in beside if getattr(inner, each) is not None)


def _on(declared: Table, name: str) -> Iterator[str]:
    """Effects, tables of which there are several, with ``on`` = ``name``, and its parts: that beam carries them."""
    yield from (part for part in parts_of(name) if getattr(declared, part, None) is not None)
    for field in physics_keys(type(declared)):
        if declared.KEYS[field].many:
            carried = [getattr(each, "on", None) == name for each in getattr(declared, field) or ()]
            yield from (effect for effect, is_on in zip(_named(declared, field), carried, strict=False) if is_on)


def _named(declared: Table, name: str) -> Iterator[str]:
    field, value = declared.KEYS[name], getattr(declared, name)
    if not field.effect:
        yield from (f"{name}.{key}" for key in _keys(value))
    elif field.many:
        yield from ([name] if len(value) == 1 else [f"{name}.{index}" for index in range(len(value))])
    elif value is not None:
        yield name


def _keys(table: object) -> Iterator[str]:
    """Effects among a table's own keys."""
    if isinstance(table, Table):
        for key, field in table.KEYS.items():
            if field.effect and getattr(table, key) != field.default:
                yield key


SAME = 1e-9  # relative tolerance for two models' modes to be the same


@dataclass(frozen=True)
class Subsets:
    """Subsets of the effects of one fidelity: of the case ``whole``, a sweep over the frequencies of ``[influence]``.

    ``own_modes``: number of the fidelity's modes that an effect adds to the others (torsion does).
    ``companions``: keys beside an effect that are meaningless without it. ``modes``: the fidelity's number of modes,
    None where its reduction sets it.
    """

    whole: Case
    fidelity: str
    effects: tuple[str, ...]
    own_modes: dict[str, int]
    companions: dict[str, tuple[str, ...]]
    modes: int | None = None

    def case(self, kept: Collection[str]) -> Case:
        """Case with the effects in ``kept`` alone; CaseError where it is invalid without the others.

        Settings that need an effect go with it: keys beside it, its own modes, modes that no longer exist.
        """
        away = [name for name in self.effects if name not in kept]
        beside = [key for name in away for key in self.companions.get(name, ())]
        last_first = [name for name in reversed(self.effects) if name in away or name in beside]
        settings: dict[str, Any] = dict.fromkeys([*last_first, *beside])  # the last of several tables first
        lost = sum(self.own_modes.get(name, 0) for name in away)
        if self.modes is not None and away:
            settings[self._modes_key] = self._modes_without(settings, max(self.modes - lost, 1))
        return self.whole.with_keys(settings)

    def _modes_without(self, settings: dict[str, Any], wanted: int) -> int:
        """Number of modes wanted, or that of the model where it has fewer."""
        other = self.whole.with_keys(settings | {self._modes_key: 1})
        return min(wanted, other.model(self.fidelity).most_modes or wanted)

    @property
    def _modes_key(self) -> str:
        return f"fidelity.{self.fidelity}.modes"


def subsets(case: Case) -> Subsets:
    """Subsets of the effects of the fidelity that [influence] names, else of the finest; ValueError without any."""
    if case.scene.given_mode is not None:
        raise ValueError("a single degree of freedom by itself has no effects: influence needs a beam")
    name = case.influence.fidelity or finest(case)
    model: Any = case.model(name)
    own, whole = model.tables, case.alone(name)
    effects = effects_of(own)
    if not effects:
        raise ValueError(f"fidelity {name!r} names no effect: vibeam keys lists those there are, each marked 'effect'")
    whole = whole if case.record is not None else whole.with_keys(_reduced(case))
    beside = {effect: companions(own, effect) for effect in effects}
    found = Subsets(whole, name, effects, {}, beside, own.fidelity[name].modes)
    return replace(found, own_modes=_own_modes(found))


def _reduced(case: Case) -> dict[str, Any]:
    """Sweep reduced to fewer of its frequencies, with the periods and the frequency of [influence]."""
    plan, grid = case.influence, np.sort(case.sweep.frequency)
    chosen = evenly(0, len(grid) - 1, plan.points)
    given = {
        "sweep.settle": plan.settle, "sweep.hold": plan.hold, "influence.frequency": plan.frequency
    }  # fmt: skip
    return {"sweep.frequency": grid[chosen].tolist()} | {
        name: value for name, value in given.items() if value is not None
    }


def finest(case: Case) -> str:
    """Fidelity with most modes, the first of several, among beams that change nothing of the case's own rig."""
    names = plain(case) or list(case.fidelities)
    beams = [name for name in names if not case.scene_of(name).in_three_dimensions] or names
    return max(beams, key=lambda name: case.system(name).size)


def _own_modes(found: Subsets) -> dict[str, int]:
    """Number of the fidelity's modes that each effect adds, where all others exist without it as well.

    Such an effect (torsion) must not leave its places to other modes: that would change the reduction.
    """
    if found.modes is None:
        return {}
    whole = _frequencies(found.case(found.effects), found.modes)
    own = {}
    for name in found.effects:
        with suppress(ValueError):  # an effect that cannot be removed is reported later, with its reason
            left = _frequencies(found.case([other for other in found.effects if other != name]), found.modes)
            own[name] = len(whole) - _shared(whole, left)
    return {name: count for name, count in own.items() if count}


def _shared(whole: Array, left: Array) -> int:
    """Number of modes kept where an effect only adds modes; all, where it changes them."""
    below = left[left <= whole[-1] * (1 + SAME)]
    stays = [bool(np.any(np.abs(whole - each) <= SAME * each)) for each in below]
    return len(below) if len(below) and all(stays) else len(whole)


def _frequencies(case: Case, modes: int) -> Array:
    return structure_of(case.scene).modes(modes).omega


EXACT = 6  # largest number of effects for which all sets are tried
Worst = Callable[[frozenset[str]], float]


def smallest(effects: Sequence[str], worst: Worst, all_sets: bool = True) -> tuple[frozenset[str], bool]:
    """Find the set, and whether it is proved to be the smallest: by ``all_sets``, where the effects are few.

    ``worst``: the largest change of a set in units of its tolerance, sufficient where it is at most 1; ∞ for an
    invalid set. Of several equally small sets the one with the least change.
    """
    if all_sets and len(effects) <= EXACT:
        return _of_all(effects, worst), True
    return _one_by_one(effects, worst), False


def _of_all(effects: Sequence[str], worst: Worst) -> frozenset[str]:
    for size in range(len(effects)):
        best, least = min(((frozenset(kept), worst(frozenset(kept))) for kept in combinations(effects, size)),
                          key=lambda pair: pair[1])  # fmt: skip
        if least <= 1:
            return best
    return frozenset(effects)


def _one_by_one(effects: Sequence[str], worst: Worst) -> frozenset[str]:
    """Eliminate the effect with the least influence among those left, as long as the rest is sufficient."""
    kept = frozenset(effects)
    while kept:
        away = [(worst(kept - {name}), index, name) for index, name in enumerate(effects) if name in kept]
        least, _, name = min(away, default=(inf, 0, ""))
        if least > 1:
            break
        kept -= {name}
    return kept
