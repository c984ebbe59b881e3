"""A random rig through ``simulate``, ``sweep``, ``run``, ``orbits``, the other engine and a solver: what must hold.

Whatever the rig: the same bits on repeat and in eight threads; no NaN without a stated reason; nothing beyond a hard
stop but round-off; energy that comes from the drive alone and goes at impacts as the law says; what two ways of
computing both know, they agree on.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from energy_balance import balance, rate_in
from numpy.random import Generator
from rig_agreement import affordable, direct_agrees, engines_agree, read_off, steady_agrees
from rig_orbits import orbits_hold
from rigs import random_rig
from verdict import Verdict
from workers import Stage

import vibeam
from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.casefile.read import parse
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.proof.certificate import certificate_of
from vibeam.flight.solver import exact_solver
from vibeam.flight.trajectory import Outcome
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

Array = np.ndarray

THREADS = 8

PERIODS, IMPACTS = 20, 5000  # length of a motion, at most

FAST = 1e4  # times the drive's frequency, from which on a mode may be too fast to find the next event

MORE = 20  # times as long a period may take as one that ``IMPACTS`` ended

TRIED = (0.05, 1.0, 4.0)  # drive periods by which it is known, one after the other, whether one is costly

COSTLY = 1.0  # CPU seconds of a sweep that is shortened, or not repeated

LONG = 2.0  # CPU seconds of a period that is read off, the first time, beyond which nothing is swept

LONGEST = 0.5  # CPU seconds of a motion, about

AFFORDED = 0.15  # CPU seconds of what is done over and over: of costly motions less is repeated

WORK = 2e5  # modes times nodes of an energy balance

BARS = {
    "penetration": 1e-11,  # of the motion's size
    "energy from nowhere": 1e-9,  # of the motion's largest energy, in a segment
    "energy from nowhere, integrated contact": 1e-6,
    "energy at impacts": 1e-9,
    "energy gained at impacts": 1e-11,
}

FINE = (Outcome.MOVING, Outcome.RESTING, Outcome.SETTLED, Outcome.SETTLED_ON_STOP, Outcome.ENDLESS_CHATTER)


@dataclass(frozen=True)
class Rig:
    """A case's one model, at one frequency of its sweep."""

    case: vibeam.Case
    system: vibeam.ImpactSystem
    drive: vibeam.Drive
    start: vibeam.State | None
    cost: float  # CPU seconds of a drive period, about
    endless: bool = False  # whether its impacts are more than are flown, by which its cost is foretold

    @property
    def period(self) -> float:
        return 2 * np.pi / self.drive.omega


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """All checks of one rig."""
    verdict, rng = Verdict(), np.random.default_rng([seed, number, 1])
    stage("load")
    try:
        rig = read(random_rig(seed, number), rng)
        exact_solver(rig.system, rig.drive.omega)
    except (vibeam.CaseError, ValueError) as error:  # a beam that buckles, a restitution that no contact gives
        verdict.count("refused")
        verdict.count(f"refused: {_plain(error)}")
        return verdict
    verdict.count("rigs")
    verdict.count(_kind(rig.system))
    for name, check in CHECKS.items():
        stage(name)
        try:
            check(rig, rng, verdict)
        except Exception as error:
            verdict.find(f"{name}: {type(error).__name__}: {error}")
    return verdict


def _plain(error: Exception) -> str:
    """The message without its numbers and names of places: what kind of refusal it is."""
    return re.sub(r"case.toml:\d+: |-?\d[\d.e+-]*|fidelity\.flown[:.] ?", "", str(error)).strip()[:48]


