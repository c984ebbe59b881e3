"""Cases of a free beam: a pulse sends it into a stop, against an integration; what every study says of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app

LENGTH, WIDTH, HEIGHT, MODULUS, DENSITY = 0.3, 0.02, 0.002, 210e9, 7850.0
MASS = DENSITY * WIDTH * HEIGHT * LENGTH
PLACE, GAP, FORCE, PULSE, END = 0.24, 1e-3, 10.0, 2e-3, 0.3

BEAM = """
[beam]
length = "300 mm"
width = "20 mm"
thickness = "2 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0
ends = "free-free"

[stop]
position = "240 mm"
gap = "1 mm"
restitution = 1
{stop}
[sensor]
position = "300 mm"

[fidelity.one]
reduction = "modal"
modes = 1

[fidelity.three]
reduction = "modal"
modes = 3
"""

RECORD = """
[drive]
shape = "half_sine"
force = "10 N"
at = "240 mm"
duration = "2 ms"

[record]
duration = "300 ms"
"""

SWEEP = """
[drive]
force = "1 N"
at = "100 mm"

[sweep]
frequency = ["20 Hz", "30 Hz"]
settle = 30
hold = 10
"""

THROWN = BEAM.format(stop="") + RECORD
BETWEEN = BEAM.format(stop='second_gap = "1 mm"\n') + RECORD
SWEPT = BEAM.format(stop='second_gap = "1 mm"\n') + SWEEP


def closed_modes() -> tuple[np.ndarray, np.ndarray]:
    """ω of translation, rotation and the first bending mode of a free beam, and their values at the stop."""
    root = 4.730040744862704
    share = (np.cosh(root) - np.cos(root)) / (np.sinh(root) - np.sin(root))
    x = root * PLACE / LENGTH
    bent = np.cosh(x) + np.cos(x) - share * (np.sinh(x) + np.sin(x))
    omega = root**2 * np.sqrt(MODULUS * WIDTH * HEIGHT**3 / 12 / (DENSITY * WIDTH * HEIGHT * LENGTH**4))
    turn = (PLACE - LENGTH / 2) / np.sqrt(LENGTH**2 / 12)
    return np.array([0.0, 0.0, omega]), np.array([1.0, turn, bent]) / np.sqrt(MASS)


def integrated(walls: tuple[float, ...]) -> tuple[list[float], list[float]]:
    """Instants and speeds of the impacts by scipy's events, R = 1 at each wall ±gap."""
    omega, w = closed_modes()
    state, time, instants, speeds = np.zeros(6), 0.0, list[float](), list[float]()

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        force = FORCE * np.sin(np.pi * t / PULSE) if t < PULSE else 0.0
        return np.concatenate([y[3:], -(omega**2) * y[:3] + w * force])

    events = []
    for wall in walls:

        def reached(t: float, y: np.ndarray, wall: float = wall) -> float:
            return float(np.sign(wall) * (wall - w @ y[:3]))

        reached.terminal, reached.direction = True, -1.0  # type: ignore[attr-defined]
        events.append(reached)
    for _ in range(100):
        stop = PULSE if time < PULSE else END
        found = solve_ivp(rates, (time, stop), state, "DOP853", events=events, rtol=1e-11, atol=1e-14, max_step=5e-4)
        time, state = float(found.t[-1]), found.y[:, -1]
        if found.status == 1:
            speed = float(w @ state[3:])
            instants.append(time)
            speeds.append(abs(speed))
            state[3:] -= 2 * speed * w / (w @ w)
        elif stop == END:
            break
    return instants, speeds


@pytest.mark.parametrize(("text", "walls"), [(THROWN, (GAP,)), (BETWEEN, (GAP, -GAP))])
def test_a_pulse_sends_a_free_beam_into_the_stop_as_integrated(text: str, walls: tuple[float, ...]) -> None:
    case = parse(text)
    path = vibeam.simulate(case.system("three"), case.input("three"), END)
    instants, speeds = integrated(walls)
    count = min(len(instants), 4)  # impacts with bending amplify the difference of the two discretisations
    assert (len(path.impact_times) > 1) == (len(instants) > 1)
    assert path.impact_times[:count] == pytest.approx(instants[:count], rel=1e-4)
    assert np.abs(path.impact_velocities[:count]) == pytest.approx(speeds[:count], rel=1e-3)


