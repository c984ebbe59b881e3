"""Numbers of a sweep against formulas and other ways to them: peak, ends of period 1, ringing, apparent restitution."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from stand_in import HELD_AT_CONTACT, RIG, point

import vibeam
from vibeam.casefile.read import parse
from vibeam.runs.comparison.places import simulated
from vibeam.runs.comparison.responses import Response
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.swept_numbers import period_one_end, refined_peak
from vibeam.studies.variants import Ensemble, ensembles
from vibeam.system.impact_system import Drive
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

Law = Callable[[float], FrequencyResponse]
OF_MOTION = ("ringing", "ringing_frequency", "apparent_restitution")
QUICK: dict[str, Any] = {
    "units": "SI", "beam.elements": 8, "sweep.frequency": {"from": "14 Hz", "to": "16.4 Hz", "points": 7},
    "sweep.direction": "up", "sweep.settle": 150, "sweep.hold": 4,
}  # fmt: skip
FIDELITY = '[fidelity.beam]\nreduction = "modal"\nmodes = 4\n'


class Drawn:
    """Motions that are a formula: amplitude and period over frequency."""

    done = False

    def __init__(self, law: Law) -> None:
        self.law = law

    def at(self, frequency: float, state: State | None, settle: bool = True) -> tuple[FrequencyResponse, State]:
        """See ``Simulator``."""
        return self.law(frequency), State(np.zeros(1), np.zeros(1))


def drawn(law: Law, ways: tuple[str, ...] = ("up", "down")) -> Response:
    simulator, grid = Drawn(law), np.linspace(14, 17, 13).tolist()
    return Response(
        {way: [simulated(simulator, each, None) for each in (grid if way == "up" else grid[::-1])] for way in ways},
        simulator,
    )


def test_a_smooth_peak_is_found_between_the_points() -> None:
    found = refined_peak(drawn(lambda f: point(f, amplitude=1e-3 / (1 + ((f - 15.3137) / 0.4) ** 2))))
    assert found.frequency == pytest.approx(15.3137, abs=1e-5)
    assert found.amplitude == pytest.approx(1e-3, rel=1e-7)
    assert not found.why


def test_a_peak_at_a_jump_is_the_last_point_before_it() -> None:
    found = refined_peak(drawn(lambda f: point(f, amplitude=1e-4 * f if f < 15.62 else 1e-5)))
    assert 15.62 - 0.25 / 16 <= found.frequency < 15.62
    assert found.amplitude == pytest.approx(1e-4 * found.frequency)


def test_a_peak_that_does_not_repeat_is_the_sweep_s_own_and_failed_points_are_none() -> None:
    wild: Law = lambda f: point(f, amplitude=f, period=0)  # noqa: E731
    own = refined_peak(drawn(wild))
    assert (own.amplitude, own.why) == (17.0, "the motion at the peak does not repeat")
    broken: Law = lambda f: point(f, amplitude=np.nan, ended=1)  # noqa: E731
    assert np.isnan(refined_peak(drawn(broken)).amplitude)
    assert refined_peak(drawn(broken)).why == "no complete point"
    assert period_one_end(drawn(wild), upper=True).why == "no motion of period 1 with impacts"
    rising = refined_peak(drawn(lambda f: point(f, amplitude=f)))
    assert rising.frequency == 17.0
    assert "may lie beyond" in rising.why


@pytest.mark.parametrize("ways", [("up",), ("down",), ("up", "down")])
def test_ends_of_period_one_are_bracketed(ways: tuple[str, ...]) -> None:
    law: Law = lambda f: point(f, amplitude=f, period=1 if 14.61 < f < 16.377 else 2)  # noqa: E731
    low, high = (period_one_end(drawn(law, ways), upper) for upper in (False, True))
    assert low.number == pytest.approx(14.61, rel=1e-4)
    assert high.number == pytest.approx(16.377, rel=1e-4)
    low, high = (period_one_end(drawn(lambda f: point(f, amplitude=f), ways), upper) for upper in (False, True))
    assert (low.number, high.number) == (14.0, 17.0)
    assert all("end of the sweep" in each.why for each in (low, high))


def test_a_narrow_range_of_period_one_beside_the_last_point_is_found_from_its_largest_amplitude() -> None:
    """Two ranges of period 1: the ends are those of the one with the largest amplitude."""
    law: Law = lambda f: point(f, amplitude=f, period=1 if f < 14.61 or 15.9 < f < 16.377 else 2)  # noqa: E731
    low, high = (period_one_end(drawn(law), upper) for upper in (False, True))
    assert low.number == pytest.approx(15.9, rel=1e-4)
    assert high.number == pytest.approx(16.377, rel=1e-4)


def case_of(**settings: Any) -> Any:
    given = {name.replace("__", "."): value for name, value in settings.items()}
    return parse(HELD_AT_CONTACT.split("[fidelity.sdof]")[0] + FIDELITY, RIG, QUICK | given)


def read(case: Any, *quantities: str) -> tuple[dict[str, float], Ensemble]:
    [found] = ensembles([(case, "beam")], [AskedNumber(each) for each in quantities])
    return {each: float(found.of(AskedNumber(each))[0, 0]) for each in quantities}, found


def test_peak_ringing_and_apparent_restitution_against_other_ways_to_them() -> None:
    """The peak by closed-form orbits, ringing by the mode's own damped frequency and motion, R by the first mode."""
    case = case_of()
    system = case.system("beam")
    found, _ = read(case, "peak", "peak_frequency", *OF_MOTION)
    near = found["peak_frequency"] + np.linspace(-0.02, 0.02, 21)
    exact = vibeam.sweep(system, omega=2 * np.pi * near, amplitude=case.base_amplitude, solver="orbit", output="sensor")
    rise = np.polyfit(near - near[10], exact.amplitude, 2)
    assert found["peak_frequency"] - near[10] == pytest.approx(-rise[1] / (2 * rise[0]), abs=2e-4)
    assert found["peak"] == pytest.approx(rise[2] - rise[1] ** 2 / (4 * rise[0]), rel=1e-6)

    damped = system.omega[1] * np.sqrt(1 - system.zeta[1] ** 2) / (2 * np.pi)
    assert found["ringing_frequency"] == pytest.approx(damped, rel=2e-3)
    path = vibeam.simulate(system, Drive(2 * np.pi * found["peak_frequency"], case.base_amplitude), 20.0)
    assert found["apparent_restitution"] == pytest.approx(shown_by_first_mode(path), rel=5e-3)
    # mode 2 less its steady response to the drive is a free vibration: its envelope from what it is after the impact
    first, second = path.impact_times[-3:-1]
    x, v = (path.modes_at(np.array([first]))[0] - steady(path, first))[:, 1]
    w, z = system.omega[1], system.zeta[1]
    sigma, ring = z * w, w * np.sqrt(1 - z**2)
    speed = np.hypot(x, (v + sigma * x) / ring) * w * abs(system.output("sensor")[1])
    span = second - first
    mean = speed * -np.expm1(-sigma * span) / (sigma * span)
    assert found["ringing"] == pytest.approx(mean, rel=0.03)  # which is read a fifth of its period after the impact


