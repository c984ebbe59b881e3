"""The commands, thin: what they do is in the library, and imported when a command runs.

Results go to stdout, everything else to stderr. Exit code 0: fine, 1: a check was missed, 2: something is wrong with
the case, an argument or a file, 130: stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from vibeam.case import Case
    from vibeam.run import Result

Made = TypeVar("Made")
MISSED, WRONG, STOPPED = 1, 2, 130
RESULTS = (".h5", ".hdf5")

app = typer.Typer(
    help="How much model does a vibro-impact beam need?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="The case file (TOML).", show_default=False)]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="A key of the case, in place of the file's. Repeatable."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON in place of tables.")]
ResultsFile = Annotated[
    Path | None, typer.Option("--out", help="The results file (.h5), or the folder for it.", show_default=False)
]
TableFile = Annotated[Path | None, typer.Option("--out", help="Write the table to this CSV file.", show_default=False)]


def main() -> None:
    """The entry point."""
    app()


class Mistake(Exception):
    """Something wrong with an argument: one line for stderr."""


@contextmanager
def _mistakes() -> Iterator[None]:
    """Turn what a user can get wrong into its message on stderr and an exit code; a defect keeps its traceback."""
    from vibeam.faults import CaseError
    from vibeam.store import StoreError

    try:
        yield
    except (CaseError, StoreError, Mistake) as mistake:
        _stop(str(mistake), WRONG)
    except OSError as error:
        _stop(f"{error.filename or 'file'}: {(error.strerror or str(error)).lower()}", WRONG)
    except KeyboardInterrupt as interrupt:
        _stop(str(interrupt) or "stopped", STOPPED)


def _stop(message: str, code: int) -> None:
    typer.echo(message, err=True)
    raise typer.Exit(code) from None


@app.callback(invoke_without_command=True)
def _version(version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if version:
        from vibeam import __version__

        typer.echo(f"vibeam {__version__}")
        raise typer.Exit


@app.command()
def run(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: ResultsFile = None) -> None:
    """Sweep every fidelity of a case; go on where the results file ends."""
    with _mistakes():
        loaded = _load(case, set_)
        path = _results_path(loaded, out or Path())
        result = _swept(loaded, path)
        _report(result, path, as_json)


@app.command()
def check(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: ResultsFile = None) -> None:
    """Compare a case with its reference curves: exit code 1 where one is missed."""
    with _mistakes():
        loaded = _load(case, set_)
        if not (loaded.references or loaded.expectations):
            typer.echo(f"{case}: a sound case, but it names no reference to check against", err=True)
            _print([], as_json)
            return
        from vibeam import expect, references
        from vibeam.report.units import units_of

        loaded = loaded.everywhere()  # each fidelity is checked by itself
        result = _swept(loaded, None if out is None else _results_path(loaded, out), show=False)
        rows = references.check(loaded, result, partial=bool(set_)) + expect.check(loaded, result, partial=bool(set_))
        _print(rows, as_json, lambda tables: [tables.checks(rows, units_of(loaded))])
        if not all(row.passed for row in rows):
            raise typer.Exit(MISSED)


@app.command()
def stability(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="The CSV file, or the folder for it.", show_default=False)
    ] = None,
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
    """Map where periodic motions exist, keep clear of the stop and are stable, over frequency and gap or drive."""
    with _mistakes():
        from vibeam.report import output
        from vibeam.report.stability import write_stability
        from vibeam.report.units import units_of
        from vibeam.stability import stability as mapped

        loaded = _load(case, set_)
        path = _table_path(loaded, out or Path(), "stability")
        found = _of_beam(case, lambda: mapped(loaded, over, low, high, points, frequencies, periods, fidelity))
        files = [path.with_suffix(ending) for ending in (".png", ".svg")]
        write_stability(found, *files)
        output.write_csv(found.points, path)
        _print(
            {"crossings": found.crossings, "maps": found.shares, "files": [path, *files]}, as_json,
            lambda tables: [tables.crossings(found.crossings, found.axis.own_text, units_of(loaded))],
        )  # fmt: skip
        if not as_json:
            typer.echo("\n".join(map(str, [path, *files])))


@app.command()
def cost(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="The folder for plot and table.", show_default=False)
    ] = None,
) -> None:
    """Accuracy against time: every fidelity by every solver, and where the error comes from."""
    with _mistakes():
        from vibeam.cost.study import cost as studied
        from vibeam.report import cost_table
        from vibeam.report.cost_files import write_files

        loaded = _load(case, set_)
        folder = out or Path()
        if not folder.is_dir():
            raise Mistake(f"{folder}: --out names a folder that is there")
        study = _study(case, loaded, studied)
        files = write_files(study, folder, case.stem)
        _print(
            {"study": study, "files": files}, as_json, lambda tables: [cost_table.runs(study), cost_table.parts(study)]
        )
        if not as_json:
            typer.echo("\n".join([*cost_table.sentences(study), *map(str, files)]))


@app.command()
def influence(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="The CSV file, or the folder for it.", show_default=False)
    ] = None,
) -> None:
    """What each effect of the case changes and costs, and which of them the scene needs."""
    with _mistakes():
        from vibeam.influence.study import influence as studied
        from vibeam.report import influence as report
        from vibeam.report.influence_files import write_files

        loaded = _load(case, set_)
        path = _table_path(loaded, out or Path(), "influence")
        study = _study(case, loaded, studied)
        files, sentences = write_files(study, path), list(report.sentences(study))
        _print(
            {"study": study, "sentences": sentences, "files": files}, as_json,
            lambda tables: [report.taken_away(study), report.left_alone(study)],
        )  # fmt: skip
        if not as_json:
            typer.echo("\n".join([*sentences, *map(str, files)]))


@app.command()
def derive(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """SDOF parameters from geometry, each beside its finite-element value."""
    with _mistakes():
        from vibeam.derive import derive as derived

        loaded = _load(case, set_)
        rows = list(_of_beam(case, lambda: derived(loaded)))
        _print(rows, as_json, lambda tables: [tables.derivation(rows)], out)


@app.command()
def modes(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[Path | None, typer.Option("--out", help="Write the mode shapes to this VTU file.")] = None,
    count: Annotated[int, typer.Option("--count", min=1, help="How many modes.")] = 10,
) -> None:
    """The modes of the finite-element beam, and the restitution that is left when it is cut off after each."""
    with _mistakes():
        from vibeam.modes import mode_table, write_shapes

        loaded = _load(case, set_)
        if out is not None and out.suffix != ".vtu":
            raise Mistake(f"{out}: mode shapes go into a .vtu file")
        table = _of_beam(case, lambda: mode_table(loaded.scene, count))
        if out is not None:
            write_shapes(table, out)
            typer.echo(f"wrote {out}", err=True)
        _print(table.rows, as_json, lambda tables: [tables.modal(table)])


@app.command()
def new(
    path: Annotated[Path, typer.Argument(help="The case file to write.")] = Path("case.toml"),
    out: Annotated[Path | None, typer.Option("--out", help="The same, as an option.", show_default=False)] = None,
    as_json: AsJson = False,
) -> None:
    """Write a case to start from, every key explained; never over a file that is there."""
    with _mistakes():
        from vibeam.keys import template

        target = out or path
        try:
            with target.open("x", encoding="utf-8") as file:
                file.write(template())
        except FileExistsError:
            raise Mistake(f"{target}: is there already: name another file") from None
        typer.echo(f"wrote {target}: edit it, then: vibeam run {target}", err=as_json)
        _print({"written": target}, as_json)


@app.command()
def keys(as_json: AsJson = False, out: TableFile = None) -> None:
    """Every key of a case file: what it means, its unit, its default."""
    with _mistakes():
        from vibeam.keys import reference_table

        rows = reference_table()
        _print(rows, as_json, lambda tables: [tables.keys(rows)], out)


def _load(path: Path, settings: list[str] | None) -> Case:
    from vibeam.case import load

    parts = [text.partition("=") for text in settings or []]
    wrong = [key for key, equals, _ in parts if not (equals and key.strip())]
    if wrong:
        raise Mistake("\n".join(f"--set {key}: write --set key=value" for key in wrong))
    return load(path, {key.strip(): value.strip() for key, _, value in parts})


def _results_path(case: Case, out: Path) -> Path:
    """``out`` itself, or the case's name in the folder ``out``."""
    if out.is_dir():
        return out / f"{case.path.stem}.h5"
    if out.suffix not in RESULTS:
        raise Mistake(f"{out}: --out names a results file that ends in .h5, or a folder that is there")
    return out


