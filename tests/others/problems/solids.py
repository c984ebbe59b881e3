"""NAFEMS' benchmarks of free vibration by the elements of a solid; numbers as ``tests/independent`` keeps them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import skfem

from tests.others.problem import Problem, spoiled
from tests.support.solid_bodies import components, frequencies, hexahedra, matrices, plane
from vibeam_models.arrays import Array
from vibeam_models.beams.stretch import Material

NAFEMS = (Path(__file__).parents[2] / "independent" / "nafems.json").read_text(encoding="utf-8")
PUBLISHED, PRINTED = json.loads(NAFEMS), json.loads(NAFEMS, parse_float=str)
RELEASED = "NAFEMS, R0015 (1987) and TNSB rev. 3 (1990), as read in "


def plate() -> Material:
    """Steel of all benchmarks."""
    own = Material(**PUBLISHED["material"])
    return replace(own, youngs_modulus=own.youngs_modulus * spoiled() ** 2)


def membrane() -> Array:
    """FV32: a half, symmetric about the plane of the membrane, whose clamp lets it contract across."""
    own = PUBLISHED["FV32"]
    box = hexahedra((16, 1, 8), (1, own["thickness"] / 2, 2), (0, 0, -1))
    x, y, z = box.p
    height = own["height_at_clamp"] + (own["height_at_tip"] - own["height_at_clamp"]) * x
    mesh = skfem.MeshHex(np.array([own["length"] * x, y, z * height / 2]), box.t)
    elements, stiff, mass = matrices(mesh, plate())
    clamp, middle = plane(elements, 0, 0), plane(elements, 1, 0)
    return frequencies(stiff, mass, components(clamp, middle, clamp), 6)


def thin_plate() -> Array:
    """FV16: eight by eight elements, one through."""
    elements, stiff, mass = matrices(hexahedra((8, 8, 1), PUBLISHED["FV16"]["sides"]), plate())
    clamp = plane(elements, 0, 0)
    return frequencies(stiff, mass, components(clamp, clamp, clamp), 6)


def thick_plate() -> Array:
    """FV52: NAFEMS' own mesh of four by four elements; the lowest three motions are rigid."""
    elements, stiff, mass = matrices(hexahedra((4, 4, 1), PUBLISHED["FV52"]["sides"]), plate())
    around = np.any([plane(elements, axis, at) for axis in (0, 1) for at in (0, 10)], axis=0)
    held = components(None, None, around & plane(elements, 2, 0))
    return frequencies(stiff, mass, held, 10, -1.0)[3:]


def deep_beam() -> Array:
    """FV5: ends held across and free along; two of bending, twist, two of bending."""
    own = PUBLISHED["FV5"]
    elements, stiff, mass = matrices(hexahedra((8, 2, 2), (own["length"], *own["section"]), (0, -1, -1)), plate())
    ends, axis = plane(elements, 0, 0) | plane(elements, 0, own["length"]), np.hypot(*elements.points[1:]) < 1e-9
    return frequencies(stiff, mass, components(axis, ends, ends), 5, -1.0)


solid = partial(Problem, adds="the solid that a case's beam is compared with")
solid(
    problem="NAFEMS FV32: cantilevered tapered membrane", quantity="frequencies 1 to 6, Hz",
    source=RELEASED + "ENERCALC 3D verification F-03", theirs=tuple(PRINTED["FV32"]["frequencies"]),
    ours=membrane, within=2e-4, why="the mesh of 128 elements", method="finite elements of plane stress",
    where="this module, membrane",
)  # fmt: skip
solid(
    problem="NAFEMS FV16: cantilevered thin plate", quantity="frequencies 1 to 6, Hz",
    source=RELEASED + "OptiStruct OS-V: 0430", theirs=tuple(PRINTED["FV16"]["frequencies"]),
    ours=thin_plate, within=0.02, why="one element of 0.05 m through, 1.25 m across", method="thin shells",
    where="this module, thin_plate",
)  # fmt: skip
solid(
    problem="NAFEMS FV52: plate held along the edges of one face", quantity="frequencies 4 to 10, Hz, on NAFEMS' mesh",
    source=RELEASED + "code_aster SDLS502, V2.03.502", theirs=tuple(PRINTED["FV52"]["by_20_node_bricks"]),
    ours=thick_plate, within=0.018, why="27 nodes an element against 20; the line of support is a singularity",
    method="bricks of 20 nodes, 4 × 4 × 1", where="this module, thick_plate",
)  # fmt: skip
solid(
    problem="NAFEMS FV5: deep beam on simple supports", quantity="bending, each twice, Hz",
    source=RELEASED + "OptiStruct OS-V: 0415", theirs=tuple(np.repeat(PRINTED["FV5"]["bending"][:2], 2).tolist()),
    ours=lambda: deep_beam()[[0, 1, 3, 4]], within=0.01, why="Timoshenko's beam is no solid",
    method="closed form of Timoshenko's beam", where="this module, deep_beam",
)  # fmt: skip
