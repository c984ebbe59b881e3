"""Every case's plain fidelities on its page, against Python at random places of the sliders.

All: ``python -m pytest -m slow tests/vibeam/extensions/explore/test_cases_in_javascript.py``, about a minute.
"""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_files import SWEPT
from engine_pages import ENGINE, compared

import vibeam
from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift
from vibeam.extensions.explore.payload import payload
from vibeam.extensions.explore.sliders import case_sliders

Node = Callable[..., Any]
CASES = Path(__file__).parents[4] / "cases"
QUICK = ("dtu_loose.toml", "experiment/fig28.toml", "matrices/frame.toml", "rigs/relay.toml")
PLACES, PERIODS, SETTLE = 20, 20, 60
DAMPING = (0.5, 2.0)


def random_places(page: Mapping[str, Any], count: int) -> list[dict[str, float]]:
    """Places of all sliders, evenly between their ends; damping between half and twice."""
    rng, found = np.random.default_rng(7), []
    for _ in range(count):
        place = {each["name"]: float(rng.uniform(each["low"], each["high"])) for each in page["sliders"]}
        if "damping" in place:
            place["damping"] = float(rng.uniform(*DAMPING))
        frequencies = next(each.get("places") for each in page["sliders"] if each["name"] == "frequency")
        if frequencies is not None:
            known = np.frombuffer(b64decode(frequencies["f8"]))
            place["frequency"] = float(rng.choice(known))
        found.append(place)
    return found


def page_and_python_agree(node: Node, case: Case, count: int) -> None:
    """The fidelities' own numbers are those that their keys make, and the motions those of Python."""
    page = payload(case)
    flown = {each["name"]: each["damped"] for each in page["models"] if each["engine"] == "plain"}
    if not flown:
        pytest.skip("no plain fidelity")
    systems = {name: case.system(name) for name in flown}
    places = {}
    for name, damped in flown.items():
        places[name] = [
            {key: value for key, value in place.items() if damped or key != "damping"}
            for place in random_places(page, count)
        ]
    numbers_are_those_of_the_keys(node, case, page, places)
    found, _, _ = compared(node, page, systems, places, PERIODS, SETTLE, case.sweep.output)
    assert found == []


def numbers_are_those_of_the_keys(
    node: Node, case: Case, page: Mapping[str, Any], places: Mapping[str, list[dict[str, float]]]
) -> None:
    """Gap, restitution, damping and amplitude to 1e-12 of what a model with these keys has."""
    sliders = case_sliders(case).sliders
    asked = [(name, place) for name in places for place in places[name][:3]]
    script = ENGINE + "return given.asked.map(([name, place]) => engine.settings(name, place));"
    for (name, place), own in zip(asked, node(script, {"payload": page, "asked": asked}), strict=True):
        keys: dict[str, float] = {}
        for slider, value in place.items():
            if slider != "frequency" and sliders[slider].of.get(name, (0.0, 0.0))[1]:
                keys |= sliders[slider].settings(value)
        model = case.model(name).at(keys) if keys else case.model(name)
        made, omega = model.system(), 2 * np.pi * place["frequency"]
        amplitude = float(np.ravel(model.amplitude(np.array([omega])))[0])
        zeta = case.system(name).zeta * own["damping"]
        assert np.isclose(own["omega"], omega, rtol=1e-15)
        assert np.isclose(own["amplitude"], amplitude, rtol=1e-12, atol=0)
        drift = gap_drift(model.scene(), np.array([omega]))
        gap = made.gap + (0.0 if drift is None else float(drift[0]))
        assert np.isclose(own["gap"], gap, rtol=1e-12, atol=1e-12 * abs(case.system(name).gap) + 1e-18)
        assert np.isclose(own["restitution"], made.restitution, rtol=1e-12, atol=1e-14)
        assert np.allclose(zeta, made.zeta, rtol=1e-12, atol=1e-10 * zeta.max())  # finite elements: sums of thousands


@pytest.mark.parametrize("name", QUICK)
def test_page_and_python_agree(node: Node, name: str) -> None:
    """At two places."""
    page_and_python_agree(node, vibeam.load(CASES / name), 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", [str(each.relative_to(CASES)) for each in SWEPT])
def test_page_and_python_agree_everywhere(node: Node, name: str) -> None:
    """At twenty places."""
    page_and_python_agree(node, vibeam.load(CASES / name), PLACES)
