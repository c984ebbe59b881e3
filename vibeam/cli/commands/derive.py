"""``vibeam derive``: the table of a beam's single degree of freedom."""

from __future__ import annotations

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, table_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_result, write_table


def derive(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Derive the SDOF parameters from geometry.

    Each stands beside its finite-element value.
    """
    from vibeam.studies.derive import derive as derived

    loaded = load(case, set_)
    table = of_case(case, lambda: derived(loaded))
    rows = list(table)
    write_table(rows, None if out is None else table_path(loaded, out, "derive"))
    print_result(rows, as_json, lambda tables: [tables.derivation(rows)], table.notes)
