"""``vibeam new``, ``keys`` and ``doctor``: a case to start from, its keys, and whether the installation is whole."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import TableFile, argument, option, out_option, output_path
from vibeam.cli.completion import keys as key_names
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_json, print_sheet
from vibeam.cli.streams import MISSED, put, put_json
from vibeam.cli.verbosity import verbosity
from vibeam.exchange.faults import suggest

if TYPE_CHECKING:
    from vibeam.casefile.documentation import KeyRow
    from vibeam.report.output import StudySheet

_KEY = "A table, stop, or a key, stop.gap or gap; absent = the list of tables."
KeyName = Annotated[str | None, argument(_KEY, "NAME", autocompletion=key_names)]

_NEW = "The case file to write, or its folder; absent = case.toml, or EXAMPLE.toml."
NewFile = Annotated[str | None, argument(_NEW, "FILE")]

_FROM = "Write an example with the files that it names; list says which there are."
ExampleName = Annotated[str | None, option(_FROM, "--from", metavar="EXAMPLE")]


def keys(
    name: KeyName = None,
    every: Annotated[bool, typer.Option("--all", help="Every key of every table.")] = False,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON schema of case files, for editors.")] = False,
    out: TableFile = None,
) -> None:
    """Explain the tables and keys of a case file.

    \b
    Examples:
      vibeam keys stop
      vibeam keys sweep.frequency
    """
    from vibeam.casefile.documentation import case_schema, reference_table, rows_of
    from vibeam.report.output import to_json, write_csv

    if schema and (name is not None or out is not None):
        raise UsageError("--schema prints the schema of all keys: leave NAME and --out away")
    if schema:
        put_json(to_json(case_schema()))
        return
    try:
        rows = reference_table() if name is None else rows_of(name)
    except ValueError as unknown:
        raise UsageError(str(unknown)) from None
    files = [] if out is None else [output_path(out, "keys.csv", (".csv",), "a table")]
    for file in files:
        write_csv(rows, file)
    print_sheet(_keys_sheet(name, rows, every or verbosity().verbose), files, whole=True)


def _keys_sheet(name: str | None, rows: list[KeyRow], whole: bool) -> StudySheet:
    """Sheet of keys: each in full (``whole``, or a single one), else in a line, of the whole case its tables."""
    from vibeam.casefile.documentation import lines_of, tables_of
    from vibeam.report import tables
    from vibeam.report.output import StudySheet
    from vibeam_models.arguments import counted

    lines = lines_of(rows, whole=not tables.on_screen())
    if name is None:
        answer = f"A case file has {len(rows)} keys. Those of one table: vibeam keys stop; of all: vibeam keys --all"
        table = tables.rows_of("Tables of a case file", tables_of())
    else:
        one = f"; one in full: vibeam keys {lines[0].key}; all in full: -v" if len(lines) > 1 else ""
        answer = f"{counted(len(lines), 'key')} by the name {name}{one}"
        table = tables.rows_of("Keys", lines)
    table.unbroken = True
    return StudySheet(
        answer, [tables.keys(rows) if whole or len(lines) == 1 else table], data={"rows": rows}, rows=rows
    )


def new(
    path: NewFile = None,
    out: Annotated[str | None, out_option("The same, as an option.")] = None,
    short: Annotated[bool, typer.Option("--short", help="Some 25 lines: what a run needs.")] = False,
    example: ExampleName = None,
) -> None:
    """Write a case to start from, each key explained.

    Never over a file that is there.

    \b
    Examples:
      vibeam new mine.toml --short
      vibeam new --from relay --short
    """
    from vibeam.report.output import StudySheet

    if example == "list":
        print_sheet(_examples_sheet())
        return
    if path is not None and out is not None:
        raise UsageError(f"--out {out}: the file is {path} already: name one of them")
    text, beside = _content(example, short)
    name = f"{example or 'case'}.toml"
    target = output_path(out or path or name, name, (".toml",), "a case file")
    texts = {target.with_name(other): content for other, content in beside.items()} | {target: text}
    texts = {file: content for file, content in texts.items() if file == target or not _holds(file, content)}
    for file in texts:
        if file.exists():
            raise UsageError(f"{file}: is there already: name another file, or folder")
    for file, content in texts.items():
        _write(file, content)
    also = f" and {', '.join(beside)} beside it" if beside else ""
    said = f"wrote {target}{also}: edit it, then: vibeam run {target}"
    print_sheet(StudySheet(said, data={"written": target}))


def _content(name: str | None, brief: bool) -> tuple[str, dict[str, str]]:
    """Text of the template or of an example, and those of the files beside it by name."""
    from vibeam.casefile.examples import PLACES, texts
    from vibeam.casefile.template import short, template

    if name is None:
        return short() if brief else template(), {}
    if name not in PLACES:
        raise UsageError(f"--from {name}: no such example; {suggest(name, PLACES)}")
    return texts(name, brief)


def _examples_sheet() -> StudySheet:
    """Sheet of the examples, each with its meaning."""
    from vibeam.casefile.examples import meanings
    from vibeam.report.output import StudySheet
    from vibeam.report.tables import blank

    found, table = meanings(), blank("Examples", "name", "what it is")
    for row in found.items():
        table.add_row(*row)
    said = f"{len(found)} examples to start from: vibeam new --from NAME"
    return StudySheet(said, [table], data={"examples": found})


def _holds(file: Path, content: str) -> bool:
    """Test whether a file is there as it would be written."""
    return file.is_file() and file.read_bytes() == content.encode()


def _write(file: Path, text: str) -> None:
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except FileExistsError:
        raise UsageError(f"{file}: is there already: name another file") from None


def doctor() -> None:
    """Examine the installation, and compute known motions.

    Versions and kernels. Exit code 1 where there is a fault.

    \b
    Examples:
      vibeam doctor
      vibeam doctor --json
    """
    from vibeam.studies.doctor import Severity, examine, verdict

    findings, form = examine(), verbosity()
    faults = sum(each.state is Severity.FAULT for each in findings)
    if form.json:
        print_json({"answer": verdict(findings), "faults": faults, "findings": findings})
    else:
        right = () if form.verbose else (Severity.GOOD, Severity.FACT)
        shown = () if form.quiet else [each for each in findings if each.state not in right]
        put(verdict(findings))
        for topic, group in groupby(shown, key=lambda each: each.topic):
            put("\n".join([topic, *(f"  {each}" for each in group)]))
        if right and not form.quiet:
            put("more: -v")
    if faults:
        raise typer.Exit(MISSED)