def test_a_rigid_bar_keeps_its_energy_and_the_impulse_at_the_stop() -> None:
    """Mode 1 alone is the rigid bar at the stop: it is thrown at J/m_eff and comes back as fast, with R = 1."""
    case = parse(THROWN)
    system = case.system("one")
    path = vibeam.simulate(system, case.input("one"), END)
    mobility = (1 + 12 * (PLACE / LENGTH - 0.5) ** 2) / MASS
    speed = FORCE * PULSE * 2 / np.pi * mobility
    assert float(system.contact @ system.contact) == pytest.approx(mobility, rel=1e-9)
    assert path.impact_velocities.tolist() == pytest.approx([speed], rel=1e-9)
    late = path.at(np.array([0.1, 0.3]), "contact")
    assert (late[1] - late[0]) / 0.2 == pytest.approx(-speed, rel=1e-9)


def test_momentum_changes_by_what_the_stop_gives() -> None:
    """Three modes, R = 1: the rigid-body mode that the stop moves turns about by 2 v₋ c₁/S, energy stays."""
    case = parse(THROWN)
    system = case.system("three")
    path = vibeam.simulate(system, case.input("three"), END)
    assert len(path.impact_times) == 1
    before, after = path.modes_at(float(path.impact_times[0]) + np.array([-1e-9, 1e-9]))[:, 1]
    impulse = -2 * float(path.impact_velocities[0]) / float(system.contact @ system.contact)
    assert after - before == pytest.approx(system.contact * impulse, abs=1e-5 * float(np.abs(before).max()))
    assert (before @ before) == pytest.approx(after @ after, rel=1e-4)  # so near to the impact it bends alike
    late = path.modes_at(np.array([0.1, 0.3]))[:, 1]
    assert late[:, :2] == pytest.approx(np.array([after[:2], after[:2]]), rel=1e-9)  # free flight of both


def told(*arguments: str) -> str:
    """What a command prints, which ends well."""
    found = CliRunner().invoke(app, list(arguments), env={"COLUMNS": "160"})
    assert found.exit_code == 0, found.output
    return found.output


@pytest.fixture
def file(tmp_path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A case of a free beam in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "free.toml").write_text(SWEPT, "utf-8")
    return "free.toml"


def test_the_table_of_modes_names_the_rigid_body_modes(file: str) -> None:
    rows = [line.split() for line in told("modes", file, "--count", "4").splitlines() if line.strip()[:1].isdigit()]
    assert [row[1:4] for row in rows[:2]] == [["0", "rigid", "body"]] * 2
    assert float(rows[2][1]) == pytest.approx(118.15, abs=0.02)


def test_derive_says_that_there_is_no_static_deflection_and_what_the_impact_moves(file: str) -> None:
    table = vibeam.derive(file)
    assert len(table) == 0
    assert table.notes[0].startswith("left out: all rows of eq. 43–47: the beam can move as a rigid body")
    assert vibeam.mode_share(file).shares[0].mass == pytest.approx(
        MASS / (1 + 12 * (PLACE / LENGTH - 0.5) ** 2), rel=1e-9
    )
    assert "the beam is free" in told("derive", file)


def test_a_run_names_what_is_free_and_its_first_elastic_mode(file: str) -> None:
    said = " ".join(told("run", file).split())
    assert "a free body, 2 rigid-body modes at 0 Hz; mode 3 at 118.1 Hz (ζ 0 %)" in said
    assert "look at the units" not in said
    far = ["stop.second_gap=100 m", "stop.gap=50 m", "beam.damping_ratio=0.01"]  # undamped, 70 modes ring for ever
    pushed = " ".join(told("run", file, *(f"--set={each}" for each in far), "-o", "b.h5").split())
    assert "no impact at any frequency: nothing brings a free body back to its stop" in pushed


def test_what_has_no_meaning_is_refused_with_its_cure() -> None:
    with pytest.raises(vibeam.CaseError, match=r"gap_at = .sensor.: no static deflection"):
        vibeam.run(parse(SWEPT, set={"stop.gap_at": "sensor", "stop.second_gap": "1 mm"}))
    with pytest.raises(vibeam.CaseError, match=r"the body is free: .* hold it, or write reduction = .modal."):
        vibeam.run(parse(SWEPT.replace('"modal"\nmodes = 1', '"static_mode"')))
    decay = parse(SWEPT + '[show.decay]\nkind = "decay"\nstart = "1 mm"\n')
    assert "a free body has no static deflection" in vibeam.run(decay).shown["decay"][0].fault
