"""One scene of every family of hard cases, each with a truth that no solver under test has made.

Closed forms in 30 digits where there are any, else ``tests/independent/events.py``: Taylor series in 30 digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import mpmath
import numpy as np
from agreement import true_motion
from motions import NONE, one, state
from mpmath import mpf
from random_systems import Case, random_case
from several import ContactRig

import vibeam

FIRM = 1e-3  # share of the fastest impact's velocity from which on each impact is asked for


@dataclass(frozen=True)
class Scene:
    """A motion and its truth: impacts (m, 2) in time and velocity before, and where the contact is in the end, m.

    ``pieces``: ends of the intervals in which it is to be run, each from the state of the one before; ``place`` None
    where all is said by the impacts. ``energy``: the true one in the end (``energy_of``), of undriven motions.
    """

    family: str
    what: str
    case: Case
    pieces: tuple[float, ...]
    impacts: np.ndarray
    place: float | None = None
    begin: float = 0.0
    energy: float | None = None

    @property
    def end(self) -> float:
        """When it is over, s."""
        return self.pieces[-1]

    @property
    def firm(self) -> np.ndarray:
        """Those impacts (k, 2) that have at least ``FIRM`` of the fastest one's velocity."""
        return self.impacts[self.impacts[:, 1] >= FIRM * self.impacts[:, 1].max(initial=0.0)]

    @property
    def size(self) -> float:
        """Scale of the contact's displacement, m."""
        system = self.case.system
        return float(np.abs(system.contact) @ np.abs(self.case.start.displacement) + abs(system.gap))


Maker = Callable[[], Scene]
MAKERS: list[Maker] = []


def scene(maker: Maker) -> Maker:
    """List a scene's maker: its truth is computed only when it is asked for."""
    MAKERS.append(maker)
    return maker


def rows(times: list, speeds: list) -> np.ndarray:
    return np.array([[float(t), float(v)] for t, v in zip(times, speeds, strict=True)]).reshape(-1, 2)


def energy_of(case: Case, displacement: np.ndarray, velocity: np.ndarray) -> float:
    """Energy of modes in a state: kinetic, of their springs, and in the static force, J."""
    spring = (case.system.omega * displacement) ** 2 / 2 - case.system.static * displacement
    return float(np.sum(velocity**2 / 2 + spring))


def followed(
    family: str, what: str, case: Case, *, count: int = 0, end: float | None = None, begin: float = 0.0
) -> Scene:
    """A scene with its truth from Taylor series: ``count`` impacts and half a flight, or all to ``end``."""
    motion = true_motion(case, begin)
    if end is None:
        motion.run(count=count + 1, t_end=begin + 1e9 / max(case.drive.omega, case.system.omega.max()))
        hits = [float(event.time) for event in motion.events if event.kind == "impact"]
        end = (hits[-2] + hits[-1]) / 2
        motion = true_motion(case, begin)
    motion.run(t_end=end)
    hits = [event for event in motion.events if event.kind == "impact"]
    last = motion.state()
    x, v = (np.array([float(each) for each in row]) for row in (last.displacement, last.velocity))
    impacts = rows([e.time for e in hits], [e.speed for e in hits])
    energy = None if case.drive.amplitude else energy_of(case, x, v)
    return Scene(family, what, case, (end,), impacts, float(case.system.contact @ x), begin, energy)


# ------------------------------------------------------------------------------------------------------- accumulations


@scene
def ball() -> Scene:
    """Flights of 2v/g, each R of the one before; all over at √(2h/g) (1 + R)/(1 − R) = 8.579 s."""
    with mpmath.workdps(30):
        g, R = mpf(9.81), mpf(0.9)
        t, v, times, speeds = mpmath.sqrt(2 / g), mpmath.sqrt(2 * g), [], []
        while v > mpf(10) ** -12:
            times.append(t)
            speeds.append(v)
            v *= R
            t += 2 * v / g
    case = Case(one(0.0, load=0.0, static=9.81, restitution=0.9), NONE, state(-1.0, 0.0))
    return Scene("chatter to rest", "a ball, R = 0.9", case, (12.0,), rows(times, speeds), 0.0, energy=0.0)


def pressed_flights(w: float, press: float, speed: float, restitution: float) -> np.ndarray:
    """Undamped mode struck at t = 0 on a stop pressed by ``press``: flights of 2/ω arctan(v/ωa)."""
    with mpmath.workdps(30):
        t, v, times, speeds = mpf(0), mpf(speed), [], []
        while v > mpf(10) ** -12 * speed:
            times.append(t)
            speeds.append(v)
            v *= mpf(restitution)
            t += 2 / mpf(w) * mpmath.atan2(v, mpf(w) * mpf(press))
    return rows(times, speeds)


