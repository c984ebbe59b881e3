"""Branches of periodic motions: against closed forms of plain systems, an independent program, published numbers."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, pi

import mpmath as mp
import numpy as np
import pytest

import vibeam
from tests.independent import cavity
from vibeam import Kind
from vibeam.periodic.grazing import Window, apart
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

COCO = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=1.0, restitution=0.8)
ONE = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
SEEDS = (14, 17, 92, 128, 235, 363)  # of random rigs: every kind of boundary is among them
BILINEAR = vibeam.ImpactSystem.from_modes(1.0, 0.03, 1.0, 1.0, gap=0.5, law=LinearStop(3.0))


def settled(system: vibeam.ImpactSystem, drive: vibeam.Drive, periods: int = 1) -> vibeam.Orbit:
    begin = 600 * 2 * pi / drive.omega
    state = vibeam.simulate(system, drive, begin).state
    return vibeam.orbits(system, drive, periods, start=state)[0]


def random_rig(seed: int) -> tuple[vibeam.ImpactSystem, vibeam.Orbit, str, float] | None:
    """A plain system of 1 to 6 modes with a motion, and the parameter it is followed along, and to where."""
    rng = np.random.default_rng([seed, 31])
    n = int(rng.integers(1, 7))
    modes, place = np.arange(1, n + 1), np.abs(rng.normal(size=(2, n)))
    system = vibeam.ImpactSystem.from_modes(
        np.cumsum(rng.uniform(0.7, 4, n)), rng.uniform(0.005, 0.08, n), place[0] / modes, place[1] / modes**2,
        gap=rng.uniform(-0.1, 0.6), restitution=rng.uniform(0.4, 0.95),
    )  # fmt: skip
    drive = vibeam.Drive(rng.uniform(0.5, 3), rng.uniform(0.1, 0.6))
    found = [orbit for orbit in vibeam.orbits(system, drive, int(rng.integers(1, 3))) if orbit.admissible]
    name = ("omega", "amplitude", "gap")[int(rng.integers(3))]
    value = {"omega": drive.omega, "amplitude": drive.amplitude, "gap": system.gap}[name]
    to = value + rng.choice([-0.5, 0.5]) if name == "gap" else value * rng.choice([0.6, 1.6])
    return (system, found[0], name, float(to)) if found else None


def test_boundaries_of_plain_systems_are_those_of_closed_forms() -> None:
    """Of each kind at least one, each to 1e-11 of its value."""
    seen = dict.fromkeys((Kind.FOLD, Kind.DOUBLING, Kind.NEIMARK_SACKER, Kind.GRAZING, Kind.TOUCHING), 0)
    for seed in SEEDS:
        rig = random_rig(seed)
        assert rig is not None
        system, orbit, name, to = rig
        branch = vibeam.follow(orbit, name, to)
        assert branch.end in (vibeam.BranchEnd.REACHED, vibeam.BranchEnd.RETURNED, vibeam.BranchEnd.GRAZING)
        own = {"omega": orbit.drive.omega, "amplitude": orbit.drive.amplitude, "gap": system.gap}
        span = own | {name: tuple(sorted((own[name], to)))}
        known = vibeam.boundaries(system, periods=orbit.periods, points=1001, **span)
        for met in branch.boundaries:
            near = [getattr(each, name) for each in known if each.kind is met.kind and each.clear]
            assert min(abs(value - met.value) for value in near) < 1e-11 * abs(met.value), (seed, met.kind)
            seen[met.kind] += 1
    assert min(seen.values()) > 0, seen


def test_the_numbers_of_the_coco_toolbox() -> None:
    """Phase of the cosine force, velocities, multipliers, grazing at amplitude 0.1; the fold is 0.03 % below that."""
    (orbit,) = [each for each in vibeam.orbits(COCO, vibeam.Drive(1.0, 1.0)) if each.admissible]
    branch = vibeam.follow(orbit, "amplitude", 0.01, behind=1.2)
    assert [met.kind for met in branch.boundaries] == [Kind.FOLD, Kind.GRAZING]
    fold, grazing = branch.boundaries
    assert grazing.value == pytest.approx(0.1, rel=1e-12)
    (exact,) = vibeam.boundaries(COCO, (0.01, 1.2), 1.0, kinds=(Kind.FOLD,))
    assert fold.value == pytest.approx(exact.amplitude, rel=1e-11)
    assert abs(fold.multipliers[0] - 1) < 1e-6  # it changes like the root of the distance to the fold
    first = branch.orbits[0]
    assert [first.phase - pi / 2, first.velocity] == pytest.approx([0.07595216, 1.69573294], abs=5e-9)
    assert first.multipliers == pytest.approx([-0.584295 + 0.0056j, -0.584295 - 0.0056j], abs=1e-6)


@pytest.mark.parametrize("modes", [1, 8])
def test_a_free_motion_begins_to_touch_where_its_closed_form_does(modes: int) -> None:
    """|Σ c l Ω²B / (ω² − Ω² + 2iζωΩ)| = gap."""
    number = np.arange(1, modes + 1)
    omega, contact, load = 1.0 * number**1.8, 1 / number, (-0.6) ** number
    system = vibeam.ImpactSystem.from_modes(omega, 0.02, contact, load, gap=1.0, restitution=0.8)
    response = abs(np.sum(contact * load * 0.9**2 / (omega**2 - 0.81 + 2j * 0.02 * omega * 0.9)))
    branch = vibeam.follow(settled(system, vibeam.Drive(0.9, 0.2 / response)), "amplitude", 2 / response)
    assert branch.end is vibeam.BranchEnd.GRAZING
    assert branch.boundaries[0].value == pytest.approx(1 / response, rel=1e-12)


def matrix(stiffness: mp.mpf, rate: mp.mpf, time: mp.mpf) -> mp.matrix:
    """Flow of x'' + rate x' + stiffness x = 0 over a time."""
    half = rate / 2
    own, decay = mp.sqrt(stiffness - half**2), mp.exp(-half * time)
    c, s = mp.cos(own * time), mp.sin(own * time) / own
    return decay * mp.matrix([[c + half * s, s], [-stiffness * s, c - half * s]])


