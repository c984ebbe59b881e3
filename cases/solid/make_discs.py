"""Mesh of the DTU rig with round discs, by Gmsh (pip install gmsh): python cases/solid/make_discs.py

Half of it, y ≥ 0: a strip of 180 × 20 × 1.034 mm, and on either side of it at 132 mm a stack of steel discs of 100 g
that is bonded to it. Radius and height follow from the mass, the density and the published inertia about y, 2.988e-5
kg m² with the strip as spacer: of two solutions the slender one, which is the nearer to four discs of one piece.
Second-order tetrahedra, mm.
"""

from __future__ import annotations

import json
from pathlib import Path

import gmsh
import numpy as np
from scipy.optimize import fsolve

LENGTH, HALF_WIDTH, HALF = 180.0, 10.0, 0.517  # of the strip, mm
MASS, DENSITY, INERTIA = 0.2, 7850e-9, 2.988e-5 * 1e6  # kg, kg/mm³, kg mm²
AT, SENSOR = 132.0, 90.0
COARSE, FINE = 10.0, 4.5  # size of elements, mm


def stack() -> tuple[float, float]:
    """Radius and height of each stack in mm."""

    def off(size: np.ndarray) -> list[float]:
        radius, height = size
        top = HALF + height
        level = (top**3 - HALF**3) / (3 * height)  # mean of z²
        return [2 * DENSITY * np.pi * radius**2 * height / MASS - 1, MASS * (radius**2 / 4 + level) / INERTIA - 1]

    radius, height = fsolve(off, (16.0, 15.0))
    return float(radius), float(height)


def main() -> None:
    """Write discs.msh, and its sizes as discs.json, beside this file."""
    radius, height = stack()
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    shapes = gmsh.model.occ
    strip = shapes.addBox(0, 0, -HALF, LENGTH, HALF_WIDTH, 2 * HALF)
    discs = [
        shapes.addCylinder(AT, 0, z, 0, 0, side * height, radius, angle=np.pi) for side, z in ((1, HALF), (-1, -HALF))
    ]
    sensor = shapes.addPoint(SENSOR, 0, HALF)
    parts, _ = shapes.fragment([(3, strip), (0, sensor)], [(3, each) for each in discs])
    shapes.synchronize()
    groups(radius, height, parts)
    field = gmsh.model.mesh.field
    box = field.add("Box")
    for name, value in {
        "VIn": FINE, "VOut": COARSE, "XMin": -1, "XMax": LENGTH + 1, "YMin": -1, "YMax": HALF_WIDTH + 1,
        "ZMin": -1.2 * HALF, "ZMax": 1.2 * HALF, "Thickness": 5,
    }.items():  # fmt: skip
        field.setNumber(box, name, value)
    field.setAsBackgroundMesh(box)
    for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{name}", 0)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(Path(__file__).with_name("discs.msh")))
    made = {"radius_mm": round(radius, 3), "height_mm": round(height, 3), "nodes": len(gmsh.model.mesh.getNodes()[0])}
    Path(__file__).with_name("discs.json").write_text(json.dumps(made) + "\n")
    gmsh.finalize()


def groups(radius: float, height: float, parts: list[tuple[int, int]]) -> None:
    """Name what the case speaks of."""

    def named(name: str, dimension: int, low: tuple[float, ...], high: tuple[float, ...]) -> None:
        near = 1e-3
        box = (*(each - near for each in low), *(each + near for each in high))
        found = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dimension)]
        assert found, name
        gmsh.model.setPhysicalName(dimension, gmsh.model.addPhysicalGroup(dimension, found), name)

    top = HALF + height
    named("clamp", 2, (0, 0, -HALF), (0, HALF_WIDTH, HALF))
    named("symmetry", 2, (0, 0, -top), (LENGTH, 0, top))
    named("contact", 2, (0, 0, top), (LENGTH, radius, top))
    named("sensor", 0, (SENSOR, 0, HALF), (SENSOR, 0, HALF))
    everything = [tag for dimension, tag in parts if dimension == 3]
    gmsh.model.setPhysicalName(3, gmsh.model.addPhysicalGroup(3, everything), "steel")


if __name__ == "__main__":
    main()
