"""What is read off a motion: energies that balance, accelerations of the equations of motion, samples and spectra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.runs.transient.energies import energy_balance
from vibeam.runs.transient.reading import reading_of
from vibeam.runs.transient.samples import samples_of
from vibeam.runs.transient.signals import FORCE, TransientSignal, accelerations, with_signals
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

OMEGA, BASE, SPAN = 95.0, 1e-4, 3.0
SYSTEM = vibeam.ImpactSystem.from_modes(
    [60.0, 400.0, 1100.0], 0.01, [1.0, -1.0, 0.9], [1.0, 0.4, 0.2], gap=1e-4, restitution=0.7,
    static=[0.1, 0.0, 0.0], outputs={"sensor": [1.0, 1.0, 1.0]},
)  # fmt: skip
SIGNALS = (
    TransientSignal("sensor", "sensor", 0, "m"),
    TransientSignal("sensor_velocity", "sensor", 1, "m s-1"),
    TransientSignal("sensor_acceleration", "sensor", 2, "m s-2"),
)
KINDS = {
    "hard": SYSTEM,
    "two sides": replace(SYSTEM, second_gap=3e-4),
    "linear": replace(SYSTEM, law=LinearStop(1e5, 20.0)),
    "Hunt–Crossley": replace(SYSTEM, law=HuntCrossley(1e7, 1e5, 1.5)),
    "coupled": replace(SYSTEM, coupling=np.diag([1.2, 8.0, 22.0]) + 0.4),
    "several": replace(SYSTEM, further=(vibeam.Contact([-1.0, 0.5, 0.2], gap=2e-4, restitution=0.5),)),
}


def moved(system: vibeam.ImpactSystem) -> tuple[vibeam.Trajectory, vibeam.Record]:
    """A motion under a sine as a record."""
    record = vibeam.Record.sine(-(OMEGA**2) * BASE, OMEGA / (2 * np.pi), SPAN)
    return vibeam.simulate(with_signals(system, SIGNALS), record, SPAN), record


@pytest.mark.parametrize("kind", KINDS)
def test_the_energy_balances(kind: str) -> None:
    """To 1e-7, the quadrature's; integrated contacts to 1e-4, the ends of whose force Gauss' rule meets less well."""
    path, record = moved(KINDS[kind])
    found = energy_balance(path, record)
    assert len(path.impact_times) > 20
    assert found.work.sum() > 0.01
    assert found.residual < (1e-4 if kind == "Hunt–Crossley" else 1e-7)
    assert np.all(found.damping > 0)
    assert np.all(found.left >= 0)
    assert found.lost.sum() > 0


def test_a_wrong_load_opens_the_balance() -> None:
    path, record = moved(SYSTEM)
    assert energy_balance(path, record.scaled(level=1.01)).residual > 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_accelerations_are_those_of_the_exact_path(kind: str) -> None:
    """To 1e-9 of the largest, in flight, in contact, at rest: the path knows them by another way, regime by regime."""
    path, record = moved(KINDS[kind])
    times = np.linspace(0.01, SPAN - 1e-6, 4001)  # before the load ends
    found = accelerations(path, record, times, path.modes_at(times)) @ path.system.output("sensor")
    exact = path.at(times, "sensor_acceleration")
    assert np.max(np.abs(found - exact)) < 1e-9 * np.max(np.abs(exact))


def test_impacts_count_on_both_sides() -> None:
    """Without any mode but one, under no load: falls onto the stop at 1 m/s and leaves at −0.5 m/s."""
    ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 0.0, static=1.0, restitution=0.5, outputs={"sensor": [1.0]})
    record = vibeam.Record([0.0, 1.9], [[0.0, 0.0, 0.0, 0.0]])
    path = vibeam.simulate(with_signals(ball, SIGNALS), record, 1.9, vibeam.State([-0.5], [0.0]))
    found = reading_of(path, record, SIGNALS, 0.0, bins=64)
    assert found["greatest"].tolist() == pytest.approx([0.0, 1.0, 1.0], abs=1e-12)
    assert found["least"].tolist() == pytest.approx([-0.5, -0.5, 1.0], abs=1e-12)
    assert found["greatest_time"][1] == pytest.approx(1.0, rel=1e-14)
    assert found["impact_times"].tolist() == pytest.approx([1.0], rel=1e-14)
    assert found["outline_greatest"][1].max() == pytest.approx(1.0, rel=1e-7)
    assert found["history_least"][1].min() == pytest.approx(-0.5, rel=1e-7)
    assert float(found["residual"]) < 1e-14
    assert found["lost"].sum() == pytest.approx(0.375, rel=1e-12)


def test_a_spectrum_holds_the_mean_square() -> None:
    """Its integral is the variance (Parseval) to a few per cent: the windows weigh the samples."""
    path, record = moved(SYSTEM)
    samples = samples_of(path, record, SIGNALS, 10)
    frequency, density = samples.spectrum()
    mean, rms = samples.moments()
    edges = np.sqrt(frequency[1:] * frequency[:-1])
    integral = np.sum(density[:, 1:-1] * np.diff(edges), axis=1)
    assert integral == pytest.approx(rms**2 - mean**2, rel=0.2)
    assert frequency[density[0].argmax()] == pytest.approx(OMEGA / (2 * np.pi), rel=0.15)


def test_a_stop_that_yields_has_a_force() -> None:
    path, record = moved(KINDS["linear"])
    found = reading_of(path, record, (*SIGNALS, TransientSignal(FORCE, "contact", -1, "N")), 0.0)
    assert found["greatest"][3] == path.contacts[:, 2].max()
    assert found["least"][3] == pytest.approx(0.0, abs=1e-15 * found["greatest"][3])  # k d + c d′ where contact ends
