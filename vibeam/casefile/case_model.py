"""Model of one fidelity of a case as a function of the case's keys: scene and impact system, no text in between."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.case.fidelity import system
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.read import validate
from vibeam.casefile.tables.table import toml_text
from vibeam.casefile.toml import key_parts
from vibeam.casefile.validation import SHARED, declaration, physics_keys

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.system.impact_system import ImpactSystem


@dataclass(frozen=True)
class CaseModel:
    """Checked tables of a case as one ``fidelity`` sees them, with files looked for from ``folder``."""

    tables: Any
    fidelity: Fidelity
    folder: Path

    @classmethod
    def of(cls, case: Case, fidelity: str) -> CaseModel:
        """Model of a fidelity at the case's own values; KeyError for an unknown fidelity."""
        own, changed = validate(narrowed(case, fidelity), case.path, {})
        return cls(changed.get(fidelity, own), case.fidelities[fidelity], case.path.parent)

    def at(self, values: Mapping[str, float]) -> CaseModel:
        """The model with keys at other values, SI, that the case is known to allow: they are not checked again."""
        tables = self.tables
        for key, value in values.items():
            tables = _put(tables, key_parts(key), float(value))
        return replace(self, tables=tables)

    def value(self, key: str) -> float:
        """Value of a key that holds one number, SI."""
        place = self.tables
        for part in key_parts(key):
            place = place[part] if isinstance(place, Mapping) else getattr(place, part)
        return float(place)

    def scene(self) -> Any:
        """Scene; ValueError for an impossible one."""
        return KINDS[self.tables.kind].scene_of(self.tables, self.folder)

    def system(self) -> ImpactSystem:
        """Impact system; ValueError for an impossible one."""
        return system(self.scene(), self.fidelity)


def narrowed(case: Case, fidelity: str) -> str:
    """The case as TOML with one fidelity, and nothing that a grid does not read; KeyError for an unknown fidelity."""
    case.scene_of(fidelity)
    tables = tomllib.loads(case.text)
    kept = {*physics_keys(declaration(tables)), *SHARED} - {"measurement"}
    own = {key: each for key, each in tables.items() if key in kept}
    return toml_text(own | {"fidelity": {fidelity: tables["fidelity"][fidelity]}})


def _put(place: Any, path: Sequence[str], value: float) -> Any:
    """A copy of tables with one value changed; a list of one number stays one."""
    if not path:
        return (value,) if isinstance(place, tuple) else value
    first, *rest = path
    if isinstance(place, Mapping):
        return {**place, first: _put(place[first], rest, value)}
    if isinstance(place, list | tuple):
        made = [_put(each, rest, value) if number == int(first) else each for number, each in enumerate(place)]
        return type(place)(made)
    return place.model_copy(update={first: _put(getattr(place, first), rest, value)})
