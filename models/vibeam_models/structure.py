"""Structure: a linear structure of n coordinates, whatever made it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any, Self, TypeVar

import numpy as np

from vibeam_models.arguments import real_array, refuse
from vibeam_models.arrays import Array, ValueRecord

SYMMETRIC = 1e-9  # share of a matrix's largest entry by which two entries may differ
NODE = 1e-9  # share of a shape's largest value below which it is round-off
STIFF = 1e-9  # share of the largest ω² by which another may be negative and still be round-off
SINGULAR = 3e14  # times the deflection of the stiffest coordinate alone: round-off bounds it where nothing else does
FREE = (
    "structure: K: is singular, the body is free: no static deflection bears a load on it: "
    'hold it, or write reduction = "modal"'
)
ROUND_OFF = 1e-12  # of a mode's damping, a share of the sizes that it is summed from
MATRICES = ("M", "C", "K")
FIELDS = (*MATRICES, "load", "static", "contact", "outputs")
SOLVED = 8  # eigenproblems kept for other structures with the same matrices, whatever their damping and load
SMALL = 24  # coordinates of a problem that is solved as soon as looked up


@dataclass(frozen=True, eq=False, repr=False)
class Modes(ValueRecord):
    """Mass-normalised natural modes: ``omega`` (n,) rad/s ascending, ``shapes`` (size, n) with ΦᵀMΦ = I."""

    omega: Array
    shapes: Array

    @property
    def frequency(self) -> Array:
        """Natural frequencies (n,) in Hz."""
        return self.omega / (2 * np.pi)


@dataclass(frozen=True, eq=False, repr=False)
class Structure(ValueRecord):
    """M ẍ + C ẋ + K x = load · b̈(t) + static, with x relative to the base whose displacement is b(t).

    A finite-element beam and its one-mode model are both a Structure: whatever accepts the one accepts the other.

    - ``M``, ``C``, ``K``: mass, damping, stiffness (n, n), symmetric;
    - ``load``: (n,) force per unit base acceleration, −M r; minus the row of its place where a force −b̈ drives it;
    - ``static``: (n,) constant force, zero unless an effect brings one;
    - ``contact``: (n,) row w; the contact displacement is w·x, positive toward the stop;
    - ``outputs``: name → (n,) row; ``units``: name → unit of that output, metres where it is not named;
    - ``attached``: (n,) rows of the places that carry a mass or a moment of inertia of their own, in their order;
    - ``contact_flexibility``: m/N, a spring without mass between the coordinates and the contact: the contact is at w·x
      plus this times the force on it. 0 but of a reduction that leaves the contact without mass.

    Lists are kept as arrays of floats. ValueError names every field whose shape is wrong, that is not finite, or, of
    the matrices, not symmetric. An example with own matrices is in ``vibeam.ImpactSystem.from_structure``.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> (chain.modes().omega ** 2).round(9).tolist()
    [1.0, 3.0]
    """

    M: Array
    C: Array
    K: Array
    load: Array
    static: Array
    contact: Array
    outputs: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    attached: tuple[Array, ...] = ()
    contact_flexibility: float = 0.0
    _known: dict[str, Modes] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._settle(FIELDS)

    def _settle(self, names: Collection[str]) -> None:
        """Keep the named fields as arrays of floats; ValueError with every fault among them."""
        faults: list[str] = []
        clean: dict[str, Any] = {name: real_array(getattr(self, name)) for name in FIELDS[:-1] if name in names}
        outputs = {name: real_array(row) for name, row in self.outputs.items()} if "outputs" in names else {}
        matrices = (clean.get(name, getattr(self, name)) for name in MATRICES)
        size = next((len(each) for each in matrices if each is not None and each.ndim == 2), 0)
        for name, value in (clean | {f"outputs[{name!r}]": row for name, row in outputs.items()}).items():
            _check(name, value, (size, size) if name in MATRICES else (size,), faults)
        refuse("structure", faults)
        self.__dict__.update(clean | {"outputs": outputs} if "outputs" in names else clean)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.M.shape[0])

    def with_(self, **changes: Any) -> Self:
        """The same structure but for the named fields."""
        unknown = changes.keys() - {each.name for each in fields(self) if each.init}
        if unknown:
            raise TypeError(f"structure: no field {', '.join(sorted(unknown))}")
        changed = object.__new__(type(self))
        changed.__dict__.update(self.__dict__ | changes)
        if not changes.keys().isdisjoint(("M", "K", "contact")):
            changed.__dict__["_known"] = {}
        resized = "M" in changes and np.shape(changes["M"]) != self.M.shape
        changed._settle(FIELDS if resized else changes)
        return changed

    def modes(self, count: int | None = None) -> Modes:
        """The lowest ``count`` undamped modes (all where it is None), each positive at the contact (``signs``).

        ValueError where ``M`` is not positive definite or ``K`` not positive semidefinite.
        """
        if "modes" not in self._known:
            self._known["modes"] = self._solved()
        every = self._known["modes"]
        return every if count is None else Modes(every.omega[:count], every.shapes[:, :count])

    def deflection(self, force: Array) -> Array:
        """The static deflection (n,) under a ``force`` (n,) on the coordinates; ValueError of a free body."""
        if rank(self.K) < self.size:
            raise ValueError(FREE)
        return self.solved(force)

    def solved(self, force: Array) -> Array:
        """K⁻¹ force (n,), also where ``K`` is that of a steady vibration; ValueError where it has no inverse."""
        try:
            found = np.asarray(np.linalg.solve(self.K, force))
        except np.linalg.LinAlgError:
            raise ValueError(FREE) from None
        if not np.abs(found).max() * np.abs(self.K).max() < SINGULAR * np.abs(force).max():
            raise ValueError(FREE)
        return found

    def mobility(self, row: Array) -> float:
        """w M⁻¹ wᵀ of a ``row`` w (n,): the velocity that an impulse of one on it gives it."""
        return float(row @ np.linalg.solve(self.M, row))

    def flexibility(self, row: Array) -> float:
        """w K⁻¹ wᵀ of a ``row`` w (n,): its displacement under a steady force of one on it."""
        return float(row @ self.deflection(row))

    def held(self, rows: Array) -> tuple[Structure, Any]:
        """The undamped structure whose ``rows`` (k, n) do not move, and its coordinates Z (n, n − k): x = Z y."""
        basis = elimination(rows).toarray()
        return in_coordinates(self, basis, C=np.zeros((basis.shape[1],) * 2)), basis

    def congruent(self, name: str, basis: Array) -> Array:
        """BᵀAB of the matrix ``name``, for a ``basis`` B (n, fewer); symmetric to the bit."""
        matrix = getattr(self, name)
        if not matrix.any():  # no damping yet
            return np.zeros((basis.shape[1], basis.shape[1]))
        product = basis.T @ matrix @ basis
        return np.asarray((product + product.T) / 2)

    def modal_damping(self, modes: Modes) -> Array:
        """ΦᵀCΦ (k, k), 0 where round-off alone damps a mode: below 0, or of a rigid-body mode."""
        damping, sizes = self.congruent("C", modes.shapes), np.abs(modes.shapes)
        own, least = np.diag(damping), ROUND_OFF * np.sum(sizes * (abs(self.C) @ sizes), axis=0)
        none = (np.abs(own) <= least) & ((modes.omega == 0) | (own < 0))
        return np.where(none | none[:, None], 0.0, damping)

    def ritz_stiffness(self, basis: Array, forces: Array) -> Array:
        """ΦᵀKΦ (n, n) of a ``basis`` Φ (size, n) whose ``forces`` KΦ (size, n) are known, without that product's loss.

        The product is exact to the round-off of the highest ω², which leaves nothing of the first mode's on a fine
        mesh. It is ηᵀω²η with η = modesᵀMΦ, in which an error of a high mode's share counts squared.
        """
        modes = self.modes()
        shares = modes.omega[:, None] * (modes.shapes.T @ (self.M @ basis))
        product = shares.T @ shares
        return np.asarray((product + product.T) / 2)

    def _solved(self) -> Modes:
        size, K, M = self.size, self.K, self.M
        try:
            squared, shapes = natural_modes(K, M) if size <= SMALL else _modes_of(size, K.tobytes(), M.tobytes())
        except np.linalg.LinAlgError:
            raise ValueError("structure: M: must be positive definite: every coordinate needs a mass") from None
        if squared[0] < -STIFF * abs(squared[-1]):
            raise ValueError("structure: K: must be positive semidefinite: a direction has negative stiffness")
        return self._modes(squared, shapes)

    def _modes(self, squared: Array, shapes: Array) -> Modes:
        """Modes by ω² and shapes: each positive at the contact, of the rigid-body modes the first alone moves it.

        Any turn of these among themselves would do; so that round-off does not choose, outputs and load follow.
        """
        rigid = shapes[:, squared <= 0]
        if rigid.shape[1] > 1:
            rows = [self.contact, *self.outputs.values(), self.load]
            shapes = np.column_stack([rigid @ turned(np.array(rows) @ rigid), shapes[:, rigid.shape[1] :]])
        return Modes(np.sqrt(np.maximum(squared, 0.0)), shapes * signs(shapes, self.contact))


AStructure = TypeVar("AStructure", bound=Structure)


def signs(shapes: Array, contact: Array) -> Array:
    """±1 (k,) that makes shapes (n, k) positive at the ``contact`` (n,); where a node lies there, at the first motion.

    A value is a node's if it is round-off beside the largest one of all shapes at that place.
    """
    sizes = np.abs(shapes)
    first = np.take_along_axis(shapes, np.argmax(sizes > NODE * sizes.max(axis=0), axis=0)[None], axis=0)[0]
    at_contact = contact @ shapes
    node = np.abs(at_contact) <= NODE * (np.abs(contact) @ sizes.max(axis=1))
    return np.where(np.where(node, first, at_contact) < 0, -1.0, 1.0)


def turned(readings: Array) -> Array:
    """Orthogonal matrix (k, k) whose columns follow what ``readings`` (rows, k) see, by Gram and Schmidt."""
    columns = np.zeros((readings.shape[1], 0))
    for reading in np.vstack([readings, np.eye(readings.shape[1])]):
        rest = reading
        for _ in range(2):
            rest = rest - columns @ (columns.T @ rest)
        if np.linalg.norm(rest) > NODE * np.linalg.norm(reading):
            columns = np.column_stack([columns, rest / np.linalg.norm(rest)])
    return columns


def _check(name: str, value: Array | None, shape: tuple[int, ...], faults: list[str]) -> None:
    if value is None or value.shape != shape or not value.size or not np.isfinite(value).all():
        faults.append(f"{name}: must be {' × '.join(map(str, shape)) if shape[0] else 'n × n'} finite numbers")
    elif value.ndim == 2 and not _symmetric(value):
        faults.append(f"{name}: must be symmetric")


def _symmetric(matrix: Array) -> bool:
    if np.array_equal(matrix, matrix.T):
        return True
    return bool(np.max(np.abs(matrix - matrix.T)) <= SYMMETRIC * np.max(np.abs(matrix)))


def elimination(rows: Array) -> Any:
    """Z (n, n − k), sparse, with rows @ Z = 0 for independent ``rows`` (k, n): x = Z y holds them.

    Of each row one coordinate goes, chosen by QR with column pivoting; all others stay as they are.
    """
    from scipy.linalg import qr
    from scipy.sparse import csc_array, lil_array

    count, size = rows.shape
    order = qr(rows, mode="r", pivoting=True)[1]
    gone, left = np.sort(order[:count]), np.sort(order[count:])
    made = lil_array((size, len(left)))
    made[left, np.arange(len(left))] = 1.0
    ties = -np.linalg.solve(rows[:, gone], rows[:, left])
    for coordinate, tie in zip(gone, ties, strict=True):
        used = np.flatnonzero(tie)
        made[[coordinate], used] = tie[used]
    return csc_array(made)


def in_coordinates(structure: Structure, basis: Array, **known: Array) -> Structure:
    """The structure in coordinates y with x = basis @ y, ``basis`` (n, fewer): BᵀMB, Bᵀload, w B …

    ``known``: fields that are known already.
    """
    matrices = {name: structure.congruent(name, basis) for name in MATRICES if name not in known}
    return Structure(
        units=structure.units,
        load=structure.load @ basis,
        static=structure.static @ basis,
        contact=structure.contact @ basis,
        outputs={name: row @ basis for name, row in structure.outputs.items()},
        attached=tuple(row @ basis for row in structure.attached),
        contact_flexibility=structure.contact_flexibility,
        **(matrices | known),
    )


def _blocks(one: Array, two: Array) -> Array:
    empty = np.zeros((len(one), len(two)))
    return np.block([[one, empty], [empty.T, two]])


def side_by_side(
    one: AStructure, two: AStructure, contact: Array, blocks: Callable[[Any, Any], Any] = _blocks
) -> AStructure:
    """Both structures as one, the coordinates of ``one`` first; ``contact`` (n₁ + n₂,): the row of what they share.

    Outputs and their units are those of ``one``, then those of ``two``. ``blocks``: two matrices as one.
    """
    ahead, beyond = np.zeros(one.size), np.zeros(two.size)
    ours = {name: np.concatenate([row, beyond]) for name, row in one.outputs.items()}
    theirs = {name: np.concatenate([ahead, row]) for name, row in two.outputs.items()}
    return type(one)(
        M=blocks(one.M, two.M),
        C=blocks(one.C, two.C),
        K=blocks(one.K, two.K),
        load=np.concatenate([one.load, two.load]),
        static=np.concatenate([one.static, two.static]),
        contact=contact,
        outputs=ours | theirs,
        units={**one.units, **two.units},
        attached=(
            *(np.concatenate([row, beyond]) for row in one.attached),
            *(np.concatenate([ahead, row]) for row in two.attached),
        ),
    )


def natural_modes(K: Array, M: Array) -> tuple[Array, Array]:
    """ω² (n,) ascending and shapes (n, n) with ΦᵀMΦ = I; ``M`` positive definite, ``K`` positive semidefinite.

    Solved as it stands, the problem is exact to 10⁻¹⁶ of the *highest* ω², which leaves little or nothing of the first
    mode on a fine or light beam; so the modes below the geometric middle come from M φ = (ω² + s)⁻¹ (K + s M) φ. s is
    0, or of a free body the first ω² above 0; its rigid-body modes are at 0. A negative ω² is left as it is.
    LinAlgError: ``M`` is not positive definite.
    """
    squared, shapes = eigenpairs(K, M)
    if squared[0] < -STIFF * abs(squared[-1]):
        return squared, shapes
    free = len(K) - rank(K)
    if free == len(K):
        return np.zeros(free), shapes
    shift = max(squared[free], len(K) * np.finfo(float).eps * squared[-1]) if free else 0.0
    try:
        inverse, flexible = eigenpairs(M, K + shift * M)
    except np.linalg.LinAlgError:
        return squared, shapes
    inverse, flexible = inverse[::-1], flexible[:, ::-1]
    low = int(np.count_nonzero(inverse > 1 / np.sqrt(squared[-1] / inverse[0])))
    squared[:low] = 1 / inverse[:low] - shift
    squared[:free] = 0.0
    shapes[:, :low] = flexible[:, :low] / np.sqrt(inverse[:low])
    return squared, shapes


def rank(K: Array) -> int:
    """The rank of ``K`` ≥ 0, by Cholesky's factors with pivoting of what it is with a diagonal of ones."""
    from scipy.linalg.lapack import dpstrf

    scale = np.sqrt(np.maximum(np.abs(np.diag(K)), np.finfo(float).tiny))
    return int(dpstrf(K / np.outer(scale, scale))[2])