def steady(stiffness: mp.mpf, rate: mp.mpf, omega: mp.mpf, force: mp.mpf, time: mp.mpf) -> mp.matrix:
    """Steady response to omega² sin(omega t) and a constant force."""
    turned = omega**2 / (stiffness - omega**2 + 1j * rate * omega) * mp.mpc(mp.cos(omega * time), mp.sin(omega * time))
    return mp.matrix([turned.imag + force / stiffness, (1j * omega * turned).imag])


def one_contact(omega: mp.mpf, entry: mp.mpf, speed: mp.mpf, lasts: mp.mpf) -> tuple[list[mp.mpf], mp.matrix]:
    """Residuals of the bilinear oscillator's motion with one contact a period, and its monodromy matrix."""
    rate, gap, spring = mp.mpf("0.06"), mp.mpf("0.5"), mp.mpf(3)
    period = 2 * mp.pi / omega
    inside, outside = matrix(1 + spring, rate, lasts), matrix(mp.mpf(1), rate, period - lasts)

    def pushed(time: mp.mpf) -> mp.matrix:
        return steady(1 + spring, rate, omega, spring * gap, time)

    def free(time: mp.mpf) -> mp.matrix:
        return steady(mp.mpf(1), rate, omega, mp.mpf(0), time)

    left = pushed(entry + lasts) + inside * (mp.matrix([gap, speed]) - pushed(entry))
    back = free(entry + period) + outside * (left - free(entry + lasts))
    return [left[0] - gap, back[0] - gap, back[1] - speed], outside * inside


