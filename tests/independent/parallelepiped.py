"""Natural frequencies of a free rectangular parallelepiped by Ritz' method with Legendre's polynomials.

    u_i = Σ a_ijkl P_j(x) P_k(y) P_l(z),  j + k + l ≤ order   (Demarest, J. acoust. Soc. Am. 49 (1971) 768)

Eight families by symmetry in x, y and z, each a small matrix of its own. A Ritz value is never below the exact one.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Legendre
from scipy.linalg import eigh


def products(order):
    """∫ P_i P_j, ∫ P_i' P_j, ∫ P_i' P_j' over (−1, 1), each (order + 1, order + 1)."""
    at, weight = np.polynomial.legendre.leggauss(order + 1)
    basis = [Legendre.basis(k) for k in range(order + 1)]
    value, slope = (np.array([each(at) for each in kind]) for kind in (basis, [each.deriv() for each in basis]))
    return (value * weight) @ value.T, (slope * weight) @ value.T, (slope * weight) @ slope.T


def free_frequencies(sides, modulus, poisson, density, order, count):
    """The first ``count`` natural frequencies in Hz of the free body, its six rigid motions among them (about 0)."""
    families = [family(sides, modulus, poisson, density, order, odd) for odd in np.ndindex(2, 2, 2)]
    return np.sort(np.concatenate(families))[:count]


def family(sides, modulus, poisson, density, order, odd):
    """All Ritz values in Hz of the modes with u_x even in x (odd where ``odd[0]``) and odd[1], odd[2] in y and z.

    u_y and u_z then have the other symmetry in x, and their own in y and z: strains of one mode are of one symmetry.
    """
    shear = modulus / (2 * (1 + poisson))
    lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))
    tables = products(order)
    half = np.asarray(sides, float) / 2
    every = np.array([each for each in np.ndindex(*[order + 1] * 3) if sum(each) <= order])
    parity = [[(odd[d] + (d == 0) + (d == i)) % 2 for d in range(3)] for i in range(3)]
    powers = [every[(every % 2 == each).all(1)] for each in parity]

    def integral(i, j, first, second):
        """∫ ∂_first N_i ∂_second N_j dV; None for no derivative."""
        result = np.prod(half)
        for d in range(3):
            order_i, order_j = int(d == first), int(d == second)
            table = tables[order_i + order_j] if order_i >= order_j else tables[1].T
            result = result * table[np.ix_(powers[i][:, d], powers[j][:, d])] / half[d] ** (order_i + order_j)
        return result

    def stiffness(i, j):
        block = lame * integral(i, j, i, j) + shear * integral(i, j, j, i)
        return block + shear * sum(integral(i, j, d, d) for d in range(3)) if i == j else block

    stiff = np.block([[stiffness(i, j) for j in range(3)] for i in range(3)])
    mass = np.zeros_like(stiff)
    ends = np.cumsum([0] + [len(each) for each in powers])
    for i in range(3):
        mass[ends[i] : ends[i + 1], ends[i] : ends[i + 1]] = density * integral(i, i, None, None)
    return np.sqrt(np.maximum(eigh(stiff, mass, eigvals_only=True), 0)) / (2 * np.pi)


def bending_waves(width, height, modulus, poisson, density, wavenumber, order=8):
    """Natural frequencies in Hz of bending across ``height`` of an endless bar with ``wavenumber`` k rad/m.

    u = (U cos kx, V sin kx, W sin kx), U, V, W of (y, z) by Legendre's polynomials: exact but for the section's order.
    So moves a bar of length nπ/k whose end faces are held across it (u_y = u_z = 0) and free along it.
    """
    shear = modulus / (2 * (1 + poisson))
    lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))
    at, weight = np.polynomial.legendre.leggauss(order + 1)
    basis = [Legendre.basis(n) for n in range(order + 1)]
    value, slope = (np.array([each(at) for each in kind]) for kind in (basis, [each.deriv() for each in basis]))
    pairs = [(j, k) for j in range(order + 1) for k in range(order + 1 - j)]

    def field(odd):
        own = [(j, k) for j, k in pairs if (j % 2, k % 2) == odd]
        parts = ((value, value, 1.0), (slope, value, 2 / width), (value, slope, 2 / height))
        return [np.array([scale * np.outer(a[j], b[k]).ravel() for j, k in own]) for a, b, scale in parts]

    fields = [field((0, 1)), field((1, 1)), field((0, 0))]  # U, V, W: symmetric about y = 0, bending across z
    sizes = [len(each[0]) for each in fields]

    def row(*parts):
        """One strain at every point: the sum of ``parts`` = (field, 0 value, 1 ∂y or 2 ∂z, factor)."""
        blocks = [np.zeros((size, len(at) ** 2)) for size in sizes]
        for which, kind, factor in parts:
            blocks[which] = blocks[which] + factor * fields[which][kind]
        return np.vstack(blocks)

    k = wavenumber
    direct = [row((0, 0, -k)), row((1, 1, 1.0)), row((2, 2, 1.0))]
    sheared = [row((0, 1, 1.0), (1, 0, k)), row((0, 2, 1.0), (2, 0, k)), row((1, 2, 1.0), (2, 1, 1.0))]
    weights = np.outer(weight, weight).ravel()
    trace = sum(direct)
    stiff = lame * (trace * weights) @ trace.T + shear * sum((each * weights) @ each.T for each in sheared)
    stiff += 2 * shear * sum((each * weights) @ each.T for each in direct)
    mass = density * sum((each * weights) @ each.T for each in (row((i, 0, 1.0)) for i in range(3)))
    return np.sqrt(eigh(stiff, mass, eigvals_only=True)) / (2 * np.pi)
