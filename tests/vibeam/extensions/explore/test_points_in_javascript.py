"""Steady points and periodic motions that the page's engine flies, against those of Python."""

from dataclasses import replace

import numpy as np
import pytest
from javascript import ScriptError
from page_payload import page_payload

import vibeam
from vibeam.flight.points.points import PlainPoints, PointSettings, compute
from vibeam.flight.solver import FlightSolver, RegimeSolver
from vibeam.solvers.orbit import OrbitSolver
from vibeam.system.response import Ended
from vibeam_models.laws.compliant import LinearStop

RATES = 47.7 * np.array([1, 6.27, 17.55, 34.4, 56.8, 84.9, 118.6, 157.9])
AMPLITUDE = 1e-3
HZ = np.linspace(6.0, 21.0, 31)
OMEGA = 2 * np.pi * HZ
START = """const { open } = await load("extensions/explore/engine/engine.js");
const engine = await open(given.payload), cases = Object.entries(given.cases);
"""


def beam(modes, **given):
    contact, load = 2 * (-0.5) ** np.arange(modes), 0.5 / (1 + np.arange(modes))
    return vibeam.ImpactSystem.from_modes(RATES[:modes], contact=contact, load=load, **given)


SYSTEMS = {
    "one mode": beam(1, zeta=0.05, gap=1e-3, restitution=0.72),
    "two modes": beam(2, zeta=0.02, gap=3e-3, restitution=0.5),
    "pressed on the stop": beam(2, zeta=0.03, gap=-2e-4, restitution=0.3),
    "eight modes": beam(
        8, zeta=0.02, gap=2e-3, restitution=0.6, static=[1.0] * 8, outputs={"sensor": 0.8 ** np.arange(8)}
    ),
    "plastic": beam(2, zeta=0.02, gap=0.0, restitution=0.0),
    "undamped mode": beam(2, zeta=[0.0, 0.01], gap=1e-3, restitution=0.8),
    "falling ball": vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, static=9.81, restitution=0.6),
}


def output_of(system):
    return "sensor" if "sensor" in system.outputs else "contact"


def points(system, settle, hold, start=None, gap=None):
    """As a batch computes them."""
    one = np.ones(len(OMEGA))
    gaps = system.gap * one if gap is None else gap
    asked = PlainPoints([system], np.zeros(len(OMEGA), dtype=np.int64), OMEGA, AMPLITUDE * one, gaps,
                        system.restitution * one, *((start.states, start.resting) if start else ()))  # fmt: skip
    ((_, found),) = compute(asked, PointSettings(settle, hold, output_of(system), 0, False, 8))
    return found


def as_states(found):
    return [
        {"displacement": place, "velocity": velocity, "resting": bool(resting)}
        for (place, velocity), resting in zip(found.states, found.resting, strict=True)
    ]


def assert_same(there, wanted, least):
    """Counters equal and values within 1e-12 of the motion's size, or of the velocity, where a motion repeats."""
    known = np.flatnonzero(wanted.period != 0)
    assert len(known) >= least
    rows = {"period": "period", "impacts": "impacts", "rest": "rest"}
    rows |= {"amplitude": "amplitude", "maximum": "maximum", "minimum": "minimum", "reach": "reach"}
    rows |= {"impactsPerPeriod": "impacts_per_period", "impactVelocity": "impact_velocity"}
    for key, name in rows.items():
        ours, theirs = np.array(there[key])[known], getattr(wanted, name)[known]
        if key in ("period", "impacts", "impactsPerPeriod"):
            assert ours.tolist() == theirs.tolist(), key
        else:
            of = {"rest": 1.0, "maximum": wanted.amplitude, "minimum": wanted.amplitude}.get(key, theirs)
            size = np.nanmax(of, initial=0.0)
            np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * size, err_msg=key)


