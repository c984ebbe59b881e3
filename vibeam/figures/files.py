"""Files of a figure: their names, and a stamp that tells whether they show the present results.

Nothing here needs matplotlib, which is imported only where something is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.exchange.whole_files import beside
from vibeam.figures import FIGURES

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import FigurePlan

MARK = {".png": "Identifier", ".svg": "Identifier", ".pdf": "Keywords"}  # entry of the metadata that holds the stamp
METADATA: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def paths_of(stem: Path, plan: FigurePlan) -> list[Path]:
    """Files of a figure beside ``stem``, whose ending they replace."""
    return [beside(stem.with_suffix(f".{ending}")) for ending in plan.format]


def shown_paths(path: Path, case: Case, name: str) -> list[Path]:
    """Files of the figure [show.``name``] beside the results file ``path``."""
    stem, own = path.with_name(f"{path.stem}_{name}.x"), FIGURES[case.shows[name].kind].ending
    return [beside(stem.with_suffix(f".{own}"))] if own else paths_of(stem, case.figure)


def figure_files(path: Path, case: Case) -> list[Path]:
    """Files of all figures of a case beside its results file ``path``."""
    return [*paths_of(path, case.figure), *(file for name in case.shows for file in shown_paths(path, case, name))]


def stamp(results: Path, case: Case) -> str:
    """Digest of all that the figures of a case are drawn from: results, case, references, the code that draws."""
    digest = sha256(f"matplotlib {version('matplotlib')}\n{case.text}\n".encode())
    references = {reference.file for reference in case.references.values() if reference.curve is None}
    house = Path(__file__).parents[1]
    sources = [*(house / "figures").rglob("*.py"), *(house / "report").glob("*.py"), house / "observe" / "branches.py"]
    for file in [results, *sorted(references), *sorted(sources)]:
        digest.update(file.read_bytes())
    return f"vibeam:{digest.hexdigest()}"


def metadata(path: Path, mark: str | None) -> dict[str, Any]:
    """Metadata of a figure's file, its stamp among them."""
    return METADATA.get(path.suffix, {}) | ({MARK[path.suffix]: mark} if mark else {})


def all_current(files: Iterable[Path], mark: str) -> bool:
    """True where every one of ``files`` is there with this stamp."""
    return all(file.is_file() and mark.encode() in file.read_bytes() for file in files)
