"""``vibeam new``, ``keys`` and ``doctor``: a case to start from, its keys, and whether the installation is whole."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli import completion
from vibeam.cli.arguments import TableFile, output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_json, print_result, write_table
from vibeam.cli.streams import MISSED, put, put_json, say
from vibeam.cli.verbosity import verbosity
from vibeam.exchange.faults import suggest, suggestion

KeyName = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME", help="A table, stop, or a key, stop.gap or gap; absent = the list of tables.",
        show_default=False, autocompletion=completion.keys,
    ),
]  # fmt: skip

NewFile = Annotated[
    str | None,
    typer.Argument(
        metavar="FILE", help="The case file to write, or its folder; absent = case.toml, or EXAMPLE.toml.",
        show_default=False, autocompletion=completion.case_files,
    ),
]  # fmt: skip

RigName = Annotated[
    str | None,
    typer.Option(
        "--rig", metavar="NAME", show_default=False, autocompletion=completion.rigs,
        help="What the case is of: cantilever (the default), tube, two-beams, matrices or modes.",
    ),
]  # fmt: skip

ExampleName = Annotated[
    str | None,
    typer.Option(
        "--from", metavar="EXAMPLE", show_default=False, autocompletion=completion.examples,
        help="Write an example with the files that it names; list says which there are.",
    ),
]  # fmt: skip


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
    from vibeam.casefile.documentation import lines_of, reference_table, rows_of, tables_of
    from vibeam.report import output

    if schema:
        from vibeam.casefile.documentation import case_schema

        put_json(output.to_json(case_schema()))
        return
    try:
        rows = reference_table() if name is None else rows_of(name)
    except ValueError as unknown:
        raise UsageError(str(unknown)) from None
    write_table(rows, None if out is None else output_path(out, "keys.csv", (".csv",), "a table"))
    if every or verbosity().json or verbosity().verbose or len(rows) == 1:
        print_result(rows, lambda tables: [tables.keys(rows)])
    elif name:
        more = [f"all of it: vibeam keys {name} -v; of one key: vibeam keys {lines_of(rows)[0].key}"]
        print_result(rows, lambda tables: [tables.rows_of(f"Keys: {name}", lines_of(rows))], more)
    else:
        head = f"A case file has {len(rows)} keys. Those of one table: vibeam keys stop; of all: vibeam keys --all"
        print_result(rows, lambda tables: [tables.rows_of("Tables of a case file", tables_of())], head=[head])


def new(
    path: NewFile = None,
    out: Annotated[
        str | None, typer.Option("--out", "-o", metavar="FILE", help="The same, as an option.", show_default=False)
    ] = None,
    rig: RigName = None,
    short: Annotated[bool, typer.Option("--short", help="Some 25 lines: what a first run needs.")] = False,
    example: ExampleName = None,
) -> None:
    """Write a case to start from, each key explained.

    Never over a file that is there.

    \b
    Examples:
    vibeam new mine.toml --rig tube --short
    vibeam new --from relay
    """
    if example and (rig or short):
        raise UsageError("--from writes an example as it is: leave --rig and --short away")
    if example == "list":
        _list_examples()
        return
    text, beside = _of_example(example) if example else _of_rig(rig or "cantilever", short)
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
    (say if verbosity().json else put)(f"wrote {target}{also}: edit it, then: vibeam run {target}")
    print_result({"written": target})


def _of_rig(rig: str, brief: bool) -> tuple[str, dict[str, str]]:
    """Text of a rig's case, and those of the files beside it by name."""
    from vibeam.casefile.rigs import RIGS
    from vibeam.casefile.template import short, template

    if rig not in RIGS:
        raise UsageError(f"--rig {rig}: no such rig; {suggest(rig, RIGS)}")
    return (short if brief else template)(rig), dict(RIGS[rig].files)


def _of_example(name: str) -> tuple[str, dict[str, str]]:
    """As ``_of_rig``, of an example."""
    from vibeam.casefile.examples import PLACES, meanings, texts

    if name not in PLACES:
        near = suggestion(name, PLACES)
        lines = [f"  {each:16}{meaning}" for each, meaning in meanings().items()]
        meant = f"did you mean {near}? " if near else ""
        raise UsageError("\n".join([f"--from {name}: no such example; {meant}there are", *lines]))
    return texts(name)


def _list_examples() -> None:
    from vibeam.casefile.examples import meanings

    lines = [f"{each:16}{meaning}" for each, meaning in meanings().items()]
    print_result({"examples": meanings()}, head=lines)


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

    Versions, machine, kernels and folders. Exit code 1 where there is a fault.

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
