"""The system held on its stop, found in JavaScript by roots, against Python's, by eigenvalues and inverses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from javascript import ScriptError

from vibeam.flight.kernels.layout import MODE
from vibeam.flight.linear.packing import PackedSystem, pack
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

Node = Callable[..., Any]
ASK = """
const { heldPlanes } = await load("extensions/explore/engine/held.js");
const of = (values) => Float64Array.from(values);
return given.systems.map(({ omega, sigma, contact }) =>
  heldPlanes({ omega: of(omega), sigma: of(sigma), contact: of(contact) }));
"""


def held_system(seed: int) -> ImpactSystem:
    """Random modes: light damping to ζ = 0.3, contact values over six decades, now and then a silent or a free one."""
    rng = np.random.default_rng(seed)
    n = int(rng.choice([2, 3, 5, 8, 24, 64]))
    omega = np.sort(10 ** rng.uniform(0, 3.5, n))
    zeta = 10 ** rng.uniform(-5, -0.52, n) if seed % 3 else np.full(n, 0.017)
    contact = rng.choice([-1, 1], n) * 10 ** rng.uniform(-6 if seed % 2 else -1, 0, n)
    if seed % 4 == 1:
        contact[rng.integers(n)] = 0.0
    if seed % 5 == 2:
        omega[0] = zeta[0] = 0.0
    if seed % 7 == 3:
        zeta = 1e-2 * omega  # proportional to stiffness, the fastest far beyond critical damping
    return ImpactSystem.from_modes(omega, zeta, contact, np.ones(n), restitution=0.7)


def asked(packed: PackedSystem) -> dict[str, Array]:
    """The modes in the kernels' order."""
    omega, zeta = packed.system.omega[packed.order], packed.system.zeta[packed.order]
    return {"omega": omega, "sigma": zeta * omega, "contact": packed.system.contact[packed.order]}


def kept(row: Array) -> Array:
    """Projector (2n, 2n) on states whose contact point neither is displaced nor moves."""
    along = np.outer(row, row) / (row @ row)
    return np.kron(np.eye(2), np.eye(len(row)) - along)


def test_blocks_are_those_of_python(node: Node) -> None:
    """Each plane's projector and generator on held states, which do not depend on how its columns are turned and
    scaled; in energy coordinates, to 1e-12 of what is largest: two algorithms, a few hundred operations each.
    """
    packings = [pack(held_system(seed), 30.0) for seed in range(24)]
    answers = node(ASK, {"systems": [asked(each) for each in packings]})
    for packed, found in zip(packings, answers, strict=True):
        rest, n, modes = packed.engine.rest, packed.system.size, asked(packed)
        m = rest.blocks.shape[1]
        into, outof = np.reshape(found["into"], (2 * m, 2 * n)), np.reshape(found["outof"], (2 * n, 2 * m))
        blocks = np.reshape(found["blocks"], (4, m))
        omega = modes["omega"]
        size = np.concatenate([np.where(omega > 0, omega, omega[1]), np.ones(n)])
        held = kept(modes["contact"]) / size  # acts on energy coordinates
        assert np.array_equal(found["mode"], rest.blocks[MODE])
        assert np.allclose(into @ outof, np.eye(2 * m), atol=1e-11)
        for k in range(m):
            pair = slice(2 * k, 2 * k + 2)
            mine, theirs = blocks[:, k].reshape(2, 2), rest.blocks[:4, k].reshape(2, 2)
            rate = max(np.sqrt(abs(np.linalg.det(theirs))), np.abs(theirs).max())
            for one, other in ((np.eye(2), np.eye(2)), (mine / rate, theirs / rate)):
                here = size[:, None] * outof[:, pair] @ one @ into[pair] @ held
                there = size[:, None] * rest.outof[:, pair] @ other @ rest.into[pair] @ held
                assert np.abs(here - there).max() <= 1e-12 * max(1.0, float(np.abs(there).max()))


def test_modes_that_do_not_oscillate_are_refused(node: Node) -> None:
    """Two modes far beyond critical damping, and not in proportion: there are real roots."""
    modes = {"omega": [1.0, 3.0, 5.0], "sigma": [0.1, 30.0, 1.0], "contact": [1.0, 1.0, 1.0]}
    with pytest.raises(ScriptError, match=r"^With so much damping a mode held on the stop does not oscillate"):
        node(ASK, {"systems": [modes]})
    with pytest.raises(ScriptError, match=r"^Two modes coincide: this page cannot hold them"):
        node(ASK, {"systems": [modes | {"omega": [1.0, 1.0, 5.0]}]})
