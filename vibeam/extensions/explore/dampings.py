"""Other damping of fidelities by regimes: found beforehand, at the few factors that the page's slider then keeps to."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.extensions.explore.models import packed
from vibeam.extensions.explore.own_numbers import SAME, changes, says, system_at
from vibeam.extensions.explore.regime_models import regimes_at_damping

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.extensions.explore.sliders import CaseSliders, Slider

#: times the case's damping: as many as there is room for
FACTORS = ((0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0), (0.0, 0.5, 1.0, 2.0, 5.0), (0.5, 1.0, 2.0))
ROOM = 250_000  # characters of a page for all of them
PARTS = ("law", "damper", "damping", "free", "upper", "lower")


def with_dampings(case: Case, found: CaseSliders, models: Sequence[dict[str, Any]]) -> CaseSliders:
    """Sliders of a case, that of damping at factors at which every fidelity by regimes has been ``damped``.

    Adds ``dampings`` to these ``models``. The sliders as they are where no such fidelity follows, or there is no room.
    """
    slider = found.sliders.get("damping")
    following = [each for each in models if each["engine"] == "regimes" and slider and slider.of[each["name"]][1]]
    if slider is None or not following:
        return found
    wanted = _factors(following, slider)
    made = {each["name"]: _dampings(case, each["name"], slider, wanted) for each in following}
    common = [factor for factor in wanted if all(factor in each for each in made.values())]
    if len(common) < 2:
        return found
    for each in following:
        dampings = [made[each["name"]][factor] for factor in common if factor != 1.0]
        each |= {"damped": True, "dampings": dampings}
    kept = replace(slider, places=np.array(common))
    return replace(found, sliders={**found.sliders, "damping": kept})


def _factors(models: Sequence[Mapping[str, Any]], slider: Slider) -> tuple[float, ...]:
    """Factors for which there is room: beside that of the models themselves, as large each."""
    size = sum(len(json.dumps({name: each["regimes"][name] for name in PARTS})) for each in models)
    for factors in FACTORS:
        inside = tuple(each for each in factors if slider.low <= each <= slider.high)
        if (len(inside) - 1) * size <= ROOM:
            return inside
    return ()


def _dampings(case: Case, name: str, slider: Slider, factors: Sequence[float]) -> dict[float, dict[str, Any]]:
    """Regimes of a fidelity by factor, where the case may have it and nothing but its damping changes.

    ``drive``: how many times as large its drive is then, as a calibrated platform has it.
    """
    model, fidelity = case.model(name), case.fidelities[name]
    base, omega, found = model.system(), 2 * np.pi * case.sweep.frequency, dict[float, dict[str, Any]]()
    for factor in factors:
        keys = {key: value for key, value in slider.settings(factor).items() if not says(fidelity, key)}
        system = system_at(model, keys)
        if system is None or next(changes(base, system, None, "zeta", "coupling"), None):
            continue
        drives = [np.broadcast_to(each.amplitude(omega), omega.shape) for each in (model.at(keys), model)]
        shares = drives[0] / drives[1] if np.all(drives[1]) else np.ones(1)
        if np.ptp(shares) > SAME * np.max(shares):
            continue  # a platform that is not felt: its damping changes how far it moves at each frequency
        with suppress(ValueError):  # modes that coincide near critical damping have no blocks
            found[factor] = packed(regimes_at_damping(system, factor)) | {"drive": float(shares[0])}
    return found
