"""Motions under a record at their limits: grazing, accumulation, rest, knots, jumps, scales, cuts, one long piece."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

for room in ("independent", "benchmarks"):
    sys.path.insert(0, str(Path(__file__).parents[1] / room))
import records  # noqa: E402
from test_loaded_flight import STORED, path_of  # noqa: E402
from yielding import Yielding, flown  # noqa: E402


def force(knots: Any, pieces: Any) -> vibeam.Record:
    return vibeam.Record(knots, pieces, "force")


def mass(omega: float = 0.0, **more: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(omega, 0.0, 1.0, 1.0, **{"gap": 0.0, "restitution": 0.5} | more)


def at(place: float, velocity: float = 0.0) -> vibeam.State:
    return vibeam.State([place], [velocity])


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12, 1e-14])
def test_a_step_grazes_or_misses(depth: float) -> None:
    """1 − cos t under a step, a stop a little below and above 2: one impact of speed √(1 − (gap−1)²), or none."""
    step = force([0, 7], [[1.0, 0, 0, 0]])
    gap = 2.0 * (1 - depth)
    path = vibeam.simulate(mass(1.0, gap=gap), step, 5.0, at(0.0), certify=True)
    assert len(path.impact_times) == 1
    speed = math.sqrt(1 - (gap - 1) ** 2)
    assert path.impact_velocities[0] == pytest.approx(speed, abs=1e-15 / speed)
    missed = vibeam.simulate(mass(1.0, gap=2.0 * (1 + depth)), step, 5.0, at(0.0), certify=True)
    assert len(missed.impact_times) == 0
    assert path.certificate.complete
    assert missed.certificate.complete


@pytest.mark.parametrize("count", [1, 7, 100, 20_000])
def test_a_bouncing_ball_through_many_pieces(count: int) -> None:
    """Pushed by 9.81 from 1 m, R = 0.9: every impact, the end of all, and rest, however the load is cut."""
    knots = np.linspace(0.0, 20.0, count + 1)
    path = vibeam.simulate(mass(restitution=0.9), force(knots, [[9.81, 0, 0, 0]] * count), 20.0, at(-1.0), certify=True)
    fall, k = math.sqrt(2 / 9.81), np.arange(len(path.impact_times))
    assert len(k) > 100
    assert path.impact_times == pytest.approx(fall * (1 + 18 * (1 - 0.9**k)), abs=1e-13)
    assert path.rests == pytest.approx(np.array([[19 * fall, 20.0]]), abs=1e-12)
    assert path.certificate.complete


@pytest.mark.parametrize("count", [2, 4, 16, 40])
def test_impacts_at_knots(count: int) -> None:
    """Pushed by 2 from −1 with R = ½: struck at 1, 2, 2½, 2¾ …, all of them knots."""
    load = force(np.linspace(0.0, 4.0, count + 1), [[2.0, 0, 0, 0]] * count)
    path = vibeam.simulate(mass(), load, 2.9, at(-1.0), certify=True)
    assert path.impact_times == pytest.approx([1, 2, 2.5, 2.75, 2.875], abs=1e-14)
    assert path.impact_velocities == pytest.approx([2, 1, 0.5, 0.25, 0.125], abs=1e-14)


@pytest.mark.parametrize("after", [0.0, -2.0, -50.0])
def test_a_load_that_jumps_at_the_impact(after: float) -> None:
    path = vibeam.simulate(mass(), force([0, 1, 4], [[2.0, 0, 0, 0], [after, 0, 0, 0]]), 4.0, at(-1.0), certify=True)
    assert path.impact_times.tolist() == [1.0]
    assert path.at(4.0) == pytest.approx(-3 + after * 4.5, rel=1e-14)
    assert path.certificate.complete


def test_a_load_that_jumps_while_the_mass_is_pressed() -> None:
    """Released at the knot, to the bit; and where the record ends with the mass pressed, it is free."""
    path = vibeam.simulate(mass(), force([0, 1, 4], [[2.0, 0, 0, 0], [-1.0, 0, 0, 0]]), 2.0, at(0.0), certify=True)
    assert path.rests.tolist() == [[0.0, 1.0]]
    assert path.at(2.0) == pytest.approx(-0.5, rel=1e-15)
    free = vibeam.simulate(mass(static=-1.0), force([0, 1], [[2.0, 0, 0, 0]]), 2.0, at(0.0), certify=True)
    assert free.rests.tolist() == [[0.0, 1.0]]
    assert free.at(2.0) == pytest.approx(-0.5, rel=1e-15)


def test_a_force_that_vanishes_on_a_cube_releases() -> None:
    """Pressed by 2 − t³: off at ∛2."""
    path = vibeam.simulate(mass(static=2.0), force([0, 9], [[0, 0, 0, -1.0]]), 4.0, at(0.0), certify=True)
    assert path.rests[0].tolist() == pytest.approx([0.0, 2 ** (1 / 3)], rel=1e-15)
    begin, left = 2 ** (1 / 3), 4 - 2 ** (1 / 3)
    assert path.at(4.0) == pytest.approx(left**2 - (4.0**5 - begin**5) / 20 + begin**4 / 4 * left, rel=1e-13)


def test_a_force_that_only_touches_zero_at_a_knot_holds() -> None:
    path = vibeam.simulate(mass(), force([0, 1, 3], [[1.0, -1, 0, 0], [0, 1.0, 0, 0]]), 3.0, at(0.0))
    assert path.rests.tolist() == [[0.0, 3.0]]
    assert len(path.impact_times) == 0


@pytest.mark.parametrize("push", [1.0, 0.0, -1.0])
@pytest.mark.parametrize("velocity", [1.0, 0.0, -1.0])
def test_a_record_that_begins_in_contact(push: float, velocity: float) -> None:
    """On the stop at the start: an impact at once where it moves in, rest where it is pressed, else flight."""
    path = vibeam.simulate(mass(1.0), force([0, 2], [[push, 0, 0, 0]]), 0.1, at(0.0, velocity))
    assert (len(path.impact_times) > 0 and path.impact_times[0] == 0.0) == (velocity > 0)
    assert (len(path.rests) > 0 and path.rests[0, 0] == 0.0) == (velocity == 0 and push >= 0)
    if velocity < 0 or (push < 0 and velocity == 0):
        assert path.at(0.1) == pytest.approx(push * (1 - math.cos(0.1)) + velocity * math.sin(0.1), rel=1e-12)


@pytest.mark.parametrize("span", [(0, 0), (1, 1), (2, 2), (2, 3), (5, 6), (0, 1e-300), (1e9, 1e9 + 1)])
def test_spans_without_length_and_beyond_the_record(span: tuple[float, float]) -> None:
    """Of no length, from the last knot on, far behind it: the load is 0 there."""
    load, system = force([0, 1, 2], [[1.0, 0, 0, 0], [2.0, 0, 0, 0]]), mass(1.0, gap=0.5)
    path = vibeam.simulate(system, load, span[1], at(0.25), t_start=span[0], certify=True)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.t_end == span[1]
    assert path.certificate.complete
    assert path.at(span[1]) == pytest.approx(0.25 * math.cos(span[1] - span[0]), rel=1e-12)


@pytest.mark.parametrize("omega", [1e3, 1e7, 1e10])
def test_a_mode_far_stiffer_than_the_samples_are_close_stands_still(omega: float) -> None:
    """It follows its static share, load u/ω²: the motion is that of the soft mode, to its order."""
    rate, times = 10.0, np.arange(201) / 10.0
    load = vibeam.Record.sampled(np.sin(1.3 * times), rate=rate, quantity="force")
    soft = mass(1.0, gap=1e3)
    both = vibeam.ImpactSystem.from_modes([1.0, omega], 0.0, [1.0, 0.3], [1.0, 0.5], gap=1e3, restitution=0.5)
    start = vibeam.State(np.zeros(2), np.zeros(2))
    ends = vibeam.simulate(both, load, 20.0, start), vibeam.simulate(soft, load, 20.0, at(0.0))
    assert ends[0].at(times[1:]) == pytest.approx(ends[1].at(times[1:]), abs=2.0 / omega**2 * 10 + 1e-12)


UNITS = [(2.0**-40, 2.0**-40), (2.0**30, 2.0**-30), (2.0**-60, 2.0**40)]


@pytest.mark.parametrize("units", UNITS)
def test_units_change_no_bit(units: tuple[float, float]) -> None:
    """All 200 stored motions in other units of time and length, powers of two: the same times to the last bit."""
    for entry in STORED[::4]:
        first, again = path_of(entry), path_of(in_units(entry, *units))
        assert (again.impact_times / units[0]).tolist() == first.impact_times.tolist()


def in_units(entry: dict[str, Any], time: float, length: float) -> dict[str, Any]:
    push = length / time**2
    made = entry | {
        "omega": [w / time for w in entry["omega"]],
        "knots": [t * time for t in entry["knots"]],
        "t_end": entry["t_end"] * time,
        "pieces": [[a * push / time**j for j, a in enumerate(piece)] for piece in entry["pieces"]],
        "static": [s * push for s in entry["static"]],
        "stops": [stop | {"gap": stop["gap"] * length} for stop in entry["stops"]],
    }
    for stop in made["stops"]:
        if "stiffness" in stop:
            stop |= {"stiffness": stop["stiffness"] / time**2, "damping": stop["damping"] / time}
    return made | ({"coupling": [[c / time for c in row] for row in entry["coupling"]]} if "coupling" in entry else {})


def test_cuts_change_no_motion() -> None:
    """Knots put in at random, and one 1e-13 behind every knot: the same impacts to round-off."""
    rng = np.random.default_rng(32)
    for entry in STORED[1::4]:
        knots = np.array(entry["knots"])
        new = np.unique([*knots, *rng.uniform(knots[0], knots[-1], 7), *(knots[1:-1] + 1e-13 * knots[-1])])
        place = np.searchsorted(knots, new[:-1], side="right") - 1
        s, c = new[:-1] - knots[place], np.array(entry["pieces"])[place].T
        moved = [
            c[0] + s * (c[1] + s * (c[2] + s * c[3])),
            c[1] + s * (2 * c[2] + 3 * s * c[3]),
            c[2] + 3 * s * c[3],
            c[3],
        ]
        cut = path_of(entry | {"knots": new.tolist(), "pieces": np.transpose(moved).tolist()})
        whole = path_of(entry)
        assert len(cut.impact_times) == len(whole.impact_times)
        off = np.abs(cut.impact_times - whole.impact_times).max(initial=0.0)
        assert off <= 1e-13 * (1 + entry["growth"]) * entry["t_end"]


def test_one_piece_of_many_periods() -> None:
    """A ramp over 16 000 periods: the stop is met where the mean reaches it, and rested on to the end."""
    end = 1e5
    path = vibeam.simulate(
        vibeam.ImpactSystem.from_modes(1.0, 0.01, 1.0, 1.0, gap=0.5, restitution=0.7),
        force([0, end], [[0.0, 2.0 / end, 0, 0]]), end, at(0.0), certify=True,
    )  # fmt: skip
    assert path.impact_times[0] == pytest.approx(end / 4, abs=10.0)
    assert path.rests[-1, 1] == end
    assert path.certificate.complete
    assert path.stats["evaluations"] < 1000


def test_pulses_without_width_are_steps_of_velocity() -> None:
    """Fifty pulses of 1e-12 s on a free mass: velocities add up; places to the width."""
    width, times = 1e-12, 0.1 + 0.3 * np.arange(50)
    knots = np.concatenate([[0.0], np.sort([*times, *(times + width)]), [16.0]])
    widths, pieces = np.diff(knots)[1::2], np.zeros((101, 4))
    pieces[1::2, 0] = 0.5 * (-1.0) ** np.arange(50) / widths
    path = vibeam.simulate(mass(gap=9.0), force(knots, pieces), 16.0, at(0.0), certify=True)
    assert path.velocity_at(16.0) == pytest.approx(0.0, abs=1e-12)
    assert path.at(16.0) == pytest.approx(25 * 0.5 * 0.3, abs=1e-10)


@pytest.mark.parametrize("exponent", [1.5, 1.0])
def test_integrated_contact_under_a_step_as_under_a_static_load(exponent: float) -> None:
    """Hertz' stop and a linear one, pushed by a step in seven pieces, against the program of stops that yield."""
    law = Hertz(90.0) if exponent == 1.5 else LinearStop(90.0, 0.0)
    own = Yielding([1.0, 4.0], [[0.1, 0.0], [0.0, 0.2]], [1.0, 0.5], [0.0] * 2, [0.9, 0.3], [0.4], 90.0, exponent)
    truth, touches = flown(own, (1.0, 0.0), [0.0] * 4, 0.0, 9.0, digits=30)
    system = vibeam.ImpactSystem.from_modes([1.0, 4.0], [0.05, 0.025], [1.0, 0.5], [0.9, 0.3], gap=0.4, law=law)
    load = force(np.linspace(0.0, 20.0, 8), [[1.0, 0, 0, 0]] * 7)
    path = vibeam.simulate(system, load, 9.0, vibeam.State(np.zeros(2), np.zeros(2)))
    assert len(path.contacts) == touches > 1
    assert path.modes_at(9.0).ravel() == pytest.approx([float(value) for value in truth], abs=1e-10)


