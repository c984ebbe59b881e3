"""``vibeam map``, ``stability`` and ``verdict``: maps over keys of a case, computed block by block and drawn."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import (
    CaseFile,
    Fresh,
    Overrides,
    TableFile,
    folder,
    load,
    output_path,
    run_study,
    table_path,
)
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result, print_sheet

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
        "--out", metavar="FILE", show_default=False,
        help="The map's file (.h5), or the folder for all; folders on the way are made; absent = the current folder.",
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
    case: CaseFile, set_: Overrides = None, out: Out = None, only: Only = None,
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
    print_result(found | {"remarks": notes, "files": files}, tables, [*notes, *files])


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


def stability(
    case: CaseFile,
    set_: Overrides = None,
    out: TableFile = None,
    over: Annotated[str, typer.Option("--over", help="What changes beside the frequency: gap or drive.")] = "gap",
    low: Annotated[str | None, typer.Option("--from", help="Its first value, with unit.", show_default=False)] = None,
    high: Annotated[str | None, typer.Option("--to", help="Its last value, with unit.", show_default=False)] = None,
    points: Annotated[int, typer.Option("--points", min=2, help="How many values of it.")] = 101,
    frequencies: Annotated[int, typer.Option("--frequencies", min=2, help="How many drive frequencies.")] = 161,
    periods: Annotated[int, typer.Option("--periods", min=1, help="Drive periods from impact to impact.")] = 1,
    fidelity: Annotated[
        str | None, typer.Option("--fidelity", help="This one alone; absent = all.", show_default=False)
    ] = None,
) -> None:
    """Map where periodic motions exist and are stable.

    The axes are frequency and gap or drive.
    """
    from vibeam.report.stability import sheet
    from vibeam.studies.stability.study import stability as mapped

    loaded = load(case, set_)
    path = table_path(loaded, out, "stability")
    found = sheet(of_case(case, lambda: mapped(loaded, over, low, high, points, frequencies, periods, fidelity)))
    print_sheet(found, found.write(path, loaded.figure))


Over = Annotated[str, typer.Option("--over", help="frequency and gap, drive, restitution or any dotted key.")]


def verdict(
    case: CaseFile,
    set_: Overrides = None,
    out: TableFile = None,
    over: Over = "frequency,gap",
    low: Annotated[str | None, typer.Option("--from", help="First value, with unit.", show_default=False)] = None,
    high: Annotated[str | None, typer.Option("--to", help="Last value, with unit.", show_default=False)] = None,
    points: Annotated[int, typer.Option("--points", min=2, help="How many values of it.")] = 61,
    frequencies: Annotated[int, typer.Option("--frequencies", min=2, help="How many drive frequencies.")] = 61,
    accuracy: Annotated[str, typer.Option("--accuracy", help="How near the finest model.")] = "1 %",
    quantity: Annotated[str, typer.Option("--quantity", help="Of what: amplitude or reach.")] = "amplitude",
    verify: Annotated[int, typer.Option("--verify", min=0, help="At how many places to fly anew.")] = 24,
    fidelity: Annotated[
        list[str] | None, typer.Option("--fidelity", help="This one; repeatable; absent = all.", show_default=False)
    ] = None,
    fresh: Fresh = False,
) -> None:
    """Map the cheapest model that suffices, and where models differ in kind; or continue such a map.

    The axes are frequency and another key of the case. Kinds: period, coexisting motions, chaos.
    """
    from vibeam.report.verdict import sheet
    from vibeam.studies.verdict.planes import kept_beside
    from vibeam.studies.verdict.study import verdict as judge

    loaded = load(case, set_)
    path = table_path(loaded, out, "verdict")
    asked = over, low, high, points, frequencies, accuracy, quantity, fidelity, verify
    with kept_beside(path, fresh) as folder:
        found = sheet(run_study(case, loaded, lambda own, tell: judge(own, *asked, tell, folder)))
        files = found.write(path, loaded.figure)
    print_sheet(found, files)
