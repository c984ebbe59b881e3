"""Fits of rigs whose points are of several families, made by another integrator (tests/benchmarks/fit_families.py)."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"

RESULTS = json.loads((BENCHMARKS / "results" / "fit_families.json").read_text(encoding="utf-8"))

EXAMPLES = [each for each in RESULTS["sets"] if each["set"]]


@pytest.fixture
def families(monkeypatch):
    """The benchmark that draws the rigs."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import fit_families

    yield fit_families
    sys.modules.pop("fit_families")


def test_nine_of_ten_intervals_hold_the_truth_in_the_trial():
    held, total = (sum(len(each[part]) for each in RESULTS["sets"]) for part in ("held", "errors"))
    assert (held, total) == (RESULTS["summary"]["held"], RESULTS["summary"]["intervals"])
    assert total == 120
    assert held >= 0.9 * total
    assert all(each["of_other_families"] >= 2 for each in RESULTS["sets"])


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda each: f"{each['rig']} {each['seed']}")
def test_points_of_other_families_do_not_pull_the_keys(families, example):
    """Every interval holds the truth, and the points left out are about as many as there are of other families."""
    given = example["set"]
    arrays = {name: np.array(given[name]) for name in ("frequency", "noisy")}
    exact = families.Record(np.array(given["exact"]), np.zeros(0), np.zeros(0))
    case = families.Measured(**given | arrays | {"exact": exact}).case()
    study = vibeam.fit(case)
    assert study.judgement.described
    assert all(row.low <= given["truth"][row.key] <= row.high for row in study.rows)
    left = sum(bool(point.left_out) for point in study.points)
    assert 0 < left <= example["of_other_families"] + 1


def test_the_integrator_of_the_trial_is_another_one_s(families):
    """Two modes from rest, 32 periods, against an adaptive Runge–Kutta method with events."""
    system = vibeam.ImpactSystem.from_modes(
        [70.0, 400.0], 0.02, [1.0, 0.6], [0.9, 0.4], gap=5e-5, restitution=0.7, outputs={"sensor": [0.8, -0.5]}
    )
    omega, amplitude = 90.0, 1e-4
    record = families.records(system, np.array([omega]), amplitude, settle=0)

    def slope(time, y):
        pull = system.load * omega**2 * amplitude * np.sin(omega * time)
        return np.concatenate([y[2:], pull - 2 * system.zeta * system.omega * y[2:] - system.omega**2 * y[:2]])

    def gap(_, y):
        return system.gap - system.contact @ y[:2]

    gap.terminal, gap.direction = True, -1.0
    time, y, end, impacts, seen = 0.0, np.zeros(4), 32 * 2 * np.pi / omega, 0, []
    while time < end:
        found = solve_ivp(slope, (time, end), y, events=gap, rtol=1e-9, atol=1e-14, max_step=2 * np.pi / omega / 100)
        seen += (system.outputs["sensor"] @ found.y[:2]).tolist()
        time, y = found.t[-1], found.y[:, -1].copy()
        if found.status != 1:
            break
        speed = system.contact @ y[2:]
        y[2:] -= (1 + system.restitution) * speed / (system.contact @ system.contact) * system.contact
        impacts += 1
    assert record.impacts.tolist() == [impacts]
    assert record.amplitude[0] == pytest.approx((max(seen) - min(seen)) / 2, rel=2e-3)
