"""Exact derivatives of periodic motions against differences of solutions in 40 digits."""

from __future__ import annotations

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest

from vibeam.observe.measuring_chain import LowPass, filtered
from vibeam.periodic.orbit_derivatives import struck
from vibeam.periodic.output_signals import QUANTITIES, OrbitOutput, of_orbits, without_contact
from vibeam.periodic.tangents import ModalData, Tangents

OMEGA = np.array([95.0])
DATA = ModalData(
    omega=np.array([47.7, 635.0]), sigma=np.array([0.85, 10.8]), contact=np.array([2.12, 0.31]),
    load=np.array([0.46, 0.09]), static=np.array([0.02, 0.01]), row=np.array([1.36, 4.1]), gap=2e-5, restitution=0.72,
    drive=np.array([8.66e-5]),
)  # fmt: skip
STEP = mp.mpf("1e-12")  # relative


def _parts(packed):
    """Members of ``ModalData`` from a packed row of two modes."""
    rows = [packed[2 * k : 2 * k + 2] for k in range(6)]
    return (*rows, packed[12], packed[13], packed[14])


def _motion(packed, guess):
    """Displacement of a row over time after the impact, span, impulse: Newton's method in 40 digits."""
    omega, sigma, contact, load, static, _, gap, restitution, drive = _parts(packed)
    w, span = mp.mpf(95), 2 * mp.pi / 95
    damped = [mp.sqrt(a**2 - s**2) for a, s in zip(omega, sigma, strict=True)]
    poles = [mp.mpc(-s, d) for s, d in zip(sigma, damped, strict=True)]

    def green(i, t, order):
        return mp.im(poles[i] ** order * mp.exp(poles[i] * t) / (1 - mp.exp(poles[i] * span))) / damped[i]

    def forced(i, phase, order):
        share = drive * load[i] * w**2 / (omega[i] ** 2 - w**2 + 2j * sigma[i] * w)
        return mp.im((1j * w) ** order * share * mp.exp(1j * phase))

    def mode(i, phase, impulse, t, order):
        still = static[i] / omega[i] ** 2 if order == 0 else 0
        return still + forced(i, phase + w * t, order) + impulse * contact[i] * green(i, t, order)

    def equations(phase, impulse):
        at = mp.fsum(contact[i] * mode(i, phase, impulse, 0, 0) for i in (0, 1)) - gap
        after = mp.fsum(contact[i] * mode(i, phase, impulse, 0, 1) for i in (0, 1))
        before = mp.fsum(contact[i] * mode(i, phase, impulse, span, 1) for i in (0, 1))
        return [at, after + restitution * before]

    phase, impulse = mp.findroot(equations, guess, tol=1e-60)
    return lambda of, t, order: mp.fsum(of[i] * mode(i, phase, impulse, t, order) for i in (0, 1)), span, impulse


def _extreme(at, of, span, sign):
    """Extreme by all zeros of the velocity between 600 samples, and the impact itself."""
    times = [span * k / 600 for k in range(601)]
    slopes = [at(of, t, 1) for t in times]
    found = [at(of, mp.mpf(0), 0)]
    for (a, b), (s, e) in zip(pairwise(times), pairwise(slopes), strict=True):
        if s * e < 0:
            found.append(at(of, mp.findroot(lambda t: at(of, t, 1), (a, b), solver="anderson", tol=1e-50), 0))
    return max(found) if sign > 0 else min(found)


@pytest.fixture(scope="module")
def exact():
    """Derivatives of phase-free quantities by every member, by differences in 40 digits."""
    with mp.workdps(40):
        base = [mp.mpf(float(each)) for each in DATA.packed()]
        start = struck(DATA, _units(), OMEGA, np.ones(1), 0)
        guess = (mp.mpf(float(start.phase[0])), mp.mpf(float(start.impulse[0])))
        places = {}

        def quantities(packed):
            at, span, impulse = _motion(packed, guess)
            contact, row, restitution = packed[4:6], packed[10:12], packed[13]
            if not places:  # where the extremes are, in the middle
                for name, of, sign in (("high", row, 1), ("low", row, -1), ("reach", contact, -1)):
                    best = _extreme(at, of, span, sign)
                    places[name] = min(
                        (t for t in _zeros(at, of, span)), key=lambda t, of=of, best=best: abs(at(of, t, 0) - best)
                    )
            found = {}
            for name, of in (("high", row), ("low", row), ("reach", contact)):
                t = (
                    mp.mpf(0)
                    if places[name] == 0
                    else mp.findroot(lambda t, of=of: at(of, t, 1), places[name], tol=1e-50)
                )
                found[name] = at(of, t, 0)
            mobility = contact[0] ** 2 + contact[1] ** 2
            return [
                (found["high"] - found["low"]) / 2, found["high"], found["low"], packed[12] - found["reach"],
                -impulse * mobility / (1 + restitution),
            ]  # fmt: skip

        values, slopes = quantities(base), []
        for k, each in enumerate(base):
            step = STEP * max(abs(each), mp.mpf("1e-3"))
            up, down = ([*base[:k], each + sign * step, *base[k + 1 :]] for sign in (1, -1))
            pairs = zip(quantities(up), quantities(down), strict=True)
            slopes.append([float((a - b) / (2 * step)) for a, b in pairs])
        return [float(each) for each in values], np.array(slopes)


