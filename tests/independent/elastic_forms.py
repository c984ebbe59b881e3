"""Exact solutions of linear elasticity for bodies of simple form, and beams' theories to their next order.

Every formula names where it is derived; ``test_elastic_forms.py`` holds them to each other. c_L, c_T: speeds of
dilatational and of shear waves, √((λ + 2μ)/ρ) and √(μ/ρ).
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
from scipy.optimize import brentq


def wave_speeds(modulus, poisson, density):
    """c_L, c_T in m/s (Love, Mathematical Theory of Elasticity, 4th ed., art. 204)."""
    shear = modulus / (2 * (1 + poisson))
    return np.sqrt(2 * shear * (1 - poisson) / (1 - 2 * poisson) / density), np.sqrt(shear / density)


def cube_mode(side, modulus, poisson, density):
    """Natural frequency in Hz of Lamé's modes of a free cube or square slab, exact: c_T/(√2 side).

    u_x = cos kx sin ky, u_y = −sin kx cos ky with k = π/side from a corner: div u = 0 and σ_xy = 0 everywhere, σ_xx and
    σ_yy vanish with sin kx sin ky at all four faces, the rest is 0: no face bears a load (Lamé 1852, art. 68; Mindlin,
    J. appl. Phys. 27 (1956) 1462). Three such modes of a cube, one of a slab side × side × any thickness.
    """
    return wave_speeds(modulus, poisson, density)[1] / (np.sqrt(2) * side)


def sliding_box(sides, modulus, poisson, density, count):
    """The first ``count`` natural frequencies in Hz of a box whose faces slide without friction on rigid walls, exact.

    u = (U sin·cos·cos, V cos·sin·cos, W cos·cos·sin) with k = π (l/a, m/b, n/c): c_L|k| once for every k whose U, V, W
    can be parallel to it, c_T|k| for each direction across it that the sines leave.
    """
    c_long, c_shear = wave_speeds(modulus, poisson, density)
    found = []
    for numbers in np.ndindex(9, 9, 9):
        present = np.count_nonzero(numbers)
        if present:
            k = np.linalg.norm(np.pi * np.array(numbers) / sides)
            found += [c_long * k / (2 * np.pi)] + [c_shear * k / (2 * np.pi)] * (present - 1)
    return np.sort(found)[:count]


def supported_plate(side, other, height, modulus, poisson, density, waves):
    """Natural frequency in Hz of bending with ``waves`` = (m, n) half waves of a thick plate on simple supports, exact.

    At an edge x = 0: u_y = u_z = 0, σ_xx = 0. Such a mode is Lamb's antisymmetric wave with k² = (mπ/a)² + (nπ/b)²:
    4k² p q tanh(q h/2) = (k² + q²)² tanh(p h/2) with p² = k² − ω²/c_L², q² = k² − ω²/c_T² (Lamb, Proc. R. Soc. A 93
    (1917) 114); Srinivas, Joga Rao & Rao, J. Sound Vib. 12 (1970) 187, have it as a series of thicknesses.
    """
    c_long, c_shear = (mp.mpf(each) for each in wave_speeds(modulus, poisson, density))
    k = mp.pi * mp.sqrt((waves[0] / mp.mpf(side)) ** 2 + (waves[1] / mp.mpf(other)) ** 2)

    def equation(omega):
        p, q = mp.sqrt(k**2 - (omega / c_long) ** 2), mp.sqrt(k**2 - (omega / c_shear) ** 2)
        return mp.re(4 * k**2 * p * q * mp.tanh(q * height / 2) - (k**2 + q**2) ** 2 * mp.tanh(p * height / 2))

    with mp.workdps(30):
        thin = k**2 * height * mp.sqrt(modulus / (12 * density * (1 - poisson**2)))
        above = float(min(thin, 0.999 * k * c_shear))
        return brentq(lambda omega: float(equation(omega)), 0.2 * above, above, xtol=1e-12) / (2 * np.pi)


def torsion_constant(width, height, terms=60):
    """J in m⁴ of a rectangle: twisting moment = G J × twist per length (Saint-Venant 1855; Love, art. 221).

    b h³ (1/3 − 64 h/(π⁵ b) Σ tanh(nπb/2h)/n⁵) over odd n, with b ≥ h.
    """
    b, h = max(width, height), min(width, height)
    n = np.arange(1, 2 * terms, 2)
    return b * h**3 * (1 / 3 - 64 * h / (np.pi**5 * b) * np.sum(np.tanh(n * np.pi * b / (2 * h)) / n**5))


def warping(y, z, width, height, terms=60):
    """φ in m² of a rectangle: u_x = φ × twist per length where the sections turn as u_y = −z θ, u_z = y θ.

    φ = −y z + 8 h²/π³ Σ (−1)^((n−1)/2)/n³ · sinh(nπy/h)/cosh(nπb/2h) · sin(nπz/h), odd n (Love, art. 221): then
    ∂φ/∂y = z at y = ± b/2, and ∂φ/∂z = −y at z = ± h/2.
    """
    n = np.arange(1, 2 * terms, 2)[:, None]
    sign = (-1.0) ** ((n - 1) // 2)
    y, z = np.ravel(y), np.ravel(z)
    a = n * np.pi / height
    ratio = np.exp(a * (np.abs(y) - width / 2)) * -np.expm1(-2 * a * np.abs(y)) / (1 + np.exp(-a * width)) * np.sign(y)
    return -y * z + 8 * height**2 / np.pi**3 * np.sum(sign / n**3 * ratio * np.sin(a * z), 0)


def shear_coefficient(width, height, poisson, terms=200):
    """κ of a rectangle that bends across ``height``, as the exact equations of motion give it to the next order.

    ω² = EI k⁴/ρA (1 − k² I/A (1 + E/κG) + …): Stephen & Levinson, J. Sound Vib. 67 (1979) 293; Hutchinson, J. appl.
    Mech. 68 (2001) 87, eq. 47; derived anew by Chan, Lai, Stephen & Young, J. Sound Vib. 330 (2011) 3492.
    A strip of ν > 0 that is much wider than high has κ < 0: stiffer than Euler–Bernoulli, a plate.
    """
    a, b, n = height / 2, width / 2, np.arange(1, terms)
    series = np.sum(16 * poisson**2 * b**5 * (n * np.pi * a - b * np.tanh(n * np.pi * a / b)) / (n * np.pi) ** 5)
    c4 = 4 / 45 * a**3 * b * (-12 * a**2 - 15 * poisson * a**2 + 5 * poisson * b**2) + series / (1 + poisson)
    return -2 * (1 + poisson) / (9 / (4 * a**5 * b) * c4 + poisson * (1 - b**2 / a**2))


def next_order(width, height, poisson):
    """c of ω² = EI k⁴/ρA (1 − c k² h² + …) for a rectangle: (1 + 2(1 + ν)/κ)/12."""
    return (1 + 2 * (1 + poisson) / shear_coefficient(width, height, poisson)) / 12
