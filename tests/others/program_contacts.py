"""Contact forces of other programs, typed from their sources, and one impact of a free mass on each in mpmath.

Nothing here is of vibeam's. ``FORCES`` has the force by depth, its rate and the speed at first touch, in the names and
the order of the source that is named; ``impact`` integrates m d″ = −F by extrapolated midpoint steps (Gragg, Bulirsch
and Stoer) at ``DIGITS`` digits, stopping where a force changes its form.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mpmath import log, mp, mpf, pi, sqrt

DIGITS = 25
COLUMNS = 6  # of the extrapolation, in 2, 4 … 12 substeps
WITHIN = mpf(10) ** -14  # error of a step, of depth and speed
GONE = mpf(10) ** -13  # depth, of the largest scale, at which nothing is left of the force
Number = Any  # mpf

Force = Callable[[Mapping[str, Number], Number, Number, Number, Number], Number]  # parameters, m, v₀, d, d′


def vibeam_linear(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """vibeam's page of laws: k d + c d′ until that is zero."""
    return max(p["stiffness"] * d + p["damping"] * u, mpf(0))


def vibeam_hunt_crossley(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """vibeam's page of laws: k d^p (1 + a d′)."""
    return p["hertz_stiffness"] * d ** mpf(1.5) * (1 + p["damping"] * u)


def mujoco(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """google-deepmind/mujoco src/engine/engine_core_constraint.c: mj_makeImpedance, mj_referenceConstraint.

    Without other forces the acceleration is imp·aref (modeling.rst, eq. constraint, a_0 = 0), and an inequality's force
    only pushes. The impedance is flat, solimp[0] = solimp[1].
    """
    imp = width = mpf("0.9")
    if "timeconst" in p:
        stiff = 1 / (width**2 * p["timeconst"] ** 2 * p["dampratio"] ** 2)
        damp = 2 / (width * p["timeconst"])
    else:
        stiff, damp = p["stiffness"] / width**2, p["damping"] / width
    aref = damp * u + stiff * imp * d
    return max(m * imp * aref, mpf(0))


def elastogap(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """Modelica/Mechanics/Translational/Components/ElastoGap.mo, s_rel = −d, n = 1."""
    f_c, f_d2 = -p["c"] * d, -p["d"] * u
    f_d = f_c if f_d2 < f_c else -f_c if f_d2 > -f_c else f_d2
    return -(f_c + f_d)


def drake(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """RobotLocomotion/drake multibody/plant/contact_model_doxygen.h: k (x)₊ (1 + d ẋ)₊."""
    return p["point_contact_stiffness"] * d * max(1 + p["hunt_crossley_dissipation"] * u, mpf(0))


def simbody(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """simbody/simbody Simbody/src/HuntCrossleyForce.cpp: fH (1 + 1.5 c v), where that is positive."""
    return max(p["stiffness"] * d ** mpf(1.5) * (1 + mpf(1.5) * p["dissipation"] * u), mpf(0))


def hertzdamp(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """OpenSees/OpenSees SRC/material/uniaxial/Hertzdamp.cpp: xi from the rate of the new impact."""
    xi = p["xiNorm"] * p["Kh"] / v0
    return (p["Kh"] + xi * u) * d ** mpf(1.5)


def jankowski(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """OpenSees/OpenSees SRC/material/uniaxial/JankowskiImpact.cpp: damped while it approaches."""
    spring = p["Kh"] * d ** mpf(1.5)
    return spring + 2 * p["xi"] * sqrt(p["Kh"] * sqrt(d) * m) * u if u > 0 else spring


def viscoelastic_gap(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """OpenSees/OpenSees SRC/material/uniaxial/ViscoelasticGap.cpp."""
    return p["K"] * d + p["C"] * u


def chrono_hertz(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """projectchrono/chrono src/chrono/physics/ChContactSMC.h, Hertz, material properties; eff_radius = 1."""
    modulus, loge = p["4/3 E √R"] * mpf(3) / 4, log(p["restitution"])
    stiff = 2 * modulus * sqrt(d)
    beta = loge / sqrt(loge * loge + pi * pi)
    kn, gn = mpf(2) / 3 * stiff, -2 * sqrt(mpf(5) / 6) * beta * sqrt(stiff * m)
    return max(kn * d + gn * u, mpf(0))


def chrono_hooke(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """projectchrono/chrono src/chrono/physics/ChContactSMC.h, Hooke, coefficients of the user."""
    return max(p["kn"] * d + m * p["gn"] * u, mpf(0))


def _lammps(elastic: Number, damp: Number, m: Number, d: Number, u: Number) -> Number:
    """lammps/lammps src/GRANULAR/gran_sub_mod_damping_kernel.h, gran_damping_tsuji_prefactor; the force may pull."""
    return elastic + damp * sqrt(m * elastic / d) * u if d > 0 else mpf(0)


def lammps_hooke(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp, coeff_restitution with hooke."""
    damp = -2 * log(p["e"]) / sqrt(pi * pi + log(p["e"]) ** 2)
    return _lammps(p["k_n"] * d, damp, m, d, u)


def lammps_hertz(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp, coeff_restitution: √(3/2)·2√(5/6)."""
    damp = -sqrt(mpf(3) / 2) * 2 * sqrt(mpf(5) / 6) * log(p["e"]) / sqrt(pi * pi + log(p["e"]) ** 2)
    return _lammps(p["k_n √R"] * d ** mpf(1.5), damp, m, d, u)


def tsuji(e: Number) -> Number:
    """α of lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp, eq. 53 of Marshall 2009, without the later √2."""
    said = ("1.2728", "-4.2783", "11.087", "-22.348", "27.467", "-18.022", "4.8218")
    return sum(mpf(each) * e**n for n, each in enumerate(said))


def lammps_tsuji(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp of 2026, tsuji: times √2."""
    return _lammps(p["k_n √R"] * d ** mpf(1.5), sqrt(2) * tsuji(p["e"]), m, d, u)


def lammps_tsuji_2025(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """The same of the release of 22 July 2025, which has no √2."""
    return _lammps(p["k_n √R"] * d ** mpf(1.5), tsuji(p["e"]), m, d, u)


def impact_material(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    """OpenSees/OpenSees SRC/material/uniaxial/ImpactMaterial.cpp: K1, from Delta_y on K2; back by K1 down to K2 d.

    The depth at which it turns is that of the energy at first touch, since the way in has no loss.
    """
    stiff, soft, yields, energy = p["K1"], p["K2"], -p["Delta_y"], m * v0**2 / 2
    if u > 0:
        return min(stiff * d, stiff * yields + soft * (d - yields))
    offset, most = (stiff - soft) * yields, sqrt(2 * energy / stiff)
    if most > yields:  # soft x²/2 + offset (x − yields/2) = energy
        most = (sqrt(offset**2 + 2 * soft * (energy + offset * yields / 2)) - offset) / soft
    return max(min(stiff * most, soft * most + offset) - stiff * (most - d), soft * d)


@dataclass(frozen=True)
class ProgramContact:
    """Contact of a program: its ``force``, and ``pieces``: functions at whose zeros the force changes its form.

    ``pulls``: until the depth is gone, else the contact ends with the force.
    """

    force: Force
    pieces: tuple[Force, ...] = ()
    pulls: bool = False


def _turned(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    return u


def _limit(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    return p["c"] * d - p["d"] * u


def _yields(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    return d + p["Delta_y"]


def _ironed(p: Mapping[str, Number], m: Number, v0: Number, d: Number, u: Number) -> Number:
    return impact_material(p, m, v0, d, mpf(-1)) - p["K2"] * d


IMPACT_MATERIAL = ProgramContact(impact_material, (_turned, _yields, _ironed))
TSUJI_OF_2025 = ProgramContact(lammps_tsuji_2025, pulls=True)
FORCES: Mapping[str, ProgramContact] = {
    "linear": ProgramContact(vibeam_linear),
    "hunt-crossley": ProgramContact(vibeam_hunt_crossley),
    "mujoco": ProgramContact(mujoco),
    "mujoco direct": ProgramContact(mujoco),
    "elastogap": ProgramContact(elastogap, (_limit,)),
    "drake": ProgramContact(drake),
    "simbody": ProgramContact(simbody),
    "hertzdamp": ProgramContact(hertzdamp),
    "jankowski": ProgramContact(jankowski, (_turned,)),
    "viscoelastic gap": ProgramContact(viscoelastic_gap, pulls=True),
    "chrono": ProgramContact(chrono_hertz),
    "chrono hooke": ProgramContact(chrono_hooke),
    "lammps hooke": ProgramContact(lammps_hooke, pulls=True),
    "lammps hertz": ProgramContact(lammps_hertz, pulls=True),
    "lammps tsuji": ProgramContact(lammps_tsuji, pulls=True),
}


@dataclass(frozen=True)
class ProgramImpact:
    """Impact as integrated: R, and ``duration`` s until the force has gone or the depth has."""

    restitution: float
    duration: float


def impact(contact: ProgramContact, parameters: Mapping[str, float], mass: float, speed: float) -> ProgramImpact:
    """Impact of a free ``mass``, kg, at a ``speed``, m/s."""
    with mp.workdps(DIGITS):
        given = {name: mpf(value) for name, value in parameters.items()}
        return _Flight(contact, given, mpf(mass), mpf(speed)).flown()


class _Flight:
    """One integration."""

    def __init__(self, contact: ProgramContact, given: Mapping[str, Number], mass: Number, speed: Number) -> None:
        self.contact, self.given, self.mass, self.speed = contact, given, mass, speed
        self.unit = mpf(0)  # largest depth up to now

    def force(self, d: Number, u: Number) -> Number:
        return self.contact.force(self.given, self.mass, self.speed, max(d, mpf(0)), u)

    def flown(self) -> ProgramImpact:
        """Steps until the mass leaves."""
        t, d, u, largest = mpf(0), mpf(0), self.speed, mpf(0)
        h = mpf(10) ** -12
        for _ in range(4000):
            now, (new, error) = (d, u), self.step(d, u, h)
            scale = max(largest, abs(new[0]))
            wrong = max(error[0] / scale, error[1] / self.speed)
            if wrong > WITHIN:
                h *= max(mpf("0.9") * (WITHIN / wrong) ** (mpf(1) / (2 * COLUMNS - 1)), mpf("0.1"))
                continue
            if self.crossed(now, new):
                h, new = self.until(now, h)
            t, (d, u), largest = t + h, new, scale
            self.unit = largest
            if not self.holds(d, u):
                return ProgramImpact(float(-u / self.speed), float(t))
            h *= min(mpf("0.9") * (WITHIN / max(wrong, WITHIN / 10**6)) ** (mpf(1) / (2 * COLUMNS - 1)), mpf(3))
        raise RuntimeError("the impact did not end")

    def signs(self, d: Number, u: Number) -> list[bool]:
        """Signs of what delimits pieces; the last one ends with the contact."""
        pieces = [each(self.given, self.mass, self.speed, d, u) > 0 for each in self.contact.pieces]
        return [*pieces, self.holds(d, u)]

    def holds(self, d: Number, u: Number) -> bool:
        """True until the mass leaves: no force, or no depth, while it moves out."""
        there = d > GONE * self.unit
        return bool(u > 0 or (there and (self.contact.pulls or self.force(d, u) > 0)))

    def crossed(self, old: tuple[Number, Number], new: tuple[Number, Number]) -> bool:
        return self.signs(*old) != self.signs(*new)

    def until(self, old: tuple[Number, Number], h: Number) -> tuple[Number, tuple[Number, Number]]:
        """The step just beyond the first change of a sign, bisected."""
        low, high = mpf(0), h
        while high - low > mpf(10) ** -18 * h:
            middle = (low + high) / 2
            low, high = (low, middle) if self.crossed(old, self.step(*old, middle)[0]) else (middle, high)
        return high, self.step(*old, high)[0]

    def step(self, d: Number, u: Number, h: Number) -> tuple[tuple[Number, Number], tuple[Number, Number]]:
        """State after ``h`` and its error: midpoint steps with 2, 4 … substeps, extrapolated in h²."""
        rows: list[list[tuple[Number, Number]]] = []
        for k in range(1, COLUMNS + 1):
            row = [self.midpoint(d, u, h, 2 * k)]
            for j in range(1, k):
                ratio = mpf(k) ** 2 / mpf(k - j) ** 2 - 1
                new, old = row[j - 1], rows[-1][j - 1]
                row.append((new[0] + (new[0] - old[0]) / ratio, new[1] + (new[1] - old[1]) / ratio))
            rows.append(row)
        best, before = rows[-1][-1], rows[-1][-2]
        return best, (abs(best[0] - before[0]), abs(best[1] - before[1]))

    def midpoint(self, d: Number, u: Number, h: Number, count: int) -> tuple[Number, Number]:
        """Gragg's modified midpoint rule."""
        part, m = h / count, self.mass
        last, now = (d, u), (d + part * u, u - part * self.force(d, u) / m)
        for _ in range(count - 1):
            last, now = now, (last[0] + 2 * part * now[1], last[1] - 2 * part * self.force(*now) / m)
        return (
            (now[0] + last[0] + part * now[1]) / 2,
            (now[1] + last[1] - part * self.force(*now) / m) / 2,
        )