def test_points_of_settled_motions(node):
    """From the states of settled motions: no transient, in which round-off could choose another motion."""
    settled = {name: points(system, 300, 20) for name, system in SYSTEMS.items()}
    script = (
        START
        + """return Object.fromEntries(cases.map(([name, states]) => {
      const points = engine.response(name, {}, given.frequencies, { settle: 20, hold: 20, states });
      const again = engine.response(name, {}, given.frequencies, { settle: 20, hold: 20, states });
      return [name, [points, again]];
    }));"""
    )
    given = {"payload": page_payload(SYSTEMS, AMPLITUDE), "frequencies": HZ}
    there = node(script, given | {"cases": {name: as_states(found) for name, found in settled.items()}})
    for name, system in SYSTEMS.items():
        wanted = points(system, 20, 20, settled[name])
        first, again = there[name]
        assert_same(first, wanted.response, least=8)
        assert np.array_equal(first["amplitude"], again["amplitude"], equal_nan=True)
        assert [Ended(each).code for each in first["ended"]] == wanted.response.ended.tolist()
        repeats = wanted.response.period != 0
        states = np.array([[each["displacement"], each["velocity"]] for each in first["states"]])[repeats]
        assert states == pytest.approx(wanted.states[repeats], abs=1e-11 * np.abs(wanted.states).max())


def test_points_from_equilibrium_and_a_gap_of_each(node):
    """Regular transients; a gap that is another at each frequency, as one that drifts."""
    chosen = {name: SYSTEMS[name] for name in ("one mode", "eight modes")}
    script = (
        START
        + """const own = engine.settings.bind(engine), schedule = { settle: 100, hold: 10 };
    return cases.map(([name, gaps]) => {
      engine.settings = own;
      const alike = engine.response(name, {}, given.frequencies, schedule);
      engine.settings = (...asked) => ({ ...own(...asked), gap: gaps[given.frequencies.indexOf(asked[1].frequency)] });
      return [alike, engine.response(name, {}, given.frequencies, schedule)];
    });"""
    )
    gaps = {name: system.gap + 1e-5 * np.arange(len(HZ)) for name, system in chosen.items()}
    given = {"payload": page_payload(chosen, AMPLITUDE), "cases": gaps, "frequencies": HZ}
    for (name, system), there in zip(chosen.items(), node(script, given), strict=True):
        assert_same(there[0], points(system, 100, 10).response, least=15)
        assert_same(there[1], points(system, 100, 10, gap=gaps[name]).response, least=15)


def test_points_carried_from_one_to_the_next(node):
    """As a sweep carries its state; in pieces too, each from the state at the end of the last."""
    system = SYSTEMS["two modes"]
    script = (
        START
        + """const carried = { settle: 50, hold: 10, carried: true }, turned = [...given.frequencies].reverse();
    const both = [given.frequencies, turned].map((each) => engine.response("two modes", {}, each, carried));
    const first = engine.response("two modes", {}, given.frequencies.slice(0, 9), carried);
    const slowest = 2 * Math.PI * given.frequencies[0], states = first.states.slice(-1);
    const schedule = { ...carried, states, slowest };
    return [...both, first, engine.response("two modes", {}, given.frequencies.slice(9), schedule)];"""
    )
    payload = page_payload({"two modes": system}, AMPLITUDE)
    up, down, first, second = node(script, {"payload": payload, "frequencies": HZ, "cases": {}})
    flight = FlightSolver(system, OMEGA[0])
    assert_same(up, flight.steady(OMEGA, AMPLITUDE, None, 50, 10, "contact")[0], least=15)
    turned = flight.steady(OMEGA[::-1], AMPLITUDE, None, 50, 10, "contact")[0]
    assert_same(down, turned, least=15)
    assert first["amplitude"] + second["amplitude"] == up["amplitude"]
    assert np.abs(np.array(up["amplitude"]) - down["amplitude"][::-1]).max() > 1e-2 * AMPLITUDE  # two motions


