"""Resonant grazing: explicit coefficients of one mode, boundaries found by others, and what several modes change."""

from __future__ import annotations

from dataclasses import replace
from math import exp, pi, sqrt

import numpy as np
import pytest
from numpy.typing import ArrayLike

import vibeam
from vibeam.periodic.modal_sums import sums
from vibeam.periodic.resonant_grazing import _doubling, _fold, _turn

ONE = vibeam.ImpactSystem.from_modes(1.0, 0.03, 1.0, 1.0, gap=1.0, restitution=0.8)
TWO = vibeam.ImpactSystem.from_modes([1.0, 6.27], 0.02, [1.0, 0.4], [1.0, 0.3], gap=1.0, restitution=0.7)
EIGHT = vibeam.ImpactSystem.from_modes(
    np.array([1.0, 6.27, 17.5, 34.4, 56.8, 84.9, 118.6, 157.9]), 0.02, 0.5 ** np.arange(8.0), 0.4 ** np.arange(8.0),
    gap=1.0, restitution=0.75,
)  # fmt: skip
SEVERAL = pytest.mark.parametrize("system", [TWO, EIGHT], ids=["two modes", "eight modes"])


def boundary_drives(system: vibeam.ImpactSystem, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Drives B/B_g of fold and doubling (points,) at frequencies ``omega``, rad/s; NaN where no impact pushes."""
    total = sums(system, np.atleast_1d(np.asarray(omega, dtype=float)), 1)
    rows = []
    for share in (_fold, _doubling):
        numerator, denominator = share(system, total)
        q = numerator / denominator
        rows.append(np.where(q < 0, np.hypot(1 - q * total.g0, q * _turn(system, total)), np.nan))
    return rows[0], rows[1]


def coefficients(zeta: float, restitution: float, k: int) -> tuple[float, float, float]:
    """Frequency, fold's and doubling's coefficient of the mode ω = 1 in resonance ω_D T = kπ, by hand."""
    span = k * pi / sqrt(1 - zeta**2)
    e = (-1) ** k * exp(-zeta * span)
    first, second = ((1 + restitution) * e * span / ((1 - e) * (1 + sign * restitution * e)) for sign in (1, -1))
    return 2 * pi / span, -(first**2) / 2, second**2 * (1 + ((1 + restitution * e) / (1 - restitution * e)) ** 2 / 2)


def grazing(system: vibeam.ImpactSystem, omega: float) -> float:
    """Drive at which the free motion grazes, by the phasors of the modes."""
    share = omega**2 / (system.omega**2 - omega**2 + 2j * system.zeta * system.omega * omega)
    return system.gap / float(abs(system.contact @ (system.load * share)))


def monodromy(system: vibeam.ImpactSystem, omega: float, lean: float) -> np.ndarray:
    """Flight over one period after an impact with a/v = ``lean``, by matrix exponentials."""
    from scipy.linalg import expm

    n, c = system.size, system.contact
    damper = np.diag(2 * system.zeta * system.omega)
    flow = expm(np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(system.omega**2), -damper]]) * 2 * pi / omega)
    jump, s = np.eye(2 * n), (1 + system.restitution) / (c @ c)
    jump[:n, :n] -= s * np.outer(c, c)
    jump[n:, n:] -= s * np.outer(c, c)
    jump[n:, :n] += s * np.outer(damper @ c + lean * c, c)
    return np.asarray(jump @ flow)


@pytest.mark.parametrize(("zeta", "restitution"), [(0.03, 0.8), (0.1, 0.3), (0.01, 0.95)])
def test_one_mode_has_the_explicit_coefficients(zeta: float, restitution: float) -> None:
    system = vibeam.ImpactSystem.from_modes(1.0, zeta, 1.0, 1.0, gap=1.0, restitution=restitution)
    for k in range(1, 5):
        omega, fold, doubling = coefficients(zeta, restitution, k)
        found = vibeam.resonant_grazing(system, (0.98 * omega, 1.02 * omega))
        assert [each.kind for each in found] == [vibeam.Kind.FOLD, vibeam.Kind.DOUBLING]
        for each, coefficient in zip(found, (fold, doubling), strict=True):
            assert each.omega == pytest.approx(omega, rel=1e-13)
            assert each.slope == 0.0
            assert each.curvature == pytest.approx(coefficient, rel=1e-8)  # of a polynomial's second derivative


def test_both_curves_leave_the_grazing_curve_quadratically() -> None:
    """The remainder B/B_g − 1 − χ ε² is of third order: a share of 2ε of the second one's size."""
    omega, fold, doubling = coefficients(0.03, 0.8, 1)
    for row, (side, coefficient) in enumerate(((-1, fold), (1, doubling))):
        offset = side * np.array([1e-2, 1e-3, 1e-4])
        left = boundary_drives(ONE, omega + offset)[row] - 1 - coefficient * offset**2
        assert np.all(np.abs(left) < 2 * np.abs(coefficient * offset**3))


@SEVERAL
def test_both_curves_are_boundaries_found_by_bracketing(system: vibeam.ImpactSystem) -> None:
    omega, compared = 2.05, 0
    fold, doubling = (float(each[0]) for each in boundary_drives(system, omega))
    touching = grazing(system, omega)
    for kind, drive in ((vibeam.Kind.FOLD, fold), (vibeam.Kind.DOUBLING, doubling)):
        if np.isfinite(drive):
            found = vibeam.boundaries(system, (0.5 * touching, 1.5 * touching), omega, kinds=(kind,))
            assert min(abs(each.amplitude / (drive * touching) - 1) for each in found) < 1e-12
            compared += 1
    assert compared


@SEVERAL
def test_the_doubling_has_a_multiplier_of_minus_one(system: vibeam.ImpactSystem) -> None:
    (doubling,) = (each for each in vibeam.resonant_grazing(system, (1.9, 2.05)) if each.kind is vibeam.Kind.DOUBLING)
    omega = doubling.omega + 0.05 * doubling.side
    drive = float(boundary_drives(system, omega)[1][0]) * grazing(system, omega)
    orbits = vibeam.orbits(system, vibeam.Drive(omega, drive))
    off = [np.abs(each.multipliers + 1).min() for each in orbits]
    assert min(off) < 1e-9


@SEVERAL
def test_several_modes_part_the_two_and_tilt_the_doubling(system: vibeam.ImpactSystem) -> None:
    fold, doubling = vibeam.resonant_grazing(system, (1.9, 2.05))
    assert abs(fold.omega - doubling.omega) > 1e-3
    assert fold.slope == 0.0
    assert abs(doubling.slope) > 1e-3
    for each, row in ((fold, 0), (doubling, 1)):
        step = 1e-3 * each.side
        found = float(boundary_drives(system, each.omega + step)[row][0]) - 1
        assert found == pytest.approx(each.slope * step + each.curvature * step**2, rel=2e-2)


def test_light_impacts_of_several_modes_are_unstable_without_bound() -> None:
    """The largest multiplier grows like 1/v; of one mode in resonance it stays within the unit circle."""
    omega = coefficients(0.03, 0.8, 1)[0]
    lean = -np.array([1e4, 1e5, 1e6])  # a/v of ever lighter impacts; a < 0, for the contact turns back
    one = [np.abs(np.linalg.eigvals(monodromy(ONE, omega, each))).max() for each in lean]
    assert max(one) < 1
    two = [np.abs(np.linalg.eigvals(monodromy(TWO, omega, each))).max() for each in lean]
    assert two[1] / two[0] == pytest.approx(10, rel=0.02)
    assert two[2] / two[1] == pytest.approx(10, rel=0.002)
    assert min(two) > 1


def test_places_without_a_grazing_motion_are_refused() -> None:
    with pytest.raises(ValueError, match="the contact rests on the stop"):
        vibeam.resonant_grazing(replace(ONE, gap=-0.1), (1.9, 2.1))
    loose = vibeam.ImpactSystem.from_modes([0.0, 2.0], [0.0, 0.1], 1.0, 1.0, static=[0.1, 0.0], gap=0.1)
    with pytest.raises(ValueError, match="a mode without stiffness"):
        vibeam.resonant_grazing(loose, (1.9, 2.1))
