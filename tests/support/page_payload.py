"""Payload of a page from systems alone, without a case: drive and stop move by sliders in SI."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vibeam.extensions.explore.models import ended_words, packed, plain_rows
from vibeam.extensions.explore.regime_models import beyond_plain
from vibeam.flight.engine.browser import browser_libraries, slots_table
from vibeam.system.impact_system import ImpactSystem

LIBRARIES = {"plain": ("tables", "flight", "points"), "regimes": ("tables", "regimes")}


def page_payload(systems: Mapping[str, ImpactSystem], amplitude: float) -> dict[str, Any]:
    """Payload of systems under a base motion of ``amplitude`` m at every frequency; read: "sensor", or the contact."""
    models = [_model(name, system, amplitude) for name, system in systems.items()]
    libraries = sorted({each for model in models for each in LIBRARIES[model["engine"]]})
    of = {name: [0.0, 1.0] for name in systems}
    sliders = [
        {"name": name, "value": 1.0, "of": of} for name in ("frequency", "drive", "gap", "restitution", "damping")
    ]
    return {
        "version": "", "level": "wasm", "libraries": browser_libraries(libraries), "slots": slots_table(libraries),
        "models": models, "sliders": sliders, "sweep": {"settle": 100, "hold": 20}, "ended": ended_words(),
    }  # fmt: skip


def _model(name: str, system: ImpactSystem, amplitude: float) -> dict[str, Any]:
    output = "sensor" if "sensor" in system.outputs else "contact"
    rows = packed(beyond_plain(system, output)) if system.beyond_plain else plain_rows(system)
    return {
        "name": name, "label": name, "engine": "regimes" if system.beyond_plain else "plain", "refusal": "",
        "modes": system.size, "output": output, "gap": system.gap, "restitution": system.restitution,
        "amplitude": {"level": amplitude, "power": 0, "factor": 1.0}, **rows,
    }  # fmt: skip
