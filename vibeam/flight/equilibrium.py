"""Contacts of a system as arrays, forces that only push, and the static equilibrium on them.

Static equilibrium, on the stop if the stop is in the way, is the start of a computation that is given none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.linear.regimes import damper_of, fastest_rate, numbers_of
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Flags

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import Spring, StopLaw

#: rate of a mode without stiffness, as a share of the slowest other one, where the least energy is asked for
SOFT = 1e-3
LOST = 1e-14  # share of the gap by which the contact may miss the stop that it rests on
SMALLEST = 1e-150  # rad/s
DRIVEN = 10.0  # how much larger than the base motion times its share a driven mode is taken to be
IMPOSSIBLE = 1e-12  # residual of least distance programming that is none
NEAR = 1e-9  # share of the largest penetration within which a contact counts as at its stop
ROUNDS = 200  # of Newton's method
SETTLED = 1e-15  # share of the displacement by which its last step may still move it
ROUGHLY = 1e-6  # share above which that is no round-off
STEP = 1e-4  # share of a penetration over which its stiffness is taken
STRONG = 1e6  # drive over start beyond which the size of the motion is that of the start


@dataclass(frozen=True)
class Contacts:
    """k contacts of a system: the first stop, the second one on its other side if there is one, the further ones."""

    system: ImpactSystem
    rows: Array  # (k, n)
    gaps: Array  # (k,)
    laws: tuple[StopLaw, ...]  # k

    @classmethod
    def of(cls, system: ImpactSystem) -> Contacts:
        """The contacts of ``system``, in their order."""
        found = [(system.contact, system.gap, system.contact_law)]
        if system.second_gap is not None:
            found.append((-system.contact, system.second_gap, system.contact_law))
        found += [(each.row, each.gap, each.contact_law) for each in system.further or ()]
        rows, gaps, laws = zip(*found, strict=True)
        return cls(system, np.array(rows), np.array(gaps), tuple(laws))

    @property
    def springs(self) -> list[Spring | None]:
        """Stiffness and damping of those that are linear stops."""
        return [law.spring for law in self.laws]

    @property
    def fastest_rate(self) -> float:
        """The highest rate (rad/s) that panels must resolve, whichever linear stops push."""
        each = [(law, float(row @ row)) for row, law in zip(self.rows, self.springs, strict=True) if law]
        stiffness = sum(law.stiffness * mobility for law, mobility in each)
        damping = sum(law.damping * mobility for law, mobility in each)
        return float(np.hypot(fastest_rate(self.system), np.sqrt(stiffness))) + damping

    def kernel_laws(self) -> tuple[Array, Array]:
        """The laws' numbers (k, LAW_ROWS) for the kernels; their tables R(v) (k, 3, m), the last point repeated."""
        found = [numbers_of(law, 1.0, float(row @ row)) for row, law in zip(self.rows, self.laws, strict=True)]
        longest = max(table.shape[1] for _, table in found)
        tables = [
            np.pad(table, ((0, 0), (0, longest - table.shape[1])), "edge" if table.size else "constant")
            for _, table in found
        ]
        return np.array([numbers for numbers, _ in found]), np.array(tables)

    @cached_property
    def spring(self) -> Array:
        """ω² (n,)."""
        return self.system.omega**2

    @cached_property
    def damper(self) -> Array:
        """Modal damping matrix (n, n)."""
        return damper_of(self.system)

    @cached_property
    def yields(self) -> Array:
        """1/ω² (n,), large and finite for a mode without stiffness."""
        omega = self.system.omega
        slowest = float(np.min(omega[omega > 0], initial=np.inf))
        loose = SOFT * slowest if np.isfinite(slowest) else 1.0
        return np.asarray(np.where(omega > 0, omega, loose) ** -2.0)

    def clearances(self, displacement: Array) -> Array:
        """Gap of every contact (k,), m."""
        return np.asarray(self.gaps - self.rows @ displacement)


