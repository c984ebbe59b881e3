"""Two ways of computing a rig's motion that must agree: two engines, a sweep's point and ``simulate``, two solvers.

Where they may differ by round-off or a tolerance, the bar is what the motion itself makes of a small disturbance.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator
from verdict import Verdict

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import RegimeSolver
from vibeam.runs.sweep import march
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

if TYPE_CHECKING:
    from rig_checks import Rig

Array = np.ndarray

DISTURBED = 1e-9  # of the motion's size: how far starts are apart

WIDER = 1e3  # times the spread of disturbed motions that two ways may be apart

MOVING, DRIVEN = 1e-3, 1e-9  # of what statics hold, of the drive's velocity: what a motion must be at least

COSTLY = 0.1  # CPU seconds of a drive period that is not gone through again and again

CHAOTIC = 1e-3  # of a motion's size: a spread that says no more how disturbances grow

SAMPLES = 32  # of a motion, for its size

SHORT = 2  # drive periods

STIFFEST = 100.0  # frequency over the drive's above which ``direct`` takes too long

SECONDS = 1.0  # of CPU time that a sweep's impacts may take, about

FEW, MANY = 20, 5000  # impacts by which it is known what one costs, read off; those of a period at most

FLIGHT = 3e-6  # CPU seconds of an impact at least, a mode

DENSE = 1e3  # standard deviations of the plain engine: the other goes through dense matrices, which round more

FIRM = 1e-6  # error of an impact's velocity, as a share, up to which impacts are compared


def apart(rig: Rig, one: vibeam.State, other: vibeam.State) -> float:
    """Distance of two states, in √energy."""
    rate = np.where(rig.system.omega > 0, rig.system.omega, rig.drive.omega)
    return float(np.hypot(np.linalg.norm(rate * (one.displacement - other.displacement)),
                          np.linalg.norm(one.velocity - other.velocity)))  # fmt: skip


def size(rig: Rig, path: vibeam.Trajectory) -> float:
    """Largest of a motion's states from equilibrium, in √energy."""
    rate = np.where(rig.system.omega > 0, rig.system.omega, rig.drive.omega)
    poses = np.concatenate([path.segments.poses, path.modes_at(np.linspace(path.t_start, path.t_end, SAMPLES))])
    away = rate * (poses[:, 0] - equilibrium(rig.system).displacement)
    return float(np.sqrt(np.sum(away**2 + poses[:, 1] ** 2, axis=1)).max())


def moves(rig: Rig, whole: float) -> bool:
    """Whether a motion of that size, in √energy, is one beside what equilibrium holds and the drive could do."""
    held = float(np.linalg.norm(rig.system.omega * equilibrium(rig.system).displacement))
    driven = float(np.linalg.norm(rig.system.load)) * rig.drive.omega * abs(rig.drive.amplitude)
    return whole > max(MOVING * held, DRIVEN * driven)


def disturbed(rig: Rig, start: vibeam.State, amount: float, rng: Generator) -> vibeam.State:
    """Another place with other velocities, each ``amount`` away in √energy, off the stop or along it."""
    rate = np.where(rig.system.omega > 0, rig.system.omega, rig.drive.omega)
    there = start.displacement + _push(rig, amount, start.resting, rate, rng)
    return replace(start, displacement=there, velocity=start.velocity + _push(rig, amount, start.resting, 1.0, rng))


def _push(rig: Rig, amount: float, along: bool, rate: Array | float, rng: Generator) -> Array:
    """A random change whose product with ``rate`` is ``amount``, away from the stop, or ``along`` it."""
    push, c = rng.normal(size=rig.system.size) / rate, rig.system.contact
    if rig.system.size > 1 and along:
        push -= c * (c @ push) / (c @ c)
    return -abs(amount) * np.sign(c @ push or 1.0) * push / np.linalg.norm(rate * push)


def spread(rig: Rig, periods: int, last: vibeam.State, amount: float, rng: Generator) -> float:
    """How far motions disturbed at the start or half-way end from ``last`` at most."""
    found, middle, end = 0.0, periods * rig.period / 2, periods * rig.period
    half = vibeam.simulate(rig.system, rig.drive, middle, rig.start, max_impacts=MANY).state
    for begin, state in ((0.0, equilibrium(rig.system) if rig.start is None else rig.start), (middle, half)):
        for _ in range(2):
            other = disturbed(rig, state, amount, rng)
            path = vibeam.simulate(rig.system, rig.drive, end, other, t_start=begin, max_impacts=MANY)
            found = max(found, apart(rig, path.state, last))
            if path.stats["cpu_seconds"] > SECONDS:  # stiff modes carried along from a start that is nothing
                return found
    return found


