"""Forward models of a fit: modal data of a fidelity at values of the keys, and as polynomials of them over a box.

Natural frequencies, mode shapes, gap, restitution and drive are smooth functions of the keys as long as no two modes
cross. Over a box they are fitted by least squares in products of Chebyshev polynomials, of total degree ≤ p in the keys
of the structure (which change frequencies or shapes) and ≤ q in the others, over quasi-random points of Chebyshev's
density, half as many again as there are terms (Cohen, Davenport & Leviatan, Found. Comput. Math. 13 (2013): stable
from points of that density). Gap, gain, restitution and damping enter as polynomials of degree one or two, which are
met to round-off; p grows until two points that were not used are met to a tolerance, or the points are too many. A fit
does not rely on that bound: it compares its residuals with those of the model itself at the minimum, and takes a
smaller box where they differ (``estimate``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil, comb
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from vibeam.case.fidelity import system
from vibeam.case.grid_keys import is_structural
from vibeam.periodic.tangents import ModalData, Tangents, aligned, derivatives_fault
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.study_plans import FitKey


@dataclass(frozen=True)
class Forward:
    """Model of a fidelity, the estimated keys, and the output that is observed.

    ``changed``: False for a key that the fidelity sets itself. ``offsets``: added to the values of the keys.
    ``closed``: motions with one impact are known in closed form, with derivatives.
    """

    model: Model
    keys: tuple[FitKey, ...]
    changed: tuple[bool, ...]
    output: str
    offsets: tuple[float, ...]
    closed: bool

    @classmethod
    def of(cls, case: Case, name: str, keys: Sequence[FitKey]) -> Forward:
        """Forward model of one fidelity; ValueError for one whose motions are not periodic ones of the drive."""
        model = case.model(name)
        changed = tuple(each.key not in model.fidelity.changes for each in keys)
        made = model.at({each.key: each.start for each, own in zip(keys, changed, strict=True) if own}).system()
        _refuse(case, name, made)
        closed = not derivatives_fault(made) and made.derivative(case.sweep.output) is None
        return cls(model, tuple(keys), changed, case.sweep.output, (0.0,) * len(keys), closed)

    def values(self, x: Array) -> Array:
        """Values of the keys (P,), SI, at shares of their bounds."""
        low, high = (np.array([getattr(each, end) for each in self.keys]) for end in ("low", "high"))
        return np.asarray(low + x * (high - low))

    def at(self, values: Array) -> Model:
        """Model at values (P,) of the keys, SI."""
        rows = zip(self.keys, values, self.offsets, self.changed, strict=True)
        return self.model.at({each.key: float(value + offset) for each, value, offset, changed in rows if changed})

    def system(self, values: Array) -> ImpactSystem:
        """Impact system at values of the keys."""
        return self.at(values).system()

    def data(self, values: Array, omega: Array) -> ModalData:
        """Modal data at drives ``omega`` (points,) rad/s."""
        model = self.at(values)
        scene = model.scene()
        drive = np.broadcast_to(np.asarray(drive_amplitude(scene, omega), dtype=float), omega.shape)
        return ModalData.of(system(scene, model.fidelity), self.output, drive)


def _refuse(case: Case, name: str, made: ImpactSystem) -> None:
    scene = case.scene_of(name)
    told = ""
    if scene.harmonics:
        told = "a fit knows a drive of one harmonic: take drive.harmonic away"
    if not told and scene.stop is not None and (scene.stop.drift is not None or scene.stop.wear is not None):
        told = "a fit knows a gap that stays: take drift and wear away"
    if told:
        raise ValueError(f"fidelity.{name}: {told}")
    try:
        made.derivative(case.sweep.output)
    except KeyError as wrong:
        raise ValueError(f"sweep.output: {wrong.args[0]}") from None


MOST = 64  # structures made for a box
DEGREES = (2, 2)  # to start with, of the keys of the structure and of the others
HIGHEST = (12, 4)
OVER = 1e-9  # by which a restitution may be outside 0 … 1 by round-off


def quasi_random(count: int, dimensions: int) -> Array:
    """Points (count, dimensions) that fill the unit cube evenly: Kronecker's sequence of the generalised golden ratio.

    Its base g solves gᵈ⁺¹ = g + 1 (Roberts, The unreasonable effectiveness of quasirandom sequences, 2018).
    """
    base = 2.0
    for _ in range(64):
        base = (1 + base) ** (1 / (dimensions + 1))
    steps = base ** -np.arange(1.0, dimensions + 1)
    return np.asarray((0.5 + np.arange(1.0, count + 1)[:, None] * steps) % 1.0)


@dataclass(frozen=True)
class ModalSurface:
    """Polynomials of the shares x (P,) of the keys' bounds: ``powers`` (terms, P), ``coefficients`` (terms, packed)."""

    middle: Array
    half: Array
    powers: Index
    coefficients: Array
    modes: int

    def at(self, x: Array) -> ModalData:
        """Modal data at shares x; ValueError where there is no such system."""
        return self._data(self._factors(x).prod(axis=0) @ self.coefficients)

    def with_tangents(self, x: Array) -> tuple[ModalData, Tangents]:
        """Modal data and their derivatives by the shares."""
        factors, slopes = self._factors(x), self._factors(x, 1)
        rows = []
        for k in range(len(x)):
            changed = factors.copy()
            changed[k] = slopes[k] / self.half[k]
            rows.append(changed.prod(axis=0))
        return self._data(factors.prod(axis=0) @ self.coefficients), Tangents.unpacked(
            np.array(rows) @ self.coefficients, self.modes
        )

    def still(self, count: int) -> Tangents:
        """Tangents by no key, at so many points."""
        return Tangents.unpacked(np.zeros((0, 6 * self.modes + 2 + count)), self.modes)

    def _factors(self, x: Array, order: int = 0) -> Array:
        """Polynomials (P, terms) of each key, or their derivatives by its coordinate in the box."""
        return factors((x - self.middle) / self.half, self.powers, order)

    def _data(self, packed: Array) -> ModalData:
        found = ModalData.unpacked(packed, self.modes)
        if not -OVER <= found.restitution <= 1 + OVER:
            raise ValueError("stop.restitution: no restitution of the contact in [0, 1] gives it")
        return replace(found, restitution=min(max(found.restitution, 0.0), 1.0))


