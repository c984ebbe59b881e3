"""Coefficients of restitution: of one collision, and apparent ones at a sensor (paper Fig. 25–26, Table 1).

A structure that moves in one mode meets the stop while all other modes are at rest. An elastic contact loses no energy
and yet mode 1 comes back slower, by what the impulse leaves in the other modes; the longer the contact lasts, the fewer
modes it excites. ApparentRestitution is then a result.

At a sensor the right method depends on time scales. The contact's own R is ``true_restitution``. Away from the
contact the impulse arrives as a bending wave: the more modes, the less does the sensor's velocity jump at the instant
of impact (its coefficient tends to −1), and the apparent one is that of the slow part, the first mode:
``mode_restitution``, R₁ where only mode 1 moves before the impact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.observe.motion import Path, impacts_within, modes_around_impacts
from vibeam.observe.slow_motion import SlowPart, solved
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, ValueRecord


@dataclass(frozen=True, eq=False, repr=False)
class ApparentRestitution(ValueRecord):
    """One entry an impact: ``time`` s, velocities ``before`` and ``after`` m/s, NaN where they could not be read."""

    time: Array
    before: Array
    after: Array

    @property
    def coefficient(self) -> Array:
        """−after/before of each impact."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(self.before != 0, -self.after / self.before, np.nan))

    @property
    def mean(self) -> float:
        """Over the impacts that could be read; NaN without any."""
        read = self.coefficient[np.isfinite(self.coefficient)]
        return float(np.mean(read)) if len(read) else float("nan")


def _instants(path: Path) -> Array:
    if path.system.contact_law.yields:
        raise ValueError("a stop that yields has no instant of impact: path.contacts has what happens at it")
    return impacts_within(path, path.t_start, path.t_end)


def true_restitution(path: Path, output: str = "contact") -> ApparentRestitution:
    """Restitution from the exact velocities of an output just before and after every impact.

    KeyError for an unknown output; ValueError for a stop that yields, where no instant parts before from after.
    """
    hits = _instants(path)
    row = path.system.output(output)
    before, after = modes_around_impacts(path, hits)
    return ApparentRestitution(hits[:, 0], before[:, 1] @ row, after[:, 1] @ row)


def mode_restitution(path: Path, mode: int = 0) -> ApparentRestitution:
    """Restitution of one mode alone: −η'⁺/η'⁻ in modal velocities; IndexError for an unknown mode."""
    hits = _instants(path)
    before, after = modes_around_impacts(path, hits)
    return ApparentRestitution(hits[:, 0], before[:, 1, mode], after[:, 1, mode])


def first_mode_restitution(system: ImpactSystem) -> float:
    """Apparent restitution R₁ = (1+R) c₁²/S − 1 of the slowest mode at any sensor; only it moves before impact."""
    slow = int(np.argmin(system.omega))
    return float((1 + system.restitution) * system.contact[slow] ** 2 / np.sum(system.contact**2) - 1)


def adjacent_restitution(
    time: ArrayLike, velocity: ArrayLike, impact_times: ArrayLike, *, skip: int = 0, delay: float = 0.0
) -> ApparentRestitution:
    """Restitution by the paper's method: samples (m,) of velocity next to the impact, ``skip`` samples away from it.

    With skip 0 a central difference reaches over the impact; skip 1 is the nearest that does not. ``delay`` s of
    the filter, by which the impact appears later.
    """
    t, v = np.asarray(time, dtype=float), np.asarray(velocity, dtype=float)
    hits = np.asarray(impact_times, dtype=float)
    index = np.searchsorted(t, hits + delay, side="right")
    return ApparentRestitution(hits, _picked(v, index - 1 - skip), _picked(v, index + skip))


def extremum_restitution(
    time: ArrayLike, velocity: ArrayLike, impact_times: ArrayLike, *, window: float, delay: float = 0.0
) -> ApparentRestitution:
    """Restitution from the largest velocity within ``window`` s before and the least ``window`` s after each impact."""
    t, v = np.asarray(time, dtype=float), np.asarray(velocity, dtype=float)
    hits = np.asarray(impact_times, dtype=float)
    before = [_extreme(v[(t >= hit + delay - window) & (t <= hit + delay)], np.max) for hit in hits]
    after = [_extreme(v[(t >= hit + delay) & (t <= hit + delay + window)], np.min) for hit in hits]
    return ApparentRestitution(hits, np.array(before), np.array(after))


