"""Write the reference curves in cases/references with the independent integration: see ``--help``.

    python tests/independent/make_references.py [names] [--out DIRECTORY]

The state is carried from point to point along the case's own grid, up from rest and then down again; the drive's
phase starts at 0 at every point. A point settles for ``settle`` periods and is held for ``hold``. Where the motion has
become periodic to 1e-20 before that, the rest is not integrated but known, and one repetition is read.
"""

from __future__ import annotations

import argparse
import csv
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import mpmath
import numpy as np
from events import Drive, Extremes, Modes, Motion, State, as_mpf
from geometry import Rig, Structure, base_amplitude

DIGITS = 30
TINY = 1e-14  # flights of a chatter shorter than this share of the fastest time constant are summed as a limit
SAME = 1e-20  # of the state's size: strobes this near are the same orbit
REPEATS = 1e-6  # of the state's size: strobes this near over a whole hold are on their way to an orbit
CLEARLY_APART = 1e-10  # of the state's size: strobes nearer than that, though not the same, will be
PATIENCE = 10  # times settle and hold for an orbit that creeps to its end
LONGEST = 16  # periods looked for
COLUMNS = (
    "frequency_hz",
    "direction",
    "amplitude",
    "maximum",
    "minimum",
    "reach",
    "impacts_per_period",
    "impact_velocity",
    "period",
)


@dataclass(frozen=True)
class Curve:
    """One reference file: a system, what is read off it, and how it is swept."""

    title: str
    system: Modes
    sensor: list[float]
    amplitude: float
    frequencies: np.ndarray  #: Hz, as written
    omegas: list[mpmath.mpf]  #: rad/s
    settle: int = 300
    hold: int = 50


@dataclass
class Reading:
    """What is read off a periodic point over ``periods`` of the drive; ``period`` is that, −1 without contact."""

    period: int
    maximum: mpmath.mpf
    minimum: mpmath.mpf
    reach: mpmath.mpf
    impacts: int
    rests: int
    speed: mpmath.mpf
    periods: int


def rig_curve(title: str, band: tuple[float, float], gap: float, restitution: float, gain: float) -> Curve:
    """A case of the rig in the single-degree-of-freedom model, whose R is what mode 1 sees; the gap is the sensor's."""
    single = Structure(Rig()).static_mode()
    frequencies = np.linspace(*band, 121)
    return Curve(
        title=f"{title}: gap {gap} m at the sensor, R {restitution}, gamma {gain} 1/V at 0.6 V; "
        f"omega {single.omega!r} rad/s, zeta {single.zeta!r}, contact row {single.contact!r}, "
        f"base factor {single.base_factor!r}",
        system=single.modes(gap * single.contact, restitution),
        sensor=[1.0],
        amplitude=base_amplitude(Rig(), gain, 0.6),
        frequencies=frequencies,
        omegas=[2 * mpmath.pi * mpmath.mpf(float(f)) for f in frequencies],
    )


def two_modes() -> Curve:
    """The neutral case with the two lowest modes of the beam, of which the first sees R = 0.72."""
    modal = Structure(Rig()).modal(2)
    restitution = modal.contact_restitution(0.72)
    frequencies = np.linspace(14, 17, 7)
    return Curve(
        title=f"DTU beam, neutral, two modes: gap 0 m, R 0.72 of mode 1, {restitution!r} of the contact, "
        f"gamma 0.000516 1/V at 0.6 V; omega {modal.omega.tolist()} rad/s, zeta 0.017, "
        f"contact row {modal.contact.tolist()}, "
        f"sensor row {modal.sensor.tolist()}, load {modal.load.tolist()}",
        system=modal.modes(0.0, restitution),
        sensor=modal.sensor.tolist(),
        amplitude=base_amplitude(Rig(), 5.16e-4, 0.6),
        frequencies=frequencies,
        omegas=[2 * mpmath.pi * mpmath.mpf(float(f)) for f in frequencies],
    )


def nominal() -> Curve:
    """The nondimensional model of the paper's §2 to §4."""
    omegas = np.linspace(1.5, 2.5, 201)
    return Curve(
        title="Nondimensional model: omega 1, zeta 0.015, gap 0, R 0.9, B 0.0005; Omega = 1.5, 1.505 ... 2.5",
        system=Modes([1.0], [0.015], [1.0], [1.0], 0.0, 0.9),
        sensor=[1.0],
        amplitude=0.5e-3,
        frequencies=omegas / (2 * np.pi),
        omegas=[mpmath.mpf(float(w)) for w in omegas],
        settle=200,
    )


