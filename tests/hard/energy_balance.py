"""The energy of a motion against the work that was done on it, segment by segment, and its loss at every impact.

With E = ½ Σ (η'² + ω²η²) − Σ static η the equations of ``ImpactSystem`` give, whatever the solver did,

    dE/dt = Ω²B sin Ωt Σ load η' − η'ᵀ C η' − F d'

with C = diag(2ζω) or the coupling, and F the force of a stop that yields, d its penetration. It is integrated here by
Gauss's quadrature over panels short beside the fastest mode. An impact takes ½ (1 − R²) v²/S.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

import vibeam
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

Array = np.ndarray

NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)

TURN = 1.5  # radians of the fastest mode in a panel

CURVED = 0.2  # the same where the force has kinks

MOST = 200  # panels of a segment that are looked at; an eighth of integrated contact, whose nodes cost more

STEPS = 30  # of integrated contact, about, each as costly as a node in closed form, from a segment's start to a node

LOOKS = 17  # instants of a contact at which its stiffness and damping are looked at


@dataclass(frozen=True)
class Balance:
    """Worst figures of a motion as shares of its largest energy, and how many segments were looked at."""

    flow: float  #: energy that came from nowhere, either sign, in a segment without integrated contact
    contact: float  #: the same in contact that is integrated
    impact: float  #: the same at an impact, beside ½ (1 − R²) v²/S
    gained: float  #: energy gained at an impact
    segments: int


def balance(path: vibeam.Trajectory, rng: Generator, work: float) -> Balance:
    """Of segments in random order, as many as ``work`` (modes times nodes) allows."""
    trace, size = path.segments.trace, path.system.size
    order = rng.permutation(np.flatnonzero(trace[:, layout.DURATION] > 0))
    scale, done, found = _scale(path), 0.0, {"flow": 0.0, "contact": 0.0, "impact": 0.0, "gained": 0.0}
    for index in order:
        if done >= work:
            break
        done += _segment(path, int(index), scale, found) * len(NODES) * size
        found["segments"] = found.get("segments", 0) + 1
    return Balance(**{"segments": 0} | found)


def _segment(path: vibeam.Trajectory, i: int, scale: float, found: dict[str, float]) -> int:
    """Worst figures so far, with those of segment ``i``; panels that it cost."""
    row = path.segments.trace[i]
    span = float(row[layout.DURATION])
    curved = row[layout.WHAT] == regime_layout.CONTACT and isinstance(path.system.law, HuntCrossley)
    panels = max(1, int(np.ceil(span * (rate_in(path, i) / CURVED if curved else _rate(path) / TURN))))
    looked = min(panels, MOST // 8 if curved else MOST)
    length = span * looked / panels
    edges = np.linspace(0.0, length, looked + 1)
    half = np.diff(edges)[:, None] / 2
    times = (edges[:-1, None] + half * (1 + NODES)).ravel()
    pose = poses(path, i, np.concatenate([[0.0], times, [length]]))
    power = _power(path, row, times, pose[1:-1]).reshape(-1, len(NODES))
    work = float(np.sum(power * WEIGHTS * half))
    energies = energy(path.system, pose[[0, -1]])
    kind = "contact" if curved else "flow"
    found[kind] = max(found[kind], abs(energies[1] - energies[0] - work) / scale)
    if row[layout.END] in (layout.IMPACT, layout.STUCK) and looked == panels and _hard(path.system):
        _impact(path, i, pose[-1], scale, found)
    return looked * (STEPS if curved else 1)


def _impact(path: vibeam.Trajectory, i: int, before: Array, scale: float, found: dict[str, float]) -> None:
    system, row = path.system, path.segments.trace[i]
    after = path.segments.poses[i + 1] if i + 1 < len(path.segments.poses) else _last(path)
    change = float(np.diff(energy(system, np.stack([before, after])))[0])
    speed, mobility = float(row[layout.BEFORE]), float(system.contact @ system.contact)
    back = system.restitution if system.law is None else system.law.at(speed)
    back = 0.0 if row[layout.END] == layout.STUCK else back
    found["impact"] = max(found["impact"], abs(change + (1 - back**2) * speed**2 / (2 * mobility)) / scale)
    found["gained"] = max(found["gained"], change / scale)


def poses(path: vibeam.Trajectory, i: int, times: Array) -> Array:
    """Poses (m, 2, n) at times since the start of segment ``i``, its end before an impact."""
    whole = path.segments
    alone = Segments(whole.trace[i : i + 1].copy(), whole.poses[i : i + 1], whole.size)
    alone.trace[0, layout.START] = 0.0
    return path._solver.poses_at(path.drive, alone, np.ascontiguousarray(times))


def energy(system: vibeam.ImpactSystem, pose: Array) -> Array:
    """½ Σ (η'² + ω²η²) − Σ static η of poses (m, 2, n)."""
    x, v = pose[:, 0], pose[:, 1]
    return 0.5 * np.sum(v**2 + (system.omega * x) ** 2, axis=1) - x @ system.static


def _power(path: vibeam.Trajectory, row: Array, times: Array, pose: Array) -> Array:
    """dE/dt (m,) by the equations of motion."""
    system, drive, v = path.system, path.drive, pose[:, 1]
    push = drive.omega**2 * drive.amplitude * np.sin(drive.omega * (row[layout.AT_CLOCK] + times))
    damper = np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling
    power = push * (v @ system.load) - np.einsum("ij,jk,ik->i", v, damper, v)
    if row[layout.WHAT] != regime_layout.CONTACT:
        return power
    depth, rate = _into(path, row, pose)
    return power - force(system.law, depth, rate) * rate


def _into(path: vibeam.Trajectory, row: Array, pose: Array) -> tuple[Array, Array]:
    """Penetration and its rate of poses (m, 2, n) at the stop of a segment."""
    system, second = path.system, len(row) > regime_layout.AT_SIDE and row[regime_layout.AT_SIDE] == 1
    side, gap = (-1.0, system.second_gap or 0.0) if second else (1.0, system.gap)
    return side * (pose[:, 0] @ system.contact) - gap, side * (pose[:, 1] @ system.contact)


def force(law: object, depth: Array, rate: Array) -> Array:
    """Of a stop that yields, by its formula where that pushes."""
    if isinstance(law, LinearStop):
        return law.stiffness * depth + law.damping * rate
    assert isinstance(law, HuntCrossley)
    return law.stiffness * np.maximum(depth, 0.0) ** law.exponent * np.maximum(1 + law.damping * rate, 0.0)


def _hard(system: vibeam.ImpactSystem) -> bool:
    return not isinstance(system.law, LinearStop | HuntCrossley)


def _rate(path: vibeam.Trajectory) -> float:
    """The fastest rate of the motion, rad/s."""
    system, law = path.system, path.system.law
    rates = system.omega * (1 + 2 * system.zeta)
    if system.coupling is not None:
        rates = system.omega + np.linalg.norm(system.coupling, 2)
    fastest = max(float(np.max(rates)), path.drive.omega)
    mobility = float(system.contact @ system.contact)
    if isinstance(law, LinearStop):
        return fastest + np.sqrt(law.stiffness * mobility) + law.damping * mobility
    return fastest


def rate_in(path: vibeam.Trajectory, i: int) -> float:
    """The same in segment ``i``, a contact by Hunt–Crossley's law: by the largest slopes of its force."""
    law, mobility = path.system.law, float(path.system.contact @ path.system.contact)
    row = path.segments.trace[i]
    depth, rate = _into(path, row, poses(path, i, np.linspace(0.0, row[layout.DURATION], LOOKS)))
    depth = np.maximum(depth, 0.0)
    stiff = law.stiffness * law.exponent * depth ** (law.exponent - 1) * np.maximum(1 + law.damping * rate, 0.0)
    damped = law.stiffness * law.damping * depth**law.exponent
    return _rate(path) + float(2 * np.sqrt(mobility * stiff.max()) + mobility * damped.max())


def _scale(path: vibeam.Trajectory) -> float:
    system = path.system
    pose = np.concatenate([path.segments.poses, _last(path)[None]])
    x, v = pose[:, 0], pose[:, 1]
    parts = 0.5 * np.sum(v**2 + (system.omega * x) ** 2, axis=1) + np.abs(x) @ np.abs(system.static)
    return float(parts.max() + _pumped(path)) or 1.0  # nothing moves: nothing may


def _pumped(path: vibeam.Trajectory) -> float:
    """Energy of the forced response, which may be larger than any at the segments' starts."""
    system, drive = path.system, path.drive
    below = np.abs(system.omega**2 - drive.omega**2) + 2 * system.zeta * system.omega * drive.omega
    forced = (
        np.abs(system.load) * drive.omega**2 * abs(drive.amplitude) / np.maximum(below, 1e-3 * drive.omega**2 + 1e-300)
    )
    return float(0.5 * np.sum((np.maximum(system.omega, drive.omega) * forced) ** 2))


def _last(path: vibeam.Trajectory) -> Array:
    return np.stack([path.state.displacement, path.state.velocity])
