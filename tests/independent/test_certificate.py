"""Certificates are checked by a program of its own, and what is wrong in one is found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from ball_signal import Signal
from check_certificate import check
from flint import acb, arb
from prove_certificates import CASES, entries, stored, stretch, sweeps
from proved_table import PAGE, written
from random_rigs import KINDS, rig

import vibeam
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.proof.certificate import CLOSES, OPEN, _without_slivers, certificate_of
from vibeam_models.laws.compliant import LinearStop

ONE = vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=0.0, restitution=0.9)
THREE = vibeam.ImpactSystem.from_modes(
    [1.0, 2.6, 17.1], [0.02, 1.0, 3.0], [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.3, restitution=0.7
)
STIFF = vibeam.ImpactSystem.from_modes(
    [1.0, 9.0, 800.0], [0.01, 0.02, 0.05], [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.1, restitution=0.5
)
BALL = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 0.0, gap=0.0, restitution=0.9, static=9.81)
RESONANT = vibeam.ImpactSystem.from_modes([1.0, 2.0], 0.0, [1.0, 0.5], [1.0, 0.2], gap=0.4, restitution=0.8)
PRESSED = vibeam.ImpactSystem.from_modes([1.0, 2.7], 0.05, [1.0, 0.5], 1.0, gap=-0.05, restitution=0.5)
MOTIONS = {
    "one mode": (ONE, vibeam.Drive(2.0, 0.5e-3), 60.0),
    "chaos": (ONE, vibeam.Drive(2.9, 1.0), 60.0),
    "three modes, damped in three ways": (THREE, vibeam.Drive(1.9, 1.0), 40.0),
    "a stiff mode": (STIFF, vibeam.Drive(1.9, 1.0), 15.0),
    "undamped resonance": (RESONANT, vibeam.Drive(1.0, 0.1), 40.0),
    "rests and releases": (PRESSED, vibeam.Drive(1.7, 0.08), 30.0),
}


def certified(system: vibeam.ImpactSystem, drive: vibeam.Drive, end: float, start: vibeam.State | None = None):
    path = vibeam.simulate(system, drive, end, start, certify=True)
    assert path.certificate is not None
    assert path.certificate.complete
    return path


@pytest.mark.parametrize("name", MOTIONS)
def test_every_claim_is_proved(name: str) -> None:
    path = certified(*MOTIONS[name])
    faults, proved = check(path.certificate)
    assert faults == []
    assert proved >= len(path.impact_times) >= 5


def test_a_falling_ball_chatters_and_every_bounce_is_proved() -> None:
    path = certified(BALL, vibeam.Drive(0.0, 0.0), 5.0, vibeam.State(np.array([-1.0]), np.array([0.0])))
    faults, _ = check(path.certificate)
    assert faults == []


def test_grazing_is_proved_too() -> None:
    """An undamped swing that comes within 1e-9 of the scale of the stop, and one that touches it at 1e-5."""
    system = vibeam.ImpactSystem.from_modes(1.0, 0.0, 1.0, 0.0, gap=1.0, restitution=0.5)
    for amplitude, touches in ((1 - 1e-9, 0), (1 + 1e-10, 1)):
        path = certified(system, vibeam.Drive(0.0, 0.0), 5.0, vibeam.State(np.array([-amplitude]), np.array([0.0])))
        assert len(path.impact_times) == touches
        faults, _ = check(path.certificate, slack=1e-9)
        assert faults == []


def test_a_sliver_at_the_end_of_a_flight_is_one_with_the_piece_before() -> None:
    """The root on a panel's end: before it or behind it, by the last digit."""
    good = certified(ONE, vibeam.Drive(2.0, 0.5e-3), 30.0).certificate
    durations, rows = good.durations, []
    for row in good.pieces:
        end, ulp = row[1] + row[2], np.spacing(durations[int(row[0])])
        closes = row[3] == CLOSES and row[1] > 0
        rows += [[row[0], row[1], row[2] - ulp, OPEN, row[4]], [row[0], end - ulp, ulp, *row[3:]]] if closes else [row]
    split = np.array(rows)
    assert len(split) > len(good.pieces) + 5
    np.testing.assert_array_equal(_without_slivers(split, durations), good.pieces)
    np.testing.assert_array_equal(_without_slivers(good.pieces.copy(), durations), good.pieces)