def factors(z: Array, powers: Index, order: int = 0) -> Array:
    """Chebyshev polynomials (P, terms) of degrees ``powers`` (terms, P) at z (P,), or their first derivatives."""
    count = int(powers.max(initial=1)) + 1
    table = chebyshev.chebvander(z, count - 1)
    if order:
        table = table[:, :-1] @ chebyshev.chebder(np.eye(count))
    return np.asarray(np.take_along_axis(table, powers.T, axis=1))


def surface_of(forward: Forward, omega: Array, low: Array, high: Array, tolerance: float) -> ModalSurface:
    """Surface of a fidelity at drives ``omega`` over a box of shares; ValueError where there is no system in it."""
    middle, half = (low + high) / 2, (high - low) / 2
    structural = np.array([is_structural(each.key) for each in forward.keys])
    like = forward.data(forward.values(middle), omega)
    seen: dict[bytes, Array | None] = {}

    def packed(z: Array) -> Array | None:
        """Modal data at a point of the box; None where there is no such system."""
        if z.tobytes() not in seen:
            try:
                found = aligned(forward.data(forward.values(middle + half * z), omega), like).packed()
            except ValueError:
                found = None
            seen[z.tobytes()] = found
        return seen[z.tobytes()]

    degrees = DEGREES
    while True:
        powers = _powers(structural, degrees)
        used, unused = _points(structural, degrees)
        made = _fitted(used, [packed(each) for each in used], powers)
        if made is None:
            raise ValueError("fit.keys: there is no system within the bounds")
        surface = ModalSurface(middle, half, powers, made[0], len(like.omega))
        further = _further(structural, degrees)
        off = [_off(surface, z, packed(z), made[1]) for z in unused] if further != degrees else []
        if max(off, default=0.0) < tolerance:
            return surface
        degrees = further


def _powers(structural: NDArray[np.bool_], degrees: tuple[int, int]) -> Index:
    """Degrees (terms, P) of all products whose total degree in either kind of keys is at most that of ``degrees``."""
    most = [degrees[0] if each else degrees[1] for each in structural]
    every = np.array(list(product(*(range(each + 1) for each in most))), dtype=np.int64)
    totals = every[:, structural].sum(axis=1), every[:, ~structural].sum(axis=1)
    return np.asarray(every[(totals[0] <= degrees[0]) & (totals[1] <= degrees[1])])


def _points(structural: NDArray[np.bool_], degrees: tuple[int, int]) -> tuple[Array, Array]:
    """Points of the box (−1 … 1) that a surface is fitted to, those of one structure together; two that it is not."""
    both = []
    for which, degree in zip((structural, ~structural), degrees, strict=True):
        count, dimensions = _count(int(which.sum()), degree), int(which.sum())
        both.append(np.cos(np.pi * quasi_random(count + 2, dimensions)) if dimensions else np.zeros((3, 0)))
    pairs = list(product(range(len(both[0]) - 2), range(len(both[1]) - 2)))
    found = np.empty((len(pairs) + 2, len(structural)))
    for row, (one, other) in enumerate([*pairs, (-1, -1), (-2, -2)]):
        found[row, structural], found[row, ~structural] = both[0][one], both[1][other]
    return found[:-2], found[-2:]


def _count(dimensions: int, degree: int) -> int:
    """Number of points for polynomials of a total degree: half as many again as terms."""
    return ceil(1.5 * comb(dimensions + degree, degree))


def _further(structural: NDArray[np.bool_], degrees: tuple[int, int]) -> tuple[int, int]:
    """The next degrees; the same where there are none."""
    if not structural.any():
        return degrees[0], min(degrees[1] + 1, HIGHEST[1])
    further = min(degrees[0] + 2, HIGHEST[0])
    return (further, degrees[1]) if _count(int(structural.sum()), further) <= MOST else degrees


def _fitted(points: Array, rows: list[Array | None], powers: Index) -> tuple[Array, Array] | None:
    """Coefficients, and the size of each of the modal data; None where no point has a system."""
    known = [k for k, row in enumerate(rows) if row is not None]
    if not known:
        return None
    wanted = np.array([rows[k] for k in known])
    table = np.array([factors(points[k], powers).prod(axis=0) for k in known])
    return np.linalg.lstsq(table, wanted, rcond=None)[0], np.abs(wanted).max(axis=0)


def _off(surface: ModalSurface, z: Array, exact: Array | None, size: Array) -> float:
    """Largest difference of a surface from the model at a point, as a share of the size of each number."""
    if exact is None:
        return 0.0
    found = factors(z, surface.powers).prod(axis=0) @ surface.coefficients
    return float(np.max(np.abs(found - exact) / np.maximum(size, 1e-300)))
