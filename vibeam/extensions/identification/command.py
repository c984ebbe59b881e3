"""``vibeam fit`` of a measured signal; of a case it is the command of vibeam itself."""

from __future__ import annotations

import inspect
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

from vibeam.cli.arguments import argument, option
from vibeam.cli.commands.measured import fit as fit_case
from vibeam.cli.commands.measured import refuse_options, show_identified
from vibeam.cli.completion import words
from vibeam.cli.verbosity import parameter, taking
from vibeam.exchange.faults import suggest
from vibeam.extensions.identification.response import DRIVES
from vibeam.extensions.identification.signal_kind import KINDS, identify_stretch
from vibeam.report.fit import identification_sheet
from vibeam.report.output import StudySheet

#: options of a signal: what each says, how its value is called, words that it takes
OPTIONS = {
    "of": ("Of a signal: decay, spectrum or response; absent = found out.", "KIND", KINDS),
    "x": ("Its column of time or frequency.", "HEAD", ()),
    "y": ("Its column of values.", "HEAD", ()),
    "from": ("Its first time or frequency taken.", "TIME", ()),
    "to": ("Its last time or frequency taken.", "TIME", ()),
    "drive": ("Of a response: base displacement, base acceleration or force.", "KIND", DRIVES),
    "level": ("Of a response: amplitude of the drive, or 1.", "NUMBER", ()),
}
FILE = Annotated[Path, argument("A case (.toml), or a measured signal.", "FILE")]


def _fit(file: Path, out: str | None = None, **asked: Any) -> None:
    """Estimate parameters from measurements, with intervals.

    Of a case the keys of [fit] from its measured responses, or those named by --key from its measured modal
    frequencies. Of a file with a decay, a spectrum or a response natural frequency, damping and gain.

    \b
    Examples:
      vibeam fit cases/synthetic/fit.toml --next
      vibeam fit decay.csv --x "t [s]" --y "u [mm]"
    """
    own = {name: asked.pop(_named(name)) for name in OPTIONS}
    if file.suffix == ".toml":
        other = "does not go with --key" if asked["key"] or asked["measured"] else "is of a signal, and this is a case"
        refuse_options(file, {f"--{name}": value for name, value in own.items()}, other)
        fit_case(file, out=out, **asked)
        return
    of_cases = {f"--{name.strip('_')}": value for name, value in asked.items()}
    faults = _faults(own["of"], own["drive"], own["level"])
    refuse_options(file, of_cases, "is of a case, which ends in .toml", faults)
    show_identified(file, partial(_identified, file, own.pop("from"), own.pop("to"), own), out)


def _named(option: str) -> str:
    """Name of the parameter of an option."""
    return f"{option}_" if option == "from" else option


def _identified(file: Path, first: str | None, last: str | None, own: dict[str, Any]) -> tuple[str, StudySheet]:
    """Method and sheet of what a signal fits."""
    found = identify_stretch(file, first, last, **own)
    return found.method, identification_sheet(found)


def _faults(of: str | None, drive: str | None, level: float | None) -> list[str]:
    """Faults of the options of a signal."""
    found = []
    if of is not None and of not in KINDS:
        found.append(f"--of {of}: {suggest(of, KINDS)}")
    elif of in KINDS[:2]:
        given = [name for name, value in (("--drive", drive), ("--level", level)) if value is not None]
        found += [f"{name} is of a response, and --of says {of}: leave one of them out" for name in given]
    if drive is not None and drive not in DRIVES:
        found.append(f"--drive {drive}: {suggest(drive, DRIVES)}")
    if level is not None and not (isfinite(level) and level > 0):
        found.append(f"--level {level:g} must be above 0")
    return found


def _option(name: str) -> inspect.Parameter:
    """Option of a signal."""
    said, shown, known = OPTIONS[name]
    made = option(said, f"--{name}", metavar=shown)
    made.autocompletion = words(known) if known else None
    kind = float | None if shown == "NUMBER" else str | None
    return parameter(_named(name), Annotated[kind, made])


def _command() -> Any:
    """Command with the options of a case and, before --price, those of a signal."""
    _, *usual = inspect.signature(fit_case, eval_str=True).parameters.values()
    at = [each.name for each in usual].index("price")
    file = inspect.Parameter("file", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=FILE)
    _fit.__name__ = "fit"
    return taking(_fit, [file, *usual[:at], *map(_option, OPTIONS), *usual[at:]])


fit = _command()
