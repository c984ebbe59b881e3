"""Motions of the engine in JavaScript against Python's, on the same kernels compiled for another machine."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engine_pages import ENGINE, compared
from javascript import MODULES, NODE
from page_payload import page_payload

import vibeam
from vibeam.flight.solver import FlightSolver
from vibeam.flight.trajectory import Trajectory
from vibeam.report.page.parts import as_json
from vibeam.system.impact_system import ImpactSystem

Node = Callable[..., Any]
OMEGA = 2 * np.pi * np.array([7.6, 49.0, 131.0, 260.0, 431.0, 644.0, 900.0, 1198.0])


def plain(n: int, **changes: Any) -> ImpactSystem:
    """Modes of a beam, the stop near its end; ``changes`` of it."""
    given = {
        "omega": OMEGA[:n], "zeta": 0.017, "contact": 2 * (-1.0) ** np.arange(n) / (1 + 0.1 * np.arange(n)),
        "load": 0.5 / (1 + np.arange(n)), "gap": 1e-4, "restitution": 0.7,
    }  # fmt: skip
    return ImpactSystem.from_modes(**(given | changes))


def many(n: int) -> ImpactSystem:
    """As many modes, of frequencies that ascend as those of a beam."""
    orders = np.arange(1, n + 1)
    return plain(8, omega=10.0 * orders**1.6, contact=(-1.0) ** orders, load=1.0 / orders)


SYSTEMS = {
    "one mode": plain(1),
    "two modes": plain(2, restitution=0.5),
    "eight modes": plain(8),
    "64 modes": many(64),
    "pressed": plain(4, gap=-2e-5),
    "under a load": plain(4, static=[0.3, 0.05, 0.0, 0.0], gap=5e-5),
    "chatters": plain(3, restitution=0.2, gap=0.0),
    "sticks at once": plain(3, restitution=0.0),
    "elastic": plain(3, restitution=1.0),
    "elastic and undamped": plain(2, restitution=1.0, zeta=0.0),
    "undamped": plain(3, zeta=0.0),
    "falls": ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, static=1.0, restitution=0.6, gap=1e-3),
    "a free mode": plain(3, omega=[0.0, 300.0, 820.0], zeta=[0.0, 0.02, 0.02], static=[0.4, 0.0, 0.0]),
    "a silent mode": plain(3, contact=[2.0, 0.0, 1.0]),
    "fast modes far beyond critical damping": plain(4, zeta=2e-3 * OMEGA[:4]),
    "small and fast": plain(3, omega=1e3 * OMEGA[:3], gap=1e-7),
    "modes that coincide": plain(3, omega=[48.0, 300.0, 300.0]),
    "slow decays": plain(3, zeta=[0.02, 7.0, 0.4]),
}
FIXED = ("modes that coincide", "slow decays")  # held on the stop by Python's blocks, as they are


def places_of(system: ImpactSystem, count: int, seed: int, fixed: bool) -> list[dict[str, float]]:
    """Random places of the sliders about the system's own."""
    rng, found = np.random.default_rng(seed), []
    rate = min((rate for rate in system.omega.tolist() if rate > 0), default=60.0)
    gap = system.gap
    for _ in range(count):
        place = {
            "frequency": rate * rng.uniform(0.7, 2.6) / (2 * np.pi),
            "drive": abs(gap) * rng.uniform(0.3, 3.0) + 1e-6,
            "gap": gap + abs(gap) * rng.uniform(-1.0, 1.0),
            "damping": 1.0 if fixed else float(rng.choice([0.5, 2.0])),
        }
        if 0 < system.restitution < 1:
            place["restitution"] = rng.uniform(0.1, 0.99)
        found.append(place)
    return found


def at_place(system: ImpactSystem, place: dict[str, float], periods: int) -> Trajectory:
    """The motion from equilibrium, by Python."""
    made = replace(
        system, gap=place["gap"], zeta=system.zeta * place["damping"],
        restitution=place.get("restitution", system.restitution),
    )  # fmt: skip
    omega = 2 * np.pi * place["frequency"]
    return vibeam.simulate(made, vibeam.Drive(omega, place["drive"]), periods * 2 * np.pi / omega)


def test_motions_are_those_of_python(node: Node) -> None:
    """Impacts to what round-off makes of them, and all counts and extremes of those that are regular."""
    systems = {name: each for name, each in SYSTEMS.items() if each.size <= 8}
    places = {name: places_of(each, 2, i, name in FIXED) for i, (name, each) in enumerate(systems.items())}
    found, counted, repeating = compared(node, page_payload(systems, 1.0), systems, places, periods=20)
    assert found == []
    assert counted >= 17, "of 34 motions, those whose counts are compared"
    assert repeating >= 10, "of 34 motions, those whose steady points are compared"


