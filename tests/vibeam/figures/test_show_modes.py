"""Figures of modes: participation, the modal table, ringing and apparent restitution, against the exact orbit."""

from __future__ import annotations

import numpy as np
import pytest
from figures import beam, sheet
from observed import settled

import vibeam
from vibeam.figures import RESTITUTIONS, SHARES
from vibeam.figures.sheet import sheet_at, sheets
from vibeam.report.figures import figure
from vibeam.runs.result import Result
from vibeam.studies.modes import mode_table

observe = vibeam.observe
CHAIN = {
    "measurement__sampling": "5 kHz", "measurement__low_pass": "bessel", "measurement__order": 4,
    "measurement__cut_off": "500 Hz",
}  # fmt: skip
ELLIPTIC = CHAIN | {"measurement__low_pass": "elliptic", "measurement__order": 6}
STEEL = {
    "stop__law": "hunt-crossley", "stop__hertz_stiffness": 2e10, "stop__restitution": 1.0, "stop__velocity": "1 m/s",
    "stop__restitution_of": "contact",
}  # fmt: skip
RING = {"near": "101 Hz", "periods": 4}


def test_participation_of_the_beam_is_that_of_its_orbit() -> None:
    found = sheet(beam("participation", frequency="15.5 Hz"), "beam", 15.5)
    path = settled("beam", 15.5, periods=4)[1]
    expected = observe.modal_participation(path, "sensor", periods=4)
    assert list(found["mode"]) == [1, 2, 3, 4, 5, 6, 7, 8]
    for share in SHARES:
        np.testing.assert_allclose(found[share], getattr(expected, share), rtol=1e-5)
        assert np.sum(found[share]) == pytest.approx(1.0)
    contact = path.system.contact
    np.testing.assert_allclose(found["impulse_share"], contact**2 / np.sum(contact**2), rtol=1e-12)


def test_the_modal_table_is_the_finite_element_models() -> None:
    case = beam("modal")
    found, table = sheet(case, "beam", None), mode_table(case.scene, 8)
    np.testing.assert_allclose(found["mode_frequency"], [row.frequency for row in table.rows], rtol=1e-9)
    np.testing.assert_allclose(found["mode_damping"], 0.017, rtol=1e-6)
    assert len(sheet(case, "two_modes", None)["mode"]) == 2


def test_the_modal_table_of_one_mode_on_a_platform() -> None:
    """ω² of [[1, a], [a, m]] and diag(ω₁², k), from the quadratic; a is the mode's load, m all that moves."""
    keys = {"mass": 5, "frequency": 3.25, "damping_ratio": 0.05, "coupling": "two-way", "calibrated_at": 15.5}
    case = beam("modal", **{f"platform__{key}": value for key, value in keys.items()})
    still = beam("modal").system("sdof")
    a, m = float(still.load[0]), 5 + case.scene.moving_mass
    k = 5 * (2 * np.pi * 3.25) ** 2
    roots = np.roots([m - a * a, -(m * still.omega[0] ** 2 + k), k * still.omega[0] ** 2])
    found = sheet(case, "sdof", None)["mode_frequency"]
    np.testing.assert_allclose(found, np.sort(np.sqrt(roots)) / (2 * np.pi), rtol=1e-9)


def test_ringing_is_mode_2_by_fit_and_not_by_counting() -> None:
    for keys in ({}, CHAIN):
        found = sheet(beam("ringing", **RING, **keys), "beam", 16.0)
        system = beam("ringing", **RING).system("beam")
        damped = system.omega[1] * np.sqrt(1 - system.zeta[1] ** 2) / (2 * np.pi)
        np.testing.assert_allclose(found["ringing_frequency"], damped, atol=0.02)
        np.testing.assert_allclose(found["ringing_decay"], system.zeta[1] * system.omega[1], rtol=5e-3)
        missed = np.abs(np.mean(found["ringing_frequency"]) - damped)
        assert np.abs(np.mean(found["counted_frequency"]) - damped) > 5 * missed + 0.05
    size = found["ringing_velocity"] / found["ringing_displacement"]
    np.testing.assert_allclose(size, system.omega[1], rtol=1e-3)


