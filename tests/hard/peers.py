"""The hard cases run through other ways to compute them: what each of them misses.

    python tests/hard/peers.py                      # prints a table and writes tests/hard/PEERS.md
    python tests/hard/peers.py --only grazing       # families whose name holds that, printed only

Every run has a process of its own and so many seconds of CPU time. Siconos runs under any interpreter that has it:
``--siconos PYTHON``.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing as mp
import platform
import resource
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from agreement import _speed as speed_scale
from scenes import FIRM, MAKERS, Scene
from scipy.integrate import solve_ivp

import vibeam
from vibeam.solvers.integration.moreau import MoreauSolver

HERE = Path(__file__).parent
BEYOND = 0.01  # share of the motion's reach by which the contact may stand beyond the stop before that is told
ASTRAY = 0.01  # the same of where it is in the end
SLOW = 2  # times as long for Siconos, whose steps here take about a millisecond each
STILL = 100  # impacts in one last digit of time: a method that is there does not come away
FAINT = 1e-9  # share of the velocities' scale below which an impact where there is none is round-off's


@dataclass
class Found:
    """What a peer says: impacts (m, 2), contact places on the way, the one in the end, and what it complained of."""

    impacts: np.ndarray
    places: np.ndarray
    complaint: str = ""


@dataclass
class Verdict:
    """A peer's answer beside the truth."""

    missed: int = 0
    invented: int = 0
    late: float = 0.0  # worst error of a time over the time since the start
    timed: int = 0  # impacts found
    beyond: float = 0.0
    off: float = 0.0
    words: list[str] = field(default_factory=list)

    @property
    def fine(self) -> bool:
        return not (self.missed or self.invented or self.words or self.beyond > BEYOND or self.off > ASTRAY)

    def __str__(self) -> str:
        parts = list(self.words)
        parts += [f"{self.missed} missed"] if self.missed else []
        parts += [f"{self.invented} invented"] if self.invented else []
        parts += [f"{self.beyond:.0%} through the stop"] if self.beyond > BEYOND else []
        parts += [f"ends {self.off:.0%} off"] if self.off > ASTRAY else []
        timed = [f"{self.late:.0e}"] if self.timed else []
        return "; ".join([*(parts or ["ok"]), *timed])


# --------------------------------------------------------------------------------------------------------------- peers


def flight(scene: Scene) -> Found:
    """The solver under test."""
    system, drive, start = scene.case
    impacts, places, begin = [], [], scene.begin
    for end in scene.pieces:
        path = vibeam.simulate(system, drive, end, start, t_start=begin)
        impacts.append(np.stack([path.impact_times, path.impact_velocities], axis=1))
        places.append(path.at(np.linspace(begin, end, 2001 if len(scene.pieces) < 10 else 5)))
        complaint = "" if path.ended is vibeam.Ended.COMPLETE else path.ended.value
        start, begin = path.state, end
    return Found(np.concatenate(impacts), np.concatenate(places), complaint)


def events(scene: Scene, method: str, rtol: float) -> Found:
    """scipy's solve_ivp as one would write it: a terminal event on the falling gap, R, and on from there.

    ``atol`` goes with the scene's own size; no step is longer than 1/50 of the drive's period or 1/100 of the motion.
    """
    system, drive, start = scene.case
    n, c, mobility = system.size, system.contact, system.contact @ system.contact
    force, damping = system.load * drive.omega**2 * drive.amplitude, 2 * system.zeta * system.omega

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        pull = damping * y[n:] + system.omega**2 * y[:n]
        return np.concatenate([y[n:], force * np.sin(drive.omega * t) + system.static - pull])

    def gap(t: float, y: np.ndarray) -> float:
        return float(system.gap - c @ y[:n])

    gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
    t, y = scene.begin, np.concatenate([start.displacement, start.velocity])
    atol = rtol * 1e-2 * np.repeat([scene.size, speed_scale(scene.case)], n) / np.abs(c).max()
    longest = min(2 * np.pi / drive.omega / 50 if drive.omega else np.inf, (scene.end - scene.begin) / 100)
    impacts, places = [], []
    for end in scene.pieces:
        while t < end:
            done = solve_ivp(rate, (t, end), y, method, events=gap, rtol=rtol, atol=atol, max_step=longest)
            t, y = float(done.t[-1]), done.y[:, -1]
            places.append(c @ done.y[:n])
            if done.status < 0:
                return Found(np.array(impacts).reshape(-1, 2), np.concatenate(places), "gives up")
            if done.status == 1:
                speed = c @ y[n:]
                impacts.append((t, speed))
                if len(impacts) > STILL and t - impacts[-STILL][0] <= STILL * np.spacing(t):
                    return Found(np.array(impacts), np.concatenate(places), "hangs")
                y = np.concatenate([y[:n], y[n:] - c * ((1 + system.restitution) * speed / mobility)])
    return Found(np.array(impacts).reshape(-1, 2), np.concatenate(places))