def read(text: str, rng: Generator) -> Rig:
    """The rig that a case file describes, started at equilibrium or with random velocities."""
    case = parse(text)
    omega = 2 * np.pi * case.sweep.frequency
    system = case.system("flown")
    amplitude = float(np.broadcast_to(case.amplitude_of("flown", omega), omega.shape)[0])
    drive = vibeam.Drive(float(omega[0]), amplitude)
    start = None if rng.random() < 0.4 else _start(system, drive, rng)
    for share in TRIED:
        first = vibeam.simulate(system, drive, share * 2 * np.pi / drive.omega, start, max_impacts=IMPACTS)
        endless, cost = first.ended is vibeam.Ended.EVENT_LIMIT, first.stats["cpu_seconds"] / share
        if endless or cost > COSTLY / 8:
            break
    return Rig(case, system, drive, start, MORE * cost if endless else cost, endless)


def _start(system: vibeam.ImpactSystem, drive: vibeam.Drive, rng: Generator) -> vibeam.State:
    """At rest but for velocities, soft modes faster than stiff ones, off the stop where it is touched."""
    still = equilibrium(system)
    slow = system.omega.min() / np.maximum(system.omega, 1e-300) if system.omega.min() > 0 else 1.0
    speed = drive.omega * abs(drive.amplitude) * np.abs(system.load).max() or 1e-3 * np.abs(system.omega).max()
    velocity = rng.normal(size=system.size) * slow * speed
    off = velocity if system.contact @ velocity < 0 else -velocity
    return vibeam.State(still.displacement, off)


def _kind(system: vibeam.ImpactSystem) -> str:
    law = "restitution" if system.law is None else system.law.name
    return law + (", two stops" if system.second_gap is not None else "")


def fly(rig: Rig, span: float) -> vibeam.Trajectory:
    """The motion over ``span`` seconds, or ``IMPACTS``."""
    return vibeam.simulate(rig.system, rig.drive, span, rig.start, max_impacts=IMPACTS)


