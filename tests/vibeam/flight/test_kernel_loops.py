"""Loops of the kernels: each ends by a count, or by what its reason here says, whatever round-off says."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

FLIGHT = Path(__file__).parents[3] / "vibeam" / "flight"
KERNELS = (FLIGHT / "kernels", FLIGHT / "points" / "kernels")

# loops whose condition names no bound: what bounds them, as their bodies have it
BY_THEIR_BODY = {
    "kernels/block_energy.py": {"done < duration": "a step is a share 1/STEPS of the duration at least"},
    "kernels/contacts/events.py": {
        "done < span or status[row.PHASE] == row.STRIKING": "EVENTS_AN_IMPACT, IDLE, STEPS_A_PANEL and ENDLESS"
    },
    "kernels/contacts/load/poses.py": {"left > 0.0": "each turn takes a piece of the load"},
    "kernels/contacts/load/walk.py": {"done < span": "LONG panels, STRIDE pieces"},
    "kernels/entry.py": {"node.time < duration": "each panel takes a row of the pieces' room, a halving a level"},
    "kernels/events.py": {"done < span": "EVENTS_AN_IMPACT and IDLE"},
    "kernels/lanes/plain_flights.py": {
        "found == SPLIT": "a halving takes a level",
        "time < span": "MOST panels",
        "ringing > 1": "one block fewer each turn",
    },
    "kernels/regimes/events.py": {"done < span": "EVENTS_AN_IMPACT, IDLE and STEPS_A_PANEL"},
    "kernels/regimes/laws.py": {"curve[row.SPEED_AT, i + 1] <= velocity": "the table's last speed is above it"},
    "kernels/roots/first_root.py": {"node.time < span": "MOST_PANELS panels"},
    "kernels/steady_point.py": {
        "outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold": "a period or a trace each turn, limit impacts",
    },
    "kernels/tangents/contact.py": {"u < 1.0 and duration > 0.0": "MOST_PANELS panels"},
    "points/kernels/entry.py": {"whole[row.PHASE] != row.FLYING": "BUDGET, or the points are used up"},
    "points/kernels/point.py": {"share[row.LEFT] > 0.0": "a period or more each turn"},
    "points/kernels/watch.py": {
        "outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold": "a period or a trace each turn, limit impacts",
    },
}
BITS = {"lost", "plain", "rest", "todo", "split", "longer"}  # lanes of a mask of eight, one fewer each turn


def names_a_bound(condition: ast.expr) -> bool:
    """True where a loop goes on only as long as a number is on one side of a constant, a shape or a given count."""
    parts = condition.values if isinstance(condition, ast.BoolOp) and isinstance(condition.op, ast.And) else [condition]
    return any(isinstance(part, ast.Compare) and bool(bounds_in(part)) for part in parts)


def bounds_in(compared: ast.Compare) -> list[str]:
    """What bounds a comparison: constants in capitals, sizes of arrays, the number of something counted."""
    found = []
    for node in ast.walk(compared):
        said = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
        is_constant = said.isupper() and said in ("BATCH", "BUDGET", "FINEST", "GRADES", "LEVELS", "ROUNDS", "SHORTEST")
        if is_constant or said.startswith("MOST") or said == "shape" or said in ("settle", "periods", "count", "most"):
            found.append(said)
    return found


def loops(source: str) -> list[ast.While]:
    return [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.While)]


def unbounded(source: str, reasons: dict[str, str]) -> list[str]:
    """The conditions of loops that nothing is known to end."""
    said = [(loop.test, ast.unparse(loop.test)) for loop in loops(source)]
    return [text for test, text in said if not (names_a_bound(test) or text in reasons or text in BITS)]


def test_every_loop_of_a_kernel_has_a_bound() -> None:
    found, used = {}, set()
    for folder in KERNELS:
        for file in sorted(folder.rglob("*.py")):
            place = file.relative_to(FLIGHT).as_posix()
            source, reasons = file.read_text(encoding="utf-8"), BY_THEIR_BODY.get(place, {})
            found[place] = unbounded(source, reasons)
            used |= {(place, ast.unparse(loop.test)) for loop in loops(source)}
    assert {place: said for place, said in found.items() if said} == {}
    stale = {(place, said) for place, reasons in BY_THEIR_BODY.items() for said in reasons} - used
    assert not stale, "reasons of loops that are gone"


@pytest.mark.parametrize(
    "condition", ["True", "h > 0.0", "done < span", "found == SPLIT", "left > 0.0 or steps < MOST"]
)
def test_a_loop_without_one_is_refused(condition: str) -> None:
    assert unbounded(f"while {condition}:\n    pass", {}) == [condition]
