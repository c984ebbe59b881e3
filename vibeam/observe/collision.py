"""One collision with the stop: what the contact, the first mode and the whole structure keep of their velocity.

A structure that moves in one mode meets the stop while all other modes are at rest. An elastic contact loses no energy
and yet mode 1 comes back slower, by what the impulse leaves in the other modes; the longer the contact lasts, the fewer
modes it excites. Restitution is then a result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.motion import Path, impacts_within, modes_around_impacts
from vibeam_models.arrays import Array


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
