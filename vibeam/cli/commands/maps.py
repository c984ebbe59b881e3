"""``vibeam map``: pictures over keys of a case, computed block by block and drawn."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import CaseFile, Fidelities, Fresh, Overrides, folder, load, option, out_option, output_path
from vibeam.cli.completion import names as names_of
from vibeam.cli.errors import Answered, UsageError, of_case
from vibeam.cli.output import print_sheet
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.grid_keys import MapPlan
    from vibeam.cli.parts import Asked
    from vibeam.maps.result import MapResult
    from vibeam.report.output import StudySheet

_NAMES = "These maps of the case; absent = all that it has."
Names = Annotated[list[str] | None, typer.Argument(metavar="NAME", help=_NAMES, autocompletion=names_of("map"))]
_OUT = "The map's file (.h5), or the folder for all; folders on the way are made; absent = the current folder."
_PICTURE = "For a case without such a table: period, values, bifurcation, stability, verdict."
_OVER = "gap, drive, restitution, frequency or a dotted key."
_POINTS = "Values of each key, one number for all."
_ACCURACY = "Of verdict: how near the finest model; absent = 1 %."
_QUANTITY = "Of values, verdict: amplitude, reach, …; of a record: peak, impacts, …"
_CLUSTER = "Workers of this Dask scheduler, or its scheduler file."


def map(
    case: CaseFile,
    names: Names = None,
    set_: Overrides = None,
    out: Annotated[str | None, out_option(_OUT)] = None,
    picture: Annotated[str | None, option(_PICTURE, "--picture", metavar="NAME")] = None,
    over: Annotated[str | None, option(_OVER, "--over", metavar="KEY[,KEY]")] = None,
    low: Annotated[str | None, option("First value of the key, with its unit.", "--from", metavar="VALUE")] = None,
    high: Annotated[str | None, option("Its last value.", "--to", metavar="VALUE")] = None,
    points: Annotated[str | None, option(_POINTS, "--points", metavar="N[,M]")] = None,
    accuracy: Annotated[str | None, option(_ACCURACY, "--accuracy", metavar="PERCENT")] = None,
    quantity: Annotated[str | None, option(_QUANTITY, "--quantity", metavar="NAME")] = None,
    periods: Annotated[int | None, option("Of stability, impact to impact.", "--periods", min=1, metavar="N")] = None,
    fidelity: Fidelities = None,
    fresh: Fresh = False,
    cluster: Annotated[str | None, option(_CLUSTER, "--cluster", metavar="ADDRESS")] = None,
    price: PriceOption = False,
    part: PartOption = None,
    gather: GatherOption = False,
) -> None:
    """Draw motions over keys: period, stability, verdict.

    A map of the case is called by its name, and goes on where it was stopped; --picture makes one that has no table.

    \b
    Examples:
      vibeam map cases/maps/fig18.toml period
      vibeam map cases/dtu_neutral.toml --picture verdict --over gap --accuracy "2 %"
      vibeam map shock.toml --over gap,level --from "0 mm,0.5" --to "1 mm,2"
    """
    asked_part = part_asked(price, part, gather, {"--fresh": fresh, "--cluster": cluster})
    loaded = load(case, set_)
    asked = {
        "over": over, "low": low, "high": high, "points": _counts(points), "accuracy": accuracy,
        "quantity": quantity, "periods": periods, "fidelities": fidelity,
    }  # fmt: skip
    given = {name: value for name, value in asked.items() if value is not None}
    if loaded.record is not None:
        not_taken = {"--picture": picture, "--accuracy": accuracy, "--periods": periods,
                     "--cluster": cluster, "NAME": names or None}  # fmt: skip
        _under_record(loaded, out, given, not_taken, asked_part)
        return
    plans = of_case(case, lambda: _plans(loaded, names or [], picture, given))
    sheets: list[tuple[str, StudySheet]] = []
    files: list[Path] = []
    for plan in plans:
        path = _path(loaded, out, plan.name, len(plans))
        try:
            sheet, written = of_case(case, lambda: _drawn(_computed(loaded, plan, path, fresh, cluster, asked_part)))  # noqa: B023
        except Answered as part_or_price:
            sheet, written = part_or_price.sheet, []
        sheets.append((plan.name, sheet))
        files += written
    from vibeam.report.output import one_sheet

    print_sheet(one_sheet(sheets), files)


def _under_record(case: Case, out: str | None, given: dict[str, Any], not_taken: dict[str, Any], asked: Asked) -> None:
    """The map of a case under a record: means over its realisations, as table and figure; or a part of it."""
    from vibeam.cli.arguments import table_path
    from vibeam.cli.progress import Bar
    from vibeam.report.record_map import sheet
    from vibeam.studies.record.plane import axes_asked, record_map

    if found := [name for name, given in not_taken.items() if given is not None]:
        raise UsageError(f"{found[0]}: is of a map of a [sweep]; of a [record]: --over KEY[,KEY] --quantity peak")
    path = table_path(case, out, "map", (".csv",))
    said = [given.get(key) for key in ("over", "low", "high", "points")]
    with in_parts("map", path, asked) as shared, Bar("map") as bar:
        study = of_case(case.path, lambda: record_map(
            case, axes_asked(case, *said), given.get("quantity") or "peak", given.get("fidelities"), bar
        ))  # fmt: skip
    made = sheet(study)
    files = made.write(path, case.figure)
    shared.discard()
    print_sheet(made, files)


def _counts(points: str | None) -> tuple[int, ...] | None:
    """Numbers of ``--points``, each 2 or more."""
    if points is None:
        return None
    try:
        found = tuple(int(each) for each in points.split(","))
    except ValueError:
        raise UsageError(f"--points {points}: write whole numbers, 61 or 61,41") from None
    if min(found) < 2:
        raise UsageError(f"--points {points}: an axis has 2 values or more")
    return found


def _plans(case: Case, names: list[str], picture: str | None, asked: dict[str, Any]) -> list[MapPlan]:
    """The maps that are named, or all; with options the one that they ask for."""
    from vibeam.exchange.faults import suggest
    from vibeam.maps.plan import plan_over

    unknown = [name for name in names if name not in case.maps]
    if unknown and case.maps:
        raise UsageError("\n".join(f"{name}: no such map; {suggest(name, case.maps)}" for name in unknown))
    if names and (picture or asked):
        raise UsageError(f"{names[0]}: a map of the case says these itself: --set map.{names[0]}.KEY=VALUE")
    tables = [plan for plan in case.maps.values() if picture in (None, plan.picture)]
    if asked or (picture and not tables):
        return [plan_over(case, picture or "period", **asked)]
    if not tables or unknown:
        cure = f"write vibeam map {case.path} --picture stability (verdict, period, …), or add a table [map.NAME]"
        raise UsageError(f"{case.path}: the case has no map: {cure} (vibeam keys map)")
    return [case.maps[name] for name in names] or tables


def _path(case: Case, out: str | None, name: str, count: int) -> Path:
    """The file of a map: ``out`` itself for a single one, else the case's and the map's name in that folder."""
    own = f"{case.path.stem}_{name}.h5"
    if out is not None and count > 1:
        if Path(out).suffix and not Path(out).is_dir():
            raise UsageError(f"{out}: the case has {count} maps: name a folder, or one of them behind the case")
        return folder(Path(out)) / own
    return output_path(out, own, (".h5",), "the file of a map")


def _computed(case: Case, plan: MapPlan, path: Path, fresh: bool, where: str | None, asked: Asked) -> MapResult:
    from vibeam.cli.progress import Bar, stderr
    from vibeam.maps.cluster import ClusterError, connected
    from vibeam.maps.run import run_map

    name = f"map {plan.name}"
    shared = nullcontext() if asked is None else in_parts(name, path, asked, last=True)
    try:
        with nullcontext() if where is None else connected(where) as cluster, shared, Bar(name) as bar:
            return run_map(case, plan, path, fresh=fresh, progress=bar, cluster=cluster, tell=stderr().print)
    except ClusterError as fault:
        raise UsageError(str(fault)) from None


def _drawn(result: MapResult) -> tuple[StudySheet, list[Path]]:
    """The sheet of a map, and all its files, of which pictures and table are written."""
    from vibeam.exchange.whole_files import beside
    from vibeam.figures.files import paths_of
    from vibeam.report.maps.page import sheet_of, study_of, write_map
    from vibeam.report.output import write_csv

    found, figures = study_of(result), paths_of(result.path, result.case.figure)
    sheet, table = sheet_of(found, write_map(found, *figures)), beside(result.path.with_suffix(".csv"))
    if sheet.rows:
        write_csv(sheet.rows, table)
    return sheet, [result.path, *([table] if sheet.rows else []), *figures]
