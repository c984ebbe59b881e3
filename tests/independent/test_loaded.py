"""The second program under a load, against closed forms, other programs and itself, before anything is judged by it."""

import json
from pathlib import Path

import mpmath
import numpy as np
import pytest
from bounded import Bound
from events import Drive as Sine
from events import Extremes, Modes, Motion, State, as_mpf
from loaded import Flight, Loaded, Stop
from make_loaded import flight, told
from mpmath import mpf
from scipy.integrate import solve_ivp
from yielding import Yielding, flown

ENTRIES = json.loads(Path(__file__).with_name("loaded.json").read_text(encoding="utf-8"))["entries"]
FAR = Stop([1], 1000, 1)


@pytest.fixture(autouse=True)
def _enough_digits():
    with mpmath.workdps(45):
        yield


def single(omega, zeta, stop, knots, pieces, static=0):
    return Loaded([omega], [[2 * mpf(zeta) * mpf(omega)]], [1], [static], [stop], knots, pieces)


def test_one_mode_under_a_cubic_in_closed_form():
    """x = e^{−ζωt}(…) + the polynomial that η'' + 2ζωη' + ω²η = u leaves, found from its highest power down."""
    w, z, a, end = mpf(3), mpf(1) / 5, [mpf(1), mpf(-2), mpf(5), mpf(-3)], mpf(2)
    p = [mpf(0)] * 6
    for k in (3, 2, 1, 0):
        p[k] = (a[k] - 2 * z * w * (k + 1) * p[k + 1] - (k + 2) * (k + 1) * p[k + 2]) / w**2
    wd = w * mpmath.sqrt(1 - z**2)
    c, s = -p[0], (-p[1] + z * w * -p[0]) / wd
    decay = mpmath.exp(-z * w * end)
    truth = decay * (c * mpmath.cos(wd * end) + s * mpmath.sin(wd * end)) + sum(p[k] * end**k for k in range(4))
    motion = Flight(single(w, z, FAR, [0, 2], [a]), [0], [0]).run(2)
    assert abs(as_mpf(motion.x[0]) - truth) < mpf(10) ** -38


@pytest.mark.parametrize("end", [1, 5])
def test_a_stretched_load_gives_the_same_motion_however_it_is_cut(end):
    """One cubic piece, and the same cubic in seven: impacts equal to the digits."""
    a, stop = [1, 8, -9, 2], Stop([1], "0.05", "0.8")
    knots = [mpf(k * end) / 7 for k in range(8)]
    shifted = [
        [sum(mpmath.binomial(m, j) * a[m] * k ** (m - j) for m in range(j, 4)) for j in range(4)] for k in knots[:-1]
    ]
    whole = Flight(single(6, "0.05", stop, [0, end], [a]), [0], [0]).run(end)
    parts = Flight(single(6, "0.05", stop, knots, shifted), [0], [0]).run(end)
    assert len(whole.events) == len(parts.events) > 0
    assert all(abs(a.time - b.time) < mpf(10) ** -28 for a, b in zip(whole.events, parts.events, strict=True))


def test_a_step_is_a_static_load_of_the_first_program():
    modes = Modes([1, "3.1"], ["0.05", "0.02"], [1, "0.5"], [0, 0], "0.4", "0.6", ["0.9", "0.3"])
    damper = [[mpf("0.1"), 0], [0, 2 * mpf("3.1") * mpf("0.02")]]
    system = Loaded(
        [1, "3.1"], damper, ["0.9", "0.3"], [0, 0], [Stop([1, "0.5"], "0.4", "0.6")], [0, 99], [[1, 0, 0, 0]]
    )
    one, two = Motion(modes, Sine(), State([0, 0], [0, 0])), Flight(system, [0, 0], [0, 0])
    one.run(t_end=40)
    two.run(40)
    assert [event.kind for event in one.events] == [event.kind for event in two.events]
    assert {"impact", "rest"} <= {event.kind for event in two.events}
    assert max(abs(a.time - b.time) for a, b in zip(one.events, two.events, strict=True)) < mpf(10) ** -30


