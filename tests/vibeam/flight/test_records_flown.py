"""Motions under a record: against the sine in closed form, against closed forms, and piece by piece against itself."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from apart import run_apart

import vibeam
from vibeam.flight.engine import threads
from vibeam.flight.kernels import layout
from vibeam.system.rows import Contact
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

OMEGA, AMPLITUDE, RATE = 95.0, 1e-4, 1e4
PLAIN = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], gap=2e-5, restitution=0.72
)
SYSTEMS = {
    "hard": PLAIN,
    "rest": replace(PLAIN, gap=0.0),
    "pressed": replace(PLAIN, gap=0.0, restitution=0.3, static=np.array([0.02, 0.01])),
    "both sides": replace(PLAIN, second_gap=3e-5),
    "several": replace(PLAIN, further=(Contact(np.array([1.0, -0.5]), 1e-5, 0.5),)),
    "linear": replace(PLAIN, law=LinearStop(1e5)),
    "linear, damped": replace(PLAIN, law=LinearStop(1e5, 20.0)),
    "coupled": replace(PLAIN, coupling=np.array([[1.6, 3.0], [3.0, 21.6]])),
    "Hertz": replace(PLAIN, law=Hertz(1e8)),
    "Hunt-Crossley": replace(PLAIN, law=HuntCrossley(1e6)),
}


def sampled_sine(rate: float, end: float) -> vibeam.Record:
    """The sine's own base acceleration, by cubics through samples."""
    times = np.arange(round(end * rate) + 1) / rate
    acceleration = -(OMEGA**2) * AMPLITUDE * np.sin(OMEGA * times)
    return vibeam.Record.sampled(acceleration, rate=rate, interpolation="cubic")


@pytest.mark.parametrize("name", SYSTEMS)
def test_samples_of_a_sine_move_a_system_as_the_sine_does(name: str) -> None:
    """Cubics through 660 samples a period are off by 1e-12 of the sine: so is the motion, before chaos enlarges it."""
    system, end = SYSTEMS[name], 0.1
    true = vibeam.simulate(system, vibeam.Drive(OMEGA, AMPLITUDE), end)
    path = vibeam.simulate(system, sampled_sine(RATE, end), end)
    times = np.linspace(0.0, end, 101)
    size = np.abs(true.at(times)).max()
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) == len(true.impact_times)
    np.testing.assert_allclose(path.impact_times, true.impact_times, rtol=0, atol=1e-10 * end)
    np.testing.assert_allclose(path.at(times), true.at(times), rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(path.rests, true.rests, rtol=0, atol=1e-9 * end)
    np.testing.assert_allclose(path.contacts, true.contacts, rtol=1e-8, atol=1e-10)


def test_linear_interpolation_converges_at_its_order() -> None:
    """Straight lines between samples are off by h²: half the spacing leaves a quarter of the error."""
    true = vibeam.simulate(PLAIN, vibeam.Drive(OMEGA, AMPLITUDE), 0.05).impact_times[0]
    times = np.arange(401) / 4000
    acceleration = -(OMEGA**2) * AMPLITUDE * np.sin(OMEGA * times)
    coarse, fine = (
        vibeam.simulate(
            PLAIN, vibeam.Record.sampled(acceleration[::each], rate=4000 / each, interpolation="linear"), 0.05
        ).impact_times[0]
        for each in (2, 1)
    )
    assert 3.5 < (coarse - true) / (fine - true) < 4.5


def test_a_free_body_under_a_step_follows_a_parabola() -> None:
    """u = a: x = at²/2, which meets the stop at √(2g/a); then R v up and down again, 2Rv/a later."""
    body = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=1e-3, restitution=0.5)
    push = 20.0
    path = vibeam.simulate(body, vibeam.Record.step(-push, 0.04), 0.04)
    first, speed = np.sqrt(2 * 1e-3 / push), np.sqrt(2 * 1e-3 * push)
    expected = first + 2 * speed / push * np.cumsum([0.0, *0.5 ** np.arange(1, len(path.impact_times))])
    np.testing.assert_allclose(path.impact_times, expected, rtol=1e-13)
    np.testing.assert_allclose(path.impact_velocities, speed * 0.5 ** np.arange(len(expected)), rtol=1e-9)
    assert path.state.resting
    assert len(path.chatters) == 1