def motion(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """One motion: how it ended, the same again and in eight threads, penetration, energy."""
    foretold = 0.0 if rig.endless else PERIODS * rig.cost
    path = fly(rig, PERIODS * rig.period * min(1.0, LONGEST / max(foretold, 1e-9)))
    verdict.count("impacts flown", len(path.impact_times))
    _ended(path, verdict)
    verdict.hold(_finite(path) or path.ended is vibeam.Ended.NOT_FINITE, "simulate: not finite without a reason")
    part = path.t_end * min(1.0, AFFORDED / max(path.stats["cpu_seconds"], 1e-9))
    again = fly(rig, part)
    verdict.hold(_same(fly(rig, part), again), "simulate: other bits on repeat")
    with ThreadPoolExecutor(THREADS) as pool:
        others = list(pool.map(lambda _: fly(rig, part), range(THREADS)))
    verdict.hold(all(_same(again, other) for other in others), "simulate: other bits in eight threads")
    verdict.count("repeats to the bit", 1 + THREADS)
    if path.ended in (vibeam.Ended.COMPLETE, vibeam.Ended.EVENT_LIMIT):
        verdict.measure("penetration", penetration(path), BARS["penetration"])
        _energy(path, rng, verdict)


def _ended(path: vibeam.Trajectory, verdict: Verdict) -> None:
    if path.outcome in FINE:
        return
    verdict.count(path.outcome.name)
    many = path.outcome is Outcome.EVENT_LIMIT and len(path.impact_times) >= IMPACTS
    fast = path.outcome is Outcome.UNRESOLVED and _fastest(path) > FAST * path.drive.omega
    verdict.hold(many or fast, f"simulate: {path.outcome.value}")


def _fastest(path: vibeam.Trajectory) -> float:
    """The fastest decay or turn of a mode, or of contact that is integrated where the motion ended, 1/s."""
    system = path.system
    if isinstance(system.law, HuntCrossley) and path.segments.trace[-1, layout.WHAT] == regime_layout.CONTACT:
        return rate_in(path, len(path.segments.trace) - 1)
    if system.coupling is not None:
        return float(np.linalg.norm(system.coupling, 2) + system.omega.max())
    return float(np.max(system.omega * (1 + 2 * system.zeta)))


def _finite(path: vibeam.Trajectory) -> bool:
    ended = np.concatenate([path.state.displacement, path.state.velocity])
    return bool(np.isfinite(path.segments.poses).all() and np.isfinite(ended).all())


def _same(one: vibeam.Trajectory, other: vibeam.Trajectory) -> bool:
    pairs = (
        (one.segments.trace, other.segments.trace), (one.segments.poses, other.segments.poses),
        (one.state.displacement, other.state.displacement), (one.state.velocity, other.state.velocity),
    )  # fmt: skip
    return one.ended is other.ended and all(a.tobytes() == b.tobytes() for a, b in pairs)


def penetration(path: vibeam.Trajectory, samples: int = 4000) -> float:
    """How far the contact lies beyond a hard stop, as a share of the motion's size; 0 for a stop that yields."""
    system = path.system
    if isinstance(system.law, LinearStop | HuntCrossley) or path.t_end <= path.t_start:
        return 0.0
    times = np.concatenate([np.linspace(path.t_start, path.t_end, samples), path.impact_times[:samples]])
    place = path.at(times)
    poses = np.concatenate([path.segments.poses, path.modes_at(times[::50])])  # a rest is one segment, and moves
    size = float(np.abs(poses[:, 0]).max(axis=0) @ np.abs(system.contact)) + abs(system.gap)
    beyond = float(np.max(place - system.gap))
    if system.second_gap is not None:
        beyond = max(beyond, float(np.max(-place - system.second_gap)))
        size += system.second_gap
    return max(beyond, 0.0) / size if size > 0 else 0.0


def _energy(path: vibeam.Trajectory, rng: Generator, verdict: Verdict) -> None:
    found = balance(path, rng, WORK)
    verdict.count("segments balanced", found.segments)
    verdict.measure("energy from nowhere", found.flow, BARS["energy from nowhere"])
    name = "energy from nowhere, integrated contact"
    verdict.measure(name, found.contact, BARS[name])
    verdict.measure("energy at impacts", found.impact, BARS["energy at impacts"])
    verdict.measure("energy gained at impacts", found.gained, BARS["energy gained at impacts"])


def certificate(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """The certificate of a short motion: how much of it is proved, and what is not has a reason."""
    if rig.cost > COSTLY:
        return
    path = vibeam.simulate(rig.system, rig.drive, 2 * rig.period, rig.start, max_impacts=100)
    if path.ended not in (vibeam.Ended.COMPLETE, vibeam.Ended.EVENT_LIMIT) or len(path.segments.trace) > 400:
        return
    found = certificate_of(path._solver, path.drive, path.segments)
    verdict.count("certificates")
    verdict.count("certificates that prove all" if found.complete else "certificates that name what they do not prove")
    for stretch in found.unproved:
        verdict.count(f"unproved: {stretch.reason}")
        verdict.hold(
            path.t_start <= stretch.begin <= stretch.end <= path.t_end * (1 + 1e-12), f"certificate: {stretch}"
        )
    if found.complete and rig.system.size <= 4 and len(path.segments.trace) <= 12:
        _checked(found, verdict)


def _checked(found: Any, verdict: Verdict) -> None:
    from check_certificate import check

    faults, proved = check(found)
    verdict.count("certificates checked in ball arithmetic")
    verdict.count("pieces proved in ball arithmetic", proved)
    for fault in faults[:3]:
        verdict.find(f"certificate: {fault}")


def swept(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """The case run and the system swept: the same bits; a point that is not complete says why."""
    if rig.cost > COSTLY / 8 and not rig.endless:
        verdict.count("sweeps left out: a period takes more than an eighth of a second")
        return
    seconds, each = read_off(rig)
    if seconds > LONG:
        verdict.count("sweeps left out: reading a period off takes more than two seconds")
        return
    rig = _shortened(rig, seconds, each, verdict)
    run = vibeam.run(rig.case, show=False)["flown"]
    for _, found in run.items():
        _complete(found, verdict)
        verdict.count("points swept", len(found))
    cost = sum(float(np.nansum(found.cpu_seconds)) for _, found in run.items())
    if rig.case.chain_of("flown") is not None or cost > COSTLY:
        return
    again = _sweep(rig)
    for direction, found in again.items():
        verdict.hold(_equal(found, getattr(run, direction)), "sweep: other bits than run")
    if cost > AFFORDED:
        return
    with ThreadPoolExecutor(THREADS) as pool:
        others = list(pool.map(lambda _: _sweep(rig), range(THREADS)))
    same = [_equal(found, getattr(other, direction)) for direction, found in again.items() for other in others]
    verdict.hold(all(same), "sweep: other bits in eight threads")
    verdict.count("repeats to the bit", 1 + THREADS)


def _shortened(rig: Rig, seconds: float, each: float, verdict: Verdict) -> Rig:
    """The same with a bound of impacts a period, and with two periods a point where those would cost much.

    ``seconds``: of a period that is read off, ``each``: of an impact.
    """
    plan, less = rig.case.sweep, {}
    bound = affordable(len(plan.frequency), each)
    if 2 * len(plan.frequency) * plan.hold * seconds >= COSTLY or _is_long(rig, bound):
        verdict.count("sweeps shortened")
        less = {"sweep.settle": 0 if rig.cost > COSTLY / 10 else 1, "sweep.hold": 1, "sweep.frequency.points": 2}
        less["sweep.direction"] = "up"
    options = dict(rig.case.fidelities["flown"].options) | {"limit": bound}
    return replace(rig, case=parse(rig.case.text, set=less | {"fidelity.flown.options": options}))


def _is_long(rig: Rig, bound: int) -> bool:
    """Whether the sweep as it is planned takes too long."""
    added, plan = gap_drift(rig.case.scene_of("flown"), [rig.drive.omega]), rig.case.sweep
    drifted = rig.system if added is None else replace(rig.system, gap=rig.system.gap + float(added[0]))
    for system in (drifted, rig.system):  # a warm-up knows of no drift
        first = vibeam.simulate(system, rig.drive, 3 * rig.period, max_impacts=bound)
        cost = first.stats["cpu_seconds"] / 3 * (plan.settle + plan.hold) * 2 * len(plan.frequency)
        if len(first.impact_times) >= bound or cost >= COSTLY:
            return True
    return False


def _sweep(rig: Rig) -> vibeam.Branches:
    plan, scene, omega = rig.case.sweep, rig.case.scene_of("flown"), 2 * np.pi * rig.case.sweep.frequency
    drifts = gap_drift(scene, omega) is not None
    drift: Callable[[Array], Any] | None = (lambda at: gap_drift(scene, at)) if drifts else None
    found = vibeam.sweep(
        rig.system, omega=omega, amplitude=rig.case.amplitude_of("flown", omega), direction=plan.direction,
        settle=plan.settle, hold=plan.hold, output=plan.output, drift=drift, wear=gap_wear(scene),
        options=rig.case.fidelities["flown"].options,
    )  # fmt: skip
    return found if isinstance(found, vibeam.Branches) else vibeam.Branches(**{plan.direction: found})


def _complete(found: vibeam.FrequencyResponse, verdict: Verdict) -> None:
    done = found.ended == vibeam.Ended.COMPLETE.code
    for code in found.ended[~done]:
        verdict.count(f"points: {vibeam.Ended.of_code(int(code)).name}")
    for name in ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "rest", "mode_energy"):
        verdict.hold(bool(np.isfinite(getattr(found, name)[done]).all()), f"sweep: {name} is NaN where it is complete")


def _equal(one: vibeam.FrequencyResponse, other: vibeam.FrequencyResponse) -> bool:
    names = [each.name for each in fields(one) if each.name not in ("cpu_seconds", "frequency")]
    return all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in names)


CHECKS: dict[str, Callable[[Rig, Generator, Verdict], None]] = {
    "motion": motion,
    "sweep": swept,
    "steady": steady_agrees,
    "engines": engines_agree,
    "direct": direct_agrees,
    "orbits": orbits_hold,
    "certificate": certificate,
}
