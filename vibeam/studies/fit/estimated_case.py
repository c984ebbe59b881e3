"""Case with the estimated values of a fit in place of its own."""

from __future__ import annotations

from vibeam.studies.fit.study import FitStudy


def estimated_case(study: FitStudy) -> str:
    """Text of the case's file with the estimated values in place of its own; keys that are not determined keep theirs.

    ValueError for a key that the file does not have, in a table written inline.
    """
    from vibeam.casefile.toml import read_text
    from vibeam.casefile.toml_writing import with_values

    rows = [row for row in study.rows if row.determined]
    found = {row.key: f'"{row.value:.6g} {row.unit}"' if row.unit else f"{row.value:.6g}" for row in rows}
    names = dict.fromkeys(point.reference for point in study.points)
    head = (
        f"# {', '.join(found) or 'nothing'}: estimated by vibeam fit from {', '.join(names)} of {study.case.path.name}"
    )
    return f"{head}\n\n{with_values(read_text(study.case.path), found)}"