@pytest.mark.parametrize(("rate", "zeta"), [(1e-3, 0.0), (1.0, 0.7), (1e3, 30.0), (1e5, 0.5), (1e7, 1.0)])
def test_slow_stiff_and_overdamped_modes_follow_a_ramp(rate: float, zeta: float) -> None:
    """u = ct from rest: x = c [t − 2ζ/ω + …]/ω² in closed form, evaluated in 60 digits."""
    mpmath = pytest.importorskip("mpmath")
    system = vibeam.ImpactSystem.from_modes(rate, zeta, 1.0, 1.0, gap=1.0)
    path = vibeam.simulate(system, vibeam.Record([0.0, 0.3, 1.0], [[0.0, -2.0, 0, 0], [-0.6, -2.0, 0, 0]]), 1.0)
    with mpmath.workdps(60):
        w, z = mpmath.mpf(rate), mpmath.mpf(zeta) + (mpmath.mpf("1e-25") if zeta == 1 else 0)
        root = mpmath.sqrt(z * z - 1)
        a, b = -w * (z - root), -w * (z + root)
        for t in (0.1, 0.3, 0.77, 1.0):
            free = (b * b * mpmath.exp(a * t) - a * a * mpmath.exp(b * t)) / (a - b)
            true = 2 * (mpmath.mpf(t) / (a * b) + (a + b + free) / (a * b) ** 2)
            assert path.at(t) == pytest.approx(float(mpmath.re(true)), rel=2e-12)


def test_what_is_not_looked_at_is_not_approximated() -> None:
    """Windows passed by an energy bound and panels looked at one by one lead to the same state."""
    record = vibeam.Record.random(1e-3, 0.5, seed=1, rate=2e4, band=(10.0, 2000.0))
    far = vibeam.simulate(replace(PLAIN, gap=1.0), record, 0.5)
    peak = vibeam.extremes(far, ("contact",)).greatest[0, 0]
    near = vibeam.simulate(replace(PLAIN, gap=peak * (1 + 1e-9)), record, 0.5)
    assert far.stats["evaluations"] < near.stats["evaluations"] < len(record.coefficients)
    assert not len(near.impact_times)
    np.testing.assert_allclose(far.state.displacement, near.state.displacement, rtol=0, atol=1e-13 * peak)


def test_a_jump_of_the_load_lets_a_held_contact_go() -> None:
    """Pressed on its stop, the reaction gone at the knot itself: the body leaves with the new acceleration."""
    body = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=0.0, restitution=0.0)
    record = vibeam.Record([0.0, 0.1, 0.2], [[-1.0, 0, 0, 0], [3.0, 0, 0, 0]])
    path = vibeam.simulate(body, record, 0.2)
    np.testing.assert_allclose(path.rests, [[0.0, 0.1]], atol=1e-15)
    assert path.at(0.15) == pytest.approx(-0.5 * 3.0 * 0.05**2, rel=1e-12)


def test_a_certificate_covers_every_segment_without_a_gap() -> None:
    """Every signal's intervals follow one another from a segment's begin to its end."""
    record = vibeam.Record.random(1e-2, 0.3, seed=3, rate=2e4, band=(10.0, 2000.0))
    path = vibeam.simulate(replace(PLAIN, second_gap=3e-5), record, 0.3, certify=True)
    certificate = path.certificate
    assert certificate is not None
    assert certificate.complete
    assert len(path.impact_times) > 20
    pieces = certificate.pieces
    assert (pieces[:, layout.CLAIM] == layout.CLOSES).sum() == len(path.impact_times)
    for segment in range(len(certificate.times)):
        own = pieces[pieces[:, layout.PIECE_SEGMENT] == segment]
        for signal in np.unique(own[:, layout.PIECE_SIGNAL]):
            one = own[own[:, layout.PIECE_SIGNAL] == signal]
            ends = one[:, layout.BEGIN] + one[:, layout.LENGTH]
            np.testing.assert_allclose(one[1:, layout.BEGIN], ends[:-1], rtol=1e-12)
            assert one[0, layout.BEGIN] == 0.0
            assert ends[-1] == pytest.approx(certificate.durations[segment], rel=1e-12)


def test_extremes_are_those_of_dense_samples_and_a_little_more() -> None:
    """In every bin the extremes enclose 2 000 samples, by next to nothing, and are values of the motion."""
    outputs = {
        "speed": vibeam.TimeDerivative(PLAIN.contact, 1), "felt": vibeam.TimeDerivative(PLAIN.contact, 2, base=1.0),
    }  # fmt: skip
    system = replace(PLAIN, derivatives=outputs)
    path = vibeam.simulate(system, vibeam.Record.half_sine(30.0, 0.011), 0.08)
    found = vibeam.extremes(path, ("contact", "speed", "felt"), np.linspace(0.0, 0.08, 6))
    for i, name in enumerate(found.outputs):
        for j in range(5):
            times = np.linspace(found.edges[j], found.edges[j + 1], 2001)
            values = path.at(times, name)
            spread = np.ptp(values)
            assert found.greatest[i, j] >= values.max() - 1e-12 * spread
            assert found.least[i, j] <= values.min() + 1e-12 * spread
            assert path.at(found.greatest_time[i, j], name) == pytest.approx(found.greatest[i, j], abs=1e-3 * spread)


