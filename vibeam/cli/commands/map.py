"""``vibeam map``: maps over any keys of a case, computed block by block, stored and drawn."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, folder, load, output_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.maps.cluster import Cluster
    from vibeam.maps.run import MapResult

Only = Annotated[
    list[str] | None, typer.Option("--only", metavar="NAME", help="This map alone. Repeatable; absent = all.")
]

Out = Annotated[
    str | None,
    typer.Option(
        "--out", metavar="FILE", help="The map's file (.h5), or the folder for all; folders on the way are made.",
        show_default=False,
    ),
]  # fmt: skip


Workers = Annotated[
    str | None,
    typer.Option(
        "--cluster", metavar="ADDRESS", help="Compute by the workers of this Dask scheduler; or its scheduler file.",
        show_default=False,
    ),
]  # fmt: skip


def map(
    case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: Out = None, only: Only = None,
    fresh: Fresh = False, cluster: Workers = None,
) -> None:  # fmt: skip
    """Map a case over any of its keys, or continue a map."""
    loaded = load(case, set_)
    names = _names(loaded, only)
    rows: list[Any] = []
    motions: list[Any] = []
    notes: list[str] = []
    files: list[Path] = []
    for name in names:
        path = _path(loaded, out, name, len(names))
        result = _computed(case, loaded, name, path, fresh, cluster)
        drawn, said = _drawn(result)
        rows += _rows(result)
        motions += _motions(result)
        notes += [f"{name}: {each}" for each in said]
        files += [path, *drawn]

    def tables(_: Any) -> list[Any]:
        from vibeam.figures.units import units_of
        from vibeam.report.maps import page as made

        units = units_of(loaded, length=max((each.amplitude for each in motions), default=0.0))
        return [made.shares(rows), *([made.motions(motions, units)] if motions else [])]

    found = {"maps": rows} | ({"motions": motions} if motions else {})
    print_result(found | {"remarks": notes, "files": files}, as_json, tables, [*notes, *files])


def _names(case: Case, only: list[str] | None) -> list[str]:
    from vibeam.exchange.faults import suggest

    if not case.maps:
        raise UsageError(f"{case.path}: the case has no map: add a table [map.NAME] (vibeam keys map)")
    unknown = [name for name in only or () if name not in case.maps]
    if unknown:
        raise UsageError("\n".join(f"--only {name}: no such map; {suggest(name, case.maps)}" for name in unknown))
    return only or list(case.maps)


def _path(case: Case, out: str | None, name: str, count: int) -> Path:
    """The file of a map: ``out`` itself for a single one, else the case's and the map's name in that folder."""
    own = f"{case.path.stem}_{name}.h5"
    if out is not None and count > 1:
        if Path(out).suffix and not Path(out).is_dir():
            raise UsageError(f"{out}: the case has {count} maps: name a folder, or one of them by --only")
        return folder(Path(out)) / own
    return output_path(out, own, (".h5",), "the file of a map")


def _computed(case: Path, loaded: Case, name: str, path: Path, fresh: bool, where: str | None) -> MapResult:
    from vibeam.cli.progress import Bar
    from vibeam.maps.run import run_map

    with _workers(where) as cluster, Bar(f"map {name}") as bar:
        return of_case(
            case, lambda: run_map(loaded, name, path, fresh=fresh, progress=bar, partial=_sketch, cluster=cluster)
        )


@contextmanager
def _workers(where: str | None) -> Iterator[Cluster | None]:
    if where is None:
        yield None
        return
    from vibeam.maps.cluster import ClusterError, connected

    try:
        with connected(where) as cluster:
            yield cluster
    except ClusterError as fault:
        raise UsageError(str(fault)) from None


def _sketch(result: MapResult) -> None:
    """Draw what is known so far."""
    from vibeam.report.maps.page import write_map

    write_map(result, _picture(result.path), exact=False)


def _picture(path: Path) -> Path:
    return path.with_suffix(".png")


def _drawn(result: MapResult) -> tuple[list[Path], list[str]]:
    from vibeam.figures.files import paths_of
    from vibeam.report.maps.page import write_map

    figures = paths_of(result.path, result.case.figure)
    return figures, write_map(result, *figures)


def _rows(result: MapResult) -> list[Any]:
    from vibeam.maps.result import rows_of

    return list(rows_of(result))


def _motions(result: MapResult) -> list[Any]:
    """Coexisting motions of a map that shows them."""
    if result.plan.picture != "basins":
        return []
    from vibeam.maps.motions import motions_of

    return list(motions_of(result))