@scene
def pressed() -> Scene:
    case = Case(one(1.7, gap=-0.3, restitution=0.5), NONE, state(-0.3, 1.0))
    return Scene(
        "chatter to rest", "one mode pressed on, R = 0.5", case, (6.0,), pressed_flights(1.7, 0.3, 1, 0.5), -0.3
    )


@scene
def driven_chatter() -> Scene:
    """Chatter, rest, release and strikes again: three modes."""
    rng = np.random.default_rng(5)
    omega, contact = np.array([1.0, 4.7, 9.1]), np.array([1.0, 0.4, -0.3])
    system = vibeam.ImpactSystem.from_modes(
        omega, 0.03, contact, np.r_[1.0, rng.normal(size=2) / 3], gap=-0.3, restitution=0.8, static=[1.0, 0.0, 0.0]
    )
    case = Case(system, vibeam.Drive(0.6, 4.2), state([-0.32, 0.0, 0.0], np.zeros(3)))
    return followed("chatter to rest", "driven, three modes: rest, release, strikes again", case, end=12.0)


@scene
def many_modes() -> Scene:
    omega = np.geomspace(1.0, 30.0, 10)
    contact = 1.0 / omega**0.5 * (-1.0) ** np.arange(10)
    system = vibeam.ImpactSystem.from_modes(omega, 0.2, contact, 0.0, restitution=0.4, static=3.0 * contact)
    start = state(-1e-3 * contact / (contact @ contact), np.zeros(10))
    return followed("chatter to rest", "ten modes, R = 0.4", Case(system, NONE, start), end=0.2)


# ---------------------------------------------------------------------------------------------------- rest and release


def held(excess: float) -> Case:
    """At rest on the stop, pressed by ω²|gap|, pulled by ``excess`` times that."""
    drive = vibeam.Drive(2.2, excess * 1.5**2 * 0.3 / 2.2**2)
    return Case(one(1.5, 0.02, gap=-0.3, restitution=0.7), drive, state(-0.3, 0.0, True))


@scene
def released() -> Scene:
    return followed("rest and release", "the force changes sign", held(1.5), end=9.0)


@scene
def tangential() -> Scene:
    """The force touches zero twenty times: to the rounding of its own amplitude the contact stays."""
    end = 20 * 2 * np.pi / 2.2
    return Scene("rest and release", "the force only touches zero, 20 periods", held(1.0), (end,), rows([], []), -0.3)


# ------------------------------------------------------------------------------------------------------------- grazing


def throw(height: float, what: str, impacts: np.ndarray, place: float) -> Scene:
    """A ball thrown up under g = 1: u = −½ + t − t²/2 crests at t = 1 on 0."""
    case = Case(one(0.0, load=0.0, gap=height, static=-1.0, restitution=0.5), NONE, state(-0.5, 1.0))
    return Scene("grazing", what, case, (1.5,), impacts, place)


@scene
def touched() -> Scene:
    after = 0.5 + 1e-4
    place = -(1e-4**2) / 2 - 0.5e-4 * after - after**2 / 2
    return throw(-(1e-4**2) / 2, "touched with 1e-4 of the speed", rows([1 - 1e-4], [1e-4]), place)


@scene
def just_missed() -> Scene:
    return throw(1e-4**2 / 2, "missed by 5e-9 of the height", rows([], []), -0.125)


def crest(part: float, end: float) -> tuple[Case, np.ndarray, float]:
    """Undamped, below resonance: u = A sin Ωt, the gap (1 − part) A; the strike, if any, and the place at the end."""
    w, W, B = 2.0, 0.75, 0.4
    with mpmath.workdps(30):
        A = mpf(W) ** 2 * mpf(B) / (mpf(w) ** 2 - mpf(W) ** 2)
        gap, place = float(A * (1 - mpf(part))), A * mpmath.sin(mpf(W) * mpf(end))
        impacts = rows([], [])
        if mpf(gap) < A:
            when = mpmath.asin(mpf(gap) / A) / mpf(W)
            speed = A * mpf(W) * mpmath.cos(mpf(W) * when)
            place -= mpf(1.5) * speed / w * mpmath.sin(mpf(w) * (mpf(end) - when))
            impacts = rows([when], [speed])
    case = Case(one(w, gap=gap, restitution=0.5), vibeam.Drive(W, B), state(0.0, float(A * mpf(W))))
    return case, impacts, float(place)


