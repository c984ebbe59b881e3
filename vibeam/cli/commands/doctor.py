"""``vibeam doctor``: whether the installation is whole and computes rightly."""

from __future__ import annotations

from itertools import groupby

import typer

from vibeam.cli.arguments import AsJson
from vibeam.cli.commands.check import MISSED
from vibeam.cli.streams import put, put_json


def doctor(as_json: AsJson = False) -> None:
    """Examine the installation: versions, machine, kernels, folders, and known motions.

    Exit code 1 where there is a fault.
    """
    from vibeam.studies.doctor import Severity, examine

    findings = examine()
    faults = sum(each.state is Severity.FAULT for each in findings)
    if as_json:
        from vibeam.report import output

        put_json(output.to_json({"faults": faults, "findings": findings}))
    else:
        for topic, group in groupby(findings, key=lambda each: each.topic):
            put("\n".join([topic, *(f"  {each}" for each in group), ""]))
        put("no fault found" if not faults else f"{faults} fault{'s' * (faults > 1)} found")
    if faults:
        raise typer.Exit(MISSED)
