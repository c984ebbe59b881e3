"""``vibeam modes``: modal table, mode shapes and matrices of the structure."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import typer

from vibeam.cli.arguments import CaseFile, Overrides, load, of_fidelities, option, out_option, output_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_sheet
from vibeam.cli.streams import say

_FIDELITY = "Whose structure: of a solid the body itself; absent = the beam of the case."
_MATRICES = "Write M, C, K and the rows too: .npz, .h5, .mat, .mtx or .npy."


def modes(
    case: CaseFile,
    set_: Overrides = None,
    out: Annotated[str | None, out_option("Mode shapes: .vtu, or .pvd with a step for each; or a folder.")] = None,
    matrices: Annotated[str | None, option(_MATRICES, "--matrices", metavar="FILE")] = None,
    count: Annotated[int, typer.Option("--count", metavar="N", min=1, help="How many modes.")] = 10,
    fidelity: Annotated[str | None, option(_FIDELITY, "--fidelity", metavar="NAME")] = None,
) -> None:
    """Modal table; mode shapes and matrices as files.

    Each mode stands with the restitution that mode 1 has in a model that is cut off after it.

    \b
    Examples:
      vibeam modes mine.toml --count 4
      vibeam modes mine.toml --out shapes.pvd --matrices mine.npz
      vibeam modes mine.toml --fidelity solid --out shapes.vtu
    """
    from vibeam.exchange.matrices.declaration import WRITTEN
    from vibeam.report.modes import sheet
    from vibeam.studies.modes import export_matrices, mode_table, write_shapes

    loaded = load(case, set_)
    name, endings = f"{loaded.path.stem}_modes.vtu", (".vtu", ".pvd")
    files = [] if out is None else [output_path(out, name, endings, "a file of mode shapes")]
    scene = loaded.scene if fidelity is None else of_fidelities(loaded, [fidelity]).scene_of(fidelity)
    table = of_case(case, lambda: mode_table(scene, count))
    if matrices is not None:
        path = output_path(matrices, f"{loaded.path.stem}.npz", WRITTEN, "a file of matrices")
        say(f"wrote {path}; to read it as a case:\n{of_case(loaded.path, lambda: export_matrices(loaded, path))}")
    for file in files:
        of_case(case, partial(write_shapes, table, file))
    print_sheet(sheet(table), files)
