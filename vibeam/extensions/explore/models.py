"""Models of a case as numbers for the page: each fidelity's system, or why the page cannot fly it."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from vibeam.case.beam_field import held_at_zero, stations, stop_places
from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift, gap_wear, system
from vibeam.case.fineness import alike, finest
from vibeam.extensions.explore.regime_models import beyond_plain, regimes_refusal
from vibeam.figures.style import looks_of, name_of
from vibeam.flight.linear.held_planes import held_planes, roots_serve
from vibeam.flight.readout import OUTCOMES
from vibeam.report.page.parts import look_on_page
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.outputs import Output
from vibeam_models.scene import AnyScene, Scene

MOST_MODES = 100  # of a plain system: its motions would no longer follow a slider


def model_of(case: Case, name: str) -> dict[str, Any]:
    """Model of one fidelity for the page, JSON-ready; its ``engine`` is None where ``refusal`` says why.

    Its drive is not part of it. ValueError where the system itself cannot be built.
    """
    found, scene = case.system(name), case.scene_of(name)
    refusal, in_regimes = page_refusal(case, name, found), _in_regimes(case, found)
    head = {
        "name": name,
        "label": name_of(case, name),
        "finest": _finest(case, name),
        "engine": None if refusal else "regimes" if in_regimes else "harmonics" if scene.harmonics else "plain",
        "refusal": refusal,
        "modes": found.size,
        "gap": found.gap,
        "restitution": found.restitution,
        "output": case.sweep.output,
        "base": _base_share(scene),
        "stops": _stops(scene, found),
        "look": look_on_page(looks_of(case, case.fidelities)[name]),
    }
    if refusal:
        return head | {"damped": False, "stations": None, "outputs": {}}
    own = packed(beyond_plain(found, case.sweep.output)) if in_regimes else plain_rows(found)
    if scene.platform is not None and case.keys.value("platform.coupling") == "two-way":
        own["damped"] = False  # the platform's damping ratio is multiplied too, and makes how far it moves the base
    if scene.harmonics:
        own["harmonics"] = array_of(np.array(scene.harmonics))
    return head | _stations(case, name) | _drift(scene) | own


def page_refusal(case: Case, name: str, found: ImpactSystem) -> str:
    """Reason why the page cannot fly a fidelity, a sentence; empty where it can."""
    solver, scene = case.fidelities[name].solver, case.scene_of(name)
    if solver != "flight":
        return f'Found by the solver "{solver}": the page has the exact flight alone. The terminal runs it: vibeam run.'
    if scene.harmonics and (_in_regimes(case, found) or not roots_serve(found)):
        return "Its drive has several harmonics, which the page takes with plain modes alone. Take vibeam run."
    if gap_wear(scene):
        return "Its gap wears with each impact: the page knows no wear. The terminal flies it: vibeam run."
    if _in_regimes(case, found):
        return regimes_refusal(found, case.sweep.output)
    if found.size > MOST_MODES:
        return f"{found.size} modes are too many for the page, which flies {MOST_MODES} at most: take fewer modes."
    return ""


def ended_words() -> dict[str, str]:
    """Why a motion ended, in words, by the kernels' code of it."""
    return {str(code): ended.value for code, ended in OUTCOMES.items()}


def array_of(values: Array) -> dict[str, Any]:
    """An array to the bit: little-endian doubles in base64, and its shape."""
    whole = np.ascontiguousarray(values, dtype="<f8")
    return {"f8": b64encode(whole.tobytes()).decode(), "shape": list(whole.shape)}


def packed(values: Any) -> Any:
    """A tree of dictionaries, its arrays to the bit."""
    if isinstance(values, dict):
        return {name: packed(each) for name, each in values.items()}
    return array_of(values) if isinstance(values, np.ndarray) else values


def _in_regimes(case: Case, found: ImpactSystem) -> bool:
    """Test whether a system is more than plain, or the sweep reads a derivative, which only regimes do."""
    return bool(found.beyond_plain) or found.derivative(case.sweep.output) is not None


def _drift(scene: AnyScene) -> dict[str, Any]:
    """Gap added at the contact (m) at frequencies (Hz), linear between them and constant beyond."""
    if scene.stop is None or scene.stop.drift_frequency is None:
        return {}
    frequency = np.array(scene.stop.drift_frequency)
    return {"drift": packed({"frequency": frequency, "gap": gap_drift(scene, 2 * np.pi * frequency)})}


def plain_rows(found: ImpactSystem) -> dict[str, Any]:
    """Rows of a plain system, JSON-ready, and the system held on its stop where the page does not find it by itself."""
    rows = {name: array_of(getattr(found, name)) for name in ("omega", "zeta", "contact", "load", "static")}
    outputs = {name: array_of(row) for name, row in found.outputs.items()}
    by_roots = roots_serve(found)
    rest = None if by_roots else {name: array_of(values) for name, values in held_planes(found).items()}
    return {**rows, "outputs": outputs, "damped": by_roots, "rest": rest}


def _finest(case: Case, name: str) -> str:
    """Finest fidelity, the first of several, among those of the same rig: as ``Result.finest``."""
    sizes = _sizes(case)
    return finest(case, {each: sizes[each] for each in alike(case, case.fidelities, name)})


@lru_cache(maxsize=1)
def _sizes(case: Case) -> dict[str, int]:
    """Number of modes of every fidelity of the case asked for last."""
    return {name: case.system(name).size for name in case.fidelities}


def _base_share(scene: AnyScene) -> float | None:
    """Share of the drive's amplitude with which the base moves; None where it moves by itself, or there is no beam."""
    if not isinstance(scene, Scene) or scene.platform or scene.harmonics:
        return None
    return 0.0 if scene.base.on_beam else 1.0


def _stops(scene: AnyScene, found: ImpactSystem) -> list[list[float]]:
    """Stops that stand still as seen from the base: place (m), height (m), side, change of the height with the gap."""
    if not isinstance(scene, Scene) or scene.named("opposite"):
        return []
    return [[*each, 1.0 if i == 0 else 0.0] for i, each in enumerate(stop_places(scene, found))]


def _stations(case: Case, name: str) -> dict[str, Any]:
    """Places along the beam (m), and the rows of its deflections there on the modes."""
    places, scene = stations(case, name), case.scene_of(name)
    if not places or not isinstance(scene, Scene):
        return {"stations": None}
    asked = tuple(Output(each, position) for each, position in places.items())
    seen = system(replace(scene, outputs=(*scene.outputs, *asked)), case.fidelities[name])
    rows = np.stack([seen.output(each) for each in places])
    held = held_at_zero(case, name)
    return {"stations": {"places": list(places.values()), "rows": array_of(rows), "held": held}}
