"""What is read off contacts that are integrated: extremes, forces and energies, against the path itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import vibeam
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

OMEGA, AMPLITUDE, SETTLE, HOLD = 95.0, 1e-4, 8, 4
LAWS = [Hertz(1e7), Hertz(1e5), HuntCrossley(1e5, 0.5), HuntCrossley(1e6, 0.5, 1.0), LinearStop(1e4, 1.0)]


def system(law: object) -> vibeam.ImpactSystem:
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
@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_extremes_are_those_of_the_path(law: object, output: str) -> None:
    """To about what the integration itself is good for; samples were off by 1e-4."""
    period = 2 * np.pi / OMEGA
    path = vibeam.simulate(system(law), vibeam.Drive(OMEGA, AMPLITUDE), (SETTLE + HOLD) * period)
    found = vibeam.sweep(system(law), omega=[OMEGA], amplitude=AMPLITUDE, settle=SETTLE, hold=HOLD, output=output)
    assert isinstance(found, vibeam.FrequencyResponse)
    swing = float(found.maximum[0] - found.minimum[0])
    span = SETTLE * period, (SETTLE + HOLD) * period
    assert found.maximum[0] == pytest.approx(largest(path, output, 1.0, *span), abs=1e-10 * swing)
    assert -found.minimum[0] == pytest.approx(largest(path, output, -1.0, *span), abs=1e-10 * swing)


@pytest.mark.parametrize("law", LAWS[:4], ids=repr)
def test_the_largest_force_is_the_law_at_its_top(law: HuntCrossley) -> None:
    path = vibeam.simulate(system(law), vibeam.Drive(OMEGA, AMPLITUDE), 0.5)
    for begin, duration, peak in path.contacts[:4]:
        times = np.linspace(begin, begin + duration, 1001)
        depth, rate = path.at(times), path.velocity_at(times)
        force = law.stiffness * np.maximum(depth, 0.0) ** law.exponent * (1 + law.damping * rate)
        assert peak == pytest.approx(float(force.max()), rel=1e-4)
        assert peak >= force.max() * (1 - 1e-12)


@pytest.mark.parametrize("law", LAWS[:4], ids=repr)
def test_energies_in_contact_are_the_means_of_the_path(law: object) -> None:
    period = 2 * np.pi / OMEGA
    path = vibeam.simulate(system(law), vibeam.Drive(OMEGA, AMPLITUDE), (SETTLE + HOLD) * period)
    found = vibeam.sweep(system(law), omega=[OMEGA], amplitude=AMPLITUDE, settle=SETTLE, hold=HOLD)
    assert isinstance(found, vibeam.FrequencyResponse)
    times = np.linspace(SETTLE * period, (SETTLE + HOLD) * period, 40_001)
    poses = path.modes_at(times)
    density = 0.5 * (poses[:, 1] ** 2 + (system(law).omega * poses[:, 0]) ** 2)
    mean = np.trapezoid(density, times, axis=0) / (HOLD * period)
    np.testing.assert_allclose(found.mode_energy[0], mean, rtol=1e-4)