def test_periodic_motions(node):
    """Existence, admissibility and stability equal; amplitude and extremes to 1e-10."""
    script = START + """return cases.map(([name]) => engine.orbits(name, {}, given.frequencies));"""
    given = {"payload": page_payload(SYSTEMS, AMPLITUDE), "cases": SYSTEMS.fromkeys(SYSTEMS), "frequencies": HZ}
    for (name, system), there in zip(SYSTEMS.items(), node(script, given), strict=True):
        by_place = {(each["frequency"], each["periods"], each["branch"]): each for each in there}
        assert len(by_place) == len(there)
        count = np.zeros(4, dtype=int)
        for periods in (1, 2, 3):
            solver = OrbitSolver(system, OMEGA[0], periods=periods)
            for f, omega in zip(HZ, OMEGA, strict=True):
                for branch, orbit in enumerate(solver._orbits(vibeam.Drive(omega, AMPLITUDE))):
                    ours = by_place.pop((f, periods, ("harder", "softer")[branch]))
                    assert ours["admissible"] == orbit.admissible, (name, f, periods, branch)
                    assert ours["stable"] == (orbit.admissible and orbit.stable)
                    count += orbit.admissible, not orbit.admissible, ours["stable"], orbit.admissible != ours["stable"]
                    assert np.isnan(ours["amplitude"]) != orbit.admissible
                    if orbit.admissible:
                        assert_extremes(ours, orbit.watched(output_of(system)))
        assert count[0] > 5, name
        for f, omega in zip(HZ, OMEGA, strict=True):
            state = solver._linear(vibeam.Drive(omega, AMPLITUDE))
            if state is not None:
                window, _ = solver.flight.steady([omega], AMPLITUDE, state, 0, 1, output_of(system))
                assert_extremes(by_place.pop((f, 1, "free")), window)
        assert not by_place, name


def assert_extremes(ours, window):
    for key in ("amplitude", "maximum", "minimum"):
        assert ours[key] == pytest.approx(getattr(window, key)[0], abs=1e-10 * window.amplitude[0])


def test_points_by_regimes(node):
    """One after the other, each by itself or carried: any law, here two stops that yield."""
    between = replace(SYSTEMS["two modes"], zeta=np.full(2, 0.2), second_gap=4e-3, law=LinearStop(5e3, 4.0))
    script = (
        START
        + """const schedule = { settle: 100, hold: 10 };
    return [engine.response("between", {}, given.frequencies, schedule),
      engine.response("between", {}, given.frequencies, { ...schedule, carried: true })];"""
    )
    payload = page_payload({"between": between}, 4 * AMPLITUDE)
    alone, carried = node(script, {"payload": payload, "frequencies": HZ, "cases": {}})
    solver, steady = RegimeSolver(between, OMEGA[0]), (4 * AMPLITUDE, None, 100, 10, "contact")
    assert_same(carried, solver.steady(OMEGA, *steady)[0], least=25)
    for at in range(len(OMEGA)):
        own = {key: values[at : at + 1] for key, values in alone.items()}
        assert_same(own, solver.steady(OMEGA[at : at + 1], *steady)[0], least=0)
    with pytest.raises(ScriptError, match="closed form only for one stop"):
        node(START + "return engine.orbits('between', {}, [10]);", {"payload": payload, "cases": {}})


def test_refusals(node):
    loose = vibeam.ImpactSystem.from_modes([0.0, 50.0], 0.0, [1.0, 0.5], 1.0)
    payload = page_payload({"loose": loose, "beam": SYSTEMS["one mode"]}, AMPLITUDE)
    for asked, said in (
        ("orbits('loose', {}, [10])", "static force toward the stop"),
        ("response('beam', { restitution: 1.2 }, [10])", "restitution"),
        ("response('beam', {}, [0, 10])", "frequency"),
        ("response('beam', {}, [10], { states: [{ displacement: [0, 1], velocity: [0, 0] }] })", "1 displacements"),
    ):
        with pytest.raises(ScriptError, match=said):
            node(START + f"return engine.{asked};", {"payload": payload, "cases": {}})
    empty = node(START + "return [engine.response('beam', {}, []), engine.orbits('beam', {}, [])];",
                 {"payload": payload, "cases": {}})  # fmt: skip
    assert empty[0]["amplitude"] == empty[1] == []
