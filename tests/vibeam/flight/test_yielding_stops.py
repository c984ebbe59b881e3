"""Stops that yield: what is read off contacts, against the path itself; one just touched is an equilibrium."""

from __future__ import annotations

import numpy as np
import pytest
from apart import run_apart
from scipy.optimize import minimize_scalar

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

STILL = vibeam.Drive(2.27, 0.0)
LAWS = [Hertz(52.7), HuntCrossley(52.7, 0.1), HuntCrossley(52.7, 0.1, 1.0), LinearStop(52.7), LinearStop(52.7, 3.0)]
RIG = """
import numpy as np
import vibeam
from vibeam_models.laws.compliant import LinearStop

def rig(damping=104.26741952508146, zeta=0.017, gap=0.0):
    return vibeam.ImpactSystem.from_modes(
        [47.73307211979106, 635.0706480710485], zeta, [2.1238579795879406, 0.30991833180957423],
        [0.462867542714578, 0.09066548216204676], gap=gap, law=LinearStop(1e6, damping),
    )

def ends(given):
    for omega in 2 * np.pi * np.array([14.0, 15.5]):
        for amplitude in (8.660311939459456e-05, 0.0):
            for end in (1e-6, 0.01):
                yield vibeam.simulate(rig(**given), vibeam.Drive(omega, amplitude), end).ended.name
            found = vibeam.sweep(rig(**given), omega=[omega], amplitude=amplitude, settle=3, hold=2)
            yield vibeam.Ended.of_code(found.ended[0]).name

for given in (
    {}, {"zeta": [0.017000000000000043, 0.016999999999999436]}, {"damping": 104.0}, {"damping": 1.0},
    {"damping": 0.0}, {"gap": 1e-5}, {"gap": -1e-5},
):
    print(*ends(given), given if set(ends(given)) != {"COMPLETE"} else "")
"""


def test_a_drive_sets_in_at_equilibrium_on_a_linear_stop() -> None:
    """The acceleration away from the stop is zero at the start; what round-off makes of it is no flight."""
    assert set(run_apart(RIG).split()) == {"COMPLETE"}


def touching(law: object, static: float, gap: float) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [1.0, 1.2], 0.05, [1.0, 0.4], [1.0, 0.3], gap=gap, law=law, static=[static, 0.0]
    )


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("static", [0.0, 1e-9, 1e-3, 0.3])
def test_equilibrium_stays(law: object, static: float) -> None:
    """Just touching, or pressed in by a static force."""
    path = vibeam.simulate(touching(law, static, 0.0), STILL, 10.0, max_impacts=20_000)
    assert path.outcome is vibeam.Outcome["SETTLED_ON_STOP" if static else "SETTLED"]
    assert path.stats["impacts"] == 0


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("digits", [-2, -1, 0, 1, 2])
def test_a_gap_that_the_static_displacement_closes_to_the_last_digits(law: object, digits: int) -> None:
    place = 0.3 / 1.0**2
    system = touching(law, 0.3, place + digits * np.spacing(place))
    path = vibeam.simulate(system, STILL, 10.0, max_impacts=20_000)
    assert path.outcome in (vibeam.Outcome.SETTLED, vibeam.Outcome.SETTLED_ON_STOP)
    assert path.stats["impacts"] <= 1


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("static", [0.0, 0.3])
def test_a_motion_that_dies_out_on_the_stop_settles(law: object, static: float) -> None:
    """Thrown off, it comes to rest where the forces balance."""
    system = touching(law, static, 0.0)
    thrown = vibeam.State(np.array([-0.1, 0.0]), np.array([0.0, 0.05]))
    path = vibeam.simulate(system, STILL, 900.0, thrown, max_impacts=20_000)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.outcome is vibeam.Outcome["SETTLED_ON_STOP" if static else "SETTLED"] or static == 0.0
    np.testing.assert_allclose(path.state.displacement, equilibrium(system).displacement, atol=1e-12)


def test_a_stop_with_much_damping_pushes_again_while_it_is_still_penetrated() -> None:
    """Let go at k d + b d' = 0, the contact goes deeper once more before it is out: there is no pull, and no free fall.

    Where the modes are off the stop by the solver, the law's own formula must give no force.
    """
    law = LinearStop(30.0, 40.0)
    system = vibeam.ImpactSystem.from_modes([1.0, 9.0], 0.01, [1.0, 0.9], [1.0, 0.3], gap=0.0, law=law)
    path = vibeam.simulate(system, vibeam.Drive(1.9, 1.0), 60.0)
    trace = path.segments.trace
    for start, duration in trace[(trace[:, layout.WHAT] == layout.FREE) & (trace[:, layout.DURATION] > 0)][
        :, [layout.START, layout.DURATION]
    ]:
        modes = path.modes_at(start + duration * np.linspace(0.01, 0.99, 99))
        deep, rate = modes[:, 0] @ system.contact - system.gap, modes[:, 1] @ system.contact
        assert not np.any((deep > 1e-9) & (law.stiffness * deep + law.damping * rate > 1e-9))
    again = (trace[1:, layout.WHAT] == regime_layout.CONTACT) & (trace[:-1, layout.END] == regime_layout.PASS)
    assert np.sum(again & (trace[1:, layout.DURATION] > 0)) > 0


