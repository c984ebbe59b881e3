"""The limit of infinitely many modes: rates of known sequences, mobilities and collisions in closed form, refusals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from vibeam.studies.modes_needed.limit import (
    BARE,
    DIVERGES,
    MOVING_LAW,
    NO_MOTION,
    ROUND_OFF,
    LimitRow,
    limit,
    models,
    observed_limit,
)

import vibeam
from vibeam.case.fidelity import Fidelity, system

CASES = Path(__file__).parents[3] / "cases"
NEUTRAL = CASES / "dtu_neutral.toml"
COUNTS = (1, 2, 4, 8, 16, 32)
DOUBLED = [2**k for k in range(8)]
STIFFNESS = 1e6
LINEAR = {"gap": "0 mm", "law": "linear", "stiffness": f"{STIFFNESS} N/m", "damping": "0 N s/m"}
HERTZ = {"gap": "0 mm", "law": "hertz", "hertz_stiffness": 2.04e10}


@pytest.mark.parametrize("rate", [0.5, 1.0, 2.0, 3.3])
def test_a_power_law_has_its_rate_and_its_limit(rate: float) -> None:
    found = observed_limit(DOUBLED, [2.0 + 0.3 * n**-rate for n in DOUBLED])
    assert found.extrapolated
    assert found.rate == pytest.approx(rate, abs=1e-9)
    assert found.limit == pytest.approx(2.0, abs=1e-12)


@pytest.mark.parametrize("signs", [(1, -1), (1, 1, -1), (1, 0.2)])
def test_an_uneven_sequence_is_bounded_and_the_limit_is_within(signs: tuple[float, ...]) -> None:
    values = [2.0 + 0.3 * signs[k % len(signs)] * n**-1.5 for k, n in enumerate(DOUBLED)]
    found = observed_limit(DOUBLED, values)
    assert not found.extrapolated
    assert abs(found.limit - 2.0) <= found.uncertainty
    assert found.uncertainty < 0.01


def test_what_does_not_converge_is_refused_with_the_sentence() -> None:
    for values in ([np.log(n) for n in DOUBLED], [float(n) for n in DOUBLED], [(-1.0) ** k for k in range(8)]):
        found = observed_limit(DOUBLED, values)
        assert np.isnan(found.limit)
        assert found.why.startswith(DIVERGES.split("{")[0])
    assert observed_limit([1, 2, 4], [1.0, 0.5, 0.25]).why
    still = observed_limit(DOUBLED, [1.0] * 8)
    assert (still.limit, still.uncertainty) == (1.0, ROUND_OFF)


def of(rows: list[LimitRow], held: str, quantity: str) -> LimitRow:
    return next(row for row in rows if row.held.startswith(held) and row.quantity == quantity)


@pytest.fixture(scope="module")
def rows() -> list[LimitRow]:
    cases = [vibeam.load(NEUTRAL, set={} if stop is None else {"stop": stop}) for stop in (None, LINEAR, HERTZ)]
    return [row for case in cases for row in limit(case, modes=32, frequency="15.2 Hz", speed=0.05)]


def test_with_r_of_the_contact_held_the_mobility_of_the_rigid_mass_is_the_limit(rows: list[LimitRow]) -> None:
    """S∞ = 1/m of what is rigid at the contact, discs and strip beneath them: the modes' share falls like 1/N."""
    found = of(rows, "R = 0.72", "R₁ of mode 1")
    first = float(models(vibeam.load(NEUTRAL).scene, [32])[0].contact[0])
    rigid = 0.2 + 7850 * 0.02 * 1.034e-3 * 2 * 11.7e-3
    assert abs(found.limit - (1.72 * first**2 * rigid - 1)) <= found.uncertainty < 0.01
    assert found.rate == pytest.approx(1, abs=0.2)
    contact = of(rows, "R₁ = 0.72", "R of the contact")
    assert abs(contact.limit - (1.72 / (first**2 * rigid) - 1)) <= contact.uncertainty < 0.01


def test_with_r_of_mode_1_held_the_motion_settles_two_powers_faster(rows: list[LimitRow]) -> None:
    """Against the flight of 96 modes."""
    case = vibeam.load(NEUTRAL, set={"stop.restitution_of": "first mode", "beam.elements": 288})
    many = system(case.scene, Fidelity("many", "modal", 96))
    flown = vibeam.sweep(many, omega=[2 * np.pi * 15.2], amplitude=case.base_amplitude, settle=400, output="sensor")
    held, free = of(rows, "R₁ = 0.72", "amplitude"), of(rows, "R = 0.72", "amplitude")
    assert held.limit == pytest.approx(flown.amplitude[0], rel=1e-5)
    assert held.rate > free.rate + 1.5
    assert held.enough == 2
    assert free.enough not in (1, 2, 4, 8, 16)  # 32 at most show that they are enough
    assert free.uncertainty > 100 * held.uncertainty


def first_mode_after(model: Any, stiffness: float, speed: float) -> float:
    """R₁ after contact with a spring, by the matrix exponential of modes and spring together."""
    n, c = model.size, model.contact
    rigid = np.diag(model.omega**2) + stiffness * np.outer(c, c)
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-rigid, -np.diag(2 * model.zeta * model.omega)]])
    start = np.zeros(2 * n)
    start[n] = speed / c[0]
    times = np.linspace(1e-6, 4e-3, 4001)
    depths = np.array([c @ (expm(matrix * t) @ start)[:n] for t in times[::40]])
    out = int(np.flatnonzero(depths < 0)[0])
    end = brentq(lambda t: float(c @ (expm(matrix * t) @ start)[:n]), times[::40][out - 1], times[::40][out])
    after, sigma = expm(matrix * end) @ start, model.zeta[0] * model.omega[0]
    free = np.array([[0.0, 1.0], [-(model.omega[0] ** 2), -2 * sigma]])
    before = expm(free * end / 2) @ np.array([0.0, start[n]])
    later = expm(-free * end / 2) @ np.array([after[0], after[n]])
    return float(-later[1] / before[1])


