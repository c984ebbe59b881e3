"""From the rig's geometry to the parameters of its models, by formulas written out here.

A clamped Euler–Bernoulli beam of Hermite elements with a point mass (and its rotary inertia) on a rigid zone: the
nodes of the rigid zone move as one body with the node of the mass, by elimination. The matrices are assembled,
condensed and inverted in 40 digits; the eigenvalues are taken of the flexibility, so that the lowest modes, which
matter, are those that doubles give best.

    static mode   φ = shape under a unit load at the mass, 1 at the sensor;   M_S = φᵀMφ, K_S = φᵀKφ,
                  C_S = φᵀCφ with C = M Φ diag(2ζω) Φᵀ M, base factor φᵀM1/φᵀMφ
    modal model   mass-normalised modes of the full structure, rows at the mass and at the sensor, load φᵀM1
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import gmpy2
import numpy as np
from events import Modes
from gmpy2 import mpfr

DIGITS = 40
TOO_NEAR = Fraction(1, 5)  # of an element: a uniform node this near to a special one is dropped


@dataclass(frozen=True)
class Rig:
    """The beam, its mass, stop and sensor: SI units, decimal strings taken exactly."""

    length: str = "0.180"
    width: str = "0.020"
    thickness: str = "0.001034"
    youngs_modulus: str = "210e9"
    density: str = "7850"
    damping_ratio: str = "0.017"
    elements: int = 36
    mass: str = "0.2"
    position: str = "0.132"
    rotary_inertia: str = "2.988e-5"
    rigid_half_width: str = "0.0117"
    sensor: str = "0.100"


@dataclass(frozen=True)
class SingleMode:
    """The static-mode model in the coordinate q = sensor displacement: M_S q̈ + C_S q̇ + K_S q = −(φᵀM1) b̈."""

    mass: float
    damping: float
    stiffness: float
    load: float  #: φᵀM1
    contact: float  #: φ at the mass

    @property
    def omega(self) -> float:
        """Natural frequency, rad/s."""
        return math.sqrt(self.stiffness / self.mass)

    @property
    def zeta(self) -> float:
        """Damping ratio."""
        return self.damping / (2 * math.sqrt(self.stiffness * self.mass))

    @property
    def base_factor(self) -> float:
        """φᵀM1/φᵀMφ."""
        return self.load / self.mass

    def modes(self, gap: float, restitution: float) -> Modes:
        """As a system with a stop at contact displacement ``gap``; the modal coordinate is q itself.

        With η = q the impact law η'⁺ = η'⁻ − (1+R) v⁻/c reads −R η'⁻ as it does for any scale of η.
        """
        return Modes([self.omega], [self.zeta], [self.contact], [self.base_factor], gap, restitution)


@dataclass(frozen=True)
class ModalModel:
    """The lowest modes of the full structure, mass-normalised, signs such that the sensor moves forward."""

    omega: np.ndarray
    zeta: np.ndarray
    contact: np.ndarray
    sensor: np.ndarray
    load: np.ndarray

    def contact_restitution(self, first: float) -> float:
        """Coefficient of the contact with which mode 1 keeps the share ``first`` of its velocity.

        An impulse p changes η'_i by c_i p; v⁺ = −R v⁻ asks for p = −(1+R) v⁻/Σc². With mode 1 alone in motion before
        the impact, η'_1⁺ = η'_1⁻ (1 − (1+R) c_1²/Σc²) = −first η'_1⁻.
        """
        return float((1 + first) * np.sum(self.contact**2) / self.contact[0] ** 2 - 1)

    def modes(self, gap: float, restitution: float) -> Modes:
        """As a system with a stop at contact displacement ``gap``."""
        rows = (self.omega, self.zeta, self.contact, self.load)
        omega, zeta, contact, load = ([float(a) for a in row] for row in rows)
        return Modes(omega, zeta, contact, load, gap, restitution)


class Structure:
    """The condensed finite-element matrices of a rig and all of its modes."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        with gmpy2.context(gmpy2.get_context(), precision=math.ceil(DIGITS * 3.33)):
            self.nodes = _nodes(rig)
            self.M, self.K, self.translation = _condensed(rig, self.nodes)
            self.contact = self._row(rig.position)
            self.sensor = self._row(rig.sensor)
            self.flexibility = _inverse(self.K)
            self._solve_modes()

    def _row(self, position: str) -> np.ndarray:
        """The row that reads the displacement at a place: node value or Hermite interpolation, then condensed."""
        x = Fraction(position)
        full = _zeros(2 * len(self.nodes))
        i = max(k for k, node in enumerate(self.nodes[:-1]) if node <= x)
        h = self.nodes[i + 1] - self.nodes[i]
        t = (x - self.nodes[i]) / h
        shape = (1 - 3 * t**2 + 2 * t**3, h * (t - 2 * t**2 + t**3), 3 * t**2 - 2 * t**3, h * (t**3 - t**2))
        full[2 * i : 2 * i + 4] = [_number(s) for s in shape]
        return full @ _condensation(self.rig, self.nodes)

    def _solve_modes(self) -> None:
        """Eigenpairs of K⁻¹ in the metric of M: with M = LLᵀ, LᵀK⁻¹L y = ω⁻² y and Φ = L⁻ᵀ y."""
        lower = _cholesky(self.M)
        flexible = (lower.T @ self.flexibility @ lower).astype(float)
        inverse_squares, y = np.linalg.eigh((flexible + flexible.T) / 2)
        self.omega = 1 / np.sqrt(inverse_squares[::-1])
        shapes = _solve_upper(lower.T, np.vectorize(mpfr, otypes=[object])(y[:, ::-1]))
        self.shapes = shapes * np.where((self.sensor @ shapes).astype(float) < 0, -1, 1)

    def static_mode(self) -> SingleMode:
        """The single-degree-of-freedom model of the static deflection."""
        with gmpy2.context(gmpy2.get_context(), precision=math.ceil(DIGITS * 3.33)):
            phi = self.flexibility @ self.contact
            phi = phi / (self.sensor @ phi)
            momentum = self.M @ phi
            shares = (self.shapes.T @ momentum).astype(float)
            damping = float(self.rig.damping_ratio) * 2 * np.sum(self.omega * shares**2)
            return SingleMode(
                mass=float(phi @ momentum),
                damping=float(damping),
                stiffness=float(phi @ self.K @ phi),
                load=float(self.translation @ momentum),
                contact=float(self.contact @ phi),
            )

    def modal(self, n: int) -> ModalModel:
        """The n lowest modes."""
        with gmpy2.context(gmpy2.get_context(), precision=math.ceil(DIGITS * 3.33)):
            shapes = self.shapes[:, :n]
            rows = {
                "contact": self.contact @ shapes,
                "sensor": self.sensor @ shapes,
                "load": self.translation @ self.M @ shapes,
            }
        zeta = np.full(n, float(self.rig.damping_ratio))
        return ModalModel(self.omega[:n], zeta, **{name: row.astype(float) for name, row in rows.items()})