def moreau(scene: Scene, steps: int) -> Found:
    """Moreau–Jean stepping, fixed steps a drive period (of the slowest mode where nothing is driven)."""
    system, drive, start = scene.case
    impacts, places, begin = [], [], scene.begin
    for end in scene.pieces:
        motion = MoreauSolver(system, drive.omega, steps=steps).motion(drive, start, begin, end)
        impacts.append(np.stack([motion.impact_times, motion.impact_velocities], axis=1))
        places.append(motion.displacement())
        complaint = "" if motion.ended is vibeam.Ended.COMPLETE else motion.ended.value
        start, begin = motion.state, end
    return Found(np.concatenate(impacts), np.concatenate(places), complaint)


def siconos(scene: Scene, python: str) -> Found:
    """Siconos' Moreau–Jean stepping by its own interpreter; 1 000 steps a period, as above."""
    system, drive, start = scene.case
    rows = {name: getattr(system, name).tolist() for name in ("omega", "zeta", "contact", "load", "static")}
    told = {
        **rows, "gap": system.gap, "restitution": system.restitution, "drive": [drive.omega, drive.amplitude],
        "displacement": start.displacement.tolist(), "velocity": start.velocity.tolist(),
        "begin": scene.begin, "pieces": scene.pieces, "steps": 1000,
    }  # fmt: skip
    script = str(HERE / "siconos_peer.py")
    done = subprocess.run([python, script], input=json.dumps(told), capture_output=True, text=True, check=False)
    if done.returncode < 0:
        raise TimeoutError
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["?"])[-1])
    answer = json.loads(done.stdout.strip().splitlines()[-1])
    return Found(np.array(answer["impacts"]).reshape(-1, 2), np.array(answer["places"]))


PEERS: dict[str, Callable[[Scene], Found]] = {
    "flight": flight,
    "RK23, events": partial(events, method="RK23", rtol=1e-4),
    "DOP853, events": partial(events, method="DOP853", rtol=1e-12),
    "Moreau, 1 000": partial(moreau, steps=1000),
    "Moreau, 10 000": partial(moreau, steps=10_000),
}


# ------------------------------------------------------------------------------------------------------------- judging


def judged(scene: Scene, found: Found) -> Verdict:
    """Each firm true impact looks for its nearest within half an interval; a firm one without a partner is invented."""
    verdict = Verdict(words=[found.complaint] if found.complaint else [])
    firm = scene.firm
    free = np.ones(len(found.impacts), dtype=bool)
    for k, (t, _) in enumerate(firm):
        beside = [abs(t - firm[j, 0]) for j in (k - 1, k + 1) if 0 <= j < len(firm)]
        window = min([*beside, scene.end - scene.begin]) / 2
        apart = np.where(free, np.abs(found.impacts[:, 0] - t), np.inf)
        if not len(apart) or not apart.min() <= window:
            verdict.missed += 1
            continue
        free[apart.argmin()] = False
        verdict.timed += 1
        since = t - scene.begin
        verdict.late = max(verdict.late, apart.min() / (since if since > 0 else scene.end - scene.begin))
    least = FIRM * firm[:, 1].max() if len(firm) else FAINT * speed_scale(scene.case)
    verdict.invented = int(np.sum(free & (found.impacts[:, 1] >= least)))
    away = scene.case.system.gap - found.places
    reach = max(scene.size, float(away.max()))
    verdict.beyond = max(0.0, float(-away.min())) / reach
    if scene.place is not None:
        verdict.off = abs(float(found.places[-1]) - scene.place) / reach
    return verdict


def attempt(scene: Scene, peer: Callable[[Scene], Found], seconds: int, pipe: Connection) -> None:
    """In a process of its own, which the system ends after so many seconds of CPU time."""
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    np.seterr(all="ignore")
    try:
        pipe.send(judged(scene, peer(scene)))
    except TimeoutError:
        pipe.send(Verdict(words=[f"not within {seconds} s"]))
    except Exception as error:
        pipe.send(Verdict(words=[f"{type(error).__name__}: {str(error)[:60]}"]))


def ask(scene: Scene, peer: Callable[[Scene], Found], seconds: int) -> Verdict:
    """The verdict on one peer; one that says nothing within its time has not ended."""
    context = mp.get_context("fork")
    mine, its = context.Pipe(duplex=False)
    process = context.Process(target=attempt, args=(scene, peer, seconds, its))
    process.start()
    its.close()
    try:
        return mine.recv()
    except EOFError:
        return Verdict(words=[f"not within {seconds} s"])
    finally:
        process.join()