@scene
def at_a_crest() -> Scene:
    case, impacts, place = crest(1e-8, 3.0)
    return Scene("grazing", "at a crest of the drive, 1e-8 of it beyond", case, (3.0,), impacts, place)


@scene
def hundred_crests() -> Scene:
    end = 100 * 2 * np.pi / 0.75
    case, impacts, place = crest(-1e-6, end)
    return Scene("grazing", "a hundred crests, 1e-6 short", case, (end,), impacts, place)


@scene
def flat_crest() -> Scene:
    """u = 9/8 cos s − 1/8 cos 3s has u″ = 0 on its crest: a root nearly of order four."""
    a1, a2, part = mpf(9) / 8, mpf(-1) / 8, mpf(10) ** -6
    with mpmath.workdps(40):
        gap = mpf(float(1 - part))
        x = [float(a * mpmath.cos(w)) for a, w in ((a1, 1), (a2, 3))]
        v = [float(a * w * mpmath.sin(w)) for a, w in ((a1, 1), (a2, 3))]
        guess = -((8 * part / 3) ** mpf("0.25"))
        s = mpmath.findroot(lambda s: a1 * mpmath.cos(s) + a2 * mpmath.cos(3 * s) - gap, guess)
        impacts = rows([s + 1], [-a1 * mpmath.sin(s) - 3 * a2 * mpmath.sin(3 * s)])
    system = vibeam.ImpactSystem.from_modes([1.0, 3.0], 0.0, [1.0, 1.0], 0.0, gap=float(gap), restitution=0.5)
    return Scene("grazing", "a crest without curvature", Case(system, NONE, state(x, v)), (1.2,), impacts)


# ------------------------------------------------------------------------------------------------------- close impacts


@scene
def slow_approach() -> Scene:
    case = Case(one(1.7, gap=-1.0, restitution=0.8), NONE, state(-1.0, 1e-3))
    flights = pressed_flights(1.7, 1.0, 1e-3, 0.8)
    return Scene("close impacts", "flights of 1e-4 periods", case, (1.5e-3,), flights[flights[:, 0] < 1.5e-3])


@scene
def ringing() -> Scene:
    system = vibeam.ImpactSystem.from_modes([1.0, 1e3], [0.01, 0.002], [1.0, 1.0], [1.0, 0.0], gap=0.1, restitution=0.3)
    return followed("close impacts", "a ringing mode strikes again", Case(system, NONE, state([0, 0], [1, 0])), count=6)


@scene
def hard_pressed() -> Scene:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.9], 0.02, [1.0, -0.5, 0.3], [1.0, 0.2, 0.1], gap=0.0, restitution=0.9, static=[1e4, 0.0, 0.0]
    )
    case = Case(system, vibeam.Drive(1.3, 0.1), state([-1e-3, 0, 0], [0.5, 0.1, 0.0]))
    return followed("close impacts", "pressed on by 10⁴ times the motion", case, count=20)


# ---------------------------------------------------------------------------------------------------- ends of intervals


@scene
def cut_at_the_impact() -> Scene:
    """x = −cos 2t strikes 0 at π/4; the first interval ends there."""
    case, hit = Case(one(2.0, gap=0.0, restitution=0.5), NONE, state(-1.0, 0.0)), float(np.pi / 4)
    place = -0.5 * np.sin(2 * (1.5 - np.pi / 4))
    return Scene("ends of intervals", "one ends on the impact", case, (hit, 1.5), rows([hit], [2.0]), place)


SYSTEM = vibeam.ImpactSystem.from_modes(
    [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7,
    static=[0.005, 0.0, 0.01],
)  # fmt: skip
DRIVE = vibeam.Drive(1.9, 0.05)
START = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])


@scene
def thousand_pieces() -> Scene:
    whole = followed("ends of intervals", "cut into 1 000", Case(SYSTEM, DRIVE, START), end=30.0)
    return replace(whole, pieces=tuple(np.linspace(0, 30.0, 1001)[1:].tolist()))


# --------------------------------------------------------------------------------------------------------- restitution


@scene
def plastic() -> Scene:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 1.7, 2.9], 0.02, [1.0, -0.4, 0.4], [1.0, -0.4, 0.4], gap=-0.1, restitution=0.0
    )
    case = Case(system, vibeam.Drive(1.3, 0.5), state([-0.5, 0, 0], np.zeros(3)))
    return followed("R = 0 and R = 1", "R = 0, three modes, pressed", case, end=25.0)