def _zeros(at, of, span):
    times = [span * k / 400 for k in range(401)]
    slopes = [at(of, t, 1) for t in times]
    yield mp.mpf(0)
    for (a, b), (s, e) in zip(pairwise(times), pairwise(slopes), strict=True):
        if s * e < 0:
            yield mp.findroot(lambda t: at(of, t, 1), (a, b), solver="anderson", tol=1e-50)


def _units() -> Tangents:
    return Tangents.unpacked(np.eye(len(DATA.packed())), 2)


@pytest.mark.parametrize("number", range(len(QUANTITIES)), ids=QUANTITIES)
def test_values_and_derivatives_are_those_of_forty_digits(exact, number):
    """Every quantity by every member of the modal data: 1e-12 in value, 1e-8 in derivative."""
    found = of_orbits(DATA, _units(), OMEGA, 1, 0, QUANTITIES[number])
    values, slopes = exact
    assert found.value[0] == pytest.approx(values[number], rel=1e-12)
    assert found.by[:, 0] == pytest.approx(slopes[:, number], rel=1e-8, abs=1e-8 * abs(values[number]))
    assert found.beyond[0] == 0


@pytest.mark.parametrize("family", ["bessel", "butterworth"])
def test_a_filtered_motion_is_that_of_the_filter_in_time(family):
    """Harmonics behind the filter, against the causal filter run over thirty periods of samples."""
    low_pass = LowPass(family, 4, 200.0)
    span, count = 2 * np.pi / OMEGA[0], 3000
    found = struck(DATA, _units(), OMEGA, np.ones(1), 0)
    plain = OrbitOutput(DATA, _units(), DATA.row, np.zeros((15, 2)), OMEGA, 1, found, None)
    once = plain.samples(count)[0, :-1]
    seen = filtered(low_pass, np.tile(once, 30), span / count)[-count:]
    assert of_orbits(DATA, _units(), OMEGA, 1, 0, "maximum", low_pass.response).value[0] == pytest.approx(
        seen.max(), abs=1e-5 * np.ptp(seen)
    )
    assert of_orbits(DATA, _units(), OMEGA, 1, 0, "minimum", low_pass.response).value[0] == pytest.approx(
        seen.min(), abs=1e-5 * np.ptp(seen)
    )


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_derivatives_behind_a_filter_are_those_of_the_values(quantity):
    """By every member of the modal data, against differences of fourth order."""
    gain = LowPass("bessel", 4, 200.0).response
    found = of_orbits(DATA, _units(), OMEGA, 1, 0, quantity, gain)
    base = DATA.packed()
    for k, each in enumerate(base):
        step = 1e-4 * max(abs(each), 1e-6)
        values = []
        for share in (1, -1, 2, -2):
            moved = base.copy()
            moved[k] += share * step
            own = ModalData(*_parts(moved)[:8], moved[14:])
            values.append(of_orbits(own, _units(), OMEGA, 1, 0, quantity, gain).value[0])
        slope = (8 * (values[0] - values[1]) - (values[2] - values[3])) / (12 * step)
        assert found.by[k, 0] == pytest.approx(slope, rel=1e-6, abs=1e-6 * abs(found.value[0]) / max(abs(each), 1e-3))


def test_beyond_a_fold_the_motion_at_the_least_drive_stands_in():
    """ln(B*/B) > 0 there, and at B* the continued motion is the fold: both roots are one."""
    from dataclasses import replace

    gapped = replace(DATA, gap=-2e-3)
    found = struck(gapped, _units(), np.array([110.0]), np.ones(1), 0)
    assert found.beyond[0] > 0
    raised = replace(gapped, drive=gapped.drive * np.exp(found.beyond[0]) * (1 + 1e-12))
    both = [struck(raised, _units(), np.array([110.0]), np.ones(1), root) for root in (0, 1)]
    assert both[0].beyond[0] == both[1].beyond[0] == 0
    assert both[0].impulse[0] == pytest.approx(found.impulse[0], rel=1e-5)
    assert both[1].impulse[0] == pytest.approx(found.impulse[0], rel=1e-5)
    assert found.by_beyond[14, 0] == pytest.approx(-1 / gapped.drive[0])


def test_without_contact_the_response_is_linear():
    """Amplitude in proportion to the drive; no contact only where the gap is larger than the motion."""
    found = without_contact(DATA, _units(), OMEGA, "amplitude")
    assert found.by[14, 0] == pytest.approx(found.value[0] / DATA.drive[0])
    assert found.beyond[0] > 0