def test_bounds_of_a_signal_hold_and_none_is_given_where_a_part_grows() -> None:
    decaying = Signal(2, 0, 0, [(acb(0.4, 0.3), acb(-0.1, 2.0)), (acb(-0.7), acb(-3)), (acb(0, 0.5), acb(0, 1.3))])
    for low in (0.0, 0.7, 5.0):
        least = decaying.least(arb(low))
        values = [decaying.derivative(0, arb(low + step)) for step in np.linspace(0.0, 9.0, 400)]
        assert all(value > least for value in values)
        assert min(float(value.mid()) for value in values) < float(least.mid()) + 0.8
    for grows in (
        Signal(2, 1),
        Signal(2, 0, 1),
        Signal(2, 0, 0, [], [(acb(1), acb(-1))]),
        Signal(2, 0, 0, [(acb(1), acb(1))]),
    ):
        assert grows.least(arb(0)) is None
    ramped = Signal(0.3, 0.2, 0.1, decaying.waves, [(acb(0.2, 0.1), acb(-0.3, 1.1))])
    found = ramped.derivatives(1, 4, arb(0.8), arb(0))
    assert all(each.overlaps(ramped.derivative(1 + j, arb(0.8))) for j, each in enumerate(found))


def test_a_missed_impact_is_found() -> None:
    """The certificate of a system without stop, given out for the one with it."""
    far = certified(replace(ONE, gap=1e3), vibeam.Drive(2.0, 0.5e-3), 30.0)
    faults, _ = check(replace(far.certificate, system=ONE))
    assert any("not proved" in fault or "does not" in fault for fault in faults)


def test_an_invented_impact_a_hole_and_a_changed_start_are_found() -> None:
    path = certified(ONE, vibeam.Drive(2.0, 0.5e-3), 30.0)
    good = path.certificate
    moved = good.pieces.copy()
    last = np.flatnonzero(moved[:, 3] == 1.0)[3]
    flight = int(moved[last, 0])
    moved[last, 2] *= 0.9
    shorter = good.durations.copy()
    shorter[flight] = moved[last, 1] + moved[last, 2]
    assert any("close" in f for f in check(replace(good, pieces=moved, durations=shorter))[0])
    hole = np.delete(good.pieces, 2, axis=0)
    assert any("hole" in f or "no piece" in f or "reach" in f for f in check(replace(good, pieces=hole))[0])
    wild = certified(THREE, vibeam.Drive(1.9, 1.0), 20.0).certificate
    assert check(replace(wild, starts=wild.starts * (1 + 1e-6)))[0] != []


QUICK, SLOW = [(kind, 0) for kind in KINDS], [(kind, seed) for kind in KINDS for seed in range(4, 12)]


@pytest.mark.parametrize(("kind", "seed"), QUICK + [pytest.param(*each, marks=pytest.mark.slow) for each in SLOW])
def test_all_of_a_random_motion_is_proved(kind: str, seed: int) -> None:
    """Every piece, every join and every tail; all that is named as not proved is contact that is integrated."""
    path = vibeam.simulate(*rig(kind, seed, 12 if seed else 5), max_impacts=1000, certify=True)
    certificate = path.certificate
    assert certificate is not None
    faults, proved = check(certificate)
    assert faults == []
    assert proved == len(certificate.pieces) > 0
    assert len(path.impact_times) > 0 or seed  # a few of the others never reach a stop
    integrated = len(path.contacts) if kind in ("hertz", "hunt-crossley") else 0
    assert certificate.complete == (integrated == 0)
    assert all("is integrated" in stretch.reason for stretch in certificate.unproved)
    assert len(certificate.unproved) == integrated


GAPS = ("tight", "neutral", "loose")

ON_STOPS = {"dtu_tight": 1, "experiment/fig18a": 1, "experiment/fig28": 3, "experiment/table1": 1}


@pytest.mark.parametrize("name", ON_STOPS)
def test_a_point_of_a_case_is_proved(name: str) -> None:
    """A gap that presses, a platform that couples the modes, R of the velocity: ``prove_certificates`` in small."""
    for own in list(sweeps(vibeam.load(CASES / f"{name}.toml")))[: ON_STOPS[name]]:
        place, path = next(replace(own, branches=[own.branches[0][-1:]], settle=40, hold=10).motions())
        part = stretch(path.certificate, 0.9 * path.t_end, np.inf)
        assert path.certificate.complete
        assert 5 <= len(part.kinds) < len(path.certificate.kinds) / 5
        assert check(part)[0] == [], place


