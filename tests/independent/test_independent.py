"""The independent truth against closed forms: it must stand before anything is judged by it."""

import ast
import csv
import json
import sys
from pathlib import Path

import mpmath
import numpy as np
import pytest
from events import Drive, Extremes, Modes, Motion, State, as_mpf, impacts
from geometry import Rig, Structure, base_amplitude, closed_form
from mpmath import mpf

HERE = Path(__file__).parent
NOMINAL = Modes([1], ["0.015"], [1], [1], gap=0, restitution="0.9")
COUPLED = Modes([1, "3.3", 9], ["0.02", 1, "2.5"], [1, "0.7", "-0.4"], [1, "0.3", "0.1"], "0.3", "0.7")
START = State([0, "0.01", "-0.02"], ["0.1", 0, "0.2"])


@pytest.fixture(autouse=True)
def _enough_digits():
    with mpmath.workdps(45):
        yield


@pytest.fixture(scope="module")
def structure():
    return Structure(Rig())


def close(got, expected, rel=0, abs=0):
    """pytest.approx for mpf (which it does not take), one number or a list: |got − expected| ≤ rel·|expected| + abs."""
    pairs = zip(got, expected, strict=True) if isinstance(got, list) else [(got, expected)]
    return all(mpmath.fabs(a - b) <= rel * mpmath.fabs(b) + abs for a, b in pairs)


def settled(system: Modes, drive: Drive, start: State, periods: int, digits: int = 30) -> Motion:
    motion = Motion(system, drive, start, digits=digits)
    motion.run(t_end=periods * 2 * mpmath.pi / mpf(drive.omega))
    return motion


PROGRAMS = ["events.py", "geometry.py", "loaded.py", "make_loaded.py", "make_references.py", "make_truth.py"]

CHECKER = ["check_certificate.py", "ball_motion.py", "ball_signal.py", "ball_tail.py"]


@pytest.mark.parametrize("file", PROGRAMS + CHECKER)
def test_imports_nothing_of_what_it_judges(file):
    nodes = list(ast.walk(ast.parse((HERE / file).read_text(encoding="utf-8"))))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    own = {each.removesuffix(".py") for each in PROGRAMS + CHECKER}
    others = {"flint", "gmpy2", "mpmath", "numpy"} | set(sys.stdlib_module_names)
    assert {name.split(".")[0] for name in names} <= own | others


def test_a_free_oscillator_moves_as_its_closed_form_says():
    zeta, t = mpf(3) / 10, mpf(17)
    motion = Motion(Modes([1], [zeta], [1], [0], gap=100), Drive(), State([1], [0]))
    motion.run(t_end=t)
    w = mpmath.sqrt(1 - zeta**2)
    truth = mpmath.exp(-zeta * t) * (mpmath.cos(w * t) + zeta / w * mpmath.sin(w * t))
    assert abs(motion.state().displacement[0] - truth) < mpf(10) ** -37


def test_bouncing_ball():
    """h = 1 m, g = 9.81, e = 0.9: every impact, the end of all impacts, and rest for ever after."""
    motion = Motion(Modes([0], [0], [1], [0], 0, "0.9", ["9.81"]), Drive(), State([-1], [0]))
    motion.run(t_end=20)
    e, fall = mpf("0.9"), mpmath.sqrt(2 / mpf("9.81"))
    hits = [event for event in motion.events if event.kind == "impact"]
    for k, hit in enumerate(hits[:100]):
        assert close(hit.time, fall * (1 + 2 * e * (1 - e**k) / (1 - e)), rel=mpf(10) ** -35)
        assert close(hit.speed, e**k * mpmath.sqrt(2 * mpf("9.81")), rel=mpf(10) ** -30)
    assert [float(hit.time) for hit in hits[:3]] == pytest.approx([0.4515236409857, 1.2642661947600, 1.9957344931569])
    assert motion.events[-1].kind == "rest"
    assert close(motion.events[-1].time, fall * (1 + e) / (1 - e), rel=mpf(10) ** -35)
    assert float(motion.events[-1].time) == pytest.approx(8.578949178729, abs=1e-12)
    assert motion.state().resting


def test_orbit_of_the_nominal_model():
    motion = settled(NOMINAL, Drive(2, "0.5e-3"), State([0], [0], resting=True), 220)
    motion.trackers = [Extremes([1])]
    motion.run(t_end=221 * mpmath.pi)
    assert -float(motion.trackers[0].minimum) == pytest.approx(1.753002e-2, abs=5e-9)