def test_the_fitted_size_is_mode_2s_at_the_sensor() -> None:
    """Free vibration of mode 2 after an impact of the exact orbit, less what the drive makes it do."""
    orbit, path = settled("beam", 14.5, periods=1.2)
    system, omega = path.system, path.drive.omega
    start = path.t_start + 2e-3
    held = path.drive.amplitude * omega**2 * system.load[1]
    forced = held / (system.omega[1] ** 2 - omega**2 + 2j * system.zeta[1] * system.omega[1] * omega)
    values = path.modes_at(start)[:, 1]
    steady = forced * np.exp(1j * omega * start)
    place, speed = values[0] - steady.imag, values[1] - (1j * omega * steady).imag
    decay = system.zeta[1] * system.omega[1]
    size = abs(complex(place, (speed + decay * place) / (system.omega[1] * np.sqrt(1 - system.zeta[1] ** 2))))
    expected = size * abs(system.output("sensor")[1]) * np.exp(decay * (start - path.t_start))
    found = sheet(beam("ringing", **RING), "beam", 14.5)
    lag = np.min(np.abs(np.mod(found["begin"] - orbit.time, 1 / 14.5)))
    np.testing.assert_allclose(found["first_displacement"], expected * np.exp(-decay * lag), rtol=0.02)


def test_peaks_are_counted_in_the_velocity_less_its_slow_part() -> None:
    """One steady motion: every interval reads the same, within a sample at either end of its five periods."""
    found = sheet(beam("ringing", **RING), "beam", 15.0)
    top, read = found["peak_time"], found["counted_frequency"]
    assert read[0] == pytest.approx((len(top) - 1) / (top[-1] - top[0]), rel=1e-12)
    assert found["counted_velocity"][0] == pytest.approx(np.mean(found["peak_velocity"]), rel=1e-12)
    assert found["counted_scatter"][0] == pytest.approx(np.std(read), rel=1e-12)
    assert np.ptp(read) < 1.0
    inside = np.isin(found["fast_time"], top)
    np.testing.assert_array_equal(found["fast_velocity"][inside], found["peak_velocity"])


def test_noise_scatters_what_is_counted_and_repeats_with_its_seed() -> None:
    noisy = CHAIN | {"measurement__noise": "0.5 µm", "measurement__seed": 1}
    one, again, quiet = (sheet(beam("ringing", **RING, **keys), "beam", 15.0) for keys in (noisy, noisy, CHAIN))
    np.testing.assert_array_equal(one["counted_frequency"], again["counted_frequency"])
    assert one["counted_scatter"][0] > 2 * quiet["counted_scatter"][0]
    assert np.abs(one["ringing_frequency"] - quiet["ringing_frequency"]).max() < 0.1


def test_one_mode_does_not_ring_and_says_so() -> None:
    case = beam("ringing", **RING)
    assert sheet_at(case, case.shows["it"], "sdof", 15.5, ()).fault == "no mode near 101 Hz that could ring"
    loose = beam("ringing", **RING, stop__gap="10 mm")
    assert sheet_at(loose, loose.shows["it"], "beam", 15.5, ()).fault == "no impacts: nothing rings between them"


def test_restitution_of_one_mode_is_read_right_in_every_way() -> None:
    found = sheet(beam("restitution"), "sdof", 15.3)
    for kind in RESTITUTIONS:
        assert len(found[kind]) == 12
        np.testing.assert_allclose(found[kind], 0.72, atol=5e-3 if kind.startswith(("adj", "extremum")) else 1e-6)


def test_no_restitution_is_read_of_a_stop_that_yields_and_the_panel_says_why() -> None:
    case = beam("restitution", frequency="15.3 Hz", **STEEL)
    plan = case.shows["it"]
    shown = sheets(case, plan)
    made = figure(Result(case, {}, shown={"it": shown}), plan)
    said = [text.get_text() for axes in made.axes for text in axes.texts]
    assert said == ["a stop that yields has no instant of impact to read restitution at"] * len(plan.fidelities)


def test_restitution_of_the_beam_is_the_first_modes_and_not_the_contacts() -> None:
    found = sheet(beam("restitution", **CHAIN), "beam", 15.3)
    path = settled("beam", 15.3, periods=4.4)[1]
    share = path.system.contact[0] ** 2 / np.sum(path.system.contact**2)
    np.testing.assert_allclose(found["true_restitution"], 1.72 / share - 1, rtol=1e-9)  # PHYSICS §3, of R₁ = 0.72
    np.testing.assert_allclose(found["first_mode_restitution"], observe.mode_restitution(path).mean, rtol=1e-5)
    np.testing.assert_allclose(found["extrapolated_restitution"], found["first_mode_restitution"], atol=0.01)


def test_a_stop_that_yields_has_no_restitution_to_read() -> None:
    case = beam("restitution", periods=2, stop__law="linear", stop__stiffness=1e8, stop__restitution_of="contact")
    assert sheet_at(case, case.shows["it"], "sdof", 15.3, ()).fault.startswith("a stop that yields")


