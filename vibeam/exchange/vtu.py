"""VTU files of lines, points and cells of a solid, and PVD collections of them over time, for ParaView.

meshio writes the VTU files; a PVD file is a list of their names, one for each step and piece.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np

from vibeam.exchange.whole_files import beside, write_whole
from vibeam_models.arrays import Array, Index

CELLS = {27: "hexahedron27", 10: "tetra10"}  # meshio's names of quadratic cells, by their number of nodes


@dataclass(frozen=True, eq=False)
class VtuPiece:
    """Points (k, 3) in m with ``data`` (k,) or (k, 3) at each.

    ``cells``: the nodes (c, nodes) of quadratic cells; None: the points are a chain of lines, or one.
    """

    points: Array
    data: Mapping[str, Array]
    cells: Index | None = None


Step = tuple[float, Mapping[str, VtuPiece]]  # time, and the pieces by name


def write_vtu(piece: VtuPiece, path: Path) -> None:
    """Write one piece to a VTU file; OSError as of ``write_whole``."""
    import meshio

    ends = np.arange(len(piece.points))
    chain = ("line", np.column_stack((ends[:-1], ends[1:]))) if len(ends) > 1 else ("vertex", ends[:, None])
    cells = chain if piece.cells is None else (CELLS[piece.cells.shape[1]], piece.cells)
    with TemporaryDirectory() as folder:  # meshio writes to a path alone
        place = Path(folder) / "piece.vtu"
        meshio.Mesh(piece.points, [cells], point_data=dict(piece.data)).write(place)
        write_whole(path, place.read_bytes())


def write_series(steps: Sequence[Step], path: Path, comment: str = "") -> None:
    """Write ``path``, a PVD file, and the VTU files of its steps into the folder of the same name beside it.

    The PVD file comes last, so that it never names a file that is not whole. A piece that is the same object at several
    steps is one file. OSError as of ``write_whole``.
    """
    folder = path.with_suffix("")
    beside(folder).mkdir(exist_ok=True)
    written: dict[int, str] = {}
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    if comment:
        root.append(ElementTree.Comment(comment))
    listed = ElementTree.SubElement(root, "Collection")
    for index, (time, pieces) in enumerate(steps):
        for part, (name, piece) in enumerate(pieces.items()):
            if id(piece) not in written:
                plain = re.sub(r"[^\w.-]", "_", name)
                written[id(piece)] = f"{folder.name}/{plain}_{index:04}.vtu"
                write_vtu(piece, beside(path.parent / written[id(piece)]))
            about = {"timestep": f"{time:.17g}", "part": str(part), "name": name, "file": written[id(piece)]}
            ElementTree.SubElement(listed, "DataSet", about)
    ElementTree.indent(root)
    write_whole(path, ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def centre_line(positions: Array, along: float, deflection: Array, slope: Array) -> dict[str, Array]:
    """Fields of a beam along x that moves along z: ``displacement`` (k, 3) m and ``rotation`` (k, 3) rad.

    ``along``: what is added to the deflection as a rigid shift, m. The rotation vector of dw/dx is (0, −dw/dx, 0).
    """
    nothing = np.zeros_like(positions)
    return {
        "displacement": np.column_stack((nothing, nothing, deflection + along)),
        "rotation": np.column_stack((nothing, -slope, nothing)),
    }