@scene
def elastic() -> Scene:
    """ẍ + x = 0 from −1: t_k = (2k + 1) arccos(0.3) for ever."""
    theta = np.arccos(0.3)
    hits = (2 * np.arange(1000) + 1) * theta
    case = Case(one(1.0, gap=-0.3), NONE, state(-1.0, 0.0))
    impacts = np.stack([hits, np.full(1000, np.sin(theta))], axis=1)
    end, place = float(hits[-1] + theta / 2), -float(np.cos(theta / 2))
    return Scene("R = 0 and R = 1", "R = 1, 1 000 impacts", case, (end,), impacts, place, energy=0.5)


# ------------------------------------------------------------------------------------------------- damping, resonances


@scene
def all_dampings() -> Scene:
    zeta = np.array([0.0, 50.0, 1.0, 0.0, 1 - 1e-12, 0.02, 1 + 1e-12])
    contact = np.array([0.5, 0.4, -0.8, 0.9, 0.5, -0.7, 0.6])
    system = vibeam.ImpactSystem.from_modes(
        np.r_[0.0, 1.6 ** np.arange(6)], zeta, contact, [0.3, 1.0, -0.5, 0.8, 0.2, -0.9, 0.4], gap=0.05,
        restitution=0.7, static=np.r_[0.6, np.zeros(6)],
    )  # fmt: skip
    start = state(-0.2 * contact / (contact @ contact), np.zeros(7))
    return followed(
        "every damping", "ω = 0; ζ = 0, 1, 1 ± 1e-12, 50", Case(system, vibeam.Drive(1.9, 0.3), start), end=12.0
    )


def undamped(gap: float, restitution: float) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [1.0, 2.3, 6.1], 0.0, [1.0, 0.5, -0.4], [1.0, 0.2, 0.3], gap=gap, restitution=restitution
    )


@scene
def resonance() -> Scene:
    case = Case(undamped(0.1, 0.7), vibeam.Drive(2.3, 0.05), state([-0.2, 0, 0], np.zeros(3)))
    return followed("resonances", "driven at an undamped mode", case, count=20)


@scene
def far_above() -> Scene:
    case = Case(undamped(-0.05, 0.9), vibeam.Drive(1e3, 1e-4), state([-0.6, 0.1, 0], [0, 0.3, 0]))
    return followed("resonances", "driven 1 000 times as fast as mode 1", case, count=4)


@scene
def far_below() -> Scene:
    case = Case(undamped(-0.05, 0.9), vibeam.Drive(1e-6, 1e10), state([-0.6, 0.1, 0], [0, 0.3, 0]))
    return followed("resonances", "driven a million times as slowly", case, count=8)


# -------------------------------------------------------------------------------------------------------------- scales


@scene
def eight_decades() -> Scene:
    omega = np.geomspace(1e-4, 1e4, 9)
    contact = np.ones(9) / np.arange(1, 10)
    system = vibeam.ImpactSystem.from_modes(omega, 0.01, contact, contact, gap=1e-5, restitution=0.8)
    case = Case(system, vibeam.Drive(2000.0, 1e-5), state(np.zeros(9), 0.5 * contact))
    return followed("scales", "frequencies over eight decades", case, end=2e-5)


@scene
def nanometres() -> Scene:
    system = replace(SYSTEM, gap=SYSTEM.gap * 1e-9, static=SYSTEM.static * 1e-9)
    start = vibeam.State(START.displacement * 1e-9, START.velocity * 1e-9)
    case = Case(system, vibeam.Drive(1.9, 0.05e-9), start)
    return followed("scales", "a rig in nanometres", case, end=30.0)


@scene
def strong_drive() -> Scene:
    return followed("scales", "a drive of 10¹²", Case(SYSTEM, vibeam.Drive(1.9, 1e12), START), count=20)


@scene
def tiny_gap() -> Scene:
    system = replace(SYSTEM, gap=1e-12, static=np.zeros(3))
    return followed("scales", "a gap of 1e-12", Case(system, DRIVE, START), count=20)


@scene
def weak_contact() -> Scene:
    contact = np.array([1.0, -0.6, 0.3])
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.1], 0.04, 1e-9 * contact, [1.0, 0.4, -0.2], gap=0.0, restitution=0.7
    )
    case = Case(system, vibeam.Drive(1.9, 0.4), state([-0.8, 0.01, 0.0], [0.02, 0.0, 0.01]))
    return followed("weak contact", "all modes nearly at their nodes (1e-9)", case, end=15.0)


