"""Certificates of all cases and of all kinds of stops, proved by the checker: writes certificates.json.

    python tests/independent/prove_certificates.py               # entries that the file does not hold; --again: all
    python tests/independent/prove_certificates.py --only fig19  # those whose name holds that; --again: written too

Each point of each branch of a case's flight fidelities is flown with a certificate over all of settle and hold, the
state carried on as in a sweep. The checker proves the first and the last ``PERIODS`` drive periods of it; with --whole
all of it. Also: the rig with every law of a stop (``LAWS``), and the random rigs of every kind (``random_rigs``).
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import proved_table
from check_certificate import check

import vibeam
from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.flight.proof.certificate import Certificate
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases"
sys.path[:0] = [str(HERE.parent / "hard"), str(HERE.parent / "support")]

from case_files import SWEPT  # noqa: E402
from random_rigs import KINDS, rig  # noqa: E402
from report import commit, machine  # noqa: E402

COMMIT = commit()  # before the file is written

FILE = HERE / "certificates.json"
PERIODS = 2
MORE_BITS = 400
SEEDS = range(24)
ROUNDED = ("periods", "seconds_flown", "seconds_checked")
LAWS: dict[str, dict[str, Any]] = {
    "R of the velocity": {"law": PlasticRestitution(0.72, 0.05)},
    "R of a table": {"law": TableRestitution((0.01, 0.1), (0.9, 0.6))},
    "R = 1 - k v^b": {"law": ViscousRestitution(0.6, 0.2)},
    "R = 0": {"restitution": 0.0},
    "R = 1": {"restitution": 1.0},
    "second stop": {"second_gap": 0.4e-3},
    "pressed": {"gap": -0.4e-3},
    "linear": {"law": LinearStop(1e5)},
    "linear, damped": {"law": LinearStop(1e6, 100.0)},
    "linear, damped, pressed, second stop": {"law": LinearStop(1e5, 30.0), "gap": -0.2e-3, "second_gap": 0.5e-3},
}  # fmt: skip


@dataclass
class Proved:
    """What was flown and proved for one entry; ``unproved`` counts the reasons that certificates name."""

    commit: str
    machine: str
    motions: int = 0
    periods: float = 0.0
    impacts: int = 0
    segments: int = 0
    segments_checked: int = 0
    pieces_checked: int = 0
    pieces_proved: int = 0
    most_pieces_a_segment: int = 0
    seconds_flown: float = 0.0
    seconds_checked: float = 0.0
    unproved: dict[str, int] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)

    def add(self, path: vibeam.Trajectory, parts: list[Certificate], place: str) -> None:
        """Check parts of a motion's certificate."""
        whole = path.certificate
        assert whole is not None
        self.motions += 1
        self.periods += (path.t_end - path.t_start) * path.drive.omega / (2 * np.pi)
        self.impacts += len(path.impact_times)
        self.segments += len(whole.kinds)
        self.unproved = dict(Counter(self.unproved) + Counter(stretch.reason for stretch in whole.unproved))
        if path.ended is not vibeam.Ended.COMPLETE:
            self.faults.append(f"{place}: {path.ended.value}")
        begun = time.process_time()
        for part in parts:
            faults, proved = check(part)
            if faults:  # of full models, perhaps: 64 coupled modes leave enclosures too wide
                faults, proved = check(part, bits=MORE_BITS)
            self.faults += [f"{place}: {text}" for text in faults]
            self.segments_checked += len(part.kinds)
            self.pieces_checked += len(part.pieces)
            self.pieces_proved += proved
            counts = np.bincount(part.pieces[:, 0].astype(int), minlength=1)
            self.most_pieces_a_segment = max(self.most_pieces_a_segment, int(counts.max()))
        self.seconds_checked += time.process_time() - begun


def stretch(whole: Certificate, begin: float, end: float) -> Certificate:
    """The segments of a certificate that begin before ``end``, from that which holds ``begin`` on."""
    first = max(int(np.searchsorted(whole.times, begin, side="right")) - 1, 0)
    last = max(int(np.searchsorted(whole.times, end)), first + 1)

    def of(rows: np.ndarray) -> np.ndarray:
        mine = rows[(rows[:, 0] >= first) & (rows[:, 0] < last)].copy()
        mine[:, 0] -= first
        return mine

    names = ("times", "kinds", "sides", "ends", "starts", "clocks", "durations", "orders", "roots")
    rows = {name: getattr(whole, name)[first:last] for name in names}
    return replace(whole, **rows, pieces=of(whole.pieces), tails=of(whole.tails))


@dataclass(frozen=True)
class Sweep:
    """One fidelity of a case."""

    name: str
    system: vibeam.ImpactSystem
    branches: list[np.ndarray]  #: rad/s, in the order swept
    amplitude: Callable[[np.ndarray], np.ndarray]
    drift: Callable[[np.ndarray], np.ndarray | None]
    settle: int
    hold: int

    def motions(self) -> Iterator[tuple[str, vibeam.Trajectory]]:
        """Every point's motion, certified, with its place; the state goes on from point to point."""
        state = None
        for omega in self.branches:
            drives, drifts = self.amplitude(omega), self.drift(omega)
            for i, rate in enumerate(omega):
                system = self.system
                if drifts is not None:
                    system = replace(system, gap=system.gap + float(drifts[i]))
                drive, periods = vibeam.Drive(float(rate), float(drives[i])), self.settle + self.hold
                begin = onto(system, state)
                path = vibeam.simulate(system, drive, periods * 2 * np.pi / rate, begin, certify=True)
                state = path.state
                yield f"{self.name}, {rate / (2 * np.pi):.6g} Hz", path