def steady(path: Any, t: float) -> Any:
    """Displacements and velocities (2, n) of the modes driven without a stop, by the complex response."""
    system, big = path.system, path.drive.omega
    response = (
        system.load * big**2 * path.drive.amplitude / (system.omega**2 - big**2 + 2j * system.zeta * system.omega * big)
    )
    turning = response * np.exp(1j * big * t)
    return np.stack([turning.imag, (1j * big * turning).imag])


def shown_by_first_mode(path: Any) -> float:
    """−after/before of the sensor's velocity at an impact, without the free vibrations of the faster modes."""
    system, hit = path.system, path.impact_times[-2]
    after = path.modes_at(np.array([hit]))[0][1]
    jump = (system.contact @ after - path.impact_velocities[-2]) / (system.contact @ system.contact)
    row, forced = system.output("sensor"), steady(path, hit)[1]
    slow = [row[0] * rate[0] + row[1:] @ forced[1:] for rate in (after - jump * system.contact, after)]
    return float(-slow[1] / slow[0])


def test_a_motion_is_read_at_the_frequency_that_the_case_says() -> None:
    case = case_of(influence__frequency="15 Hz")
    found, _ = read(case, "apparent_restitution")
    path = vibeam.simulate(case.system("beam"), Drive(2 * np.pi * 15, case.base_amplitude), 20.0)
    assert found["apparent_restitution"] == pytest.approx(shown_by_first_mode(path), rel=5e-3)


def test_one_mode_does_not_ring_and_says_so() -> None:
    found, one = read(case_of(fidelity__beam__modes=1), "ringing", "apparent_restitution")
    assert np.isnan(found["ringing"])
    assert "nothing rings" in one.why[AskedNumber("ringing")]
    assert found["apparent_restitution"] == pytest.approx(0.72, abs=1e-6)


def test_a_motion_that_is_not_reached_from_rest_is_not_read() -> None:
    """The preloaded rig: what the sweep carries to its peak is another motion than that settled from rest."""
    case = vibeam.load(RIG.parent / "dtu_tight.toml", {"sweep.frequency.points": 31})
    _, one = read(case, "peak_frequency", "apparent_restitution")
    assert one.response is not None
    assert one.response.simulator is not None
    places = [each for several in one.response.places.values() for each in several]
    place = max(places, key=lambda each: each.amplitude)
    rest = simulated(one.response.simulator, place.frequency, None)
    assert abs(rest.amplitude / place.amplitude - 1) > 0.02
    assert "from rest another motion" in one.why[AskedNumber("apparent_restitution")]
