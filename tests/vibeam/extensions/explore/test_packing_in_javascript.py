"""Plain systems packed in JavaScript against Python's arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from engine_pages import ENGINE
from page_payload import page_payload
from test_flights_in_javascript import FIXED, SYSTEMS

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.linear.block_regime import set_output
from vibeam.flight.linear.held_planes import roots_serve
from vibeam.flight.linear.packing import pack
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

Node = Callable[..., Any]
CHANGES = {"gap": 2e-4, "restitution": 0.4, "damping": 1.5}
SCRIPT = (
    ENGINE
    + """
const arrays = (given) => Object.fromEntries(Object.entries(given).map(([name, each]) =>
  [name, each.data ? each.data.slice() : arrays(each)]));
return given.asked.map(([fidelity, place, omega]) => {
  const { packed } = engine.ready(fidelity, engine.settings(fidelity, place), omega);
  packed.output("all");
  return { ...arrays(packed.engine(0.5)), order: packed.order };
});
"""
)


def test_arrays_are_those_of_python(node: Node) -> None:
    """As the system is, with another gap, restitution and damping, and back: to the last bits, of sums and powers in
    another order; tables to 1e-13, as two machines' exponentials make them.
    """
    asked, systems = [], {name: replace(each, outputs={"all": np.ones(each.size)}) for name, each in SYSTEMS.items()}
    for name in SYSTEMS:
        changes = {key: value for key, value in CHANGES.items() if key != "damping" or name not in FIXED}
        asked += [
            [name, {"frequency": 1.0, **each}, omega] for each, omega in (({}, 60.0), (changes, 11.0), ({}, 60.0))
        ]
    answers = node(SCRIPT, {"payload": page_payload(systems, 1.0), "asked": asked})
    for (name, place, omega), found in zip(asked, answers, strict=True):
        system = SYSTEMS[name]
        system = replace(
            system, gap=place.get("gap", system.gap), restitution=place.get("restitution", system.restitution),
            zeta=system.zeta * place.get("damping", 1.0),
        )  # fmt: skip
        packed = pack(system, omega)
        engine = packed.engine_for(0.5)
        set_output(engine.rest, packed.inward(np.ones(system.size)))
        assert found["order"] == packed.order.tolist()
        for field in ("pairs", "levels", "modes", "drive"):
            near(found[field], getattr(engine, field), 1e-15, f"{name} {field}")
        for field in ("table", "cells", "rungs"):
            near(found[field], getattr(engine, field), 1e-13, f"{name} {field}")
        rest_is_that_of_python(found["rest"], engine.rest, packed.inward(system.contact), load_of(system), name)


def test_only_systems_that_have_no_roots_of_their_own_carry_blocks() -> None:
    """Modes that coincide, and held modes that do not oscillate, but not damping in proportion, however large."""
    assert {name for name, each in SYSTEMS.items() if not roots_serve(each)} == set(FIXED)
    assert not roots_serve(ImpactSystem.from_modes([3.0, 3.0], 0.1, [1.0, 2.0], [1.0, 1.0]))


def test_memory_that_is_not_there_is_a_sentence(node: Node) -> None:
    """What is asked for beyond it, and what fits goes on."""
    script = """
    const { Slots } = await load("extensions/explore/engine/slots.js");
    const memory = new WebAssembly.Memory({ initial: 1, maximum: 4 });
    const slots = new Slots(memory, { entries: {}, rows: {}, first: 0 }, {});
    const said = (size) => {
      try { return slots.array("f8", [size]).address; } catch (fault) { return fault.message; }
    };
    return [said(8000), said(80000), said(8)];
    """
    first, beyond, last = node(script, {})
    assert (first, last) == (0, 64000)
    assert beyond == "This motion needs more memory than there is: take fewer periods, or a model with fewer modes."


def load_of(system: ImpactSystem) -> float:
    """The largest share of a mode in what acts on the system held on its stop."""
    held = np.abs(system.contact * system.gap / system.mobility)
    return float(max(np.abs(system.load).max(), (np.abs(system.static) + system.omega**2 * held).max()))


def near(mine: Any, theirs: Array, off: float, where: str) -> None:
    """Equal but for ``off`` of each number."""
    assert np.size(mine) == theirs.size, where
    assert np.allclose(np.reshape(mine, theirs.shape), theirs, rtol=off, atol=0), where


def rest_is_that_of_python(mine: dict[str, Any], theirs: Regime, contact: Array, largest: float, name: str) -> None:
    """Rates, what acts on the modes, and the signals of held states: none depends on how blocks are turned and scaled;
    but for 1e-13 of the largest of each, which is a sum over the modes.
    """
    n, m = len(contact), theirs.blocks.shape[1]
    kept = np.kron(np.eye(2), np.eye(n) - np.outer(contact, contact) / (contact @ contact))
    rows = slice(layout.OMEGA, layout.DISC)
    into, outof, blocks, signals = (
        np.reshape(mine[field], getattr(theirs, field).shape) for field in ("into", "outof", "blocks", "signals")
    )
    alike(np.array(mine["held"]), theirs.held, 0.0, name)
    alike(np.reshape(mine["pairs"], theirs.pairs.shape)[rows], theirs.pairs[rows], 0.0, name)
    alike(signals[:, 2 * m :], theirs.signals[:, 2 * m :], 0.0, name)
    for each in ([layout.CONSTANT1, layout.CONSTANT2], [layout.LOAD1, layout.LOAD2]):
        alike(outof @ blocks[each].T.ravel(), theirs.outof @ theirs.blocks[each].T.ravel(), largest, name)
    for own, other in zip(signals[:, : 2 * m], theirs.signals[:, : 2 * m], strict=True):
        parts = np.abs(other) @ np.abs(theirs.into)
        alike(own @ into @ kept, other @ theirs.into @ kept, parts.max(initial=0.0), name)


def alike(mine: Array, theirs: Array, parts: float, where: str) -> None:
    """Equal but for 1e-13 of the largest, or of the parts that it is a sum of."""
    assert np.abs(mine - theirs).max(initial=0.0) <= 1e-13 * max(np.abs(theirs).max(initial=0.0), parts), where