CURVES = {
    "dtu_neutral_sdof": lambda: rig_curve("DTU beam, neutral", (14, 17), 0.0, 0.72, 5.16e-4),
    "dtu_loose_sdof": lambda: rig_curve("DTU beam, loose", (8, 17), 1e-4, 0.59, 7.66e-4),
    "dtu_tight_sdof": lambda: rig_curve("DTU beam, tight", (14, 20), -1e-4, 0.80, 3.78e-4),
    "sdof_nominal_sdof": nominal,
    "dtu_neutral_two_modes": two_modes,
}


class Point:
    """One point of a sweep: a motion followed from strobe to strobe."""

    def __init__(self, curve: Curve, omega: mpmath.mpf, start: State) -> None:
        self.curve = curve
        drive = Drive(omega, curve.amplitude)
        self.motion = Motion(curve.system, drive, start, digits=DIGITS, tiny=TINY)
        self.length = 2 * mpmath.pi / omega
        self.omega = omega
        self.strobes = [self._strobe()]

    def read(self) -> Reading | None:
        """Settle and read one repetition, None if there is none; ends at a state that stands for the end of the hold.

        An orbit that only creeps to its end (within 1e-6 after settle and hold) is given more time.
        """
        total = self.curve.settle + self.curve.hold
        period = self._settle(total)
        if period is None and self._repetition():
            period = self._settle(PATIENCE * total)
        if period is None:
            return None
        for _ in range((total - len(self.strobes) + 1) % period):
            self._next()
        return self._observe(period)

    def _settle(self, most: int) -> int | None:
        """Go on until the motion repeats to 1e-20, for ``most`` periods from the start at the most: its period."""
        period = None
        while len(self.strobes) <= most and period is None:
            self._next()
            period = self._orbit()
        return period

    def end(self) -> State:
        """The state with which the next point starts."""
        state = self.motion.state()
        return State(state.displacement, state.velocity, state.resting)

    def _observe(self, periods: int) -> Reading:
        sensor, contact = Extremes(self.curve.sensor), Extremes(self.curve.system.contact)
        self.motion.trackers, first = [sensor, contact], len(self.motion.events)
        began = self.motion.resting
        for _ in range(periods):
            self._next()
        self.motion.trackers = []
        events = self.motion.events[first:]
        speeds = [event.speed for event in events if event.kind == "impact"]
        rests = began + sum(event.kind == "rest" for event in events)
        return Reading(
            period=periods if speeds or rests else -1,
            maximum=as_mpf(sensor.maximum),
            minimum=as_mpf(sensor.minimum),
            reach=mpmath.mpf(self.curve.system.gap) - as_mpf(contact.minimum),
            impacts=len(speeds),
            rests=rests,
            speed=sum(speeds) / len(speeds) if speeds else mpmath.nan,
            periods=periods,
        )

    def _next(self) -> None:
        self.motion.run(t_end=len(self.strobes) * self.length)
        self.strobes.append(self._strobe())

    def _strobe(self) -> tuple[np.ndarray, np.ndarray]:
        """The state as doubles of displacement and velocity/Ω and what doubles leave of it: 30 digits, subtractable."""
        state = self.motion.state()
        values = [*state.displacement, *(v / self.omega for v in state.velocity)]
        head = np.array([float(a) for a in values])
        return head, np.array([float(a - mpmath.mpf(b)) for a, b in zip(values, head.tolist(), strict=True)])

    def _apart(self, i: int, j: int) -> float:
        """Distance of two strobes relative to their size."""
        (a, a_rest), (b, b_rest) = self.strobes[i], self.strobes[j]
        size = np.abs(a).max()
        return float(np.abs((a - b) + (a_rest - b_rest)).max() / size) if size else 0.0

    def _orbit(self) -> int | None:
        """Least n ≤ 16 such that n strobes in a row have come back within 1e-20.

        A motion that spirals into its orbit may come back to n sooner than to a divisor of n: it is given more time.
        """
        last = len(self.strobes) - 1
        for n in range(1, LONGEST + 1):
            if last < 2 * n or last < 3:
                return None
            if all(self._apart(last - k, last - k - n) < SAME for k in range(n)):
                spirals = any(self._apart(last, last - m) < CLEARLY_APART for m in range(1, n))
                return None if spirals else n
        return None

    def _repetition(self) -> bool:
        """Whether the strobes of the hold repeat to 1e-6 after some n ≤ 16."""
        last = len(self.strobes) - 1
        held = range(last - self.curve.hold, last + 1)
        return any(all(self._apart(k, k - n) < REPEATS for k in held) for n in range(1, LONGEST + 1))


