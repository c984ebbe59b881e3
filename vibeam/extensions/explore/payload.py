"""Payload of a page: engine, models, sliders, sweep and case as one JSON object, arrays to the bit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from typing import Any

import numpy as np

from vibeam import __version__
from vibeam.case.case import Case, quantity_of
from vibeam.extensions.explore.case_text import fixed_keys, template
from vibeam.extensions.explore.dampings import with_dampings
from vibeam.extensions.explore.drive import drive_amplitude, motion_without_stop, slider_frequencies
from vibeam.extensions.explore.models import array_of, ended_words, model_of, packed
from vibeam.extensions.explore.sliders import CaseSliders, Slider, case_sliders
from vibeam.figures.units import DisplayUnits, units_of
from vibeam.flight.engine.browser import browser_libraries, slots_table
from vibeam.flight.engine.loading import WASM
from vibeam.runs.comparison.errors import asked_of
from vibeam_models.outputs import DISPLACEMENT

#: libraries of the kernels by which each engine flies
LIBRARIES = {
    "plain": ("tables", "flight", "points"),
    "harmonics": ("tables", "flight"),
    "regimes": ("tables", "regimes"),
}
FAR = 10.0  # times a motion, beyond which a gap plays no part in it
IMPACTING = 3.0  # times the motion without a stop, that of one with impacts at its peak, roughly
NOT_DAMPED = "the page knows these models at their own damping alone: vibeam run flies others"


def payload(case: Case, units: DisplayUnits | None = None) -> dict[str, Any]:
    """Everything that a page needs to fly a case; ``units``: in which it shows numbers, None: by their size.

    ValueError or CaseError where a fidelity cannot be built, KernelsUnavailable where the libraries of pages are
    missing.
    """
    found = case_sliders(case)
    models = [_model(case, name, found) for name in case.fidelities]
    sliders = _moving(with_dampings(case, found, models), models)
    flown = {each["engine"] for each in models}
    libraries = tuple(dict.fromkeys(name for engine, names in LIBRARIES.items() if engine in flown for name in names))
    contents = browser_libraries(libraries)
    return {
        **_engine(contents),
        "slots": slots_table(libraries),
        "models": models,
        "sliders": [_slider(each) for each in sliders.sliders.values()],
        "fixed": fixed_keys(case, sliders),
        "ended": ended_words(),
        "sweep": _sweep(case, units or guessed_units(case)),
        "asked": vars(asked_of(case)),
        "case": {
            "title": case.title, "name": case.path.stem, "file": case.path.name, "template": template(case, sliders),
        },
    }  # fmt: skip


def _engine(packed: Mapping[str, str]) -> dict[str, Any]:
    digest = sha256("".join(packed[name] for name in sorted(packed)).encode()).hexdigest()
    return {"version": __version__, "level": WASM, "digest": digest[:16], "libraries": dict(packed)}


def _model(case: Case, name: str, sliders: CaseSliders) -> dict[str, Any]:
    """Model of one fidelity with its drive; one that does not follow a slider is refused."""
    made: dict[str, Any] = model_of(case, name)
    made["amplitude"] = packed(drive_amplitude(case, name, slider_frequencies(case)))
    if name in sliders.refused and made["engine"]:
        why = f"It does not follow every slider: {sliders.refused[name]}."
        made |= {"engine": None, "refusal": why}
    return made


def _moving(found: CaseSliders, models: Sequence[Mapping[str, Any]]) -> CaseSliders:
    """Sliders that a model of the page follows."""
    damping = found.sliders.get("damping")
    follows = [each["name"] for each in models if each["engine"] and each.get("damped")]
    if damping is None or any(damping.of.get(name, (1.0, 0.0))[1] for name in follows):
        return found
    kept = {name: each for name, each in found.sliders.items() if name != "damping"}
    return replace(found, sliders=kept, fixed={**found.fixed, "damping": NOT_DAMPED})


def _slider(slider: Slider) -> dict[str, Any]:
    kept = ("name", "key", "label", "unit", "factor", "value", "low", "high")
    said: dict[str, Any] = {name: getattr(slider, name) for name in kept}
    said["of"] = {name: list(each) for name, each in slider.of.items()}
    return said if slider.places is None else said | {"places": array_of(slider.places)}


def _sweep(case: Case, units: DisplayUnits) -> dict[str, Any]:
    swept = case.sweep
    contact = ("mm/s", 1e3) if units.frequency else ("", units.speed_factor)
    return {
        "frequency": swept.frequency.tolist(),
        "direction": swept.direction,
        "settle": swept.settle,
        "hold": swept.hold,
        "output": swept.output,
        "units": {
            "frequency": {"unit": units.frequency, "factor": units.frequency_factor},
            "output": {"unit": units.length, "factor": units.length_factor, "name": swept.output},
            "speed": {"unit": units.speed, "factor": units.speed_factor},
            "contact_speed": dict(zip(("unit", "factor"), contact, strict=True)),
        },
    }


def guessed_units(case: Case) -> DisplayUnits:
    """Units by the largest motion without a stop, the gap, or the room between two stops: no sweep has found a size.

    A gap far beyond that motion, as of a fidelity without a stop, says nothing.
    """
    systems, quantity = [case.system(name) for name in case.fidelities], quantity_of(case, case.sweep.output)
    size = IMPACTING * motion_without_stop(case, next(iter(case.fidelities)), case.sweep.output)
    if quantity is DISPLACEMENT:
        rooms = [each.gap + each.second_gap for each in systems if each.second_gap is not None]
        near = [gap for each in systems if (gap := abs(each.gap)) < FAR * size]
        size = min([max([size, *near]), *rooms])
    return units_of(case, size, 2 * np.pi * float(case.sweep.frequency[-1]) * size, quantity.name)