@pytest.mark.parametrize("damping", [0.0, 3.0])
def test_linear_stops_as_the_program_of_stops_that_yield(damping):
    own = Yielding(
        [1.0, 4.0], [[0.1, 0.0], [0.0, 0.2]], [1.0, 0.5], [0.0] * 2, [0.9, 0.3], [0.4, 0.1], 90.0, damping=damping
    )
    state, touches = flown(own, (1.0, 0.0), [0.0] * 4, 0.0, 9.0)
    stops = [Stop([w * 1.0, w * 0.5], gap, None, 90.0, damping) for w, gap in ((1, 0.4), (-1, 0.1))]
    system = Loaded([1.0, 4.0], own.damper, own.static, [0.0] * 2, stops, [0, 20], [[1, 0, 0, 0]])
    motion = Flight(system, [0.0] * 2, [0.0] * 2).run(9.0)
    assert touches == sum(event.kind == "entry" for event in motion.events) > 2
    assert all(abs(as_mpf(a) - as_mpf(b)) < mpf(10) ** -28 for a, b in zip(motion.x + motion.v, state, strict=True))


def test_a_ramp_lifts_a_mass_off_its_stop_when_the_force_is_gone():
    """Pressed by 2 and pulled by t³: released at 2^{1/3}; then x'' = 2 − t³, until it is back."""
    motion = Flight(single(0, 0, Stop([1], 0, "0.5"), [0, 9], [[0, 0, 0, -1]], static=2), [0], [0], held=0)
    motion.run(4)
    begin = mpmath.cbrt(2)
    assert [event.kind for event in motion.events] == ["release"]
    assert abs(motion.events[0].time - begin) < mpf(10) ** -38
    fallen = 2 * (4 - begin) ** 2 / 2 - (mpf(4) ** 5 - begin**5) / 20 + begin**4 / 4 * (4 - begin)
    assert abs(as_mpf(motion.x[0]) - fallen) < mpf(10) ** -37


def test_a_step_down_releases_at_its_knot():
    motion = Flight(single(1, 0, Stop([1], 0, "0.5"), [0, 1, 9], [[2, 0, 0, 0], [-1, 0, 0, 0]]), [0], [0], held=0).run(
        2
    )
    assert [(event.kind, event.time) for event in motion.events] == [("release", 1)]
    assert abs(as_mpf(motion.x[0]) - (mpmath.cos(1) - 1)) < mpf(10) ** -38


@pytest.mark.parametrize("entry", ENTRIES[3::17], ids=lambda entry: entry["kind"])
def test_energy_balances_with_the_work_of_the_load(entry):
    """Works as integrals of products of series, each to the last order of the series: 1e-20 of the largest."""
    motion = flight(entry)
    before = motion.energy()
    motion.run(entry["t_end"])
    work = {name: as_mpf(value) for name, value in motion.work.items()}
    left = motion.energy() - before - work["load"] - work["static"] + work["damping"] + work["stops"]
    assert abs(left) < mpf(10) ** -20 * max(abs(value) for value in work.values())


@pytest.mark.parametrize("entry", ENTRIES[4::19], ids=lambda entry: entry["kind"])
def test_the_stored_motions_belong_to_their_inputs(entry):
    """Flown again with fewer digits, as far as a change grows."""
    again = flight(entry, digits=32)
    again.trackers = [Extremes(entry["stops"][0]["row"])]
    again.run(entry["t_end"])
    bound = mpf(10) ** -21 * (1 + entry["growth"])
    assert [list(event[:2]) for event in told(again)] == [event[:2] for event in entry["events"]]
    off = [abs(a.time - mpf(b[2])) for a, b in zip(told(again), entry["events"], strict=True)]
    assert max(off) < bound * entry["t_end"]
    reach = [as_mpf(again.trackers[0].minimum), as_mpf(again.trackers[0].maximum)]
    assert all(
        abs(a - mpf(b)) < mpf(10) ** -14 * max(map(abs, reach)) for a, b in zip(reach, entry["extremes"], strict=True)
    )


def stored(kinds):
    """Motions on hard stops without an accumulation of impacts."""
    own = [entry for entry in ENTRIES if entry["kind"] in kinds]
    return [entry for entry in own if all(event[0] == "impact" for event in entry["events"])]


