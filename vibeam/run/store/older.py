"""Results files of the previous format: branches without keys and checksums."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.run.store.branch import ROWS, Branch, count_points, lay_out, points_of, write_rows

if TYPE_CHECKING:
    import h5py


def lay_out_anew(file: h5py.File, branch: Branch, unit: str) -> None:
    """Convert an older branch of the same case to the present layout, with its points."""
    group = file[branch.group]
    done = points_of(group)
    values = {name: group[name][:done] for name in ROWS}
    del file[branch.group]
    present = lay_out(file, branch, unit)
    if done:
        write_rows(present, 0, values)
        count_points(present, done)