@pytest.mark.parametrize("law", [Hertz(1e4), HuntCrossley(1e4, 0.3), LinearStop(1e6, 0.0), LinearStop(1e8, 10.0)])
def test_extremes_are_not_within_the_samples(law: Any) -> None:
    """Under noise between two stops, every extreme is at least what a million samples see, and hardly more."""
    values = 3 * np.random.default_rng(3).normal(size=1001)
    load = vibeam.Record.sampled(values, rate=20.0, quantity="force")
    system = vibeam.ImpactSystem.from_modes([1.0, 7.3], 0.02, [1.0, 0.5], [1.0, -0.3], gap=0.2, second_gap=0.4, law=law)
    path = vibeam.simulate(system, load, 50.0, vibeam.State(np.zeros(2), np.zeros(2)))
    found, seen = vibeam.extremes(path, ["contact"]), path.at(np.linspace(0.0, 50.0, 100_001))
    size, near = np.ptp(seen), 5e-6 if not isinstance(law, LinearStop) else 1e-12
    assert found.greatest[0, 0] >= seen.max() - near * size
    assert found.least[0, 0] <= seen.min() + near * size
    assert found.peak[0] <= np.abs(seen).max() + 1e-3 * size


def test_far_from_its_stop_it_is_linear_stepping() -> None:
    """Eight modes under 20 000 samples of noise, with lines between them: each mode's exact recursion by lfilter."""
    values = records.samples(2.0)
    own = records.SYSTEM
    free = vibeam.ImpactSystem.from_modes(own.omega, own.zeta, own.contact, own.load, gap=1e3, restitution=0.5)
    load, start = vibeam.Record.sampled(values, rate=records.RATE), vibeam.State(np.zeros(8), np.zeros(8))
    path = vibeam.simulate(free, load, load.end, start, certify=True)
    stepped = records.linear(values)
    off = np.abs(path.at(load.times) - stepped).max()
    assert off < 1e-9 * np.abs(stepped).max()  # the recursion's own round-off grows with 1/(ωh)²
    assert path.certificate.complete


def test_memory_of_a_quiet_record() -> None:
    """200 000 samples with a stop out of reach: no impact, proved, and next to nothing kept."""
    values = np.random.default_rng(0).normal(size=200_001)
    load = vibeam.Record.sampled(values, rate=1e4)
    path = vibeam.simulate(mass(50.0, gap=1e3), load, load.end, at(0.0), certify=True)
    assert len(path.impact_times) == 0
    assert path.certificate.complete
    assert path.segments.trace.nbytes < 0.1 * load.coefficients.nbytes