def test_bins_see_no_more_than_their_time() -> None:
    """Bins that begin later, end earlier or lie beyond the motion."""
    path = vibeam.simulate(PLAIN, vibeam.Record.half_sine(30.0, 0.011), 0.08)
    found = vibeam.extremes(path, ("contact",), [0.02, 0.03, 0.1, 0.2])
    for j, times in enumerate((np.linspace(0.02, 0.03, 2001), np.linspace(0.03, 0.08, 2001))):
        values = path.at(times)
        assert found.least[0, j] == pytest.approx(values.min(), abs=1e-3 * np.ptp(values))
        assert found.greatest[0, j] == pytest.approx(values.max(), abs=1e-3 * np.ptp(values))
    assert np.isnan([found.least[0, 2], found.greatest[0, 2]]).all()


def test_records_side_by_side_move_as_one_by_one() -> None:
    """To the bit, in threads of their own; the motions can be read off afterwards, in any order."""
    records = [vibeam.Record.random(1e-2, 0.1, seed=seed, rate=1e4, band=(10.0, 1000.0)) for seed in range(4)]
    paths = vibeam.simulate_records(PLAIN, records, 0.1, workers=2)
    for path, record in zip(paths, records, strict=True):
        alone = vibeam.simulate(PLAIN, record, 0.1)
        np.testing.assert_array_equal(path.impact_times, alone.impact_times)
        np.testing.assert_array_equal(path.at([0.03, 0.08]), alone.at([0.03, 0.08]))


def test_what_is_no_load_is_refused() -> None:
    """One sentence each."""
    with pytest.raises(ValueError, match="must be a Drive or a Record, not float"):
        vibeam.simulate(PLAIN, 3.0, 1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="4 of them, but 1 records"):
        vibeam.simulate_records(PLAIN, [vibeam.Record.half_sine(1.0, 0.01)], 0.1, [None] * 4)


@pytest.mark.parametrize("name", ["rest", "linear", "Hertz"])
@pytest.mark.parametrize("peak", [30.0, -30.0])
def test_a_contact_that_touches_is_judged_where_the_load_begins(name: str, peak: float) -> None:
    """At rest on its stop without force, and 20 ms of quiet before the pulse: the motion is the same, 20 ms later."""
    system, pulse = replace(SYSTEMS[name], gap=0.0), vibeam.Record.half_sine(peak, 0.011)
    at_once, later = vibeam.simulate(system, pulse, 0.06), vibeam.simulate(system, pulse.shifted(0.02), 0.08)
    times = np.linspace(0.0, 0.06, 61)
    size = np.abs(at_once.at(times)).max()
    assert len(at_once.impact_times) == len(later.impact_times)
    np.testing.assert_allclose(later.at(times + 0.02), at_once.at(times), rtol=0, atol=1e-12 * size)


def test_a_release_from_a_rest_is_no_impact() -> None:
    """What a held contact's velocity has of round-off after many pieces is taken out: no impact at 1e-17 m/s."""
    rng = np.random.default_rng(200)
    system = vibeam.ImpactSystem.from_modes(
        [20.0, 90.0, 310.0, 800.0], 0.02, contact=[0.7, -1.1, 0.4, 0.9], load=[1.0, 0.6, -0.8, 0.3], gap=0.02,
        restitution=0.0, static=[8.0, 3.0, -2.0, 1.0],
    )  # fmt: skip
    record = vibeam.Record.sampled(rng.normal(size=1001) * 30.0, rate=400.0, interpolation="linear")
    path = vibeam.simulate(system, record, 2.5)
    assert len(path.rests) > 20
    assert path.impact_velocities.min() > 1e-9 * path.impact_velocities.max()


def test_a_push_by_a_first_jump_of_the_load_is_proved_from_its_start() -> None:
    """A linear stop that is touched, in modes that it couples: the force starts with its second derivative."""
    system = vibeam.ImpactSystem.from_modes(
        [18.706, 31.5417], 0.01, contact=[0.9, -0.4], load=[1.3, 0.2], law=LinearStop(1200.0)
    )
    record = vibeam.Record([0.0, 0.01, 0.02], [[-1.0, 0, 0, 0], [0.5, 0, 0, 0]])
    path = vibeam.simulate(system, record, 0.02, certify=True)
    assert path.certificate is not None
    assert path.certificate.complete
    assert path.contacts[0, 2] > 0