def onto(system: vibeam.ImpactSystem, state: vibeam.State | None) -> vibeam.State | None:
    """A state that a gap which has shrunk leaves beyond the stop, put back onto it."""
    if state is None or hasattr(system.law, "stiffness"):
        return state
    beyond = max(0.0, float(system.contact @ state.displacement) - system.gap)
    back = system.contact * (beyond / float(system.contact @ system.contact))
    return vibeam.State(state.displacement - back, state.velocity, state.resting)


def sweeps(case: vibeam.Case) -> Iterator[Sweep]:
    """The fidelities of a case that fly with certificates, each system under its drive once."""
    taken: list[Sweep] = []
    for name, fidelity in case.fidelities.items():
        scene, grid = case.scene_of(name), 2 * np.pi * case.sweep.frequency
        if fidelity.solver != "flight" or case.system(name).further is not None:  # contacts in several places
            continue
        assert not gap_wear(scene)
        legs = {"up": [grid], "down": [grid[::-1]], "both": [grid, grid[::-1]]}[case.sweep.direction]
        own = Sweep(
            name, case.system(name), legs,
            lambda omega, name=name: np.broadcast_to(case.amplitude_of(name, omega), omega.shape),
            lambda omega, scene=scene: gap_drift(scene, omega), case.sweep.settle, case.sweep.hold,
        )  # fmt: skip
        if not any(same(own, other, grid) for other in taken):
            taken.append(own)
            yield own


def same(one: Sweep, other: Sweep, grid: np.ndarray) -> bool:
    """Whether two fidelities are one motion."""
    if one.system != other.system or not np.array_equal(one.amplitude(grid), other.amplitude(grid)):
        return False
    drifts = [each.drift(grid) for each in (one, other)]
    return np.array_equal(*(np.zeros(1) if drift is None else drift for drift in drifts))


def prove_case(path: Path, changes: dict[str, Any] | None = None, whole: bool = False) -> Proved:
    """All fidelities of a case file; the first and last periods of each point, or all.

    ``changes`` of the systems: then nine points of the first branch, 100 periods each.
    """
    case, found = vibeam.load(path), Proved(COMMIT, machine())
    for own in sweeps(case):
        if changes:
            legs = [leg[:: len(leg) // 8] for leg in own.branches[:1]]
            own = replace(own, system=replace(own.system, **changes), branches=legs, settle=80, hold=20)
        begun, checked = time.process_time(), found.seconds_checked
        for place, motion in own.motions():
            cut = PERIODS * 2 * np.pi / motion.drive.omega
            ends = [(0.0, cut), (motion.t_end - cut, np.inf)] if motion.t_end > 2 * cut and not whole else [(0, np.inf)]
            found.add(motion, [stretch(motion.certificate, *each) for each in ends], place)
        found.seconds_flown += time.process_time() - begun - (found.seconds_checked - checked)
    return found


def prove_kind(kind: str, seeds: range = SEEDS) -> Proved:
    """Random rigs of a kind, twelve periods each."""
    found = Proved(COMMIT, machine())
    for seed in seeds:
        begun = time.process_time()
        path = vibeam.simulate(*rig(kind, seed, 12), max_impacts=1000, certify=True)
        found.seconds_flown += time.process_time() - begun
        if path.ended is vibeam.Ended.EVENT_LIMIT:
            path = replace(path, ended=vibeam.Ended.COMPLETE)
        found.add(path, [path.certificate], f"seed {seed}")
    return found


def entries(whole: bool = False) -> dict[str, Callable[[], Proved]]:
    """Everything that the file holds, by name; ``whole``: every period of every case."""
    files, neutral = sorted(SWEPT, key=lambda path: (path.parent != CASES, path)), CASES / "dtu_neutral.toml"
    found: dict[str, Callable[[], Proved]] = {f"random, {kind}": lambda kind=kind: prove_kind(kind) for kind in KINDS}
    found |= {f"rig, {name}": lambda more=more: prove_case(neutral, more) for name, more in LAWS.items()}
    return found | {
        f"cases/{path.relative_to(CASES)}": lambda path=path: prove_case(path, whole=whole) for path in files
    }


def stored() -> dict[str, dict[str, Any]]:
    """What the file holds."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}


def line(name: str, found: Proved) -> str:
    """One entry in words."""
    named = f", {sum(found.unproved.values())} stretches named as not proved" if found.unproved else ""
    return (
        f"{name}: {found.motions} motions, {found.impacts} impacts, {found.pieces_proved} of {found.pieces_checked} "
        f"pieces proved, {len(found.faults)} faults{named}, {found.seconds_flown + found.seconds_checked:.1f} s"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--whole", action="store_true")
    options = parser.parse_args()
    held = {} if options.again else stored()
    for name, prove in entries(options.whole).items():
        if options.only not in name or (not options.only and name in held):
            continue
        found = prove()
        print(line(name, found), *found.faults[:5], sep="\n  ", flush=True)
        if found.motions and (options.again or not options.only):
            write(name, found)


def write(name: str, found: Proved) -> None:
    """Put one entry into the file, which another program may have changed meanwhile."""
    found = replace(found, **{key: round(getattr(found, key), 1) for key in ROUNDED})
    held = stored() | {name: asdict(found)}
    held = {each: held[each] for each in entries() if each in held}
    FILE.write_text(json.dumps(held, indent=1) + "\n", encoding="utf-8")
    proved_table.write()


if __name__ == "__main__":
    main()