def test_a_stretch_is_what_the_whole_says_of_it() -> None:
    """Cut in two it is all proved, and a hole in the second half shows there alone."""
    whole = certified(THREE, vibeam.Drive(1.9, 1.0), 20.0).certificate
    broken = replace(whole, pieces=whole.pieces[:-1])
    middle = float(whole.times[len(whole.times) // 2])
    (first, last), halves = [(0.0, middle), (middle, np.inf)], []
    for cut in (first, last):
        faults, proved = check(stretch(whole, *cut))
        halves.append(proved)
        assert faults == []
        assert bool(check(stretch(broken, *cut))[0]) == (cut == last)
    assert sum(halves) == len(whole.pieces)


@pytest.mark.parametrize("share", [0.8, 0.96, 1.06, 1.16])
def test_a_flight_that_ends_where_a_panel_ends_is_proved(share: float) -> None:
    """At 8 Hz a period is eight panels, and a flight lasts a period, give or take its last digits."""
    own = list(sweeps(vibeam.load(CASES / "dtu_loose.toml")))[-1]
    omega = 2 * np.pi * 8.0
    path = certified(own.system, vibeam.Drive(omega, share * float(own.amplitude(np.array([omega]))[0])), 44.0)
    last = path.certificate.durations[-60:-1]
    assert np.all(np.abs(last - 0.125) < 1e-15)
    assert check(stretch(path.certificate, 36.5, np.inf))[0] == []


def test_the_report_has_no_fault() -> None:
    held, laws = stored(), [name for name in entries() if not name.startswith("cases/")]
    assert [name for name in [*laws, *(f"cases/dtu_{gap}.toml" for gap in GAPS)] if name not in held] == []
    for name, found in held.items():
        assert found["faults"] == [], name
        assert found["pieces_proved"] == found["pieces_checked"], name
        assert found["motions"] > 0, name
        assert all("is integrated" in reason for reason in found["unproved"]), name


def test_the_page_says_what_the_report_holds() -> None:
    page, held = PAGE.read_text(encoding="utf-8"), stored()
    assert written(page, held) == page
    assert sum(found["pieces_proved"] for found in held.values()) > 400_000
    del held["cases/dtu_neutral.toml"]
    assert written(page, held) != page


@pytest.mark.slow
def test_the_report_holds_every_case_of_the_rig() -> None:
    """Else: python tests/independent/prove_certificates.py."""
    assert [name for name in entries() if ("dtu_" in name or "experiment/" in name) and name not in stored()] == []


TAMPERED = [
    "one stop",
    "two stops",
    "coupled damping",
    "pressed, plastic",
    "linear stop, damped, two, coupled",
    "table",
]


@pytest.mark.parametrize("kind", TAMPERED)
@pytest.mark.parametrize("how", ["an impact removed", "two flights made one", "a root moved"])
def test_a_tampered_motion_is_found(kind: str, how: str) -> None:
    """The certificate is made of the tampered motion, so that only the proofs can tell."""
    system, drive, end = rig(kind, 0, 5)
    path = vibeam.simulate(system, drive, end)
    trace, poses = path.segments.trace.copy(), path.segments.poses
    which = int(np.flatnonzero(trace[:-1, layout.DURATION] > 1e-3 * end)[1])
    if how == "a root moved":
        moved = 1e-6 * trace[which, layout.DURATION]
        trace[which, layout.DURATION] += moved
        trace[which + 1 :, layout.START] += moved
    elif how == "two flights made one":
        trace[which, layout.DURATION] += trace[which + 1, layout.DURATION]
    if how != "a root moved":
        trace, poses = np.delete(trace, which + 1, axis=0), np.delete(poses, which + 1, axis=0)
    made = certificate_of(path._solver, drive, Segments(trace, poses, path.segments.size))
    found, _ = check(made)
    assert any(text.startswith(f"segment {which}:") for text in found)


def test_contact_that_is_integrated_is_named_with_its_time() -> None:
    path = vibeam.simulate(*rig("hertz", 0, 5), certify=True)
    named = np.array([(stretch.begin, stretch.end) for stretch in path.certificate.unproved])
    np.testing.assert_allclose(named[:, 0], path.contacts[:, 0], rtol=1e-14)
    np.testing.assert_allclose(named[:, 1] - named[:, 0], path.contacts[:, 1], rtol=1e-9)


def test_a_stop_that_is_just_touched_is_named() -> None:
    """Held at the stop by nothing: no bound can tell a force of 0 from none."""
    still = vibeam.ImpactSystem.from_modes(1.0, 0.02, 1.0, 1.0, gap=0.0, law=LinearStop(50.0))
    path = vibeam.simulate(still, vibeam.Drive(1.0, 0.0), 5.0, certify=True)
    assert not path.certificate.complete
    assert all("touches a stop" in stretch.reason for stretch in path.certificate.unproved)


def test_a_retreat_within_round_off_of_the_stop_is_named() -> None:
    """From rest at gap 0 a damped stop lets go for 5e-18 s, as some processors round: its sign is unknown."""
    stop = LinearStop(6627.917059554478, 327.36159570311116)
    system = vibeam.ImpactSystem.from_modes(2.82703262, 0.073824, 0.85037794, 1.0, gap=0.0, law=stop)
    drive, retreat = vibeam.Drive(40.003445984762756, 2e-5), 5.43763436e-18
    path = vibeam.simulate(system, drive, 0.3)
    first = int(np.argmax(path.segments.trace[:, layout.DURATION] > 0))
    trace, poses = path.segments.trace[first:], path.segments.poses[first:]
    assert trace[0, layout.WHAT] == regime_layout.CONTACT
    added = np.zeros((2, trace.shape[1]))
    added[0, [layout.WHAT, layout.END]], added[1, [layout.DURATION, layout.END]] = (
        (regime_layout.CONTACT, layout.RELEASE),
        (retreat, regime_layout.PASS),
    )
    later = trace.copy()
    later[:, [layout.START, layout.AT_CLOCK]] += retreat
    rows, starts = np.concatenate([added, later]), np.concatenate([np.zeros_like(poses[[0, 0]]), poses])
    made = certificate_of(path._solver, drive, Segments(rows, starts, path.segments.size))
    assert not [text for text in check(made)[0] if "not proved" in text]
    assert [(each.begin, each.end) for each in made.unproved] == [(0.0, retreat)]
    assert "touches a stop" in made.unproved[0].reason


def test_bounds_of_a_tail_hold_for_the_impacts_themselves() -> None:
    """A ball that falls: 2u/g(1 − R) is what is left, to the digit; and that is inside, with little room."""
    path = certified(replace(BALL, restitution=0.5), vibeam.Drive(0.0, 0.0), 5.0, vibeam.State([-1.0], [0.0]))
    ((_, least, most),) = path.certificate.tails
    exact = 2 * 0.5 * path.impact_velocities[-1] / (9.81 * 0.5)
    assert least <= exact <= most <= exact * (1 + 1e-6)
    assert check(path.certificate)[0] == []
    wrong = path.certificate.tails * [1, 1 + 1e-5, 1 + 1e-5]
    assert any("accumulation" in text for text in check(replace(path.certificate, tails=wrong))[0])


def test_without_asking_there_is_none() -> None:
    assert vibeam.simulate(ONE, vibeam.Drive(2.0, 0.5e-3), 3.0).certificate is None


@pytest.mark.parametrize("speed", [-0.5, -2.0])
def test_a_start_within_a_linear_stop_that_does_not_push_is_proved(speed: float) -> None:
    """It leaves faster than the stop follows: k d < c |d'|, so that there is no force whose root it could start at."""
    law = LinearStop(100.0, 8.0)
    system = vibeam.ImpactSystem.from_modes(1.0, 0.3, 1.0, 1.0, gap=-0.05, law=law)
    path = certified(system, vibeam.Drive(0.7, 0.1), 6.0, vibeam.State(np.array([-0.03]), np.array([speed])))
    assert law.stiffness * 0.02 + law.damping * speed < 0
    faults, proved = check(path.certificate)
    assert faults == []
    assert proved > 1