def extrapolated_restitution(
    time: ArrayLike, displacement: ArrayLike, impact_times: ArrayLike, slow: SlowPart, *,
    window: float, guard: float = 0.0, delay: float = 0.0, beside: SlowPart | None = None,
) -> ApparentRestitution:  # fmt: skip
    """Restitution from fits of the slow part to displacements within ``window`` s before and after each impact.

    ``beside``: vibrations of further modes, fitted along but not used; without them they bias the slow part.
    ``guard`` s: left out next to impacts (where a filter smears). A stretch ends at the neighbouring impacts.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(displacement, dtype=float)
    hits = np.asarray(impact_times, dtype=float)
    delayed = hits + delay
    before, after = np.full(len(hits), np.nan), np.full(len(hits), np.nan)
    for i, hit in enumerate(delayed):
        since = max(hit - window, delayed[i - 1] + guard if i else -np.inf)
        until = min(hit + window, delayed[i + 1] - guard if i + 1 < len(delayed) else np.inf)
        before[i] = _extrapolated(t, x, slow, beside, since, hit - guard, hit)
        after[i] = _extrapolated(t, x, slow, beside, hit + guard, until, hit)
    return ApparentRestitution(hits, before, after)


def _extrapolated(
    t: Array, x: Array, slow: SlowPart, beside: SlowPart | None, begin: float, end: float, hit: float
) -> float:
    """Rate at ``hit`` of the slow part fitted to [begin, end]; NaN with too few samples."""
    part = (t >= begin) & (t <= end)
    if np.count_nonzero(part) < 2 * (slow.size + (beside.size if beside else 0)):
        return float("nan")
    clock = t[part] - t[part][0]
    columns = slow.columns(clock)[0]
    if beside is not None:
        columns = np.concatenate([columns, beside.columns(clock)[0]], axis=1)
    rates = slow.columns(np.array([hit - t[part][0]]))[1]
    return float(rates[0] @ solved(columns, x[part])[: slow.size])


def _picked(values: Array, index: NDArray[np.int64]) -> Array:
    inside = (index >= 0) & (index < len(values))
    return np.where(inside, values[np.clip(index, 0, len(values) - 1)], np.nan)


def _extreme(values: Array, pick: Callable[[Array], np.float64]) -> float:
    return float(pick(values)) if len(values) else float("nan")


@dataclass(frozen=True)
class Collision:
    """One collision, from the first touch to the last separation before the end of the motion.

    ``speed`` m/s: of the contact at first touch. ``restitution``: −v⁺/v⁻ of the contact over the first touch.
    ``mode_restitution``: −η'⁺/η'⁻ of the mode, its free motions before and after extrapolated to the middle of the
    first touch; above 1 where a touch damps less than the free motion that it replaces. ``energy_restitution``:
    √(E⁺/E⁻) of all modes. ``mode_share``: of the energy E⁺ that is the mode's. ``duration`` s and ``force`` N: of the
    first touch, 0 and NaN for an impact; ``touches``: their number.
    """

    speed: float
    restitution: float
    mode_restitution: float
    energy_restitution: float
    mode_share: float
    duration: float
    force: float
    touches: int


def collision_of(path: Path, contacts: ArrayLike | None = None, mode: int = 0) -> Collision:
    """Read a motion that begins at the stop, moving in ``mode`` alone, without drive.

    ``contacts`` (m, 3): of a stop that yields, as in ``Trajectory.contacts``; None: impacts. ValueError for a motion
    with no touch, with a touch that has not ended, or with damping that couples the modes.
    """
    system = path.system
    if system.coupling is not None:
        raise ValueError("collision: with damping that couples the modes no mode has a motion of its own")
    touches = _touches(path, contacts)
    if not len(touches) or touches[-1, 1] >= path.t_end:
        raise ValueError("collision: the motion has no touch that ends")
    start, first, last = _poses(path, touches, contacts is None)
    middle = np.mean(touches[0, :2])
    rates = [
        _free_rate(float(system.omega[mode]), float(system.zeta[mode]), pose[:, mode], middle - t)
        for pose, t in ((start, touches[0, 0]), (last, touches[-1, 1]))
    ]
    before, after = _energies(system.omega, start), _energies(system.omega, last)
    speed = float(system.contact @ start[1])
    return Collision(
        speed=speed,
        restitution=float(-(system.contact @ first[1]) / speed),
        mode_restitution=float(-rates[1] / rates[0]),
        energy_restitution=float(np.sqrt(np.sum(after) / np.sum(before))),
        mode_share=float(after[mode] / np.sum(after)),
        duration=float(touches[0, 1] - touches[0, 0]),
        force=float(touches[0, 2]),
        touches=len(touches),
    )


def _touches(path: Path, contacts: ArrayLike | None) -> Array:
    """Begin and end, s, and largest force, N, of each touch (m, 3)."""
    if contacts is None:
        return np.stack([path.impact_times, path.impact_times, np.full(len(path.impact_times), np.nan)], axis=1)
    rows = np.asarray(contacts, dtype=float)
    return np.stack([rows[:, 0], rows[:, 0] + rows[:, 1], rows[:, 2]], axis=1)


def _poses(path: Path, touches: Array, sudden: bool) -> tuple[Array, Array, Array]:
    """Poses (2, n) at the first touch, after it and after the last one; ``sudden``: touches are impacts."""
    if sudden:
        before, after = modes_around_impacts(path, impacts_within(path, path.t_start, path.t_end))
        return before[0], after[0], after[-1]
    start, first, last = path.modes_at([touches[0, 0], touches[0, 1], touches[-1, 1]])
    return start, first, last


def _energies(omega: Array, pose: Array) -> Array:
    """Twice the energy (n,) of each mode of a pose (2, n)."""
    return np.asarray(pose[1] ** 2 + (omega * pose[0]) ** 2)


def _free_rate(omega: float, zeta: float, pose: Array, elapsed: float) -> float:
    """Rate of a free mode ``elapsed`` s (of either sign) after the pose (η, η')."""
    root = omega * np.sqrt(complex(zeta**2 - 1))
    turn = np.sinh(root * elapsed) / root if root != 0 else elapsed
    rate = pose[1] * np.cosh(root * elapsed) - (zeta * omega * pose[1] + omega**2 * pose[0]) * turn
    return float((np.exp(-zeta * omega * elapsed) * rate).real)
