"""Contact dictionary: a coefficient of restitution in the terms of other programs, and theirs as a coefficient.

Formulas are those of the programs' sources, each named beside its form; ``tests/others`` integrates every one and runs
the programs that install.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, nan, pi, sqrt

from vibeam_models.arguments import number, refuse
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.dissipation import KINDS, bound_damping_ratio, bound_restitution
from vibeam_models.laws.free_impact import falling_zero

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


MUJOCO = "google-deepmind/mujoco src/engine/engine_core_constraint.c, mj_makeImpedance"
MODELICA = "modelica/ModelicaStandardLibrary Modelica/Mechanics/Translational/Components/ElastoGap.mo"
DRAKE = "RobotLocomotion/drake multibody/plant/contact_model_doxygen.h"
SIMBODY = "simbody/simbody Simbody/src/HuntCrossleyForce.cpp"
CHRONO = "projectchrono/chrono src/chrono/physics/ChContactSMC.h"
LAMMPS = "lammps/lammps src/GRANULAR/gran_sub_mod_damping.cpp"
OPENSEES = "OpenSees/OpenSees SRC/material/uniaxial/"
OURS = "models/vibeam_models/laws/compliant.py"
STIFF = {1.0: "N/m", 1.5: "N/m^1.5"}  # unit by exponent


def _dashpot(program: str, kind: str, k: str, c: str, source: str) -> ContactForm:
    """Contact with stiffness and damping, ζ = c/(2 √(k m))."""
    return ContactForm(
        program, kind, 1.0, {k: "N/m", c: "N s/m"}, lambda m, v, stiff, zeta: (stiff, 2 * zeta * sqrt(stiff * m)),
        lambda given, mass, _: given[c] / (2 * sqrt(given[k] * mass)), source,
    )  # fmt: skip


def _product(program: str, exponent: float, k: str, a: str, source: str, factor: float = 1.0) -> ContactForm:
    """Contact with Hunt and Crossley's damping, ``factor`` a in its force."""
    return ContactForm(
        program, "product", exponent, {k: STIFF[exponent], a: "s/m"}, lambda m, v, stiff, x: (stiff, x / v / factor),
        lambda given, _, speed: factor * given[a] * speed, source,
    )  # fmt: skip


def _bound(program: str, kind: str, exponent: float, k: str, e: str, source: str, least: float = 0.0) -> ContactForm:
    """Contact that takes the coefficient of a damper that pulls, whether it pulls or not."""
    return ContactForm(
        program, kind, exponent, {k: STIFF[exponent], e: "1"}, lambda m, v, s, zeta: (s, bound_restitution(zeta)),
        lambda given, *_: bound_damping_ratio(given[e]), source, bound_damping_ratio, (least, 1.0),
    )  # fmt: skip


FORMS: Mapping[str, ContactForm] = {
    "linear": _dashpot("vibeam linear", "pushing", "stiffness", "damping", OURS),
    "hunt-crossley": _product("vibeam hunt-crossley", 1.5, "hertz_stiffness", "damping", OURS),
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
    "elastogap": _dashpot("Modelica ElastoGap", "limited", "c", "d", MODELICA),
    "drake": _product("Drake point contact", 1.0, "point_contact_stiffness", "hunt_crossley_dissipation", DRAKE),
    "simbody": _product("Simbody HuntCrossley", 1.5, "stiffness", "dissipation", SIMBODY, 1.5),
    "hertzdamp": ContactForm(
        "OpenSees Hertzdamp", "product", 1.5, {"Kh": STIFF[1.5], "xiNorm": "1"}, lambda m, v, k, product: (k, product),
        lambda given, *_: given["xiNorm"], f"{OPENSEES}Hertzdamp.cpp", lambda e: 8 * (1 - e) / (5 * e),
    ),
    "jankowski": ContactForm(
        "OpenSees Jankowski", "loading", 1.5, {"Kh": STIFF[1.5], "xi": "1"},
        lambda m, v, k, zeta: (k, zeta * sqrt(1.25)), lambda given, *_: given["xi"] / sqrt(1.25),
        f"{OPENSEES}JankowskiImpact.cpp", lambda e: 9 * (1 - e**2) / (e * (e * (9 * pi - 16) + 16)),
    ),
    "viscoelastic gap": _dashpot("OpenSees Viscoelastic", "bound", "K", "C", f"{OPENSEES}ViscoelasticGap.cpp"),
    "chrono": _bound("Chrono SMC Hertz", "pushing", 1.5, "4/3 E √R", "restitution", CHRONO, exp(-2)),
    "chrono hooke": ContactForm(
        "Chrono SMC Hooke", "pushing", 1.0, {"kn": "N/m", "gn": "1/s"},
        lambda m, v, k, zeta: (k, 2 * zeta * sqrt(k / m)),
        lambda given, mass, _: given["gn"] / (2 * sqrt(given["kn"] / mass)), CHRONO,
    ),
    "lammps hooke": _bound("LAMMPS hooke", "bound", 1.0, "k_n", "e", LAMMPS),
    "lammps hertz": _bound("LAMMPS hertz", "bound", 1.5, "k_n √R", "e", LAMMPS),
    "lammps tsuji": ContactForm(
        "LAMMPS hertz, tsuji", "bound", 1.5, {"k_n √R": STIFF[1.5], "e": "1"},
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
