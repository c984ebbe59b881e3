"""Contact dictionary: a coefficient of restitution in the terms of other programs, and theirs as a coefficient.

Formulas are those of the programs' sources, each named beside its form; ``tests/others`` integrates every one and runs
the programs that install.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, nan, pi, sqrt

from vibeam_models.arguments import number, refuse
from vibeam_models.laws.compliant import LinearStop, falling_zero
from vibeam_models.laws.dissipation import KINDS, bound_damping_ratio, bound_restitution

SLOWEST, FASTEST = 0.01, 10.0  # m/s, between which a form is judged
TSUJI = (1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218)  # lammps gran_sub_mod_damping.cpp: α/√2 by eⁿ


Parameters = Mapping[str, float]
Writer = Callable[[float, float, float, float], tuple[float, ...]]  # of mass, speed, stiffness, strength of damping
Reader = Callable[[Parameters, float, float], float]  # of parameters, mass and speed: strength


@dataclass(frozen=True)
class ContactForm:
    """Contact of a ``program``: its kind of damping and exponent, its parameters with their units.

    ``own``: the strength that the program or its manual takes for a coefficient of restitution; ``reach``: the least R,
    which it only comes near, and the largest; ``source``: where its force stands.
    """

    program: str
    kind: str
    exponent: float
    units: Mapping[str, str]
    write: Writer
    read: Reader
    source: str
    own: Callable[[float], float] | None = None
    reach: tuple[float, float] = (0.0, 1.0)

    def restitution(self, parameters: Parameters, mass: float, speed: float) -> float:
        """R of a free ``mass``, kg, at a ``speed``, m/s."""
        return KINDS[self.kind].restitution(self.read(parameters, mass, speed))

    def matched(self, restitution: float, mass: float, contact_time: float, speed: float) -> dict[str, float]:
        """Parameters that give R and the contact time, s; empty where the form does not reach that R."""
        if not self.reach[0] < restitution <= self.reach[1]:
            return {}
        kind = KINDS[self.kind]
        strength = kind.strength(restitution) if restitution < 1 else 0.0
        depth = speed * contact_time / kind.duration(self.exponent, strength)
        stiffness = mass * speed**2 / depth ** (self.exponent + 1)
        return dict(zip(self.units, self.write(mass, speed, stiffness, strength), strict=True))


@dataclass(frozen=True)
class ContactTerm:
    """Form of a ``program`` matched to an impact: ``parameters`` by the program's own names, with their ``units``.

    ``restitution`` R at the speed asked for, ``slow`` and ``fast`` at 0.01 and 10 m/s; NaN, without parameters, where
    that is not between the ``least`` and the ``most`` that the form reaches. ``own``: the R that comes out where the
    coefficient itself is put into the program's own formula; NaN where it has none. ``source``: of its force.
    """

    program: str
    source: str
    units: Mapping[str, str]
    parameters: Mapping[str, float]
    restitution: float
    slow: float
    fast: float
    own: float
    least: float
    most: float


def _tsuji(restitution: float) -> float:
    """ζ = α/√5, with the polynomial of Marshall (2009, eq. 53) as LAMMPS has it."""
    return sqrt(2 / 5) * sum(each * restitution**n for n, each in enumerate(TSUJI))


def _ye(restitution: float) -> float:
    return 8 * (1 - restitution) / (5 * restitution)


def _jankowski(restitution: float) -> float:
    e = restitution
    return 9 * sqrt(5) / 2 * (1 - e**2) / (e * (e * (9 * pi - 16) + 16)) / sqrt(1.25)


def _ratio(stiffness: str, damping: str) -> Reader:
    """Reader of ζ = c/(2 √(k m))."""
    return lambda given, mass, _: given[damping] / (2 * sqrt(given[stiffness] * mass))


def _dashpot(m: float, v: float, k: float, zeta: float) -> tuple[float, float]:
    return k, 2 * zeta * sqrt(k * m)


def _crossed(m: float, v: float, k: float, product: float) -> tuple[float, float]:
    return k, product / v


def _coefficient(m: float, v: float, k: float, zeta: float) -> tuple[float, float]:
    """Stiffness, and the coefficient that a program takes for a damper that pulls."""
    return k, bound_restitution(zeta)


MUJOCO = "google-deepmind/mujoco src/engine/engine_core_constraint.c, mj_makeImpedance"
CHRONO = "projectchrono/chrono src/chrono/physics/ChContactSMC.h"
LAMMPS = "lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp"
OPENSEES = "OpenSees/OpenSees SRC/material/uniaxial/"
HERTZIAN = "N/m^1.5"
FORMS: Mapping[str, ContactForm] = {
    "linear": ContactForm(
        "vibeam linear", "pushing", 1.0, {"stiffness": "N/m", "damping": "N s/m"}, _dashpot,
        _ratio("stiffness", "damping"), "vibeam_models/laws/compliant.py",
    ),
    "hunt-crossley": ContactForm(
        "vibeam hunt-crossley", "product", 1.5, {"hertz_stiffness": HERTZIAN, "damping": "s/m"},
        _crossed, lambda given, _, speed: given["damping"] * speed, "vibeam_models/laws/compliant.py",
    ),
    "mujoco": ContactForm(
        "MuJoCo solref", "pushing", 1.0, {"timeconst": "s", "dampratio": "1"},
        lambda m, v, k, zeta: (sqrt(m / k) / zeta, zeta), lambda given, *_: given["dampratio"], MUJOCO,
        reach=(0.0, 1 - 1e-6),
    ),
    "mujoco direct": ContactForm(
        "MuJoCo −solref", "pushing", 1.0, {"stiffness": "1/s²", "damping": "1/s"},
        lambda m, v, k, zeta: (k / m, 2 * zeta * sqrt(k / m)),
        lambda given, *_: given["damping"] / (2 * sqrt(given["stiffness"])), MUJOCO,
    ),
    "elastogap": ContactForm(
        "Modelica ElastoGap", "limited", 1.0, {"c": "N/m", "d": "N s/m"}, _dashpot, _ratio("c", "d"),
        "modelica/ModelicaStandardLibrary Modelica/Mechanics/Translational/Components/ElastoGap.mo",
    ),
    "drake": ContactForm(
        "Drake point contact", "product", 1.0, {"point_contact_stiffness": "N/m", "hunt_crossley_dissipation": "s/m"},
        _crossed, lambda given, _, speed: given["hunt_crossley_dissipation"] * speed,
        "RobotLocomotion/drake multibody/plant/contact_model_doxygen.h",
    ),
    "simbody": ContactForm(
        "Simbody HuntCrossley", "product", 1.5, {"stiffness": HERTZIAN, "dissipation": "s/m"},
        lambda m, v, k, product: (k, product / v / 1.5),
        lambda given, _, speed: 1.5 * given["dissipation"] * speed, "simbody/simbody Simbody/src/HuntCrossleyForce.cpp",
    ),
    "hertzdamp": ContactForm(
        "OpenSees Hertzdamp", "product", 1.5, {"Kh": HERTZIAN, "xiNorm": "1"}, lambda m, v, k, product: (k, product),
        lambda given, *_: given["xiNorm"], f"{OPENSEES}Hertzdamp.cpp", _ye,
    ),
    "jankowski": ContactForm(
        "OpenSees Jankowski", "loading", 1.5, {"Kh": HERTZIAN, "xi": "1"},
        lambda m, v, k, zeta: (k, zeta * sqrt(1.25)), lambda given, *_: given["xi"] / sqrt(1.25),
        f"{OPENSEES}JankowskiImpact.cpp", _jankowski,
    ),
    "viscoelastic gap": ContactForm(
        "OpenSees Viscoelastic", "bound", 1.0, {"K": "N/m", "C": "N s/m"}, _dashpot, _ratio("K", "C"),
        f"{OPENSEES}ViscoelasticGap.cpp", bound_damping_ratio,
    ),
    "chrono": ContactForm(
        "Chrono SMC Hertz", "pushing", 1.5, {"4/3 E √R": HERTZIAN, "restitution": "1"},
        _coefficient, lambda given, *_: bound_damping_ratio(given["restitution"]), CHRONO, bound_damping_ratio,
        (exp(-2), 1.0),
    ),
    "chrono hooke": ContactForm(
        "Chrono SMC Hooke", "pushing", 1.0, {"kn": "N/m", "gn": "1/s"},
        lambda m, v, k, zeta: (k, 2 * zeta * sqrt(k / m)),
        lambda given, mass, _: given["gn"] / (2 * sqrt(given["kn"] / mass)), CHRONO,
    ),
    "lammps hooke": ContactForm(
        "LAMMPS hooke", "bound", 1.0, {"k_n": "N/m", "e": "1"},
        _coefficient, lambda given, *_: bound_damping_ratio(given["e"]), LAMMPS, bound_damping_ratio,
    ),
    "lammps hertz": ContactForm(
        "LAMMPS hertz", "bound", 1.5, {"k_n √R": HERTZIAN, "e": "1"},
        _coefficient, lambda given, *_: bound_damping_ratio(given["e"]), LAMMPS, bound_damping_ratio,
    ),
    "lammps tsuji": ContactForm(
        "LAMMPS hertz, tsuji", "bound", 1.5, {"k_n √R": HERTZIAN, "e": "1"},
        lambda m, v, k, zeta: (k, falling_zero(lambda e: _tsuji(e) - zeta, 0.0, 1.0)),
        lambda given, *_: _tsuji(given["e"]), LAMMPS, _tsuji,
        (bound_restitution(_tsuji(0)), bound_restitution(_tsuji(1))),
    ),
}  # fmt: skip


def contact_terms(
    restitution: float,
    *,
    mass: float,
    contact_time: float | None = None,
    stiffness: float | None = None,
    speed: float = 0.1,
) -> dict[str, ContactTerm]:
    """A coefficient of restitution in the terms of other programs, by form: see ``ContactTerm``.

    All contacts last as long: ``contact_time`` s, or that of a linear stop of ``stiffness`` N/m, for a free ``mass``,
    kg, at a ``speed``, m/s; of a beam that mass is 1/S, S the contact's mobility. ValueError for numbers out of range.

    >>> import vibeam
    >>> terms = vibeam.contact_terms(0.72, mass=0.2, contact_time=0.5e-3)
    >>> {name: round(value, 4) for name, value in terms["mujoco"].parameters.items()}  # solref
    {'timeconst': 0.0015, 'dampratio': 0.1119}
    >>> round(terms["chrono"].parameters["restitution"], 4), round(terms["chrono"].own, 4)  # it does not pull
    (0.702, 0.7359)
    """
    faults: list[str] = []
    coefficient = number("restitution", restitution, faults, above=0.0, most=1.0)
    free, rate = number("mass", mass, faults, above=0.0), number("speed", speed, faults, above=0.0)
    given = {"contact_time": contact_time, "stiffness": stiffness}
    if (contact_time is None) == (stiffness is None):
        faults.append("contact_time or stiffness: give one of the two")
    checked = {name: number(name, value, faults, above=0.0) for name, value in given.items() if value is not None}
    refuse("contact terms", faults)
    stop = None if stiffness is None else LinearStop.matched(checked["stiffness"], coefficient, free)
    lasts = checked["contact_time"] if stop is None else stop.free_impact(free, rate).duration
    return {name: _term(form, coefficient, free, lasts, rate) for name, form in FORMS.items()}


def _term(form: ContactForm, restitution: float, mass: float, contact_time: float, speed: float) -> ContactTerm:
    parameters, kind = form.matched(restitution, mass, contact_time, speed), KINDS[form.kind]
    own = nan if form.own is None else kind.restitution(form.own(restitution))

    def at(v: float) -> float:
        return form.restitution(parameters, mass, v) if parameters else nan

    found, slow, fast = at(speed), at(SLOWEST), at(FASTEST)
    return ContactTerm(form.program, form.source, form.units, parameters, found, slow, fast, own, *form.reach)


def restitution_in(form: str, *, mass: float = 1.0, speed: float = 0.1, **parameters: float) -> float:
    """Coefficient of restitution that a ``form`` of ``contact_terms`` has by its program's own parameters.

    Those that R depends on are needed, with the ``mass``, kg, and the ``speed``, m/s, where it depends on them.
    ValueError for another form, and for parameters that are missing or that it does not have.

    >>> import vibeam
    >>> round(vibeam.restitution_in("mujoco", dampratio=0.3), 4)
    0.451
    """
    if form not in FORMS:
        raise ValueError(f"contact form {form!r}: there are {', '.join(FORMS)}")
    known = FORMS[form]
    if strange := sorted({*parameters} - {*known.units}):
        raise ValueError(f"{form}: {', '.join(strange)}: its parameters are {', '.join(known.units)}")
    try:
        return known.restitution(parameters, mass, speed)
    except KeyError as missing:
        raise ValueError(f"{form}: {missing.args[0]} is missing: its R depends on it") from None
