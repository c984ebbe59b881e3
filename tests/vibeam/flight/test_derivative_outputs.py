"""Velocities and accelerations as outputs: closed forms, and the motion itself at many times."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam import TimeDerivative
from vibeam_models.laws.compliant import Hertz, LinearStop

ROW = np.array([0.8, -0.5, 0.3])
OUTPUTS = {"v": TimeDerivative(ROW, 1), "a": TimeDerivative(ROW, 2), "absolute": TimeDerivative(ROW, 2, 1.0)}
OMEGA, AMPLITUDE = 95.0, 1e-4


def three_modes(**more: object) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [97.0, 500.0, 1400.0], [0.1, 0.05, 0.05], [1.0, 0.6, -0.4], [1.0, 0.3, 0.2], outputs={"s": ROW},
        derivatives=OUTPUTS, **more,
    )  # fmt: skip


def swept(system: vibeam.ImpactSystem, output: str, **more: object) -> vibeam.FrequencyResponse:
    asked = {"omega": [OMEGA], "amplitude": AMPLITUDE, "settle": 400, "hold": 8} | more
    return vibeam.sweep(system, output=output, **asked)


def test_a_harmonic_response_is_multiplied_by_the_frequency():
    system = three_modes(gap=1.0)
    x = swept(system, "s").amplitude[0]
    assert swept(system, "v").amplitude[0] == pytest.approx(OMEGA * x, rel=1e-9)
    assert swept(system, "a").amplitude[0] == pytest.approx(OMEGA**2 * x, rel=1e-9)
    omega, zeta, load = system.omega, system.zeta, system.load
    whole = np.sum(ROW * load * OMEGA**2 / (omega**2 - OMEGA**2 + 2j * zeta * omega * OMEGA))
    expected = OMEGA**2 * AMPLITUDE * abs(whole + 1)  # the base's own −Ω²B sin Ωt beside −Ω² X
    assert swept(system, "absolute").amplitude[0] == pytest.approx(expected, rel=1e-9)


def ball(**more: object) -> vibeam.ImpactSystem:
    """A mass of 1 kg that 2 N press toward the stop."""
    derivatives = {"v": TimeDerivative([1.0], 1), "a": TimeDerivative([1.0], 2)}
    return vibeam.ImpactSystem.from_modes([0.0], 0.0, [1.0], [1.0], static=2.0, derivatives=derivatives, **more)


THROWN = vibeam.State(np.zeros(1), np.array([-0.3]))


def test_a_bouncing_ball_has_the_velocities_of_its_impacts_and_one_acceleration():
    asked = {"state": THROWN, "amplitude": 0.0, "settle": 0, "hold": 5}
    speed = swept(ball(restitution=1.0), "v", **asked)
    assert [speed.minimum[0], speed.maximum[0]] == pytest.approx([-0.3, 0.3], rel=1e-12)
    pull = swept(ball(restitution=1.0), "a", **asked)
    assert [pull.minimum[0], pull.maximum[0]] == pytest.approx([2.0, 2.0], rel=1e-12)


def test_a_stop_that_yields_adds_its_force_to_the_acceleration():
    """½v² = ½kd² − gd at the deepest: a = g − kd = −√(g² + kv²)."""
    system = ball(law=LinearStop(50.0))
    asked = {"state": THROWN, "amplitude": 0.0, "settle": 0, "hold": 40}
    pull = swept(system, "a", **asked)
    assert [pull.minimum[0], pull.maximum[0]] == pytest.approx([-np.sqrt(2.0**2 + 50 * 0.3**2), 2.0], rel=1e-10)
    path = vibeam.simulate(system, vibeam.Drive(OMEGA, 0.0), 1.0, THROWN)
    begin, duration, force = path.contacts[0]
    assert float(path.at(begin + duration / 2, "a")) == pytest.approx(2.0 - force, rel=1e-10)


def test_hertz_contact_at_its_deepest_and_its_sweep_refused():
    """½v² = (2/5) k d^(5/2) without gravity: a = −k d^(3/2)."""
    stiff = 1e4
    system = vibeam.ImpactSystem.from_modes(
        [0.0], 0.0, [1.0], [1.0], law=Hertz(stiff), derivatives={"a": TimeDerivative([1.0], 2)}
    )
    start = vibeam.State(np.array([-1e-3]), np.array([0.3]))
    path = vibeam.simulate(system, vibeam.Drive(OMEGA, 0.0), 0.2, start)
    begin, duration, _ = path.contacts[0]
    deepest = (1.25 * 0.3**2 / stiff) ** 0.4
    assert float(path.at(begin + duration / 2, "a")) == pytest.approx(-stiff * deepest**1.5, rel=1e-6)
    with pytest.raises(ValueError, match="acceleration in a contact that is integrated is not read, 'hertz'"):
        swept(system, "a", settle=1, hold=1)


def test_at_rest_on_the_stop_the_contact_has_the_acceleration_of_the_base():
    derivatives = {"own": TimeDerivative([1.0], 2), "absolute": TimeDerivative([1.0], 2, 1.0)}
    system = vibeam.ImpactSystem.from_modes([50.0], 0.02, [1.0], [1.0], gap=-1e-2, restitution=0.3,
                                            derivatives=derivatives)  # fmt: skip
    asked = {"settle": 5, "hold": 2}
    assert swept(system, "own", **asked).rest[0] == 1.0
    assert abs(swept(system, "own", **asked).amplitude[0]) < 1e-14 * OMEGA**2
    found = swept(system, "absolute", **asked).amplitude[0]
    assert found == pytest.approx(OMEGA**2 * AMPLITUDE, rel=1e-9)


RIGS = {
    "impacts": {"gap": 5e-5, "restitution": 0.7},
    "rest": {"gap": -2e-5, "restitution": 0.3},
    "linear stop": {"gap": 5e-5, "law": LinearStop(2e5, 20.0)},
    "two stops": {"gap": 5e-5, "second_gap": 8e-5, "restitution": 0.6},
}


@pytest.mark.parametrize("output", OUTPUTS)
@pytest.mark.parametrize("rig", RIGS)
def test_extremes_are_those_of_the_motion(rig, output):
    """Against a central difference of the displacement and its rate, away from events, and no sample beyond them."""
    system = three_modes(**RIGS[rig])
    found = swept(system, output)
    drive, period = vibeam.Drive(OMEGA, AMPLITUDE), 2 * np.pi / OMEGA
    path = vibeam.simulate(system, drive, 408 * period)
    times = np.linspace(400 * period, 408 * period, 8_001)[1:-1]
    step = 1e-7
    rates = (path.at(times + step, "s") - path.at(times - step, "s")) / (2 * step)
    if OUTPUTS[output].order == 2:
        rates = (path.velocity_at(times + step, "s") - path.velocity_at(times - step, "s")) / (2 * step)
        rates -= OUTPUTS[output].base * OMEGA**2 * AMPLITUDE * np.sin(OMEGA * times)
    segments = path.segments.trace[:, 0]
    clear = np.abs(times[:, None] - segments[segments > 400 * period - 1]).min(axis=1) > 2 * step
    values = path.at(times, output)
    size = found.amplitude[0]
    assert np.max(np.abs(values - rates)[clear]) < 1e-4 * size
    assert found.minimum[0] - 1e-9 * size <= values.min() <= found.minimum[0] + 0.02 * size
    assert found.maximum[0] - 0.02 * size <= values.max() <= found.maximum[0] + 1e-9 * size


def test_who_does_not_ask_keeps_its_numbers_to_the_bit_and_its_engine():
    plain = vibeam.ImpactSystem.from_modes(
        [97.0, 500.0], 0.05, [1.0, 0.6], [1.0, 0.3], gap=5e-5, restitution=0.7, outputs={"s": [0.8, -0.5]}
    )
    with_speed = vibeam.ImpactSystem.from_modes(
        [97.0, 500.0], 0.05, [1.0, 0.6], [1.0, 0.3], gap=5e-5, restitution=0.7, outputs={"s": [0.8, -0.5]},
        derivatives={"v": TimeDerivative([0.8, -0.5], 1)},
    )  # fmt: skip
    assert plain.derivatives == {}
    assert not with_speed.beyond_plain
    one, other = (swept(each, "s") for each in (plain, with_speed))
    assert one.maximum.tobytes() == other.maximum.tobytes()
    assert one.mode_energy.tobytes() == other.mode_energy.tobytes()
    assert plain.moves_as(with_speed)


def test_closed_form_orbits_are_read_too():
    derivatives = {"v": TimeDerivative([0.8, 0.3], 1), "a": TimeDerivative([0.8, 0.3], 2, 1.0)}
    system = vibeam.ImpactSystem.from_modes(
        [47.7, 635.0], 0.05, [1.0, 0.4], [1.0, 0.2], restitution=0.7, derivatives=derivatives
    )
    for output in derivatives:
        flown, formula = swept(system, output, settle=600), swept(system, output, solver="orbit")
        assert formula.maximum[0] == pytest.approx(flown.maximum[0], rel=1e-7)
        assert formula.minimum[0] == pytest.approx(flown.minimum[0], rel=1e-7)


@pytest.mark.parametrize("solver", ["averaging", "direct", "moreau"])
def test_solvers_of_displacements_alone_say_so(solver):
    with pytest.raises(ValueError, match=f"output 'v': solver '{solver}' reads no velocity: flight and orbit do"):
        swept(three_modes(gap=5e-5), "v", solver=solver)


def test_rates_of_outputs_and_unknown_names():
    path = vibeam.simulate(three_modes(gap=5e-5), vibeam.Drive(OMEGA, AMPLITUDE), 1.0)
    t = np.linspace(0.11, 0.9, 7)
    assert path.velocity_at(t, "v") == pytest.approx(path.at(t, "a"), rel=1e-12)
    jerk = (path.at(t + 1e-7, "a") - path.at(t - 1e-7, "a")) / 2e-7
    assert path.velocity_at(t, "a") == pytest.approx(jerk, rel=1e-4)
    with pytest.raises(KeyError, match="no output 'w': there are a, absolute, contact, s, v"):
        path.at(0.5, "w")
    with pytest.raises(ValueError, match="output 'v' is no displacement"):
        path.system.output("v")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((ROW, 3), "order: 3 must be 1"),
        (([1.0, np.nan], 1), "row: must be finite"),
        ((ROW, 1, 1.0), "base: goes with an acceleration alone"),
    ],
)
def test_what_is_no_derivative(given, message):
    with pytest.raises(ValueError, match=message):
        TimeDerivative(*given)


@pytest.mark.parametrize(
    ("derivatives", "message"),
    [
        ({"v": ROW}, "must be a TimeDerivative whose row is 3 numbers"),
        ({"v": TimeDerivative([1.0], 1)}, "must be a TimeDerivative whose row is 3 numbers"),
        ({"s": OUTPUTS["v"]}, "is the name of another output"),
    ],
)
def test_what_a_system_does_not_take(derivatives, message):
    with pytest.raises(ValueError, match=message):
        vibeam.ImpactSystem.from_modes([1.0, 2.0, 3.0], 0.1, 1.0, 1.0, outputs={"s": ROW}, derivatives=derivatives)