def test_orbit_of_the_nominal_model_from_the_periodic_greens_function():
    """PHYSICS' quadratic for the impulse p, with mpmath's exponentials: the speed before impact to 25 digits."""
    beta, R, omega, B = mpf("0.015"), mpf("0.9"), mpf(2), mpf("0.5e-3")
    period = 2 * mpmath.pi / omega
    root = mpmath.mpc(-beta, mpmath.sqrt(1 - beta**2))
    # η = Re(z e^{root t}) with η(T) = η(0) and η'(0) − η'(T) = 1
    grown = mpmath.exp(root * period)
    jump = lambda z: (mpmath.re(z * (1 - grown)), mpmath.re(z * root * (1 - grown)))  # noqa: E731
    (a, b), (c, d) = jump(mpmath.mpc(1)), jump(mpmath.mpc(0, 1))
    z = mpmath.mpc(-c, a) / (a * d - b * c)
    G0, G1 = mpmath.re(z), mpmath.re(z * root)
    H = omega**2 * B / mpmath.mpc(1 - omega**2, 2 * beta * omega)
    kappa = R / (1 + R) - G1
    p = -abs(H) / mpmath.sqrt(G0**2 + (kappa / omega) ** 2)
    last = settled(NOMINAL, Drive(2, B), State([0], [0], resting=True), 400, digits=35).events[-1]
    assert close(last.speed, -p / (1 + R), rel=mpf(10) ** -25)


def test_coco_impact_demo():
    motion = settled(Modes([1], ["0.05"], [1], [1], 1, "0.8"), Drive(1, 1), State([0], [0]), 150)
    last = motion.events[-1]
    phase = (last.time - mpmath.pi / 2) % (2 * mpmath.pi)  # its drive is a cosine
    values = [float(a) for a in (phase, last.speed, last.velocity[0])]
    assert values == pytest.approx([0.07595216, 1.69573294, -1.35658635], abs=5e-9)


@pytest.mark.parametrize(
    ("omega", "r", "sigma", "printed"), [("2", "0.8", "0", 6.6667), ("2.8", "0.8", "0.1", 0.106477937315)]
)
def test_budd_and_dux_orbits(omega, r, sigma, printed):
    """Set on the closed-form orbit of the undamped oscillator, the integration comes back to it."""
    w, r, sigma = mpf(omega), mpf(r), mpf(sigma)
    gamma, period = 1 / (1 - w**2), 2 * mpmath.pi / w
    c = mpmath.sin(period) * (1 + r) / (1 - mpmath.cos(period))
    m = (1 - r) / w
    speed = (-2 * c * sigma + 2 * mpmath.sqrt(gamma**2 * c**2 - (sigma**2 - gamma**2) * m**2)) / (c**2 + m**2)
    assert float(speed) == pytest.approx(printed, rel=1e-5)
    free = -(1 + r) * speed * mpmath.sin(period) / (2 * (1 - mpmath.cos(period)))
    phase = mpmath.atan2((r - 1) / 2 * speed / (gamma * w), (sigma - free) / gamma)
    begin = (phase + mpmath.pi / 2) / w
    start = State([sigma - mpf(10) ** -35], [-r * speed], time=begin)
    for k, hit in enumerate(impacts(Modes([1], [0], [1], [1], sigma, r), Drive(w, 1 / w**2), start, count=3), start=1):
        assert close(hit.time - begin, k * period, rel=mpf(10) ** -30)
        assert close(hit.speed, speed, rel=mpf(10) ** -30)


def test_more_digits_change_nothing_that_was_claimed():
    """20 against 40 digits over 40 impacts of three coupled modes; the loss shows that the check can fail."""
    drive = Drive("1.7", "0.5")
    coarse, fine = (impacts(COUPLED, drive, START, count=40, digits=digits) for digits in (20, 40))
    errors = [abs(a.time - b.time) / b.time for a, b in zip(coarse, fine, strict=True)]
    assert mpf(10) ** -28 < max(errors) < mpf(10) ** -17


def test_energy_is_kept_without_loss():
    """R = 1, no damping, no drive: ½Σ(η'² + ω²η²) stays through 60 impacts."""
    omega = [1, mpf("2.7"), mpf("6.1")]
    system = Modes(omega, [0, 0, 0], [1, "-0.8", "0.5"], [0, 0, 0], "0.2", 1)
    hits = impacts(system, Drive(), State([-1, "0.1", "0.2"], ["0.3", "0.2", 0]), count=60)
    energy = [sum(v**2 + (w * x) ** 2 for x, v, w in zip(h.displacement, h.velocity, omega, strict=True)) for h in hits]
    assert max(energy) - min(energy) < mpf(10) ** -35


