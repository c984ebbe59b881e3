"""Command of a study, made of its declaration: one option for each key of its table, JSON, CSV and figure."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from vibeam.cli.arguments import CaseFile, Overrides, TableFile, load, option, table_path
from vibeam.cli.completion import words
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_sheet
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked
from vibeam.cli.streams import tell
from vibeam.cli.verbosity import parameter, taking, verbosity
from vibeam.system.number_text import begun
from vibeam_models.keys import Key, defaults_of, keys_of
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import FigurePlan
    from vibeam.cli.parts import Asked
    from vibeam.report.declaration import StudyDeclaration
    from vibeam.report.output import StudySheet


def study_command(study: StudyDeclaration) -> Callable[..., None]:
    """Command ``vibeam NAME CASE`` of a study."""
    keys = keys_of(study.asks) if study.asks is not None else {}
    defaults = defaults_of(study.asks) if study.asks is not None else {}

    def command(
        case: CaseFile, set_: Overrides = None, out: TableFile = None, price: PriceOption = False,
        part: PartOption = None, gather: GatherOption = False, **asked: Any,
    ) -> None:  # fmt: skip
        shared = part_asked(price, part, gather)
        given = {key: value for key, value in asked.items() if value not in (None, [])}
        settings = [f"{study.name}.{key}={_text(value, keys[key])}" for key, value in given.items()]
        with _named_as_options(study.name, list(given)):
            loaded = load(case, [*(set_ or ()), *settings])
        run_declared(study, loaded, out, shared)

    command.__name__, command.__doc__ = study.name, help_of(study)
    *usual, price, part, gather, _ = inspect.signature(command, eval_str=True).parameters.values()
    own = [_option(name, key, defaults.get(name)) for name, key in keys.items()]
    return taking(command, [*usual, *own, *[price, part, gather] * study.parts])


def _option(name: str, key: Key, default: Any) -> inspect.Parameter:
    """Option of a key; its text is read as a case's is, and its default is shown as the example writes it."""
    shown = "|".join(key.words) if key.words else key.unit.upper() or ("TEXT" if key.text else "NUMBER")
    usual = "" if default is None or key.several else f"; absent = {key.example}"
    said = option(begun(key.meaning) + usual, f"--{name.replace('_', '-')}", metavar=shown)
    said.autocompletion = words(key.words) if key.words else None
    kind = list[str] | None if key.several else str | None
    return parameter(name, Annotated[kind, said])


def _text(value: str | list[str], key: Key) -> str:
    """Value of an option as a case has it: several as a list."""
    from vibeam.casefile.toml_writing import to_toml

    if isinstance(value, str):
        return value
    return value[0] if key.alone and len(value) == 1 else to_toml(value)


@contextmanager
def _named_as_options(table: str, given: Sequence[str]) -> Iterator[None]:
    """Context in which a fault of a key that was given by its option bears the option's name."""
    from vibeam.exchange.faults import OVERRIDE, CaseError

    options = {f"{table}.{key}": f"--{key.replace('_', '-')}" for key in given}
    try:
        yield
    except CaseError as wrong:
        named = [
            replace(each, file=options[each.key], key="") if each.file == OVERRIDE and each.key in options else each
            for each in wrong.faults
        ]
        raise CaseError(named) from None


def help_of(study: StudyDeclaration) -> str:
    """Help of a study's command: its meaning, and examples."""
    examples = "\n".join(f"  {line}" for line in study.examples)
    return f"{begun(study.meaning)}." + (f"\n\n\b\nExamples:\n{examples}" if examples else "")


ENDINGS = (".csv", ".html")


def run_declared(study: StudyDeclaration, case: Case, out: str | None, asked: Asked = None) -> None:
    """Run a study of a case, or the part of it that is ``asked``, and show and write what it gives."""
    from vibeam.cli.progress import Bar, stderr

    place = table_path(case, out, study.name, ENDINGS)  # before anything is computed
    _look(study, case)
    with in_parts(study.name, place, asked) if study.parts else nullcontext() as shared, Bar(study.name) as bar:
        record = of_case(case.path, lambda: study.of(case, stderr().print, bar))
    sheet = study.shown(record, case)
    path = table_path(case, out, sheet.study or study.name, ENDINGS)
    wanted = out or sheet.draw or sheet.page or sheet.study
    files = files_of(sheet, path, case.title, study.meaning, case.figure) if wanted else []
    if shared is not None:
        shared.discard()
    print_sheet(sheet, files)


def files_of(sheet: StudySheet, path: Path, title: str, meaning: str, plan: FigurePlan) -> list[Path]:
    """Files of a sheet, written: its page, or table and figures."""
    if path.suffix != ".html":
        return sheet.write(path, plan)
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.page.page import study_page

    write_whole(path, (sheet.page() if sheet.page else study_page(title, sheet.answer, [(meaning, sheet)])).encode())
    return [path]


def _look(study: StudyDeclaration, case: Case) -> None:
    """Print what a quick look tells beside the progress of a study that has one: the answer follows on stdout."""
    if study.first is None or verbosity().json or verbosity().quiet:
        return
    said = of_case(case.path, lambda: loaded(study.first)(case))
    if said:
        tell(said)