def _table_path(case: Case, out: Path, kind: str) -> Path:
    """``out`` itself, or the case's name and ``kind`` in the folder ``out``."""
    if out.is_dir():
        return out / f"{case.path.stem}_{kind}.csv"
    if out.suffix != ".csv":
        raise Mistake(f"{out}: --out names a file that ends in .csv, or a folder that is there")
    return out


def _swept(case: Case, path: Path | None, show: bool = True) -> Result:
    from vibeam.progress import Bar
    from vibeam.run import run as run_case

    with Bar() as bar:
        return run_case(case, out=path, progress=bar, show=show)


def _report(result: Result, path: Path, as_json: bool) -> None:
    from vibeam.compare import compare
    from vibeam.report.frc import write_frc
    from vibeam.report.units import units_of

    files = [path, path.with_suffix(".png"), path.with_suffix(".svg")]
    write_frc(result, *files[1:])
    files += _shown(result, path)
    rows = compare(result)
    units = units_of(result.case)
    whole = {"fidelities": rows, "found": result.found, "total": result.total, "files": files}
    whole |= {"curves": curves} if (curves := result.curves) else {}
    study = result.accuracy
    if study is None:
        _print(whole, as_json, lambda tables: [tables.responses(rows, units), tables.costs(rows)])
        told = []
    else:
        from vibeam.report import accuracy_table

        whole |= {"accuracy": study}
        _print(whole, as_json, lambda tables: [tables.responses(rows, units), accuracy_table.choices(study)])
        told = list(accuracy_table.sentences(study, units))
    if not as_json:
        typer.echo("\n".join([*told, *map(str, files)]))


def _shown(result: Result, path: Path) -> list[Path]:
    """The further figures of a case, where it asks for any."""
    if not result.case.shows:
        return []
    from vibeam.report.show import write_shown

    return write_shown(result, path)


def _study(case: Path, loaded: Case, studied: Callable[[Case, Callable[[str], None]], Made]) -> Made:
    """What a study of the case finds; what it does meanwhile goes to stderr."""
    from vibeam.progress import compile_first, stderr

    console = stderr()
    compile_first(console)
    return _of_beam(case, lambda: studied(loaded, console.print))


def _of_beam(case: Path, make: Callable[[], Made]) -> Made:
    """What needs a beam; its refusal (a case without one) as a mistake."""
    try:
        return make()
    except ValueError as refusal:
        raise Mistake(f"{case}: {refusal}") from None


def _print(
    rows: Any, as_json: bool, tables: Callable[[Any], list[Table]] = lambda tables: [], out: Path | None = None
) -> None:
    """``rows`` as JSON or as tables on stdout, and as CSV in ``out``."""
    from vibeam.report import output, table

    if out is not None:
        output.write_csv(rows, out)
        typer.echo(f"wrote {out}", err=True)
    if as_json:
        typer.echo(output.to_json(rows))
    else:
        for shown in tables(table):
            table.show(shown)