def test_every_impact_lies_on_the_stop_and_none_is_missed():
    motion = Motion(COUPLED, Drive("1.7", "0.5"), START, digits=30)
    reach = Extremes(COUPLED.contact)
    motion.trackers = [reach]
    motion.run(count=40)
    contact = [mpf(c) for c in COUPLED.contact]
    for hit in motion.events:
        assert abs(sum(c * x for c, x in zip(contact, hit.displacement, strict=True)) - mpf("0.3")) < mpf(10) ** -28
        assert hit.speed > 0
    assert as_mpf(reach.maximum) - mpf("0.3") < mpf(10) ** -28


@pytest.mark.parametrize("exponent", [-2, -6, -12, -24])
def test_grazing_is_told_from_a_near_miss(exponent):
    """x = −cos t … against a stop a hair below and above its crest: an impact of speed √(1−gap²), or none at all."""
    depth = mpf(10) ** exponent
    hit = impacts(Modes([1], [0], [1], [0], 1 - depth, "0.5"), Drive(), State([-1], [0]), count=1, t_end=6)
    assert close(hit[0].time, mpmath.acos(depth - 1), abs=mpf(10) ** (-33 - exponent / 2))
    assert close(hit[0].speed, mpmath.sqrt(depth * (2 - depth)), rel=mpf(10) ** (-34 - exponent))
    assert not impacts(Modes([1], [0], [1], [0], 1 + depth, "0.5"), Drive(), State([-1], [0]), t_end=20)


def test_a_true_touch_is_refused_not_guessed():
    with pytest.raises(ArithmeticError, match="nearer to the stop"):
        impacts(Modes([1], [0], [1], [0], 1, "0.5"), Drive(), State([-1], [0]), t_end=6)


def test_two_impacts_within_one_taylor_step():
    """A fast small bounce on a slow motion: the step that a series would reach holds several impacts."""
    system = Modes([0], [0], [1], [0], 0, "0.5", [100])
    hits = impacts(system, Drive(), State(["-1e-6"], [0]), count=5)
    fall = mpmath.sqrt(mpf("2e-6") / 100)
    truth = [fall * (1 + 2 * (1 - mpf(2) ** -k)) for k in range(5)]
    assert close([h.time for h in hits], truth, rel=mpf(10) ** -34)


def test_a_rest_ends_where_the_contact_force_does():
    """One mode pressed to the stop: load Ω²B sin Ωt − ω² gap = 0 on its way down."""
    motion = Motion(Modes([1], ["0.1"], [1], [1], "-0.1", "0.5"), Drive("1.5", 1), State(["-0.1"], [0], resting=True))
    motion.run(count=1, until="release")
    force = lambda t: mpf("2.25") * mpmath.sin(mpf("1.5") * t) + mpf("0.1")  # noqa: E731
    assert motion.events[0].kind == "release"
    assert close(motion.events[0].time, mpmath.findroot(force, (2, 2.2)), rel=mpf(10) ** -37)
    motion.run(count=1)
    assert motion.events[1].speed > 0


def test_at_rest_the_other_modes_go_on_under_the_constraint():
    """Two modes held at the contact are one oscillator along the stop: its closed form, with the force."""
    w1, w2 = mpf(1), mpf(2)
    system = Modes([w1, w2], [0, 0], [1, 1], [0, 0], 0, "0.5", static=[5, 5])
    motion = Motion(system, Drive(), State(["0.1", "-0.1"], [0, 0], resting=True))
    motion.run(t_end=7)
    # η₁ = −η₂ = y: 2y'' + (ω₁² + ω₂²) y = 0
    y = mpf("0.1") * mpmath.cos(mpmath.sqrt((w1**2 + w2**2) / 2) * 7)
    assert close(motion.state().displacement, [y, -y], abs=mpf(10) ** -36)


def test_chatter_completes_to_the_same_limit_wherever_it_is_cut():
    """Followed to 1e-25 and to 1e-12 of a time constant: the geometric remainder is good to the square of that."""
    system = Modes([1, "3.1"], ["0.05", "0.02"], [1, "0.5"], [1, "0.2"], "-0.5", "0.6", [1, 0])
    ends = []
    for tiny in (1e-25, 1e-12):
        motion = Motion(system, Drive("0.9", "0.1"), State([-1, 0], [0, 0]), digits=50, tiny=tiny)
        motion.run(count=1, until="rest")
        ends.append(motion.events[-1].time)
    assert close(ends[1], ends[0], abs=mpf(10) ** -22)
    assert ends[1] != ends[0]


