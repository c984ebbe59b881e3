"""Cases with subsets of the effects: each is complete and can be run as usual."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import Case
from vibeam.casefile.content import content, toml_text
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.read import parse, validate
from vibeam.studies.influence.effects import companions, effects_of

Array = NDArray[np.float64]

SAME = 1e-9  # relative tolerance for two models' modes to be the same


@dataclass(frozen=True)
class Subsets:
    """Subsets of the effects of one fidelity, over the frequencies of the case's ``[influence]``.

    ``own_modes``: number of the fidelity's modes that an effect adds to the others (torsion does).
    ``companions``: keys beside an effect that are meaningless without it. ``modes``: the fidelity's number of modes,
    None where its reduction sets it.
    """

    text: str
    path: Path
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
        return parse(self.text, self.path, settings)

    def _modes_without(self, settings: dict[str, Any], wanted: int) -> int:
        """Number of modes wanted, or that of the model where it has fewer."""
        declared, _ = validate(self.text, self.path, settings | {self._modes_key: 1})
        return min(wanted, KINDS[declared.kind].most_modes_of(declared, self.path.parent)[0])

    @property
    def _modes_key(self) -> str:
        return f"fidelity.{self.fidelity}.modes"


def subsets(case: Case) -> Subsets:
    """Subsets of a case's effects; ValueError where there is none."""
    if case.scene.given_mode is not None:
        raise ValueError("a single degree of freedom by itself has no effects: influence needs a beam")
    name = case.influence.fidelity or finest(case)
    declared, changed = validate(case.text, case.path, {})
    own: Any = changed.get(name, declared)
    effects = effects_of(own)
    if not effects:
        raise ValueError(f"fidelity {name!r} names no effect: vibeam keys lists those there are, each marked 'effect'")
    table: Any = declared.fidelity[name]
    alone = {
        "fidelity": {name: table.model_copy(update={"set": None, "without": None})},
        "sweep": own.sweep.model_copy(update=_reduced(case)),
    }
    text = toml_text({"units": "SI"} | content(own.model_copy(update=alone), "numbers"))
    beside = {effect: companions(own, effect) for effect in effects}
    found = Subsets(text, case.path, name, effects, {}, beside, table.modes)
    return replace(found, own_modes=_own_modes(found))


def _reduced(case: Case) -> dict[str, Any]:
    """Sweep reduced to fewer of its frequencies, with the periods of [influence]."""
    plan, grid = case.influence, np.sort(case.sweep.frequency)
    chosen = np.unique(np.linspace(0, len(grid) - 1, min(plan.points, len(grid))).round().astype(int))
    given = {"settle": plan.settle, "hold": plan.hold}
    periods = {name: value for name, value in given.items() if value is not None}
    return {"frequency": tuple(grid[chosen].tolist())} | periods


def finest(case: Case) -> str:
    """Fidelity with most modes, the first of several, among those that change nothing of the case's own physics."""
    plain = [name for name, each in case.fidelities.items() if not (each.changes or each.without)]
    return max(plain or case.fidelities, key=lambda name: case.system(name).size)


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
    return case.scene.structure().modes(modes).omega
