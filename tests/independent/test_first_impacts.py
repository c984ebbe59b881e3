"""First impacts under shocks in closed form, against the second program and the flight; sampled sines against sines."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from loaded import Flight, Loaded, Stop
from mpmath import mpf
from shock import first_impact, first_impact_half_sine, first_impact_saw_tooth, half_sine, saw_tooth

import vibeam

PEAK, DURATION = mpf(490), mpf("0.011")  # 50 g, 11 ms
SHOCKS = [(w, z, g) for w in (80, 400, 1500) for z in ("0", "0.05", "0.3") for g in ("0.2", "0.9")]


@pytest.fixture(autouse=True)
def _enough_digits():
    with mpmath.workdps(40):
        yield


def reached(response, omega):
    """Largest x, roughly."""
    end = float(DURATION + 8 / mpf(omega))
    return max(response(mpf(t)) for t in np.linspace(0.0, end, 400).tolist()), mpf(end)


def device(omega, zeta, gap):
    """One mode that the base's acceleration pushes toward its stop."""
    return vibeam.ImpactSystem.from_modes(float(omega), float(zeta), 1.0, -1.0, gap=float(gap), restitution=0.6)


@pytest.mark.parametrize(("omega", "zeta", "share"), SHOCKS)
@pytest.mark.parametrize("shape", ["half_sine", "saw_tooth"])
def test_the_flight_meets_its_stop_when_the_closed_form_says(shape, omega, zeta, share):
    """To 1e-12 of the peak, which is what the pieces of a half-sine leave; a saw-tooth is exact."""
    function = {"half_sine": half_sine, "saw_tooth": saw_tooth}[shape]
    most, end = reached(lambda t: function(mpf(omega), mpf(float(zeta)), PEAK, DURATION, t), omega)
    gap = float(mpf(share) * most)
    duration = mpf(float(DURATION))
    truth = first_impact(lambda t: function(mpf(omega), mpf(float(zeta)), PEAK, duration, t), mpf(gap), end)
    record = getattr(vibeam.Record, shape)(float(PEAK), float(DURATION))
    path = vibeam.simulate(device(omega, zeta, gap), record, float(end) * 1.1)
    assert path.impact_times[0] == pytest.approx(float(truth), rel=2e-12)


@pytest.mark.parametrize("gap", ["1e-6", "1e-4", "2e-3"])
def test_a_saw_tooth_without_damping_is_keplers_equation(gap):
    truth = first_impact_saw_tooth(mpf(200), PEAK, DURATION, mpf(gap))
    assert truth < DURATION
    assert (
        abs(first_impact(lambda t: saw_tooth(mpf(200), mpf(0), PEAK, DURATION, t), mpf(gap), DURATION) - truth)
        < mpf(10) ** -30
    )
    system = Loaded([200], [[0]], [1], [0], [Stop([1], mpf(gap), 1)], [0, DURATION], [[0, PEAK / DURATION, 0, 0]])
    assert abs(Flight(system, [0], [0]).run(truth * 1.01).events[0].time - truth) < mpf(10) ** -30
    path = vibeam.simulate(device(200, 0, gap), vibeam.Record.saw_tooth(490.0, 0.011), 0.02)
    assert path.impact_times[0] == pytest.approx(float(truth), rel=1e-14 if gap != "1e-6" else 1e-13)


@pytest.mark.parametrize("omega", [20, 60, 120])
def test_a_half_sine_without_damping_leaves_an_arcsine(omega):
    """A stop at 0.95 of what is left after a pulse that does not reach it: a blow on a soft mode."""
    omega, beta = mpf(omega), mpmath.pi / (omega * DURATION)
    left = abs(PEAK * 2 * beta * mpmath.cos(omega * DURATION / 2) / (omega**2 * (beta**2 - 1)))
    gap = mpf(float(left * mpf("0.95")))
    assert max(half_sine(omega, mpf(0), PEAK, DURATION, DURATION * k / 500) for k in range(501)) < gap
    truth = first_impact_half_sine(omega, PEAK, DURATION, gap)
    path = vibeam.simulate(device(omega, 0, gap), vibeam.Record.half_sine(490.0, 0.011), 0.2)
    assert path.impact_times[0] == pytest.approx(float(truth), rel=1e-11)


@pytest.mark.parametrize(("interpolation", "order"), [("linear", 2), ("cubic", 4)])
def test_a_sampled_sine_converges_at_the_interpolations_order(interpolation, order):
    """Last impact and state after two seconds, against the sine's own flight in closed form."""
    system = vibeam.ImpactSystem.from_modes([47.0, 290.0], 0.02, [1.6, -0.9], [1.0, 0.4], gap=1e-3, restitution=0.7)
    drive, start = vibeam.Drive(60.0, 1e-3), vibeam.State(np.zeros(2), np.zeros(2))
    true = vibeam.simulate(system, drive, 2.0, start)
    errors = []
    for rate in (1000, 2000, 4000):
        times = np.arange(2 * rate + 1) / rate
        values = -(60.0**2) * 1e-3 * np.sin(60.0 * times)
        record = vibeam.Record.sampled(values, rate=rate, interpolation=interpolation)
        path = vibeam.simulate(system, record, 2.0, start)
        assert len(path.impact_times) == len(true.impact_times) > 10
        errors.append(float(np.abs(path.impact_times - true.impact_times).max()))
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    assert found == pytest.approx(order, abs=0.25)
