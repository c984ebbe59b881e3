"""Mode 1's share of an impact, against an impulse by hand and modes integrated through a contact; its tables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam
from tests.models.bench import RIG
from vibeam.extensions.dictionary.mode_share import counts_up_to, mode_share, yielding_shares
from vibeam.extensions.dictionary.sheets import share_table, sheet, term_table
from vibeam.report.tables import height
from vibeam.studies.derive import derive
from vibeam_models.base import Base
from vibeam_models.beam import assemble
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.yielding import Damped, Linear
from vibeam_models.stop import Stop
from vibeam_models.structure import Structure

CASES = Path(__file__).parents[4] / "cases"
NEUTRAL = CASES / "dtu_neutral.toml"
BRIEF = 2e-7  # s: a contact that moves all modes


@pytest.fixture(scope="module")
def structure() -> Structure:
    return assemble(replace(RIG, base=Base()))


@pytest.mark.parametrize(
    ("case", "settings", "numbers"),
    [
        ("paper/eq38.toml", {}, [1]),  # a static mode
        ("dtu_neutral.toml", {"beam.elements": 8}, [1, 2, 4, 8, 16]),
        ("dtu_neutral.toml", {"beam.elements": 16}, [1, 2, 4, 8, 16, 28]),
        ("dtu_neutral.toml", {"beam.elements": 12}, [1, 2, 4, 8, 16, 22]),
    ],
)
def test_each_number_of_modes_is_a_row_once(case: str, settings: dict[str, Any], numbers: list[int]) -> None:
    found = mode_share(vibeam.load(CASES / case, settings))
    assert [row.modes for row in found.shares] == numbers


def test_a_rigid_stop_by_an_impulse_on_the_modes() -> None:
    impact = mode_share(NEUTRAL)
    modes = assemble(replace(vibeam.load(NEUTRAL).scene, base=Base())).modes()
    contact = modes.shapes.T @ assemble(replace(vibeam.load(NEUTRAL).scene, base=Base())).contact
    for row in impact.shares:
        own = contact[: row.modes]
        for restitution, seen in ((0.72, row.seen), (row.needed, 0.72)):
            before = np.eye(len(own))[0] / own[0]  # contact at 1 m/s
            after = before - own * (1 + restitution) / (own @ own)
            assert -(own @ after) == pytest.approx(restitution)
            assert -after[0] / before[0] == pytest.approx(seen)
    assert [row.modes for row in impact.shares] == [1, 2, 4, 8, 16, 32, len(contact)]


def test_counts() -> None:
    assert [counts_up_to(n) for n in (1, 2, 3, 8, 9)] == [(1,), (1, 2), (1, 2, 3), (1, 2, 4, 8), (1, 2, 4, 8, 9)]


def integrated(structure: Structure, stop: Any, count: int, speed: float) -> float:
    """R₁ of one touch of so many modes, mode 1 moving: DOP853 until the stop lets go, mode 1 freely to the middle."""
    modes = structure.modes(count)
    c = structure.contact @ modes.shapes
    damping = np.diag(structure.congruent("C", modes.shapes))

    def moved(_: float, y: np.ndarray) -> np.ndarray:
        push = stop.force(np.maximum(c @ y[:count], 0.0), c @ y[count:])
        return np.concatenate([y[count:], -damping * y[count:] - modes.omega**2 * y[:count] - c * push])

    def gone(t: float, y: np.ndarray) -> float:
        depth, rate = c @ y[:count], c @ y[count:]
        return 1.0 if t == 0 or (depth > 0 and rate > 0) else stop.stiffness * depth + stop.damping * rate

    gone.terminal, gone.direction = True, -1.0  # type: ignore[attr-defined]
    start = np.zeros(2 * count)
    start[count] = speed / c[0]
    flown = solve_ivp(moved, (0, 0.1), start, "DOP853", events=gone, rtol=1e-12, atol=1e-16)
    lasted, last = flown.t_events[0][0], flown.y_events[0][0]

    def free(y: np.ndarray, elapsed: float) -> float:
        one = solve_ivp(
            lambda _, z: [z[1], -damping[0] * z[1] - modes.omega[0] ** 2 * z[0]], (0, elapsed), [y[0], y[count]],
            "DOP853", rtol=1e-12, atol=1e-16,
        )  # fmt: skip
        return float(one.y[1, -1])

    return -free(last, -lasted / 2) / free(start, lasted / 2)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_stop_that_yields_by_modes_integrated_through_the_contact(structure: Structure, count: int) -> None:
    """A stop so stiff and damped that all is one touch, which R₁ of a collision is then read from."""
    law = Linear(2e7, 4000.0)
    row = list(yielding_shares(structure, law, 0.1, count))[-1]
    assert row.modes == count
    assert row.seen == pytest.approx(integrated(structure, law.contact(1.0), count, 0.1), abs=1e-8)
    assert np.isnan(row.needed)  # no coefficient is given that could be asked for


def test_the_damping_that_a_measured_restitution_needs(structure: Structure) -> None:
    """Put into the stop, it shows that restitution; of one mode it is nearly that of the free mass."""
    law = Linear(1e6, None, 0.72)
    rows = list(yielding_shares(structure, law, 0.1, 8))
    assert [row.modes for row in rows] == [1, 2, 4, 8]
    for row in rows:
        given = list(yielding_shares(structure, Linear(1e6, row.damping), 0.1, row.modes))[-1]
        assert given.seen == pytest.approx(0.72, abs=1e-5)
        assert row.damping == pytest.approx(LinearStop.matched(1e6, row.needed, row.mass).damping, rel=1e-12)
    assert rows[0].needed == pytest.approx(0.72, abs=2e-3)
    assert rows[-1].needed > rows[0].needed + 0.03


def test_hunt_crossley_s_contact_that_a_measured_restitution_needs(structure: Structure) -> None:
    row = list(yielding_shares(structure, Damped(1e9, 0.72, 0.1), 0.1, 4))[-1]
    again = list(yielding_shares(structure, Damped(1e9, row.needed, 0.1), 0.1, 4))[-1]
    assert again.seen == pytest.approx(0.72, abs=1e-5)
    assert np.isnan(row.damping)


def test_a_contact_as_brief_as_none_is_the_rigid_one() -> None:
    rigid, brief = mode_share(RIG), mode_share(RIG, contact_time=BRIEF)
    counted = {row.modes: row for row in rigid.shares}
    for row in brief.shares[:4]:
        assert row.seen == pytest.approx(counted[row.modes].seen, abs=2e-3)
        assert row.share == pytest.approx(counted[row.modes].share, rel=1e-9)


def test_terms_are_of_the_contact_that_the_last_share_has() -> None:
    """R held at mode 1: they have the damping with which eight modes show it; held at the contact: its own."""
    held = mode_share(NEUTRAL, contact_time="0.5 ms", speed="0.2 m/s")
    linear = held.terms["linear"]
    assert held.terms["mujoco"].restitution == pytest.approx(held.shares[-1].needed)
    assert linear.parameters["damping"] == pytest.approx(held.shares[-1].damping, rel=1e-3)
    assert (held.speed, held.contact_time) == (0.2, 0.0005)
    own = mode_share(replace(RIG, stop=Stop(0.132, 1e-4, 0.6)), contact_time=5e-4)
    assert own.terms["chrono"].restitution == pytest.approx(0.6)
    stop = LinearStop(**own.terms["linear"].parameters)
    found = stop.free_impact(own.shares[-1].mass, 0.1)
    assert (found.restitution, found.duration) == (pytest.approx(0.6), pytest.approx(5e-4, rel=1e-9))


def test_a_stop_that_yields_has_its_own_contact_time() -> None:
    soft = CASES / "rigs" / "elastic_stop.toml"
    impact = mode_share(soft)
    assert impact.contact_time == derive(soft).contacts[1].duration
    assert impact.terms["linear"].parameters["stiffness"] == pytest.approx(2e4, rel=1e-8)
    assert impact.terms["linear"].parameters["damping"] == pytest.approx(1.113, rel=1e-3)  # as its note says
    with pytest.raises(ValueError, match=r"this stop yields, and lasts 1\.123 ms by itself"):
        mode_share(soft, contact_time=1e-3)
    assert np.isnan(mode_share(CASES / "rigs" / "afm_tip.toml").shares[0].seen)  # no impact: it stays in contact


def test_no_damping_is_needed_where_even_an_elastic_stop_shows_less() -> None:
    shares = mode_share(CASES / "rigs" / "elastic_stop.toml").shares
    assert [bool(np.isnan(row.needed)) for row in shares] == [False, True, True, True]


def test_the_sheet_says_modes_and_both_coefficients_and_fits_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    case = vibeam.load(NEUTRAL, {"mode_share.contact_time": "0.5 ms"})
    impact = mode_share(case)
    shown, last = sheet(impact, case), impact.shares[-1]
    assert shown.answer == (
        f"R = {last.needed:.4f} at a contact of 0.5 ms, which moves {last.modes} modes, {1e3 * last.mass:.4g} g in "
        "all, is R₁ = 0.7200 of mode 1 at a sensor."
    )
    assert sum(height(each.brief()) for each in shown.tables) <= 37
    usual = vibeam.load(NEUTRAL)
    rigid = sheet(mode_share(usual), usual)
    assert [str(table.title) for table in rigid.tables] == ["Restitution of contact and sensor"]
    assert rigid.answer.startswith("R = 0.8")
    assert rigid.answer.endswith("modes, is R₁ = 0.7200 of mode 1 at a sensor.")
    held = vibeam.load(NEUTRAL, {"mode_share.contact_time": "0.5 ms", "stop.restitution_of": "contact"})
    found = mode_share(held)
    answer = sheet(found, held).answer
    assert answer.startswith("R = 0.7200 at a contact of 0.5 ms")
    assert answer.endswith(f"is R₁ = {found.shares[-1].seen:.4f} of mode 1 at a sensor.")


def test_what_a_form_does_not_reach_is_said() -> None:
    low = mode_share(replace(RIG, stop=Stop(0.132, 1e-4, 0.1)), contact_time=5e-4)
    rows = dict(zip(*(list(column.cells) for column in term_table(low).columns[:2]), strict=True))
    assert rows["Chrono SMC Hertz"] == "out of reach"
    assert rows["LAMMPS hooke"].endswith("e 0.1")
    assert len(share_table(low).rows) == len(low.shares)
