"""``vibeam influence``: the influence study as plot and table."""

from __future__ import annotations

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.output import print_sheet


def influence(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Measure what each effect changes, costs and is needed for."""
    from vibeam.report.influence import sheet
    from vibeam.studies.influence.study import influence as influences

    loaded = load(case, set_)
    path = table_path(loaded, out, "influence")
    found = sheet(run_study(case, loaded, influences), loaded.figure)
    print_sheet(found, as_json, found.write(path, loaded.figure))