def test_one_collision_with_a_linear_stop_is_that_of_modes_and_spring(rows: list[LimitRow]) -> None:
    found = of(rows, 'law "linear"', "R₁ of mode 1")
    scene = vibeam.load(NEUTRAL, set={"stop": LINEAR}).scene
    for count in (2, 8):
        (model,) = models(scene, [count])
        truth = first_mode_after(replace(model, law=None, restitution=1.0), STIFFNESS, 0.05)
        assert found.values[COUNTS.index(count)] == pytest.approx(truth, abs=1e-7)
    assert found.rate > 3  # the static flexibility of the modes left out falls like N⁻⁵
    assert found.uncertainty < 1e-6


def test_the_contact_time_says_how_many_modes(rows: list[LimitRow]) -> None:
    for law, modes in (('law "linear"', 3), ('law "hertz"', 8)):
        found = of(rows, law, "R₁ of mode 1")
        time = of(rows, law, "contact time").limit
        frequencies = np.sort(models(vibeam.load(NEUTRAL).scene, [32])[0].omega) / (2 * np.pi)
        assert found.by_contact_time == modes == np.count_nonzero(frequencies * time < 1)
        assert found.enough in (modes, modes + 1)


def test_a_contact_without_mass_has_no_limit_and_says_why(tmp_path: Path) -> None:
    text = (CASES / "rigs" / "elastic_stop.toml").read_text("utf-8").split("[expect")[0]
    bare = tmp_path / "bare.toml"
    bare.write_text(text.replace('law = "linear"\nstiffness = "20 N/mm"\n', ""), "utf-8")
    rows = limit(vibeam.load(bare), modes=32)
    own = {row.quantity: row.why for row in rows if row.held.startswith("R = ")}
    assert own.pop("R₁ of mode 1") == BARE
    lost = NO_MOTION.format("4, 8, 16, 32")
    assert set(own.values()) == {f"{BARE}; {lost}"}
    assert all(np.isnan(row.limit) and row.enough == 0 for row in rows if row.held.startswith("R = "))
    refused = next(row for row in rows if row.held.startswith("R₁"))
    assert "outside [0, 1]" in refused.why
    own = limit(vibeam.load(CASES / "rigs" / "elastic_stop.toml"), modes=32)
    assert all(row.why.startswith(MOVING_LAW) for row in own)
    damped = bare.with_name("damped.toml")
    damped.write_text(text.replace("restitution = 0.8", 'damping = "1 N s/m"'), "utf-8")
    found = of(limit(vibeam.load(damped)), 'law "linear"', "contact time")
    assert np.isfinite(found.limit)


def test_a_motion_that_ends_with_more_modes_is_said_beside_what_else_is_wrong() -> None:
    values = (1e-4, 9e-5, float("nan"))
    row = LimitRow("R = 0.5", "amplitude", "m", (8, 16, 32), values, why="the contact has no mass")
    assert row.observed().why == f"the contact has no mass; {NO_MOTION.format('32')}"


def test_one_degree_of_freedom_has_no_more_modes() -> None:
    with pytest.raises(ValueError, match="no more modes"):
        limit(vibeam.load(CASES / "sdof_nominal.toml"))
    with pytest.raises(ValueError, match="modes: 12 must be a power of two"):
        limit(vibeam.load(NEUTRAL), modes=12)


TWO_SIDES = {"second_gap": "0.4 mm", "gap": "0 mm", "restitution": 0.5}


@pytest.mark.parametrize("stop", [HERTZ, LINEAR, TWO_SIDES], ids=["Hertz", "linear", "two sides"])
def test_the_exact_motion_with_any_stop_is_that_of_settled_flights(stop: dict[str, Any], tmp_path: Path) -> None:
    text = NEUTRAL.read_text("utf-8").split("[reference")[0]
    head, tail = text.split("[stop]")
    lines = "\n".join(f"{key} = {value!r}".replace("'", '"') for key, value in stop.items())
    (tmp_path / "it.toml").write_text(f"{head}[stop]\n{lines}\n\n[sensor]{tail.split('[sensor]')[1]}", "utf-8")
    case = vibeam.load(tmp_path / "it.toml")
    scene: Any = case.scene
    at = 15.0
    rows = {(row.held, row.quantity): row for row in limit(case, modes=16, frequency=at)}
    found = next(row for (_, quantity), row in rows.items() if quantity == "amplitude")
    omega, counts = 2 * np.pi * at, (4, 8, 16)
    for count, model in zip(counts, models(scene, counts), strict=True):
        flown = vibeam.sweep(
            model, omega=[omega], amplitude=case.amplitude(np.array([omega])), settle=600, hold=8, output="sensor"
        )
        assert found.values[found.counts.index(count)] == pytest.approx(flown.amplitude[0], rel=1e-8)


@pytest.mark.parametrize(
    ("values", "arrived"),
    [
        ([1, 1, 1, 2, 3, 4], False), ([1, 1, 1, 1, 1.5, 1.7], False), ([1, 2, 3, 4, 4], True),
        ([1, 2, 1, 2, 1, 1], True), ([0, 0, 0, 0, 0], True),
    ],
)  # fmt: skip
def test_values_that_stand_still_are_taken_without_a_division_by_nothing(values: list[float], arrived: bool) -> None:
    found = observed_limit([2**n for n in range(len(values))], [float(each) for each in values])
    assert (found.limit == values[-1]) is arrived
    assert np.isfinite(found.uncertainty) == arrived
