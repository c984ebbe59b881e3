"""A finite-element beam with all of its four hundred modes, up to ten million times as stiff as the first."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np
import pytest
from mpmath import mpf

import vibeam
from vibeam.flight.trajectory import Trajectory
from vibeam_models.beam import assemble

pytestmark = pytest.mark.slow  # half a minute

CASE = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"
MODES = 400


def full(gap: float, restitution: float) -> vibeam.ImpactSystem:
    case = vibeam.load(CASE, set={"beam.elements": 230})
    system = vibeam.ImpactSystem.from_structure(assemble(case.scene), gap=gap, restitution=restitution)
    return replace(system, outputs={}, zeta=np.minimum(system.zeta, 0.05))


@pytest.fixture(scope="module")
def beam() -> vibeam.ImpactSystem:
    return full(1e-5, 0.7)


DRIVE = vibeam.Drive(2 * np.pi * 15.3, 3e-4)


@pytest.fixture(scope="module")
def path(beam: vibeam.ImpactSystem) -> Trajectory:
    return vibeam.simulate(beam, DRIVE, 0.12, max_impacts=60)


def exact_at(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, pose: np.ndarray, begin: float, t: float
) -> tuple[mpf, mpf]:
    """Contact displacement and velocity at t of the free flight from ``pose`` at ``begin``: closed form, 40 digits."""
    W, u, rate = mpf(drive.omega), mpf(0), mpf(0)
    for w, z, c, load, static, x, v in zip(
        *(getattr(system, name) for name in ("omega", "zeta", "contact", "load", "static")), *pose, strict=True
    ):
        w, z, force = mpf(float(w)), mpf(float(z)), mpf(float(load)) * W**2 * mpf(drive.amplitude)
        answer = force / (w * w - W * W + 2j * z * w * W)
        first, last = answer * mpmath.expj(W * mpf(begin)), answer * mpmath.expj(W * mpf(t))
        still = mpf(float(static)) / w**2
        x0 = mpf(float(x)) - still - first.imag
        v0 = mpf(float(v)) - W * first.real
        own, s = w * mpmath.sqrt(1 - z * z), mpf(t) - mpf(begin)
        decay, cos, sin = mpmath.exp(-z * w * s), mpmath.cos(own * s), mpmath.sin(own * s)
        u += mpf(float(c)) * (decay * (x0 * cos + (v0 + z * w * x0) / own * sin) + still + last.imag)
        rate += mpf(float(c)) * (decay * (v0 * cos - (w * w * x0 + z * w * v0) / own * sin) + W * last.real)
    return u, rate


def test_the_beam_is_what_it_should_be(beam: vibeam.ImpactSystem) -> None:
    assert beam.size >= MODES
    assert beam.omega.max() > 1e5 * beam.omega.min()


def test_it_strikes_where_the_closed_form_says(beam: vibeam.ImpactSystem, path: Trajectory) -> None:
    """Each flight from the state that the path has just after the impact before it, in 40 digits."""
    hits, speeds = path.impact_times, path.impact_velocities
    assert len(hits) > 5
    strong = [k for k in range(1, len(hits)) if speeds[k] > 1e-3 * speeds.max() and hits[k] > hits[k - 1]][:6]
    with mpmath.workdps(40):
        for k in strong:
            pose = path.modes_at(hits[k - 1])
            u, rate = exact_at(beam, DRIVE, pose, float(hits[k - 1]), float(hits[k]))
            size = np.abs(pose[0] * beam.contact).sum()
            ringing = np.abs(pose[1] * beam.contact).sum() * hits[k] * 4e-16  # the time of the pose is rounded
            assert abs(float(u) - beam.gap) < 1e-12 * size + 1e-12 * beam.gap + ringing
            assert float(rate) == pytest.approx(speeds[k], rel=1e-7)


def test_no_contact_is_passed_over(beam: vibeam.ImpactSystem, path: Trajectory) -> None:
    """Sampled, and most closely just after impacts, where the fast modes ring."""
    times = np.linspace(0, path.t_end, 4001)
    times = np.concatenate([times, (path.impact_times[:10, None] + np.geomspace(1e-9, 1e-4, 30)).ravel()])
    times = np.unique(times[times < path.t_end])
    contact = np.concatenate([path.at(part) for part in np.array_split(times, 20)])
    assert contact.max() <= beam.gap + 1e-14


def test_the_first_contact_is_that_of_the_free_beam(beam: vibeam.ImpactSystem, path: Trajectory) -> None:
    """Before it, the motion from rest in 40 digits stays below the gap; at it, it is there."""
    rest = np.zeros((2, beam.size))
    first = float(path.impact_times[0])
    with mpmath.workdps(40):
        u, rate = exact_at(beam, DRIVE, rest, 0.0, first)
        before = [exact_at(beam, DRIVE, rest, 0.0, float(t))[0] for t in np.linspace(0, first, 12)[:-1]]
    assert float(u) == pytest.approx(beam.gap, abs=1e-16)
    assert float(rate) == pytest.approx(path.impact_velocities[0], rel=1e-9)
    assert max(before) < beam.gap


def test_impacts_take_the_contact_energy(beam: vibeam.ImpactSystem, path: Trajectory) -> None:
    """½(1 − R²)v²/S at each impact, to round-off of the modes' energies just before and after."""
    k = int(np.argmax(path.impact_velocities))
    t, speed = path.impact_times[k], path.impact_velocities[k]
    after = path.modes_at(t)
    S = beam.contact @ beam.contact
    before = after[1] + beam.contact * (1 + beam.restitution) * speed / S
    assert beam.contact @ before == pytest.approx(speed, rel=1e-9)
    assert beam.contact @ after[1] == pytest.approx(-beam.restitution * speed, rel=1e-9)
    lost = (before @ before - after[1] @ after[1]) / 2
    assert lost == pytest.approx((1 - beam.restitution**2) * speed**2 / (2 * S), rel=1e-9)


def test_splitting_and_turned_modes_change_nothing(beam: vibeam.ImpactSystem, path: Trajectory) -> None:
    cut = float(path.impact_times[:2].mean())
    first = vibeam.simulate(beam, DRIVE, cut)
    second = vibeam.simulate(beam, DRIVE, path.impact_times[2] + 1e-9, first.state, t_start=cut)
    hits = np.concatenate([first.impact_times, second.impact_times])
    np.testing.assert_allclose(hits[:3], path.impact_times[:3], rtol=1e-10)
    order = np.random.default_rng(0).permutation(beam.size)
    rows = {name: getattr(beam, name)[order] for name in ("omega", "zeta", "contact", "load", "static")}
    other = vibeam.simulate(replace(beam, **rows), DRIVE, path.impact_times[2] + 1e-9)
    np.testing.assert_allclose(other.impact_times[:3], path.impact_times[:3], rtol=1e-10)