@scene
def late() -> Scene:
    begin = 1e6 * 2 * np.pi / 1.9
    return followed("long times", "begun after 10⁶ periods", Case(SYSTEM, DRIVE, START), end=begin + 30.0, begin=begin)


@scene
def both_sides() -> Scene:
    """Clearance on both sides, an impact on either in turn or several: by eigenvalues and bisection in 30 digits."""
    row, gaps, drive, end = np.array([1.0, -0.6, 0.3]), (0.02, 0.05), vibeam.Drive(1.9, 0.05), 24.0
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], row, [1.0, 0.4, -0.2], gap=gaps[0], second_gap=gaps[1], restitution=0.7
    )
    twin = replace(system, second_gap=None, further=(vibeam.Contact(-row, gaps[1], 0.7),))
    with mpmath.workdps(30):
        hits, last = ContactRig(twin, drive).fly(end)
    impacts = rows([time for time, *_ in hits], [speed for *_, speed in hits])
    place = float(row @ np.array([float(x) for x in last[:3]]))
    case = Case(system, drive, state(np.zeros(3), np.zeros(3)))
    return Scene("clearance on both sides", "three modes, from rest", case, (end,), impacts, place)


# ------------------------------------------------------------------------------------------------- brink, full, random


@scene
def brink() -> Scene:
    """One mode a billionth before a fold of its period-1 orbits, begun beside that orbit."""
    system = vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=5e-4, restitution=0.8)
    omega = next(
        each.omega for each in vibeam.boundaries(system, amplitude=5e-4, omega=(1.5, 6.5), points=121) if each.clear
    )
    case = Case(system, vibeam.Drive(omega * (1 - 1e-9), 5e-4), state(system.gap - 5e-4 * 1.01, 0.0))
    return followed("brink of a bifurcation", "1e-9 from a boundary", case, count=20)


@scene
def full_model() -> Scene:
    """Four hundred modes of the beam from rest: the first strike, and what it adds to each, in closed form."""
    from test_full_models import DRIVE as SHAKEN
    from test_full_models import exact_at, full

    beam = full(1e-5, 0.7)
    rest = np.zeros((2, beam.size))
    turn = np.linspace(0, 2 * np.pi / SHAKEN.omega, 20_001)
    t = float(turn[np.flatnonzero(free_contact(beam, SHAKEN, rest, turn) > beam.gap)[0]])
    with mpmath.workdps(30):
        for _ in range(4):
            u, rate = exact_at(beam, SHAKEN, rest, 0.0, t)
            t -= float((u - mpf(beam.gap)) / rate)
        speed, end = exact_at(beam, SHAKEN, rest, 0.0, t)[1], 1.2 * t
        kick = np.array([rest[0], -beam.contact * float((1 + beam.restitution) * speed) / beam.mobility])
        place = exact_at(beam, SHAKEN, rest, 0.0, end)[0] + exact_at(beam, NONE, kick, t, end)[0]
    after = np.linspace(0, end - t, 2001)[1:]
    if np.any(free_contact(beam, SHAKEN, rest, t + after) + free_contact(beam, NONE, kick, after) > beam.gap):
        raise ValueError("it strikes again")
    case = Case(beam, SHAKEN, vibeam.State(*rest))
    what = f"{beam.size} modes, first strike"
    return Scene("full models", what, case, (end,), rows([t], [speed]), float(place))


def free_contact(system: vibeam.ImpactSystem, drive: vibeam.Drive, pose: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The contact's place in a flight from ``pose`` at zero: complex exponentials, in doubles."""
    w, z, W = system.omega, system.zeta, drive.omega
    answer = system.load * W**2 * drive.amplitude / (w**2 - W**2 + 2j * z * w * W)
    own = w * np.sqrt(1 - z**2)
    x, v = pose[0] - answer.imag, pose[1] - W * answer.real
    turn = x - 1j * (v + z * w * x) / own
    parts = np.array_split(times[:, None], 40)
    found = [((np.exp((-z * w + 1j * own) * t) * turn).real + (answer * np.exp(1j * W * t)).imag) for t in parts]
    return np.concatenate([each @ system.contact for each in found])


@scene
def random_system() -> Scene:
    return followed("random systems", "number 79 of seed 7, 8 modes", random_case(7, 79, size=8), count=20)