def test_one_impact_of_the_beam_is_newtons() -> None:
    """R₁ = (1+R) c₁²/S − 1 at any velocity: 0.602474 for eight modes, as in tests/vibeam/observe."""
    found = sheet(beam("impact", velocity=["20 mm/s", "0.1 m/s"], stop__restitution_of="contact"), "beam", None)
    assert list(found["velocity"]) == [0.02, 0.1]
    np.testing.assert_allclose(found["first_mode_restitution"], 0.602474, atol=1e-6)
    np.testing.assert_allclose(found["true_restitution"], 0.72, rtol=1e-9)
    assert not found["contact_time"].any()


def test_a_yielding_stop_takes_less_from_the_first_mode_than_newtons_law() -> None:
    """The higher modes follow a contact that lasts: with its own R, Newton's law would leave mode 1 less."""
    case = beam("impact", velocity="50 mm/s", **STEEL)
    found = sheet(case, "beam", None)
    contact = case.system("beam").contact
    newton = (1 + found["true_restitution"][0]) * contact[0] ** 2 / np.sum(contact**2) - 1
    assert 0.02 < found["first_mode_restitution"][0] - newton < 0.05
    assert found["contact_periods"][0] == pytest.approx(found["contact_time"][0] * 4148.2, rel=1e-3)


def test_a_sharp_filter_overshoots() -> None:
    """PHYSICS §4: R + 0.2(1 + R) by an elliptic low-pass; a Bessel filter is unbiased."""
    reads = [
        sheet(beam("restitution", **each), "sdof", 15.3)["extremum_restitution"].mean() for each in (CHAIN, ELLIPTIC)
    ]
    assert reads[0] == pytest.approx(0.72, abs=0.015)
    assert reads[1] == pytest.approx(0.72 + 0.2 * 1.72, abs=0.04)


def test_a_two_way_platform_changes_no_reading_of_the_contact() -> None:
    keys = {"mass": 50, "frequency": 3.25, "damping_ratio": 0.05, "coupling": "two-way", "calibrated_at": 15.3}
    case = beam("restitution", periods=4, **{f"platform__{key}": value for key, value in keys.items()})
    found = sheet(case, "sdof", 15.3)
    np.testing.assert_allclose(found["true_restitution"], 0.72, rtol=1e-9)
    np.testing.assert_allclose(found["extremum_restitution"], 0.72, atol=0.01)


def test_an_impact_jolts_the_platform_by_its_impulse() -> None:
    keys = {"mass": 5, "frequency": 3.25, "damping_ratio": 0.05, "coupling": "two-way", "calibrated_at": 15.3}
    own = {f"platform__{key}": value for key, value in keys.items()}
    case = beam("history", frequency="15.3 Hz", periods=3, output="platform", **own)
    found, still = sheet(case, "sdof", 15.3), beam("modal").system("sdof")
    a, m, c = float(still.load[0]), 5 + case.scene.moving_mass, float(still.contact[0])
    inverse = np.linalg.inv([[1, a], [a, m]])  # relative coordinate η and base b
    impulse = -1.72 * found["impact_velocity"] / (c * c * inverse[0, 0])
    np.testing.assert_allclose(found["jump"], inverse[1, 0] * c * impulse, rtol=1e-6)
    assert sheet_at(beam("history", frequency="15.3 Hz", output="contact"), beam("history", frequency="15.3 Hz",
        output="contact").shows["it"], "sdof", 15.3, ())["jump"][0] < 0  # fmt: skip


def test_a_gap_that_drifts_counts_in_figures_too() -> None:
    drift = {"stop__drift_frequency": ["15 Hz", "16 Hz"], "stop__drift": ["0 mm", "0.1 mm"], "stop__gap_at": "contact"}
    found = sheet(beam("history", frequency="15.5 Hz", output="contact", **drift), "sdof", 15.5)
    assert np.max(found["displacement"]) == pytest.approx(0.05e-3, abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("participation", {"frequency": "15.5 Hz"}),
        ("modal", {}),
        ("ringing", RING),
        ("ringing", RING | {"frequency": "15.3 Hz"}),
        ("restitution", {"periods": 4}),
        ("impact", STEEL | {"velocity": ["20 mm/s", "0.1 m/s"]}),
    ],
)
def test_the_figures_are_drawn(kind: str, keys: dict[str, object]) -> None:
    case = beam(kind, **keys, sweep__frequency=["15.3 Hz", "15.5 Hz"])
    plan = case.shows["it"]
    made = figure(Result(case, {}, shown={"it": sheets(case, plan)}), plan)
    assert all(axes.lines or axes.patches or axes.tables for axes in made.axes)