@lru_cache(maxsize=SOLVED)
def _modes_of(size: int, K: bytes, M: bytes) -> tuple[Array, Array]:
    """As ``natural_modes``, read-only; solved once for matrices with the same bits, of the last few problems."""
    made = natural_modes(*(np.frombuffer(each).reshape(size, size) for each in (K, M)))
    for each in made:
        each.setflags(write=False)
    return made


def eigenpairs(A: Array, B: Array) -> tuple[Array, Array]:
    """Eigenvalues (n,) ascending and vectors (n, n) of A x = λ B x with xᵀBx = 1, by divide and conquer.

    What ``scipy.linalg.eigh`` calls, without its preparations. LinAlgError: ``B`` is not positive definite.
    """
    from scipy.linalg.lapack import dsygvd

    values, vectors, fault = dsygvd(A, B)
    if fault:
        raise np.linalg.LinAlgError(f"dsygvd: {fault}")
    return values, vectors


def with_inertia(structure: Structure, row: Array, inertia: float, translation: float) -> Structure:
    """The structure with ``inertia`` (kg, or kg m² on a slope) on the coordinate row·x, ``row`` (n,).

    ``translation``: what the coordinate reads when the base moves by 1 m: 1 for a deflection, 0 for a slope.
    """
    mass = structure.M + inertia * np.outer(row, row)
    attached = (*structure.attached, np.asarray(row, dtype=float))
    return structure.with_(M=mass, load=structure.load - inertia * translation * row, attached=attached)