@pytest.mark.parametrize(("start", "to"), [(1.2, 2.5), (1.9, 2.9)])
def test_doublings_of_the_bilinear_oscillator_by_an_independent_program(start: float, to: float) -> None:
    """Piecewise closed forms in 30 digits: 1 + tr M + det M = 0 with the motion's own three equations."""
    branch = vibeam.follow(settled(BILINEAR, vibeam.Drive(start, 1.0)), "omega", to)
    met = [each for each in branch.boundaries if each.kind is Kind.DOUBLING]
    assert met
    with mp.workdps(30):
        for each in met:
            orbit = each.orbit
            force = orbit.path().contacts
            guess = [each.value, orbit.times[0], orbit.velocities[0], force[0, 1]]

            def equations(*values: mp.mpf) -> list[mp.mpf]:
                residuals, monodromy = one_contact(*values)
                return [*residuals, 1 + monodromy[0, 0] + monodromy[1, 1] + mp.det(monodromy)]

            exact = mp.findroot(equations, guess, tol=1e-40)
            assert each.value == pytest.approx(float(exact[0]), rel=1e-11)
            assert [orbit.times[0], orbit.velocities[0], force[0, 1]] == pytest.approx(
                [float(value) for value in list(exact)[1:]], rel=1e-8
            )


def test_there_and_back_around_a_fold_is_the_same_motion() -> None:
    system = vibeam.ImpactSystem.from_modes(1.0, 0.02, 1.0, 1.0, gap=0.3, restitution=0.8)
    hard, soft = vibeam.orbits(system, vibeam.Drive(1.4, 0.1))
    ahead = vibeam.follow(hard, "gap", 3.0)
    assert [each.kind for each in ahead.boundaries] == [Kind.FOLD]
    assert ahead.end is vibeam.BranchEnd.RETURNED
    assert ahead.orbits[-1].velocity == pytest.approx(soft.velocity, rel=1e-11)
    assert not ahead.stable[-1]
    back = vibeam.follow(ahead.orbits[-1], "gap", 3.0)
    assert back.boundaries[0].value == pytest.approx(ahead.boundaries[0].value, rel=1e-12)
    assert back.orbits[-1].velocity == pytest.approx(hard.velocity, rel=1e-11)
    assert back.orbits[-1].phase == pytest.approx(hard.phase, rel=1e-11)


def test_a_doubled_branch_leaves_like_a_square_root_and_leads_back_to_its_birth() -> None:
    branch = vibeam.follow(vibeam.orbits(ONE, vibeam.Drive(2.0, 0.1))[0], "omega", 3.2)
    (birth,) = branch.boundaries
    doubled = branch.switch(birth)
    assert doubled.orbits[1].periods == 2
    assert doubled.stable[1]
    apart = [float(np.ptp(orbit.velocities)) for orbit in doubled.orbits[1:4]]
    share = np.array(apart) / np.sqrt(doubled.values[1:4] - birth.value)
    assert share == pytest.approx(share[0], rel=0.02)
    later = doubled.orbits[4]
    back = vibeam.follow(later, "omega", 2.0, behind=later.drive.omega + 0.01)
    assert back.end is vibeam.BranchEnd.BIRTH
    assert back.boundaries[-1].kind is Kind.DOUBLING
    assert back.boundaries[-1].value == pytest.approx(birth.value, rel=1e-11)


def test_a_doubled_motion_doubles_where_it_does_in_30_digits() -> None:
    """Two impacts in two periods: 1 + tr M + det M = 0 with their four equations."""
    branch = vibeam.follow(vibeam.orbits(ONE, vibeam.Drive(2.0, 0.1))[0], "omega", 3.2)
    met = next(each for each in branch.switch(branch.boundaries[0]).boundaries if each.kind is Kind.DOUBLING)
    rate, amplitude = mp.mpf("0.1"), mp.mpf("0.1")

    def equations(omega: mp.mpf, *unknown: mp.mpf) -> list[mp.mpf]:
        times, speeds, back, product = unknown[:2], unknown[2:], list[mp.mpf](), mp.eye(2)
        ends = [times[1], times[0] + 4 * mp.pi / omega]
        for at, end, speed, following in zip(times, ends, speeds, speeds[::-1], strict=True):
            flow = matrix(mp.mpf(1), rate, end - at)
            own = [amplitude * steady(mp.mpf(1), rate, omega, mp.mpf(0), each) for each in (at, end)]
            arrived = own[1] + flow * (mp.matrix([0, -speed / 2]) - own[0])
            back += [arrived[0], arrived[1] - following]
            push = omega**2 * amplitude * mp.sin(omega * at) - rate * speed
            lean = (1 + mp.mpf("0.5")) * (rate + push / speed)
            product = flow * mp.matrix([[-0.5, 0], [lean, -0.5]]) * product
        return [*back, 1 + product[0, 0] + product[1, 1] + mp.det(product)]

    with mp.workdps(30):
        exact = mp.findroot(equations, [met.value, *met.orbit.times, *met.orbit.velocities], tol=1e-40)
    assert met.value == pytest.approx(float(exact[0]), rel=1e-11)