def test_motions_of_many_modes_are_those_of_python(node: Node) -> None:
    """Also with the damping of 64 modes at half and twice: nothing of it is in the payload."""
    systems = {"64 modes": SYSTEMS["64 modes"]}
    places = {"64 modes": places_of(systems["64 modes"], 3, 2, False)}
    found, counted, _ = compared(node, page_payload(systems, 1.0), systems, places, periods=1, settle=2)
    assert found == []
    assert counted


def test_poses_are_those_of_python(node: Node) -> None:
    """Displacement, rate and modes at even times, and both sides of impacts, and the state that goes on."""
    systems = {name: SYSTEMS[name] for name in ("two modes", "chatters", "under a load", "a free mode")}
    script = (
        ENGINE
        + """
    return given.asked.map(([fidelity, place]) => {
      const motion = engine.motion(fidelity, place, { periods: 6 }), times = motion.times(200), even = motion.times(50);
      const { impacts, state, ended } = motion, around = motion.at(impacts.flatMap(([t]) => [before(t), t]));
      const first = motion.at(times);
      engine.motion(fidelity, { ...place, gap: 2 * place.gap, damping: 1.5 * place.damping }, { periods: 2 });
      return { times, ...motion.at(times), first, around: around.v, impacts, state, ended };
    });
    function before(time) { return time * (1 - Number.EPSILON); }
    """
    )
    asked = [(name, place) for i, name in enumerate(systems) for place in places_of(systems[name], 2, i, False)]
    found = node(script, {"payload": page_payload(systems, 1.0), "asked": asked})
    for (name, place), motion in zip(asked, found, strict=True):
        path, row = at_place(systems[name], place, 6), systems[name].contact
        assert path.errors.meaningful == len(path.impact_times), "a motion whose last digits are sure"
        times = np.array(motion["times"])
        modes = path.modes_at(times)
        smooth = np.min(np.abs(times[:, None] - np.append(path.impact_times, -1.0)), axis=1) > 1e-9 * path.t_end
        shown = [motion["x"], motion["v"], np.reshape(motion["modes"], (len(times), -1))]
        theirs = [modes[:, 0] @ row, modes[:, 1] @ row, modes[:, 0]]
        sizes = np.abs(modes[:, 0] * row).max(), np.abs(modes[:, 1] * row).max(), np.abs(modes[:, 0]).max()
        for mine, other, size in zip(shown, theirs, sizes, strict=True):
            assert np.allclose(np.array(mine)[smooth], other[smooth], rtol=0, atol=1e-9 * size), name
        assert motion["x"] == motion["first"]["x"], "a motion stays what it was while others are flown"
        assert motion["ended"] == "ran to the end"
        assert motion["state"]["resting"] == path.state.resting
        sides, speeds = np.reshape(motion["around"], (-1, 2)), np.array(motion["impacts"]).reshape(-1, 2)[:, 1]
        strong = speeds > 1e-3 * speeds.max(initial=0.0)
        assert np.allclose(sides[strong, 0], speeds[strong], rtol=1e-9)
        expected = -path.system.restitution * speeds[strong]
        assert np.allclose(sides[strong, 1], expected, rtol=1e-9)


def test_grazes_are_neither_missed_nor_invented(node: Node) -> None:
    """Gaps by 1e-11 below and above the largest displacement of a motion that is flown without a stop."""
    system, omega, drive, periods = plain(3), 1.3 * OMEGA[0], 1e-4, 12
    far = FlightSolver(replace(system, gap=1.0), omega)
    top = float(far.steady([omega], drive, None, 0, periods, "contact")[0].maximum[0])
    places = [{"frequency": omega / (2 * np.pi), "drive": drive, "gap": top * (1 + off)} for off in (-1e-11, 1e-11)]
    script = (
        ENGINE + "return given.places.map((each) => engine.fly({ fidelity: 'it', ...each, periods: 12, settle: 1 }));"
    )
    touched, free = node(script, {"payload": page_payload({"it": system}, 1.0), "places": places})
    path = at_place(system, {**places[0], "damping": 1.0}, periods)
    assert len(path.impact_times) >= 1
    assert np.allclose(touched["impactTimes"][0], path.impact_times[0], rtol=1e-8)
    assert 0 < touched["impactVelocities"][0] < 1e-4 * omega * top
    assert free["impactTimes"] == []