def base_amplitude(rig: Rig, gain: float, voltage: float) -> float:
    """b = γ V φ(L_m) L with the static mode of the massless beam without a rigid zone."""
    length, mass, sensor = float(rig.length), float(rig.position), float(rig.sensor)
    return gain * voltage * 2 * mass**3 / (sensor**2 * (3 * mass - sensor)) * length


def closed_form(rig: Rig) -> tuple[float, float]:
    """φ at the mass and K_S in closed form, with the rigid zone: a cubic up to it, then straight lines.

    Under a load F at x_m the clamped part carries the moment F(x_m − x): w' = F(x_m x − x²/2)/EI and
    w = F(x_m x²/2 − x³/6)/EI up to the rigid zone's begin a; from there on the slope stays w'(a).
    """
    x_m, x_s = float(rig.position), float(rig.sensor)
    start = x_m - float(rig.rigid_half_width)
    stiffness = float(rig.youngs_modulus) * float(rig.width) * float(rig.thickness) ** 3 / 12

    def deflection(x: float) -> float:
        bent = min(x, start)
        slope = x_m * bent - bent**2 / 2
        return (x_m * bent**2 / 2 - bent**3 / 6 + slope * (x - bent)) / stiffness

    return deflection(x_m) / deflection(x_s), deflection(x_m) / deflection(x_s) ** 2


def _number(value: Fraction) -> mpfr:
    return mpfr(value.numerator) / mpfr(value.denominator)


def _zeros(*shape: int) -> np.ndarray:
    return np.full(shape, mpfr(0), dtype=object)


def _rigid_zone(rig: Rig) -> tuple[Fraction, Fraction]:
    position, half = Fraction(rig.position), Fraction(rig.rigid_half_width)
    return position - half, position + half


def _nodes(rig: Rig) -> list[Fraction]:
    """Uniform nodes and the special ones (mass, ends of its rigid zone); uniform ones too near those are left out."""
    length = Fraction(rig.length)
    special = sorted({Fraction(rig.position), *_rigid_zone(rig)})
    near = TOO_NEAR * length / rig.elements
    uniform = [length * i / rig.elements for i in range(rig.elements + 1)]
    kept = [x for x in uniform if x in (0, length) or all(abs(x - s) > near for s in special)]
    return sorted({*kept, *special})