@pytest.mark.parametrize("entry", stored(("hard", "two hard", "coupled"))[::7], ids=lambda entry: entry["kind"])
def test_dop853_between_the_events_of_stored_motions(entry):
    """From impact to impact at 1e-12, piece by piece of the load, in units of the motion's own."""
    found = dop853(entry)
    assert len(found) == len(entry["events"])
    fastest = max(float(event[3]) for event in entry["events"])
    for (time, speed), event in zip(found, entry["events"], strict=True):
        assert time == pytest.approx(float(event[2]), abs=1e-11 * (1 + entry["growth"]) * entry["t_end"])
        assert speed == pytest.approx(float(event[3]), abs=1e-10 * (1 + entry["growth"]) * fastest)


def dop853(entry):
    """Impacts (time, speed) on hard stops by scipy, as the equation of motion says and nothing else."""
    n, unit = len(entry["omega"]), entry["t_end"]
    damper = np.diag(2 * np.multiply(entry["zeta"], entry["omega"]))
    if "coupling" in entry:
        damper = np.array([[entry["coupling"][max(i, k)][min(i, k)] for k in range(n)] for i in range(n)])
    length = max(abs(stop["gap"]) for stop in entry["stops"])
    knots, stiffness = np.array(entry["knots"]) / unit, (np.array(entry["omega"]) * unit) ** 2
    pieces = np.array(entry["pieces"]) * unit ** (2 + np.arange(4)) / length
    rows, gaps = np.array([s["row"] for s in entry["stops"]]), np.array([s["gap"] for s in entry["stops"]]) / length
    load, static, y, t, hits = (
        np.array(entry["load"]),
        np.array(entry["static"]) * unit**2 / length,
        np.zeros(2 * n),
        0.0,
        [],
    )
    within = Bound()
    while within(t < 1):
        i = int(np.searchsorted(knots, t, side="right")) - 1
        own, begin = (pieces[i], knots[i]) if i < len(pieces) else (np.zeros(4), t)
        limit = min(1.0, knots[i + 1]) if i < len(pieces) else 1.0

        def rate(s, y, own=own, begin=begin):
            u = np.polyval(own[::-1], s - begin)
            return np.concatenate([y[n:], load * u + static - unit * damper @ y[n:] - stiffness * y[:n]])

        watch = []
        for row, gap in zip(rows, gaps, strict=True):
            watch.append(lambda s, y, row=row, gap=gap: row @ y[:n] - gap)
            watch[-1].terminal, watch[-1].direction = True, 1
        longest = 0.05 / max(np.sqrt(stiffness.max()), 1.0)
        run = solve_ivp(rate, (t, limit), y, "DOP853", rtol=1e-12, atol=1e-14, events=watch, max_step=longest)
        t, y = (limit if run.status == 0 else run.t[-1]), run.y[:, -1].copy()
        for j in range(len(rows)):
            if run.status == 1 and len(run.t_events[j]):
                speed = rows[j] @ y[n:]
                hits.append((t * unit, speed * length / unit))
                y[n:] -= rows[j] * (1 + entry["stops"][j]["restitution"]) * speed / (rows[j] @ rows[j])
    return hits


def test_every_kind_of_event_and_of_load_is_among_the_stored_motions():
    assert len(ENTRIES) == 200
    kinds = {event[0] for entry in ENTRIES for event in entry["events"]}
    assert kinds == {"impact", "entry", "exit", "rest", "release"}
    assert {len(entry["omega"]) for entry in ENTRIES} == {1, 2, 3, 5}
    zeta = {value for entry in ENTRIES for value in entry["zeta"]}
    assert {0.0, 1.0, 1.7} <= zeta
    assert any(value == 0 for entry in ENTRIES for value in entry["omega"])
    assert any(entry["knots"][-1] < entry["t_end"] for entry in ENTRIES)
    jumps = [p for entry in ENTRIES for p in entry["pieces"] if p[1] == 0]
    assert len(jumps) > 100


def test_a_start_beyond_a_stop_is_refused():
    with pytest.raises(ArithmeticError, match="beyond"):
        Flight(single(1, 0, Stop([1], 1, 1), [0, 1], [[0, 0, 0, 0]]), [2], [0])
