"""``vibeam influence``: the influence study as plot and table."""

from __future__ import annotations

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.output import print_result


def influence(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Measure what each effect changes, costs and is needed for."""
    from vibeam.report import influence as report
    from vibeam.report.influence import write_files
    from vibeam.runs.comparison.differences import headline
    from vibeam.studies.influence.study import influence as influences

    loaded = load(case, set_)
    path = table_path(loaded, out, "influence")
    study = run_study(case, loaded, influences)
    files, sentences = write_files(study, path, loaded.figure), list(report.sentences(study))
    print_result(
        {"study": study, "sentences": sentences, "files": files}, as_json,
        lambda tables: [report.taken_away(study), report.left_alone(study)], [*sentences, *files],
        [headline(study.comparison)],
    )  # fmt: skip
