"""The kinds of case, each declared once: the table that tells it, its tables, rules and scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.registry import Registry, loaded

if TYPE_CHECKING:
    from vibeam_models.scene import AnyScene


@dataclass(frozen=True)
class CaseKind:
    """A kind of case: a file that has the table ``name`` is of it, and of the beam where it has none of these.

    What it does is said as ``"module:function"``, imported when it is asked for:

    - ``rules`` yields complaints of its own (case, folder), ``outputs`` those about a motion asked for (case, path,
      output);
    - ``scene`` makes its scene (declared case, folder), ``most_modes`` counts the modes it has, with what
      gives them (case, folder);
    - ``sources`` tells the digests of the files that it is made of (declared case, folder; empty: of none).

    ``plain``: its numbers have no dimension; ``one_mode``: it is one mode. Of a given structure that is no kind of
    vibeam's own ``table`` is the dataclass of the keys of its table and ``meaning`` what it is; where that may stand
    beside [beam] too, ``needs`` is the key by which it is the whole rig.
    """

    name: str
    rules: str
    outputs: str
    scene: str
    most_modes: str = ""
    sources: str = ""
    plain: bool = False
    one_mode: bool = False
    table: str | type[Any] = ""
    meaning: str = ""
    needs: str = ""

    def declaration(self) -> Any:
        """Its tables and keys, with the effects and contact laws that are registered now: a class of ``AnyCase``."""
        return loaded("vibeam.casefile.tables.cases:case_table")(self.name)

    def checks(self, case: Any, folder: File) -> Iterator[Complaint]:
        """Complaints about what is its own."""
        yield from loaded(self.rules)(case, folder)

    def output_complaints(self, case: Any, path: KeyPath, output: str | None) -> Iterator[Complaint]:
        """A complaint where a motion is asked for that it does not have."""
        yield from loaded(self.outputs)(case, path, output)

    def most_modes_of(self, case: Any, folder: File) -> tuple[int, str]:
        """Largest number of modes of a case (0: not known), and what gives it, as in "beam.elements gives"."""
        found: tuple[int, str] = loaded(self.most_modes)(case, folder) if self.most_modes else (1, "one mode gives")
        return found

    def scene_of(self, case: Any, folder: File) -> AnyScene:
        """The scene of a checked case, whose files are looked for from ``folder``."""
        made: AnyScene = loaded(self.scene)(case, folder)
        return made

    def digests(self, case: Any, folder: File) -> Mapping[str, str]:
        """SHA-256 of the content of the files that a checked case is made of, by the key that names them."""
        found: Mapping[str, str] = loaded(self.sources)(case, folder) if self.sources else {}
        return found


KINDS = Registry(
    "kind of case",
    CaseKind(
        "beam",
        "vibeam.casefile.tables.beam:beam_rules",
        "vibeam.casefile.tables.outputs:beam_output",
        "vibeam.casefile.scenes:beam_scene",
        "vibeam.casefile.tables.beam:most_modes",
    ),
    CaseKind(
        "sdof",
        "vibeam.casefile.tables.cases:sdof_rules",
        "vibeam.casefile.tables.cases:sdof_output",
        "vibeam.casefile.scenes:sdof_scene",
        plain=True,
        one_mode=True,
    ),
    CaseKind(
        "matrices",
        "vibeam.casefile.tables.given:matrices_rules",
        "vibeam.casefile.tables.given:given_output",
        "vibeam.casefile.scenes:given_scene",
        "vibeam.casefile.tables.given:most_modes",
        "vibeam.casefile.tables.given:sources",
    ),
    CaseKind(
        "modes",
        "vibeam.casefile.tables.given:modes_rules",
        "vibeam.casefile.tables.given:given_output",
        "vibeam.casefile.scenes:given_scene",
        "vibeam.casefile.tables.given:most_modes",
        "vibeam.casefile.tables.given:sources",
    ),
)


@dataclass(frozen=True)
class ModelDeclaration:
    """Model of the rig that a fidelity of a beam's case names in place of the beam, by ``model = "NAME"``.

    Its table [NAME] has the keys that the dataclass ``table`` declares, and ``meaning``. ``scene`` (declared case,
    folder, scene of the beam) makes its scene, ``rules`` (case, folder) yields complaints, ``sources`` the digests of
    files: ``"module:function"``, imported when it is asked for.
    """

    name: str
    meaning: str
    table: str | type[Any]
    scene: str
    rules: str = ""
    sources: str = ""


MODELS: Registry[ModelDeclaration] = Registry("model")


def kind_of(tables: Mapping[str, Any]) -> CaseKind:
    """The kind of case that a file's tables are; one whose table may stand beside [beam] is the whole rig without."""
    others = (kind for name, kind in KINDS.items() if name != "beam" and name in tables)
    return next((kind for kind in others if not kind.needs or _is_whole(tables, kind)), KINDS["beam"])


def _is_whole(tables: Mapping[str, Any], kind: CaseKind) -> bool:
    """Test whether the table of a kind is all of the rig."""
    said = tables[kind.name]
    return "beam" not in tables and isinstance(said, Mapping) and kind.needs in said