# --------------------------------------------------------------------------------------------------------------- table


def siconos_of(python: str) -> str | None:
    """The version that an interpreter has, or None."""
    script = [python, str(HERE / "siconos_peer.py"), "--version"]
    try:
        done = subprocess.run(script, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def table(only: str, seconds: int, peers: dict[str, Callable[[Scene], Found]]) -> list[list[str]]:
    lines, fine = [], dict.fromkeys(peers, 0)
    for make in MAKERS:
        scene = make()
        if only not in scene.family:
            continue
        cells = []
        for name, peer in peers.items():
            verdict = ask(scene, peer, seconds * scene.patience * (SLOW if name.startswith("Siconos") else 1))
            fine[name] += verdict.fine
            cells.append(str(verdict))
        lines.append([scene.family, scene.what, str(len(scene.firm)), *cells])
        print(" | ".join(lines[-1]), flush=True)
    return [*lines, ["**fine**", "", "", *(f"**{count} of {len(lines)}**" for count in fine.values())]]


def machine() -> str:
    """Processor and system, without the host's name."""
    names = [
        line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line
    ]
    return f"{len(names)} × {names[0] if names else platform.machine()}, {platform.system()}"


TEXT = """# The hard cases, run through peers

One scene of each family of `tests/hard`, run through vibeam's solver and through other ways to compute the same motion.
`python tests/hard/peers.py` remakes this file in about {minutes} minutes.

Each cell: what was missed or invented, and the worst error of an impact's time as a share of the time since the start.
The truth is a closed form in 30 digits or 30-digit Taylor series (`tests/hard/scenes.py`); asked for are the impacts
with at least 1/1000 of the fastest one's velocity (*n* of them). One counts as found if it lies nearer to the true one
than half the way to the next, so that a motion that has gone another way misses and invents at once. *Through the
stop*: how far the contact stands beyond it, as a share of the motion's reach, where that is more than 1 %. *Ends off*:
the contact's place at the end, the same share. *Hangs*: 100 impacts while time stands still. *Not within n s*: of CPU
time.

- **RK23, DOP853, events**: scipy's `solve_ivp` with a terminal event on the falling gap, restarted after each impact;
  rtol 1e-4 (the paper's) and 1e-12, atol a hundredth of it times the scene's size, no step over 1/50 of the drive's
  period. No model of rest: what a user writes in twenty lines, and told here of none of the scenes' rests.
- **Moreau**: Moreau–Jean time stepping (`solver = "moreau"`), so many steps a drive period. It never hangs at an
  accumulation, and its times are good to a step; impacts slower than a step's acceleration are none to it. Where the
  drive is much slower than the motion, steps counted by its period are too long: that is the user's to know. The
  402 modes are followed no further than their first strike, which a step may put just behind the end: no fault of it.
{siconos}

{rows}

Measured with {versions}; {machine}.
"""


def write(lines: list[list[str]], peers: list[str], known: str | None) -> None:
    """``PEERS.md``, from the table's lines."""
    head = ["family", "scene", "n", *peers]
    made = ["| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *lines]]
    versions = f"vibeam {vibeam.__version__}, Python {platform.python_version()}, "
    versions += ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba"))
    said = "- **Siconos** was not installed where this was made: `--siconos PYTHON` names an interpreter that has it."
    if known:
        said = (
            "- **Siconos**: its `TimeStepping` with `MoreauJeanOSI` (θ = ½), Newton's impact law, 1 000 steps a period."
        )
        versions += f", Siconos ({known})"
    text = TEXT.format(minutes=5, siconos=said, rows="\n".join(made), versions=versions, machine=machine())
    (HERE / "PEERS.md").write_text(text, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="part of a family's name: nothing is written then")
    parser.add_argument("--seconds", type=int, default=4, help="CPU time of one run")
    parser.add_argument("--siconos", default=sys.executable, metavar="PYTHON", help="an interpreter that has Siconos")
    options = parser.parse_args()
    peers, known = dict(PEERS), siconos_of(options.siconos)
    if known:
        peers["Siconos, 1 000"] = partial(siconos, python=options.siconos)
    else:
        print(f"Siconos left out: {options.siconos} does not have it", file=sys.stderr)
    flight(MAKERS[0]())  # compiles
    lines = table(options.only, options.seconds, peers)
    if not options.only:
        write(lines, list(peers), known)


if __name__ == "__main__":
    main()