def one_sided(rows: Array, vector: Array) -> Array:
    """μ ≥ 0 (k,) that minimises |vector − rowsᵀ μ|: what is left is not positive along any row, 0 where μ > 0.

    Lawson & Hanson, Solving Least Squares Problems, 1974, ch. 23.
    """
    if len(rows) == 1:
        return np.maximum(rows @ vector, 0.0) / float(rows[0] @ rows[0])
    from scipy.optimize import nnls

    sizes, size = np.linalg.norm(rows, axis=1), float(np.linalg.norm(vector)) or 1.0
    found, _ = nnls((rows / sizes[:, None]).T, vector / size)
    return np.asarray(found * size / sizes)


def multipliers(rows: Array) -> Array:
    """(k, n): what takes a vector to the μ that minimise |vector − rowsᵀ μ|, whatever their sign."""
    if len(rows) == 1:
        return np.asarray(rows / float(rows[0] @ rows[0]))
    return np.asarray(np.linalg.pinv(rows @ rows.T, hermitian=True) @ rows)


def equilibrium(system: ImpactSystem) -> State:
    """The static equilibrium, resting on the stop where the free one lies beyond it.

    Modes without stiffness (ω = 0) have no equilibrium of their own: they start at zero displacement, and where that
    lies beyond the stop, they alone carry the contact point back to it.
    """
    if system.further is not None:
        return equilibrium_on_contacts(system)
    if system.beyond_plain:
        return equilibrium_with_law(system)
    (pose,), (resting,) = equilibria(system, np.array([system.gap]))
    return State(pose[0], pose[1], bool(resting))


def equilibria(system: ImpactSystem, gaps: Array) -> tuple[Array, Flags]:
    """Static equilibria of a plain system for each of ``gaps`` (m,): poses (m, 2, n), and whether on the stop (m,)."""
    moving, free = system.omega > 0, without_stop(system)
    poses = np.zeros((len(gaps), 2, system.size))
    poses[:, 0] = free
    beyond = float(system.contact @ free) - gaps
    on = beyond > 0
    if not on.any():
        return poses, on
    loose = ~moving & (system.contact != 0)
    softly = system.contact / np.where(moving, system.omega, 1.0) ** 2
    shape = np.where(loose, system.contact, 0.0) if loose.any() else softly
    over = float(system.contact @ shape)
    at = free - shape * (beyond / over)[:, None]
    left = products(at, system.contact) - gaps
    off = np.abs(left) > LOST * np.abs(gaps)  # round-off of a free displacement far beyond the stop
    at[off] -= shape * (left[off] / over)[:, None]
    poses[on, 0] = at[on]
    return poses, on


def products(rows: Array, row: Array) -> Array:
    """Products of ``rows`` (m, n) with one row, each summed as if it were alone."""
    return np.asarray((np.ascontiguousarray(rows)[:, None, :] @ np.ascontiguousarray(row)[:, None])[:, 0, 0])


def without_stop(system: ImpactSystem) -> Array:
    """The displacements (n,) under the static forces alone; 0 of modes without stiffness."""
    moving = system.omega > 0
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        free = np.where(moving & (system.static != 0), system.static / np.where(moving, system.omega, 1.0) ** 2, 0.0)
    if not np.isfinite(free).all():
        raise ValueError("static: no float holds the equilibrium, static over omega²: take other units")
    return free


def size_of_motion(system: ImpactSystem, drive: Drive, pose: Array) -> float:
    """About how large the modal displacements are: those of a start ``pose`` (2, n), a swing on, and the drive's.

    What steady response lies far beyond it costs digits when it is taken out of the state and put back. A drive so
    strong that the start is nothing against it is left out: what happens first happens before it has its full effect.
    (Not so of a start from nothing, which has no size to be kept.)
    """
    turn = 1 / np.where(system.omega > SMALLEST, system.omega, np.inf)
    start = float(np.max(np.abs(pose[0]) + np.abs(pose[1]) * turn))
    driven = DRIVEN * abs(drive.amplitude) * float(np.abs(system.load).max())
    return start if driven > STRONG * start > 0 else start + driven