def _condensed(rig: Rig, nodes: list[Fraction]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, stiffness and the vector of a unit translation in the free coordinates."""
    M, K = _assembled(rig, nodes)
    T = _condensation(rig, nodes)
    M, K = T.T @ M @ T, T.T @ K @ T
    at_mass = next(k for k in range(T.shape[1]) if T[2 * nodes.index(Fraction(rig.position)), k] == 1)
    M[at_mass, at_mass] += mpfr(rig.mass)
    M[at_mass + 1, at_mass + 1] += mpfr(rig.rotary_inertia)
    translation = _zeros(T.shape[1])
    translation[0::2] = mpfr(1)
    return M, K, translation


def _assembled(rig: Rig, nodes: list[Fraction]) -> tuple[np.ndarray, np.ndarray]:
    """The free beam: consistent mass and bending stiffness; nothing bends within the rigid zone."""
    start, end = _rigid_zone(rig)
    per_length = mpfr(rig.density) * mpfr(rig.width) * mpfr(rig.thickness)
    bending = mpfr(rig.youngs_modulus) * mpfr(rig.width) * mpfr(rig.thickness) ** 3 / 12
    M, K = _zeros(2 * len(nodes), 2 * len(nodes)), _zeros(2 * len(nodes), 2 * len(nodes))
    for i, (a, b) in enumerate(pairwise(nodes)):
        mass, stiffness = _element(_number(b - a))
        at = slice(2 * i, 2 * i + 4)
        M[at, at] += per_length * mass
        if not (start <= a and b <= end):
            K[at, at] += bending * stiffness
    return M, K


def _element(h: mpfr) -> tuple[np.ndarray, np.ndarray]:
    """Hermite element of length h, coordinates (w, w', w, w'), of unit mass per length and unit bending stiffness."""
    mass = [
        [156, 22 * h, 54, -13 * h],
        [22 * h, 4 * h**2, 13 * h, -3 * h**2],
        [54, 13 * h, 156, -22 * h],
        [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
    ]
    stiffness = [
        [12, 6 * h, -12, 6 * h],
        [6 * h, 4 * h**2, -6 * h, 2 * h**2],
        [-12, -6 * h, 12, -6 * h],
        [6 * h, 2 * h**2, -6 * h, 4 * h**2],
    ]
    return np.array(mass, dtype=object) * h / 420, np.array(stiffness, dtype=object) / h**3


def _condensation(rig: Rig, nodes: list[Fraction]) -> np.ndarray:
    """All coordinates by the free ones: the clamp is gone, the rigid zone follows w and w' of the mass."""
    start, end = _rigid_zone(rig)
    position = Fraction(rig.position)
    rigid = [start <= x <= end for x in nodes]
    free = [i for i, x in enumerate(nodes) if i > 0 and (not rigid[i] or x == position)]
    T = _zeros(2 * len(nodes), 2 * len(free))
    column = {node: 2 * k for k, node in enumerate(free)}
    for i, x in enumerate(nodes[1:], start=1):
        k = column[nodes.index(position) if rigid[i] else i]
        T[2 * i, k] = T[2 * i + 1, k + 1] = mpfr(1)
        if rigid[i]:
            T[2 * i, k + 1] = _number(x - position)
    return T


def _cholesky(matrix: np.ndarray) -> np.ndarray:
    """Lower factor of a positive definite matrix of mpfr."""
    n = len(matrix)
    lower = _zeros(n, n)
    for j in range(n):
        column = matrix[j:, j] - lower[j:, :j] @ lower[j, :j] if j else matrix[:, 0]
        lower[j:, j] = column / gmpy2.sqrt(column[0])
    return lower


def _solve_upper(upper: np.ndarray, right: np.ndarray) -> np.ndarray:
    solution = right.copy()
    for i in range(len(upper) - 1, -1, -1):
        if i + 1 < len(upper):
            solution[i] = solution[i] - upper[i, i + 1 :] @ solution[i + 1 :]
        solution[i] = solution[i] / upper[i, i]
    return solution


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a positive definite matrix through its Cholesky factor: K⁻¹ = L⁻ᵀL⁻¹."""
    n = len(matrix)
    identity = _zeros(n, n)
    identity[range(n), range(n)] = mpfr(1)
    inverse_transposed = _solve_upper(_cholesky(matrix).T, identity)
    return inverse_transposed @ inverse_transposed.T