# ------------------------------------------------------------------------------------------------ what is read off

OMEGA, AMPLITUDE, SETTLE, HOLD = 95.0, 1e-4, 8, 4
INTEGRATED = [Hertz(1e7), Hertz(1e5), HuntCrossley(1e5, 0.5), HuntCrossley(1e6, 0.5, 1.0), LinearStop(1e4, 1.0)]


def three_modes(law: object) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [47.7, 635.0, 1800.0], 0.017, [2.12, 0.31, -1.5], [0.46, 0.09, 0.3], law=law,
        outputs={"sensor": [1.0, -0.7, 2.0]},
    )  # fmt: skip


def largest(path: vibeam.Trajectory, output: str, sign: float, begin: float, end: float) -> float:
    """The maximum of sign · output on [begin, end]: the best of many samples, refined between its neighbours."""
    times = np.linspace(begin, end, 10_001)
    values = sign * path.at(times, output)
    best = float(values.max())
    for i in np.flatnonzero(values >= best - 1e-3 * np.ptp(values)):
        low, high = times[max(i - 1, 0)], times[min(i + 1, len(times) - 1)]
        found = minimize_scalar(
            lambda t: -sign * float(path.at(t, output)), bounds=(low, high), method="bounded", options={"xatol": 1e-12}
        )
        best = max(best, -float(found.fun))
    return best


@pytest.mark.parametrize("output", ["contact", "sensor"])
@pytest.mark.parametrize("law", INTEGRATED, ids=repr)
def test_extremes_are_those_of_the_path(law: object, output: str) -> None:
    """To about what the integration itself is good for; samples were off by 1e-4."""
    period = 2 * np.pi / OMEGA
    path = vibeam.simulate(three_modes(law), vibeam.Drive(OMEGA, AMPLITUDE), (SETTLE + HOLD) * period)
    found = vibeam.sweep(three_modes(law), omega=[OMEGA], amplitude=AMPLITUDE, settle=SETTLE, hold=HOLD, output=output)
    assert isinstance(found, vibeam.FrequencyResponse)
    swing = float(found.maximum[0] - found.minimum[0])
    span = SETTLE * period, (SETTLE + HOLD) * period
    assert found.maximum[0] == pytest.approx(largest(path, output, 1.0, *span), abs=1e-10 * swing)
    assert -found.minimum[0] == pytest.approx(largest(path, output, -1.0, *span), abs=1e-10 * swing)


@pytest.mark.parametrize("law", INTEGRATED[:4], ids=repr)
def test_the_largest_force_is_the_law_at_its_top(law: HuntCrossley) -> None:
    path = vibeam.simulate(three_modes(law), vibeam.Drive(OMEGA, AMPLITUDE), 0.5)
    for begin, duration, peak in path.contacts[:4]:
        times = np.linspace(begin, begin + duration, 1001)
        depth, rate = path.at(times), path.velocity_at(times)
        force = law.stiffness * np.maximum(depth, 0.0) ** law.exponent * (1 + law.damping * rate)
        assert peak == pytest.approx(float(force.max()), rel=1e-4)
        assert peak >= force.max() * (1 - 1e-12)


@pytest.mark.parametrize("law", INTEGRATED[:4], ids=repr)
def test_energies_in_contact_are_the_means_of_the_path(law: object) -> None:
    period = 2 * np.pi / OMEGA
    path = vibeam.simulate(three_modes(law), vibeam.Drive(OMEGA, AMPLITUDE), (SETTLE + HOLD) * period)
    found = vibeam.sweep(three_modes(law), omega=[OMEGA], amplitude=AMPLITUDE, settle=SETTLE, hold=HOLD)
    assert isinstance(found, vibeam.FrequencyResponse)
    times = np.linspace(SETTLE * period, (SETTLE + HOLD) * period, 40_001)
    poses = path.modes_at(times)
    density = 0.5 * (poses[:, 1] ** 2 + (three_modes(law).omega * poses[:, 0]) ** 2)
    mean = np.trapezoid(density, times, axis=0) / (HOLD * period)
    np.testing.assert_allclose(found.mode_energy[0], mean, rtol=1e-4)