@pytest.mark.parametrize("name", ["hard", "both sides", "several"])
def test_accumulations_under_a_record_are_bounded(name: str) -> None:
    """What each still takes lies between its bounds, which are as near as the doubt in its last velocity lets them."""
    record = vibeam.Record.random(1.0, 3.0, seed=5, rate=2e3, band=(1.0, 8.0))
    path = vibeam.simulate(replace(SYSTEMS[name], restitution=0.4), record, 3.0, certify=True)
    assert path.certificate is not None
    tails = path.certificate.tails
    bounded = tails[np.isfinite(tails[:, 2])]
    left = path.segments.trace[bounded[:, 0].astype(int), layout.LEFT]
    assert len(bounded) == len(tails) >= 8
    assert np.all(bounded[:, 2] - bounded[:, 1] <= 1e-3 * left)
    assert np.all((bounded[:, 1] <= left) & (left <= bounded[:, 2]))


CLOSING = """
from dataclasses import replace
import numpy as np
import vibeam

case = vibeam.load({case!r}, set={{"record.duration": "{end} ms", "stop.damping": "{damping} N s/m", **{more!r}}})
system, record, end = case.system({name!r}), case.input({name!r}), {end} * 1e-3
path = vibeam.simulate(system, record, end)
for bins in (1, 7, 2000):
    print(vibeam.extremes(path, ("sensor",), np.linspace(0.0, end, bins + 1)).peak.tolist())
row = system.output("sensor")
read = {{"speed": vibeam.TimeDerivative(row, 1), "felt": vibeam.TimeDerivative(row, 2)}}
path = vibeam.simulate(replace(system, derivatives=read), record, end)
found = vibeam.extremes(path, ("speed", "felt"), np.linspace(0.0, end, 2001))
print([*found.peak.tolist(), float(np.ptp([found.least[0, -1], found.greatest[0, -1]]))])
"""
RELAY = """
title = "a relay closes, and stays closed"
[beam]
length = "20 mm"
width = "3 mm"
thickness = "0.15 mm"
youngs_modulus = "125 GPa"
density = "8800 kg/m^3"
damping_ratio = 0.01
[stop]
gap = "0.3 mm"
position = "20 mm"
law = "linear"
stiffness = "2e5 N/m"
damping = "1 N s/m"
[sensor]
position = "20 mm"
[drive]
shape = "step"
force = "0.3 N"
at = "14 mm"
[record]
duration = "30 ms"
[fidelity.one]
reduction = "static_mode"
[fidelity.six]
reduction = "modal"
modes = 6
"""


@pytest.mark.parametrize(
    ("name", "damping", "end", "more"),
    [
        ("one", 1.0, 30.0, {}),
        ("one", 1.0, 2.0, {}),
        ("one", 3.0, 100.0, {}),
        ("one", 1.0, 30.0, {"drive.force": "1 N"}),
        ("one", 1.0, 30.0, {"stop.stiffness": "2e6 N/m"}),
        ("six", 1.0, 30.0, {}),
    ],
)
def test_extremes_at_rest_are_read_off(
    name: str, damping: float, end: float, more: dict[str, str], tmp_path: Path
) -> None:
    """A contact that closes and stays closed: what moves at the end is round-off, of which signs say nothing."""
    case = tmp_path / "relay.toml"
    case.write_text(RELAY)
    given = {"case": str(case), "name": name, "damping": damping, "end": end, "more": more}
    lines = [ast.literal_eval(line) for line in run_apart(CLOSING.format(**given)).splitlines()]
    for other in lines[1:3]:
        np.testing.assert_allclose(other, lines[0], rtol=1e-11)
    assert lines[3][0] > 1.0  # m/s
    assert lines[3][2] < 1e-3 * lines[3][0]


def test_extremes_are_the_same_wherever_they_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    """10⁵ pieces of a random load take several calls; a bin for each second joins to the whole."""
    pauses = []
    monkeypatch.setattr(threads, "pause", lambda: pauses.append(1))
    record = vibeam.Record.random(1e-2, 10.0, seed=3, rate=1e4, band=(10.0, 1000.0))
    path = vibeam.simulate(PLAIN, record, 10.0)
    pauses.clear()
    found = vibeam.extremes(path, ("contact",) * 20)
    assert len(pauses) > 1
    each = vibeam.extremes(path, ("contact",), np.linspace(0.0, 10.0, 11))
    assert found.greatest[0, 0] == pytest.approx(each.greatest.max(), rel=1e-14)
    assert found.least[0, 0] == pytest.approx(each.least.min(), rel=1e-14)
