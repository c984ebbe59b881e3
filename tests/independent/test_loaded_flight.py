"""The flight under a record, held to 200 motions of the second program: loaded.json."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam_models.laws.compliant import LinearStop

STORED = json.loads(Path(__file__).with_name("loaded.json").read_text(encoding="utf-8"))["entries"]
NAMES = [f"{k} {entry['kind']}, {len(entry['omega'])}" for k, entry in enumerate(STORED)]
NEAR = 2e-13  # round-off of times over the duration, speeds over the fastest, states over the largest
ACCUMULATION = "what is left of the accumulation of impacts has no bound"
WEAK = 1e-3  # of the fastest impact: weaker ones of an accumulation are not stored


def system_of(entry):
    """The system of an entry."""
    first, *others = entry["stops"]
    known = {name: entry[name] for name in ("omega", "zeta", "load", "static")}
    known |= {"contact": first["row"], "gap": first["gap"], **wall(first)}
    if "coupling" in entry:
        low = entry["coupling"]
        n = len(low)
        known["coupling"] = [[low[max(i, k)][min(i, k)] for k in range(n)] for i in range(n)]
    if entry["kind"].startswith("two"):
        known["second_gap"] = others[0]["gap"]
    elif others:
        known["further"] = tuple(vibeam.Contact(each["row"], each["gap"], **wall(each)) for each in others)
    return vibeam.ImpactSystem.from_modes(**known)


def wall(stop):
    if "restitution" in stop:
        return {"restitution": stop["restitution"]}
    return {"restitution": 0.0, "law": LinearStop(stop["stiffness"], stop["damping"])}


def path_of(entry, **how):
    record = vibeam.Record(entry["knots"], entry["pieces"], "force")
    start = vibeam.State(np.array(entry["displacement"]), np.array(entry["velocity"]))
    return vibeam.simulate(system_of(entry), record, entry["t_end"], start, **how)


def true(entry, *kinds):
    """Times, speeds and stops of events of some kinds, in doubles."""
    own = [(float(time), float(speed), stop) for kind, stop, time, speed in entry["events"] if kind in kinds]
    return np.array(own).reshape(-1, 3).T


def met(path, entry):
    """Impacts and entries as the entry lists them."""
    times, speeds, which = path.impact_times, path.impact_velocities, path.impact_contacts
    if any(event[0] == "rest" for event in entry["events"]) and len(speeds):
        kept = speeds > WEAK * speeds.max()
        times, speeds, which = times[kept], speeds[kept], which[kept]
    return times, speeds, which


@pytest.mark.parametrize("entry", STORED, ids=NAMES)
def test_impacts_rests_and_the_state_at_the_end(entry):
    path = path_of(entry, certify=True)
    bound = NEAR * (1 + entry["growth"])
    times, speeds, which = met(path, entry)
    true_times, true_speeds, true_stops = true(entry, "impact", "entry")
    assert len(times) == len(true_times)
    assert np.abs(times - true_times).max(initial=0.0) <= bound * entry["t_end"]
    assert np.abs(speeds - true_speeds).max(initial=0.0) <= bound * true_speeds.max(initial=0.0)
    assert which.tolist() == true_stops.tolist()
    begins, ends = true(entry, "rest")[0], true(entry, "release")[0]
    if entry["held"] and not (len(ends) and ends[0] == 0):
        begins = np.append(0.0, begins)
    ends = ends[ends > 0]
    ends = np.append(ends, entry["t_end"])[: len(begins)]
    assert path.rests.shape == (len(begins), 2)
    assert np.abs(path.rests - np.stack([begins, ends], axis=1)).max(initial=0.0) <= 10 * bound * entry["t_end"]
    for found, name in ((path.state.displacement, "displacement"), (path.state.velocity, "velocity")):
        truth = np.array([float(value) for value in entry["end"][name]])
        assert np.abs(found - truth).max() <= 10 * bound * size(entry, path, name)
    reasons = {span.reason for span in path.certificate.unproved}
    assert reasons <= ({ACCUMULATION} if entry["kind"] == "several" else set())


def size(entry, path, name):
    """Largest of the modes' displacements or velocities along the motion."""
    states = path.modes_at(np.linspace(0.0, entry["t_end"], 200))
    return np.abs(states[:, 0 if name == "displacement" else 1]).max()