def equilibrium_with_law(system: ImpactSystem) -> State:
    """The static equilibrium: of a hard stop as for every solver, of one that yields where the forces balance.

    Modes without stiffness start at zero displacement and carry no contact force.
    """
    free = without_stop(system)
    for row, gap in ((system.contact, system.gap), (-system.contact, system.second_gap)):
        if gap is None or (beyond := float(row @ free) - gap) <= 0:
            continue
        if not system.contact_law.yields:
            found = equilibrium(replace(system, gap=gap, contact=row, law=None, coupling=None, second_gap=None))
            return State(found.displacement, found.velocity, True)
        give = np.where(system.omega > 0, row / np.where(system.omega > 0, system.omega, 1.0) ** 2, 0.0)
        force = system.contact_law.balance(beyond, float(row @ give))
        return State(free - give * force, np.zeros(system.size))
    return State(free, np.zeros(system.size))


def equilibrium_on_contacts(system: ImpactSystem) -> State:
    """The static equilibrium among several contacts: the least energy that the stops allow.

    ValueError where every displacement is beyond one of them, or Newton's method finds none. A mode without stiffness
    starts at zero, or where the stops push it.
    """
    contacts, free = Contacts.of(system), without_stop(system)
    soft = [j for j, law in enumerate(contacts.laws) if law.yields]
    rigid = [j for j, law in enumerate(contacts.laws) if not law.yields]
    found, resting = _on_rigid(contacts, rigid, free, np.diag(np.sqrt(contacts.yields)))
    for _ in range(ROUNDS if soft else 0):  # Newton's method, each step among the rigid stops
        deep = contacts.rows[soft] @ found - contacts.gaps[soft]
        pushes = [_push(contacts.laws[j], max(float(d), 0.0)) for j, d in zip(soft, deep, strict=True)]
        force, stiff = np.array(pushes).T
        stiffness = np.diag(1 / contacts.yields) + (contacts.rows[soft].T * stiff) @ contacts.rows[soft]
        pull = free / contacts.yields + (stiff * (deep + contacts.gaps[soft]) - force) @ contacts.rows[soft]
        half = np.linalg.inv(np.linalg.cholesky(stiffness)).T
        before = found
        found, resting = _on_rigid(contacts, rigid, half @ (half.T @ pull), half)
        change, size = np.max(np.abs(found - before)), np.max(np.abs(found))
        if change <= SETTLED * size:
            break
    else:
        if soft and change > ROUGHLY * size:
            raise ValueError("contacts: Newton's method finds no static equilibrium among the stops that yield")
    return State(found, np.zeros(system.size), resting=resting)


def _push(law: StopLaw, depth: float) -> tuple[float, float]:
    """Static force of a stop that yields, and its stiffness there."""
    if depth <= 0:
        return 0.0, 0.0
    low, here, high = law.force(depth * np.array([1 - STEP, 1.0, 1 + STEP]), np.zeros(3)).tolist()
    return here, (high - low) / (2 * STEP * depth)


def _on_rigid(contacts: Contacts, rigid: list[int], free: Array, half: Array) -> tuple[Array, bool]:
    """The displacement nearest to ``free`` among rigid stops, and whether it is on one; ``half`` halfᵀ: compliance.

    Least distance programming (Lawson & Hanson 1974, ch. 23): μ ≥ 0 that minimises |Sᵀμ|² + (1 − hᵀμ)².
    """
    beyond = contacts.rows[rigid] @ free - contacts.gaps[rigid]
    if np.all(beyond <= 0):
        return free, False
    rows, size = contacts.rows[rigid] @ half, float(np.max(beyond))
    scale = float(np.max(np.linalg.norm(rows, axis=1)))
    sides = np.concatenate([-rows / scale, beyond[:, None] / size], axis=1)
    left = np.append(np.zeros(len(free)), 1.0) - one_sided(sides, np.append(np.zeros(len(free)), 1.0)) @ sides
    if left[-1] < IMPOSSIBLE:
        raise ValueError("contacts: nothing fits between the stops")
    moved = free - half @ left[:-1] / left[-1] * (size / scale)
    at = np.flatnonzero(contacts.rows[rigid] @ moved - contacts.gaps[rigid] > -size * NEAR)
    rows = contacts.rows[rigid][at]
    soft = half @ half.T @ rows.T
    put = free - soft @ (np.linalg.pinv(rows @ soft, hermitian=True) @ (rows @ free - contacts.gaps[rigid][at]))
    return put, True