def read_off(rig: Rig) -> tuple[float, float]:
    """CPU seconds of a drive period that is read off, up to ``FEW`` impacts, and about those of an impact."""
    begun = time.process_time()
    point, _ = next(march(
        rig.system, [rig.drive.omega], rig.drive.amplitude, settle=0, hold=1, options={"limit": FEW}
    ))  # fmt: skip
    seconds = time.process_time() - begun
    return seconds, max(seconds / max(int(point.impacts[0]), FEW), FLIGHT * rig.system.size)


def affordable(points: int, each: float) -> int:
    """Impacts a drive period of so many seconds each beyond which a point is given up, if all points have as many."""
    return int(np.clip(SECONDS / (points * each), FEW, MANY))


def steady_agrees(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """A point of a sweep without settling is the motion of ``simulate``."""
    if rig.cost > COSTLY:
        return
    path = vibeam.simulate(rig.system, rig.drive, SHORT * rig.period, rig.start, max_impacts=5000)
    if path.ended is not vibeam.Ended.COMPLETE:
        return
    point, last = next(march(
        rig.system, [rig.drive.omega], rig.drive.amplitude, settle=0, hold=SHORT, state=rig.start,
        options={"limit": affordable(1, read_off(rig)[1])},
    ))  # fmt: skip
    if point.ended[0] != vibeam.Ended.COMPLETE.code:
        return
    whole = size(rig, path)
    if not moves(rig, whole):
        return
    wide = spread(rig, SHORT, path.state, DISTURBED * whole, rng)
    if wide > CHAOTIC * whole:
        verdict.count("motions too sensitive to compare")
        return
    allowed = wide / DISTURBED * 1e-12 + 1e-11 * whole
    verdict.count("points beside simulate")
    verdict.measure("steady beside simulate", apart(rig, last, path.state) / (allowed * WIDER), 1.0)


def engines_agree(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """A plain system through the engine of all regimes: its firm impacts at the same times."""
    if rig.system.beyond_plain:
        return
    path = vibeam.simulate(rig.system, rig.drive, 6 * rig.period, rig.start, max_impacts=60)
    solver = RegimeSolver(rig.system, rig.drive.omega, 6 * rig.period)
    ended, last, after, segments, stats = solver.simulate(rig.drive, rig.start, 0.0, 6 * rig.period, 60)
    other = vibeam.Trajectory(rig.system, rig.drive, 0.0, last, after, ended, stats, solver, segments)
    errors, speeds = path.errors, path.impact_velocities
    before = path.rests[0, 0] if len(path.rests) else np.inf
    with np.errstate(invalid="ignore"):
        firm = (
            (errors.velocity < FIRM * speeds) & (path.impact_times < before) & (speeds > 1e-6 * speeds.max(initial=0))
        )
    count = int(np.cumprod(firm).sum())
    verdict.count("impacts in both engines", count)
    if len(other.impact_times) < count:
        verdict.find(f"engines: {count} firm impacts in one, {len(other.impact_times)} in the other")
    elif count:
        allowed = DENSE * errors.time[:count] + 1e-13 * path.impact_times[:count]
        off = np.abs(other.impact_times[:count] - path.impact_times[:count])
        verdict.measure("engines: times over what round-off allows", float(np.max(off / allowed)), 1.0)


def direct_agrees(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """Direct integration to 1e-10 ends where flight does."""
    system = rig.system
    yields = isinstance(system.law, LinearStop | HuntCrossley) or system.second_gap is not None
    rates = float(np.max(system.omega * (1 + system.zeta)))
    if yields or system.size > 6 or rates > STIFFEST * rig.drive.omega:
        return
    path = vibeam.simulate(system, rig.drive, SHORT * rig.period, rig.start, max_impacts=200)
    whole = size(rig, path)
    if path.ended is not vibeam.Ended.COMPLETE or len(path.impact_times) > 60 or not moves(rig, whole):
        return
    fine = whole / max(rates, rig.drive.omega)
    point, last = next(march(
        system, [rig.drive.omega], rig.drive.amplitude, settle=0, hold=SHORT, solver="direct", state=rig.start,
        options={"method": "DOP853", "rtol": 1e-10, "atol": 1e-12 * fine},
    ))  # fmt: skip
    if point.ended[0] != vibeam.Ended.COMPLETE.code:
        verdict.count(f"direct: {vibeam.Ended.of_code(int(point.ended[0])).name}")
        return
    wide = spread(rig, SHORT, path.state, DISTURBED * whole, rng)
    if wide > CHAOTIC * whole:
        verdict.count("motions too sensitive to compare")
        return
    allowed = wide + DISTURBED * whole
    verdict.count("motions beside direct integration")
    verdict.measure("direct beside flight", apart(rig, last, path.state) / (allowed * WIDER), 1.0)