def sweep(curve: Curve) -> Iterator[tuple[float, str, Reading | None]]:
    """All points, up and down, with the state carried."""
    n = len(curve.system.omega)
    pressed = curve.system.gap <= 0
    start = [curve.system.gap / curve.system.contact[0]] if n == 1 and pressed else [0.0] * n
    state = State(start, [0.0] * n, resting=pressed)
    points = list(zip(curve.frequencies.tolist(), curve.omegas, strict=True))
    for direction, order in (("up", points), ("down", points[::-1])):
        for frequency, omega in order:
            point = Point(curve, omega, state)
            yield frequency, direction, point.read()
            state = point.end()


def row(frequency: float, direction: str, reading: Reading | None) -> list[str]:
    """A line of the file; what cannot be compared is left empty."""
    if reading is None:
        return [repr(frequency), direction, *[""] * 6, "0"]
    number = [
        (reading.maximum - reading.minimum) / 2,
        reading.maximum,
        reading.minimum,
        reading.reach,
    ]
    impacts = ["", ""] if reading.rests else [repr(reading.impacts / reading.periods), _digits(reading.speed)]
    swing = number[0]
    number = [mpmath.mpf(0) if abs(a) < swing * mpmath.mpf(10) ** (5 - DIGITS) else a for a in number]
    return [repr(frequency), direction, *map(_digits, number), *impacts, str(reading.period)]


def _digits(value: mpmath.mpf) -> str:
    return "" if mpmath.isnan(value) else mpmath.nstr(value, 18, min_fixed=0, max_fixed=0)


def header(name: str, curve: Curve) -> list[str]:
    """What the file is, in comment lines."""
    gap_text = "rest on the stop" if curve.system.gap <= 0 else "rest"
    return [
        f"# Reference curve {name}: independent integration by Taylor series, {DIGITS} digits",
        f"# {curve.title}",
        f"# base amplitude {curve.amplitude!r}; SI units (the nondimensional model: its own)",
        f"# up from {gap_text}, then down; state carried, phase 0 at every point; settle {curve.settle}, "
        f"hold {curve.hold} periods",
        f"# as soon as the strobes repeat to {SAME} one repetition is read: settling is cut short there; an orbit that",
        f"# repeats only to {REPEATS} by then is followed on to {SAME}",
        "# amplitude, maximum, minimum: sensor; reach: gap - min of the contact displacement; impact_velocity: mean",
        "# contact velocity before impact; period: least n <= 16, -1 no impact; all empty where the motion of the "
        "point or",
        "# of a neighbour does not repeat: there round-off decides what a point locks to, and nothing is to be "
        "compared;",
        "# impacts_per_period and impact_velocity are empty where a chatter ends in rest: its impacts are countless",
        f"# made by: python tests/independent/make_references.py {name}",
    ]


def only_settled(rows: list[list[str]]) -> list[list[str]]:
    """The rows, emptied where the motion of the point or of a neighbour, up or down, does not repeat.

    Among chaotic motions it is round-off that decides whether and on which orbit a point locks: nothing to compare.
    The same holds of a single point left between emptied ones, whose start is the end of one of them.
    """
    grid = sorted({float(line[0]) for line in rows})
    wild = [any(line[-1] == "0" for line in rows if float(line[0]) == f) for f in grid]
    near = [any(wild[max(i - 1, 0) : i + 2]) for i in range(len(grid))]
    alone = [i > 0 and all(near[i - 1 : i] + near[i + 1 : i + 2]) for i in range(len(grid))]
    emptied = {f for i, f in enumerate(grid) if near[i] or alone[i]}
    return [[*line[:2], *[""] * 7] if float(line[0]) in emptied else line for line in rows]


def write(name: str, folder: Path) -> None:
    """Integrate one curve and write its file."""
    began, curve = time.perf_counter(), CURVES[name]()
    rows = only_settled([row(*point) for point in sweep(curve)])
    with open(folder / f"{name}.csv", "w", encoding="utf-8", newline="") as file:
        file.write("\n".join(header(name, curve)) + "\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([COLUMNS, *rows])
    print(f"{name}: {len(rows)} points, {time.perf_counter() - began:.0f} s", flush=True)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description="Write reference curves by arbitrary-precision integration.")
    parser.add_argument("names", nargs="*", help=f"which curves (default: all): {', '.join(CURVES)}")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "cases" / "references")
    given = parser.parse_args()
    mpmath.mp.prec = math.ceil(DIGITS * math.log2(10)) + 16
    for name in given.names or CURVES:
        write(name, given.out)


if __name__ == "__main__":
    main()
