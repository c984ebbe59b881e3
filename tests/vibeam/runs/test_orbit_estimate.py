"""Errors estimated by orbits where no closed form knows the motion: against flights of the full model, settled."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.case.fidelity import gap_drift
from vibeam.flight.solver import exact_solver
from vibeam.runs.estimate.by_orbits import looked_at
from vibeam.runs.estimate.error import estimate_error
from vibeam.runs.estimate.of_case import full_model
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate, estimate_texts
from vibeam.runs.estimate.work import CountedWork
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import StatesAfter
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

ROOT = Path(__file__).parents[3]
COUNT = np.arange(1, 9)
EIGHT = ImpactSystem.from_modes(
    1.0 * COUNT**2, 0.02, [1.0, 0.5, -0.4, 0.3, 0.25, -0.2, 0.15, 0.1], 1.0 / COUNT**2, gap=0.1, restitution=0.6,
    outputs={"sensor": 0.8 / COUNT},
)  # fmt: skip
SPREAD = np.cos(np.add.outer(COUNT, COUNT))
COUPLED = np.diag(2 * 0.05 * COUNT**2) + 0.01 * (SPREAD + SPREAD.T)


def first_modes(full: ImpactSystem, n: int) -> ImpactSystem:
    rows: dict[str, Any] = {name: getattr(full, name)[:n] for name in ("omega", "zeta", "contact", "load", "static")}
    coupling = None if full.coupling is None else full.coupling[:n, :n]
    return replace(full, outputs={"sensor": full.outputs["sensor"][:n]}, coupling=coupling, **rows)


def settled(system: ImpactSystem, omega: float, base: float) -> tuple[FrequencyResponse, StatesAfter]:
    found, state = exact_solver(system, omega).steady([omega], base, None, 1200, 16, "sensor")
    return found, StatesAfter(state.displacement[None], state.velocity[None])


SYSTEMS = {
    "linear stop": replace(EIGHT, law=LinearStop(200.0, 1.0)),
    "Hertz": replace(EIGHT, law=HuntCrossley(400.0)),
    "Hunt–Crossley": replace(EIGHT, law=HuntCrossley(400.0, damping=1.0)),
    "both sides": replace(EIGHT, second_gap=0.12, restitution=0.2, zeta=np.full(8, 0.1)),
    "rests on the stop": replace(EIGHT, gap=-0.05, restitution=0.3),
    "linear stops on both sides": replace(EIGHT, law=LinearStop(200.0, 1.0), second_gap=0.1),
    "coupled damping": replace(EIGHT, coupling=COUPLED),
}


DRIVES = [
    ("linear stop", 1.7, 0.1), ("linear stop", 2.3, 0.2), ("Hertz", 1.7, 0.1), ("Hertz", 0.8, 0.15),
    ("Hunt–Crossley", 2.3, 0.2), ("Hunt–Crossley", 0.8, 0.15), ("both sides", 0.9, 0.2),
    ("rests on the stop", 1.2, 0.05), ("rests on the stop", 2.0, 0.05),
    ("linear stops on both sides", 0.9, 0.1), ("linear stops on both sides", 1.3, 0.3), ("coupled damping", 1.7, 0.1),
]  # fmt: skip


@pytest.mark.parametrize(("name", "omega", "base"), DRIVES)
def test_the_error_is_that_of_flights_of_both_models(name: str, omega: float, base: float) -> None:
    full = SYSTEMS[name]
    small = first_modes(full, 3)
    response, after = settled(small, omega, base)
    found = estimate_error(response, small, full, base, "sensor", after)
    true, _ = settled(full, omega, base)
    assert found.known[0]
    assert abs(found.amplitude[0]) > 1e-4
    for quantity in QUANTITIES:
        off = getattr(response, quantity)[0] / getattr(true, quantity)[0] - 1
        assert getattr(found, quantity)[0] == pytest.approx(off, abs=1e-9)  # 1200 periods leave less
        assert getattr(found, f"{quantity}_bound")[0] >= abs(off)


def test_a_motion_that_is_not_known_says_why() -> None:
    full = SYSTEMS["Hertz"]
    far = replace(full, gap=9.0)
    free, after = settled(first_modes(far, 3), 1.7, 0.1)
    touching = estimate_error(free, first_modes(far, 3), full, 0.1, "sensor", after)
    assert Basis.of_code(int(touching.basis[0])) is Basis.TOUCHES
    clear = estimate_error(free, first_modes(far, 3), far, 0.1, "sensor", after)
    true, _ = settled(far, 1.7, 0.1)
    assert Basis.of_code(int(clear.basis[0])) is Basis.FREE
    assert clear.amplitude == pytest.approx(free.amplitude / true.amplitude - 1, abs=1e-9)
    struck, _ = settled(first_modes(full, 3), 1.7, 0.1)
    without = estimate_error(struck, first_modes(full, 3), full, 0.1, "sensor")  # no states after the points
    assert Basis.of_code(int(without.basis[0])) is Basis.UNSETTLED


CASES = {
    "linear stop": ("[stop]", '[stop]\nlaw = "linear"\nstiffness = "1e5 N/m"\ndamping = "10 N s/m"'),
    "drift": ("[sensor]", 'drift_frequency = ["14 Hz", "17 Hz"]\ndrift = ["0 mm", "0.01 mm"]\n\n[sensor]'),
    "platform": (
        "[sweep]",
        '[platform]\nmass = "5 kg"\nfrequency = "3.25 Hz"\ndamping_ratio = 0.05\ncalibrated_at = "15.5 Hz"\n'
        'coupling = "two-way"\n\n[sweep]',
    ),
    "wear": ("[sensor]", 'wear = "1e-9 mm"\n\n[sensor]'),
}
SHORT = {
    "sweep.frequency": ["14.5 Hz", "15 Hz", "15.5 Hz"], "sweep.settle": 400, "sweep.hold": 10, "beam.elements": 12,
    "sweep.direction": "up",
}  # fmt: skip


def case_with(name: str, folder: Path) -> vibeam.Case:
    at, text = CASES[name]
    lines = (ROOT / "cases" / "dtu_neutral.toml").read_text("utf-8").split("[reference.exact]")[0].replace(at, text, 1)
    if "linear" in text:
        lines = "\n".join(line for line in lines.splitlines() if not line.startswith("restitution"))
    (folder / "it.toml").write_text(lines, "utf-8")
    return vibeam.load(folder / "it.toml", set=SHORT)


@pytest.mark.parametrize("name", ["linear stop", "drift", "platform"])
def test_the_errors_of_a_case_are_those_of_sweeps(name: str, tmp_path: Path) -> None:
    case = case_with(name, tmp_path)
    result = vibeam.run(case, show=False, compare=True)
    full, omega = full_model(case.scene), 2 * np.pi * case.sweep.frequency
    drift = gap_drift(case.scene, omega)
    parts = [
        vibeam.sweep(
            replace(full, gap=full.gap + (0.0 if drift is None else float(drift[k]))), omega=omega[k : k + 1],
            amplitude=case.amplitude(omega[k : k + 1]), settle=800, hold=10, output="sensor",
        )
        for k in range(len(omega))
    ]  # fmt: skip
    for each, branches in result.items():
        found = result.estimates[each].branches["up"]
        assert found.known.all()
        off = branches.up.amplitude / np.array([part.amplitude[0] for part in parts]) - 1
        assert found.amplitude == pytest.approx(off, abs=1e-6)
    assert estimate_texts(result.estimates).cells["sdof"].endswith("%")


def test_a_gap_that_wears_is_refused_for_that(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="each impact widens the gap"):
        full_model(case_with("wear", tmp_path).scene)


def test_orbits_are_found_at_points_evenly_spread_and_around_the_peak() -> None:
    omega = np.linspace(0.5, 1.5, 101)
    free = vibeam.sweep(replace(first_modes(EIGHT, 1), gap=90.0), omega=omega, amplitude=0.1, settle=300, hold=2)
    chosen = np.flatnonzero(looked_at(free))
    top = int(np.argmax(free.amplitude))
    assert {0, top - 1, top, top + 1, 100} <= set(chosen.tolist())
    assert 13 <= len(chosen) <= 16
    assert looked_at(vibeam.sweep(EIGHT, omega=omega[::20], amplitude=1e-9, settle=2, hold=2)).all()


def test_orbits_are_found_until_their_work_is_done_the_peak_first() -> None:
    full = SYSTEMS["linear stop"]
    small, omega = first_modes(full, 3), np.linspace(1.5, 1.9, 9)
    solver, states, parts = exact_solver(small, omega[0]), [], []
    for each in omega.tolist():
        response, state = solver.steady([each], 0.1, None, 1200, 16, "sensor")
        parts.append(response)
        states.append((state.displacement, state.velocity))
    swept, after = join(parts), StatesAfter(*(np.array(rows) for rows in zip(*states, strict=True)))

    def estimated(most: float) -> tuple[ErrorEstimate, CountedWork]:
        work = CountedWork(most)
        return estimate_error(swept, small, full, 0.1, "sensor", after, work=work), work

    whole, work = estimated(float("inf"))
    assert whole.known.sum() >= 5
    part, spent = estimated(work.spent / 2)
    again, same = estimated(work.spent / 2)
    assert spent.spent == same.spent <= 0.6 * work.spent  # counted: no clock has a say
    assert part.basis.tolist() == again.basis.tolist()
    assert part.basis[int(np.argmax(swept.amplitude))] == whole.basis[int(np.argmax(swept.amplitude))]
    assert 0 < part.known.sum() < whole.known.sum()
    assert part.amplitude[part.known].tolist() == whole.amplitude[part.known].tolist()
    dear, _ = estimated(2e4)
    assert not dear.known.any()
    assert {Basis.of_code(int(code)) for code in dear.basis} <= {Basis.DEAR, Basis.LEFT_OUT}
