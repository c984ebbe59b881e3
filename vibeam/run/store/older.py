"""Results files of previous formats: branches with other keys, or without keys and checksums."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.run.store.branch import ROWS, Branch, count_points, lay_out, points_of, read_rows, write_rows
from vibeam.run.store.checksum import CHECKSUM

if TYPE_CHECKING:
    import h5py

    from vibeam.system.quantities import OutputUnits


def lay_out_anew(file: h5py.File, branch: Branch, units: OutputUnits, *, signed: bool) -> None:
    """Convert an older branch of the same case to the present layout, with its points.

    ``signed``: its points have checksums; ValueError where one does not fit.
    """
    group = file[branch.group]
    done = points_of(group)
    rows = read_rows(group) if signed else group
    values = {name: rows[name][:done] for name in ROWS}
    del file[branch.group]
    file[branch.fidelity].attrs.pop(CHECKSUM, None)  # data beside the branch no longer fit it
    present = lay_out(file, branch, units)
    if done:
        write_rows(present, 0, values)
        count_points(present, done)