def test_static_mode_against_the_piecewise_closed_form(structure):
    single = structure.static_mode()
    assert (single.contact, single.stiffness) == pytest.approx(closed_form(Rig()), rel=1e-13)


def test_the_rig_has_the_measured_frequencies(structure):
    """7.60 Hz; mode 2 at 101.1 … 103 Hz without the accelerometer; the static mode 0.05 % above the first mode."""
    modes, single = structure.modal(2), structure.static_mode()
    assert modes.omega[0] / (2 * np.pi) == pytest.approx(7.60, abs=0.005)
    assert 101 < modes.omega[1] / (2 * np.pi) < 103
    assert 1 < single.omega / modes.omega[0] < 1.0005
    assert single.zeta == pytest.approx(0.017, rel=1e-3)


def test_modes_are_orthonormal_and_converged(structure):
    gram = (structure.shapes[:, :10].T @ structure.M @ structure.shapes[:, :10]).astype(float)
    assert gram == pytest.approx(np.eye(10), abs=1e-12)
    finer = Structure(Rig(elements=48)).omega
    assert finer[:3] == pytest.approx(structure.omega[:3], rel=2e-6)


def test_restitution_seen_by_the_first_mode_falls_with_the_number_of_modes(structure):
    """PHYSICS §3: 0.72, 0.684, 0.619, 0.599 for N = 1, 2, 5, 10 of a rig with an accelerometer: near those without."""
    rows = [structure.modal(n).contact for n in (1, 2, 5, 10)]
    seen = [1.72 * c[0] ** 2 / (c @ c) - 1 for c in rows]
    assert seen == pytest.approx([0.72, 0.684, 0.619, 0.599], abs=2e-3)


def test_massless_base_amplitude():
    """φ(L_m) = 2·132³/(100²·296): b = γ V φ(L_m) L."""
    assert base_amplitude(Rig(), 5.16e-4, 0.6) == pytest.approx(5.16e-4 * 0.6 * 2 * 1.32**3 / 2.96 * 0.18, rel=1e-14)


def stored(kind: str) -> list[dict]:
    return json.loads((HERE / "truth.json").read_text(encoding="utf-8"))[kind]


def rerun(entry: dict, digits: int = 30) -> list:
    """The impacts of a stored entry, integrated again with other digits."""
    rows = {name: entry[name] for name in ("omega", "zeta", "contact", "load", "gap", "restitution", "static")}
    start = State(entry["start"]["displacement"], entry["start"]["velocity"])
    drive = Drive(entry["drive"]["omega"], entry["drive"]["amplitude"])
    return impacts(Modes(**rows), drive, start, count=len(entry["times"]), digits=digits)


@pytest.mark.parametrize("kind", ["systems", "grazing", "chatter"])
def test_the_stored_truth_belongs_to_its_inputs(kind):
    """Remade with fewer digits; where a graze multiplies their loss, the bound follows."""
    entries = [entry for entry in stored(kind) if len(entry["omega"]) <= 3 and entry["times"]]
    assert len(entries) >= 5
    for entry in entries:
        again, bound = rerun(entry), mpf(10) ** (-12 if kind == "grazing" else -20)
        fastest = max(mpf(v) for v in entry["velocities"])
        assert close([hit.time for hit in again], [mpf(t) for t in entry["times"]], rel=bound)
        assert close([hit.speed for hit in again], [mpf(v) for v in entry["velocities"]], abs=bound * fastest)


def test_the_stored_curves_are_whole():
    """Every reference file: up and down over the same points; the nominal one meets the closed form at Ω = 2."""
    folder = HERE.parents[1] / "cases" / "references"
    for name, points in {"dtu_neutral": 121, "dtu_loose": 121, "dtu_tight": 121, "sdof_nominal": 201}.items():
        lines = (folder / f"{name}_sdof.csv").read_text(encoding="utf-8").splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        up, down = ([r["frequency_hz"] for r in rows if r["direction"] == d] for d in ("up", "down"))
        assert len(up) == points
        assert down == up[::-1]
    at_two = min(rows, key=lambda r: abs(float(r["frequency_hz"]) - 1 / np.pi))
    assert float(at_two["reach"]) == pytest.approx(1.753002e-2, abs=5e-9)