@pytest.mark.parametrize("entry", [e for e in STORED if any(stop.get("damping") == 0 for stop in e["stops"])])
def test_the_ends_of_contacts_with_linear_stops(entry):
    """Without damping, where the force ends as the stop is left."""
    contacts, bound = path_of(entry).contacts, NEAR * (1 + entry["growth"])
    ends = true(entry, "exit")[0]
    assert np.abs(contacts[: len(ends), :2].sum(axis=1) - ends).max(initial=0.0) <= 10 * bound * entry["t_end"]


@pytest.mark.parametrize("entry", STORED, ids=NAMES)
def test_extremes_of_the_contact(entry):
    path = path_of(entry)
    found = vibeam.extremes(path, ["contact"])
    least, greatest = (float(value) for value in entry["extremes"])
    bound = 10 * NEAR * (1 + entry["growth"]) * max(-least, greatest)
    assert [found.least[0, 0], found.greatest[0, 0]] == pytest.approx([least, greatest], abs=bound)


def quadrature(path, knots, end):
    """Times (m, 20) and weights of Gauss' points on stretches without a knot or an event, at most end/400 long."""
    events = [*path.impact_times, *path.contacts[:, :2].sum(axis=1), *path.rests.ravel()]
    cuts = np.unique(np.concatenate([knots, events, np.linspace(0.0, end, 401)]))
    cuts = cuts[cuts <= end]
    nodes, weights = np.polynomial.legendre.leggauss(20)
    half = np.diff(cuts)[:, None] / 2
    return cuts[:-1, None] + half * (1 + nodes), half * weights


@pytest.mark.parametrize("entry", STORED[::7], ids=NAMES[::7])
def test_the_work_of_the_load_by_quadrature_along_the_motion(entry):
    """∫ u load·η' dt, against the second program's integral of products of series."""
    path, record = path_of(entry), vibeam.Record(entry["knots"], entry["pieces"], "force")
    t, weights = quadrature(path, entry["knots"], entry["t_end"])
    power = weights * record.at(t) * (path.modes_at(t)[..., 1, :] @ np.array(entry["load"]))
    assert power.sum() == pytest.approx(float(entry["work"]), abs=1e-10 * (1 + entry["growth"]) * np.abs(power).sum())


@pytest.mark.parametrize("peak", [-30.0, 30.0])
def test_energy_balances_with_the_work_of_the_base(peak):
    """Three modes on a base that jerks by a half-sine: ½η'² + ½ω²η² is the base's work less damping and impacts."""
    omega, zeta = np.array([47.7, 299.0, 840.0]), np.array([0.017, 0.01, 0.01])
    contact, load = np.array([1.9, -1.8, 1.7]), np.array([1.5, 0.8, 0.5])
    system = vibeam.ImpactSystem.from_modes(omega, zeta, contact, load, gap=5e-4, restitution=0.7)
    record = vibeam.Record.half_sine(peak, 0.011)
    path = vibeam.simulate(system, record, 0.4, vibeam.State(np.zeros(3), np.zeros(3)))
    assert len(path.impact_times) > 5
    t, weights = quadrature(path, record.times, 0.4)
    rates = path.modes_at(t)[..., 1, :]
    work = float(np.sum(weights * -record.at(t) * (rates @ load)))
    lost = float(np.sum(weights * (rates**2 @ (2 * zeta * omega))))
    lost += float(np.sum((1 - 0.7**2) * path.impact_velocities**2) / (2 * contact @ contact))
    left = 0.5 * float(np.sum(path.state.velocity**2 + (omega * path.state.displacement) ** 2))
    assert left == pytest.approx(work - lost, abs=1e-12 * work)
