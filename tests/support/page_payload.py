"""Payload of a page from systems alone, without a case: drive and stop move by sliders in SI."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vibeam.flight.engine.browser import browser_libraries, slots_table
from vibeam.report.explore.models import _plain, ended_words
from vibeam.system.impact_system import ImpactSystem

LIBRARIES = ("tables", "flight", "points")


def page_payload(systems: Mapping[str, ImpactSystem], amplitude: float) -> dict[str, Any]:
    """Payload of plain systems under a base motion of ``amplitude`` m at every frequency; output: the contact."""
    models = [
        {
            "name": name, "label": name, "engine": "plain", "refusal": "", "modes": system.size, "output": "contact",
            "gap": system.gap, "restitution": system.restitution,
            "amplitude": {"level": amplitude, "power": 0, "factor": 1.0}, **_plain(system),
        }
        for name, system in systems.items()
    ]  # fmt: skip
    of = {name: [0.0, 1.0] for name in systems}
    sliders = [
        {"name": name, "value": 1.0, "of": of} for name in ("frequency", "drive", "gap", "restitution", "damping")
    ]
    return {
        "version": "", "level": "wasm", "libraries": browser_libraries(LIBRARIES), "slots": slots_table(LIBRARIES),
        "models": models, "sliders": sliders, "sweep": {"settle": 100, "hold": 20}, "ended": ended_words(),
    }  # fmt: skip