def test_a_contact_that_lasts_opens_where_its_force_vanishes() -> None:
    """Pressed by ω²|gap|, pulled by Ω²B: a hard stop holds up to B = ω²|gap|/Ω²."""
    system = replace(ONE, gap=-0.3)
    branch = vibeam.follow(settled(system, vibeam.Drive(0.7, 0.2)), "amplitude", 0.9)
    met = branch.boundaries[0]
    assert met.kind is Kind.CONTACT
    assert met.value == pytest.approx(0.3 / 0.49, rel=1e-9)
    assert branch.end is vibeam.BranchEnd.REACHED
    assert branch.orbits[-1].rests == 1


def test_the_symmetric_motion_of_a_ball_in_a_shaken_cavity() -> None:
    """cos φ = −A (d/B + sin φ), A = (1−R)/(1+R)·2/π, folds at d/B = √(1+A²)/A; symmetry is lost, and a pair begins."""
    ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=1.7, restitution=0.65, second_gap=1.7)
    drive = vibeam.Drive(1.0, 1.0)
    state = vibeam.simulate(ball, drive, 2400.0, vibeam.State([0.0], [1.9])).state
    (start,) = vibeam.orbits(ball, drive, start=state, time=2400.0)

    def between(gap: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
        return replace(ball, gap=gap, second_gap=gap), drive

    share = 0.35 / 1.65 * 2 / pi
    (fold,) = vibeam.follow(start, between, 12.0, value=1.7).boundaries
    assert (fold.kind, fold.value) == (Kind.FOLD, pytest.approx(hypot(1, share) / share, rel=1e-11))
    branch = vibeam.follow(start, between, 1.2, value=1.7)
    (met,) = branch.boundaries
    assert (met.kind, met.value) == (Kind.PLUS_ONE, pytest.approx(float(cavity.symmetry_lost()), rel=1e-8))
    assert met.multipliers == pytest.approx([1.0, 0.65**4], rel=1e-7)  # of det M = R⁴
    for side in (1, -1):
        pair = branch.switch(met, side)
        assert pair.values[-1] == 1.2
        assert pair.stable[-1]
        last = pair.orbits[-1]
        phases = np.mod(np.where(last.contacts == 0, last.times, last.times + pi), 2 * pi)  # each at its own wall
        assert np.ptp(phases) > 0.1


def test_a_stop_that_yields_is_touched_and_left_on_one_branch() -> None:
    """Integrated contact too: the branch of the free motion goes on, and begins to touch at the closed form's place."""
    law = HuntCrossley(stiffness=20.0, exponent=1.5, damping=0.1)
    system = vibeam.ImpactSystem.from_modes(1.0, 0.1, 1.0, 1.0, gap=1.0, law=law)
    branch = vibeam.follow(settled(system, vibeam.Drive(0.8, 0.4)), "amplitude", 0.7)
    response = 0.64 / hypot(1 - 0.64, 0.2 * 0.8)
    (met,) = [each for each in branch.boundaries if each.kind is Kind.TOUCHING]
    assert met.value == pytest.approx(1 / response, rel=1e-12)
    assert len(branch.orbits[-1].times) == 1


@pytest.mark.parametrize("third", [False, True])
def test_a_touch_is_met_at_whichever_contact(third: bool) -> None:
    """Linear stops, one within reach: a free motion begins to touch it where its amplitude there is the gap."""
    law, row = LinearStop(1e5, 5.0), np.array([0.8, -0.5])
    contacts = [vibeam.Contact([-1.0, 0.2], 1.0, law=law), vibeam.Contact(row, 1e-4, law=law)]
    system = vibeam.ImpactSystem.from_modes(
        [71.0, 440.0], [0.02, 0.02], [1.0, 0.7], [0.9, 0.4], gap=1.0, law=law, further=contacts[:: 1 if third else -1]
    )
    drive = vibeam.Drive(95.0, 1e-5)
    [orbit] = [each for each in vibeam.orbits(system, drive) if not len(each.times)]
    branch = vibeam.follow(orbit, "amplitude", 6.12e-5)
    damped = system.omega**2 - drive.omega**2 + 2j * system.zeta * system.omega * drive.omega
    touch = 1e-4 / abs(np.sum(row * system.load * drive.omega**2 / damped))
    assert branch.boundaries[0].kind is Kind.TOUCHING
    assert branch.boundaries[0].value == pytest.approx(touch, rel=1e-11)


def test_a_rigid_stop_beside_one_that_yields() -> None:
    """The one that is touched decides: past a linear stop it goes on as if both yielded, a rigid one ends it."""
    law, row, drive = LinearStop(1e5, 5.0), [0.8, -0.5], vibeam.Drive(95.0, 1e-5)
    branches = []
    for first, further in (law, law), (None, law), (law, None):
        system = vibeam.ImpactSystem.from_modes(
            [71.0, 440.0], [0.02, 0.02], [1.0, 0.7], [0.9, 0.4], gap=1.0, law=first, restitution=0.7,
            further=[vibeam.Contact(row, 1e-4, 0.7, further)],
        )  # fmt: skip
        [orbit] = [each for each in vibeam.orbits(system, drive) if not len(each.times)]
        branches.append(vibeam.follow(orbit, "amplitude", 6.115e-5))
    ends = [branch.end.name for branch in branches]
    assert ends == ["REACHED", "REACHED", "GRAZING"]
    values = [[met.value for met in branch.boundaries if met.kind is Kind.TOUCHING] for branch in branches]
    assert values[1] == pytest.approx(values[0], rel=1e-12)
    assert values[2] == pytest.approx(values[0], rel=1e-12)


def test_windows_of_three_touches_are_cut_apart() -> None:
    """The middle one on both sides: half way to its neighbours, less a twentieth of the way."""
    cut = apart([Window(0.0, 6.0, 0, 3.0), Window(1.0, 9.0, 1, 5.0), Window(0.5, 4.0, 0, 1.0)])
    assert [each.touch for each in cut] == [1.0, 3.0, 5.0]
    assert [(each.begin, each.end) for each in cut] == [(0.5, 1.9), (2.1, 3.9), (4.1, 9.0)]


def test_what_makes_no_branch_is_refused_in_words() -> None:
    orbit = vibeam.orbits(ONE, vibeam.Drive(2.0, 0.1))[0]
    with pytest.raises(ValueError, match="'speed' is none of omega, amplitude, gap"):
        vibeam.follow(orbit, "speed", 3.0)
    with pytest.raises(ValueError, match="either side of the orbit's own value 2"):
        vibeam.follow(orbit, "omega", 3.0, behind=2.5)
    with pytest.raises(ValueError, match="a function needs the number"):
        vibeam.follow(orbit, lambda omega: (ONE, vibeam.Drive(omega, 0.1)), 3.0)
    with pytest.raises(ValueError, match="none of the system at 2"):
        vibeam.follow(orbit, lambda omega: (ONE, vibeam.Drive(omega, 0.2)), 3.0, value=2.0)
    with pytest.raises(ValueError, match="passes through the stop"):
        vibeam.follow(replace(orbit, admissible=False), "omega", 3.0)
    branch = vibeam.follow(orbit, "omega", 1.0)
    with pytest.raises(ValueError, match="TOUCHING begins no branch"):
        branch.switch(branch.boundaries[-1])
    same = vibeam.follow(orbit, lambda omega: (ONE, vibeam.Drive(omega, 0.1)), 1.0, value=2.0)
    assert same.boundaries[-1].value == pytest.approx(branch.boundaries[-1].value, rel=1e-12)