def test_frames_take_no_more_memory_as_they_go(node: Node) -> None:
    """As sliders move for minutes: a thousand motions of any length, drawn at any number of times."""
    script = (
        ENGINE
        + """
    const sizes = [];
    for (let i = 0; i < 1000; i += 1) {
      const gap = 1e-4 * ((i % 11) / 5 - 1), damping = 1 + (i % 3) / 2;
      const place = { frequency: 8 + (i % 37) / 3, drive: 1e-4, gap, damping };
      const motion = engine.motion("chatters", place, { periods: 2 + (i % 7) });
      motion.at(motion.times(100 + i % 50));
      sizes.push(engine.slots.end);
    }
    return [sizes[199], sizes[999]];
    """
    )
    early, late = node(script, {"payload": page_payload({"chatters": SYSTEMS["chatters"]}, 1.0)})
    assert early == late


def test_what_cannot_be_is_refused_by_a_sentence(node: Node) -> None:
    """No motion is drawn that the terminal would refuse."""
    script = (
        ENGINE
        + """
    const said = (asked) => {
      try { engine.fly({ periods: 2, ...asked }); } catch (fault) { return fault.message; }
      return "";
    };
    return given.asked.map(said);
    """
    )
    usual = {"fidelity": "slow decays", "frequency": 10.0, "drive": 1e-4}
    asked = [
        {**usual, "fidelity": "other"}, {**usual, "restitution": 1.01}, {**usual, "frequency": 0.0},
        {**usual, "damping": 2.0}, {**usual, "drive": -1e-4}, {**usual, "gap": 1e-4},
    ]  # fmt: skip
    assert node(script, {"payload": page_payload({"slow decays": SYSTEMS["slow decays"]}, 1.0), "asked": asked}) == [
        "No fidelity other: there are slow decays.",
        "slow decays: the coefficient of restitution at the contact cannot be 1.01.",
        "slow decays: the drive frequency cannot be 0 rad/s.",
        "slow decays: its damping cannot be changed on this page.",
        "slow decays: the amplitude of the drive cannot be -0.0001 m.",
        "",
    ]


def asked_of_node(page: Path, requests: str) -> subprocess.CompletedProcess[str]:
    """What the command does with a page and requests."""
    command = [
        NODE,
        "--disable-warning=MODULE_TYPELESS_PACKAGE_JSON",
        MODULES / "extensions/explore/engine/node.js",
        page,
    ]
    return subprocess.run(command, input=requests, capture_output=True, text=True, check=False)


def test_a_command_answers_for_programs(tmp_path: Path) -> None:
    """``node node.js page.html``: requests in, answers out, refusals among them."""
    page = tmp_path / "page.html"
    held = as_json(page_payload({"one mode": SYSTEMS["one mode"]}, 1.0))
    page.write_text(f'<p>…</p><script id="engine" type="application/json">{held}</script><p>…</p>', encoding="utf-8")
    place = {"fidelity": "one mode", "frequency": 12.0, "drive": 1e-4, "periods": 3}
    asked = [{"call": "fly", "arguments": [each]} for each in (place, {**place, "restitution": 2.0})]
    done = asked_of_node(page, json.dumps([*asked, {"call": "draw"}]))
    flight, refused, unknown = json.loads(done.stdout)
    path = at_place(SYSTEMS["one mode"], {**place, "gap": 1e-4, "damping": 1.0}, 3)
    assert np.allclose(flight["impactTimes"], path.impact_times, rtol=1e-13)
    assert refused == {"fault": "one mode: the coefficient of restitution at the contact cannot be 2."}
    assert unknown["fault"].startswith("No call draw: there are fly,")


@pytest.mark.parametrize(
    ("page", "requests", "said"),
    [("<p>no engine</p>", "[]", "The page cannot be read"), ("{}", "{", "The list of requests cannot be read"),
     ("{}", "{}", "The requests are no list")],
)  # fmt: skip
def test_the_command_says_what_it_cannot_read(tmp_path: Path, page: str, requests: str, said: str) -> None:
    """In one line, with the usage."""
    file = tmp_path / "page.html"
    file.write_text(page, encoding="utf-8")
    done = asked_of_node(file, requests)
    assert done.returncode == 1
    assert done.stderr.startswith(said)
    assert done.stderr.endswith("node node.js PAGE.html < REQUESTS.json, a list of {call, arguments}\n")
