"""Write truth.json, true motions to many digits for the tests of the flight solver.

    python tests/independent/make_truth.py [--out FILE]

Three lists. ``systems``: 50 impacts each of random systems in motions that are not chaotic. ``grazing``: first
approaches to the stop that just touch and just miss. ``chatter``: impacts that accumulate, rest, release. Inputs are
doubles and exact as printed; times and velocities are decimal strings of 30 digits that belong to just those doubles.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import mpmath
import numpy as np
from events import Drive, Event, Modes, Motion, State
from mpmath import mpf

SEED = 20180105
DIGITS = 50
DIGITS_SYSTEMS = 42  # of the random systems: their motions forget
IMPACTS = 50
NUDGE = 1e-20  # of the state: how far the start of the second run is moved
AGREE = 1e-15  # how near the two runs must stay
SIZES = (1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 5, 5, 5, 5, 8, 8, 8, 8, 12, 12, 12)
RESTITUTIONS = (0.2, 0.5, 0.72, 0.9, 1.0)
GAPS = (-1, 0, 1)  # signs
SPECIAL_RATIOS = (1.0, 1.0 - 1e-9, 1.0 + 1e-9, 0.0, 5.0)
WEAK = 1e-4  # of the fastest impact: slower ones are left to the grazing list
FASTEST = 60.0  # limit of frequency ratio times damping ratio
ABOUT = (
    "True motions by Taylor series in 42 to 50 digits, remade by: python tests/independent/make_truth.py.",
    "System: eta_i'' + 2 zeta_i omega_i eta_i' + omega_i^2 eta_i = load_i Omega^2 B sin(Omega t) + static_i, "
    "stop at sum contact_i eta_i = gap, restitution R; drive {omega: Omega, amplitude: B}; the start is at time 0.",
    "Inputs are doubles, exact as printed. times and velocities (contact velocity just before impact, positive toward "
    "the stop) are strings of 30 digits.",
    "systems: 50 impacts. amplification: how much a relative change of the start grows in times (of a drive period) "
    "and velocities (of the largest) within them; no motion here exceeds 1e5.",
    "grazing: the first approach has its crest at crest_time; depth is crest minus gap in displacement, exactly for "
    "the doubles given (> 0 touches, < 0 misses); depth_over_size is depth over the largest |contact_i eta_i| or "
    "|gap| there, to be set against 1.1e-16; speed_over_scale is the aimed-at impact velocity over velocity_scale. "
    "times and velocities are the first impacts at all: of a miss, those after it (they may be none within t_end).",
    "chatter: times and velocities down to 1e-12 of the largest; then infinitely many impacts up to rest_time, rest "
    "until release_time, and the next impact after it.",
)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description="Write the true motions that the flight solver is tested with.")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("truth.json"))
    out = parser.parse_args().out
    mpmath.mp.dps = DIGITS
    truth = {
        "about": ABOUT,
        "systems": list(random_systems()),
        "grazing": list(grazing_cases()),
        "chatter": list(chatter_cases()),
    }
    out.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


# ------------------------------------------------------------------------------------------------ random systems


def random_systems() -> Iterator[dict[str, Any]]:
    """One entry for each of SIZES: draws are thrown away until one moves regularly."""
    rng = np.random.default_rng(SEED)
    for k, n in enumerate(SIZES):
        entry, draws = None, 0
        while entry is None:
            entry, draws = _regular(*_draw(rng, n, k)), draws + 1
        name = f"{n} mode{'s' if n > 1 else ''} #{k}"
        print(f"{name}: draw {draws}, amplification {entry['amplification']:.2g}", flush=True)
        yield {"name": name, **entry}


def _draw(rng: np.random.Generator, n: int, k: int) -> tuple[Modes, Drive, State]:
    """A random system, number k of the list: its gap's sign, R and one special damping ratio follow from k."""
    base = 10 ** rng.uniform(-1, 2)
    ratios = np.sort(np.r_[1.0, np.exp(rng.uniform(0.2, np.log(15 if n == 12 else 40), n - 1))])
    omega = base * ratios
    zeta = np.where(rng.random(n) < 0.7, 10 ** rng.uniform(-2, -0.5, n), 10 ** rng.uniform(-0.3, 0.6, n))
    zeta[rng.integers(n)] = SPECIAL_RATIOS[k % len(SPECIAL_RATIOS)]
    zeta = np.where(ratios * zeta > FASTEST, 1.0, zeta)
    contact = rng.normal(size=n) / ratios**0.3
    drive = base * rng.uniform(0.6, 2.6)
    load, static = rng.normal(size=n), np.where(rng.random(n) < 0.3, rng.normal(size=n), 0.0)
    swing = np.abs(contact * load) @ (1 / ratios**2) * 10 ** rng.uniform(-4, 1)
    amplitude = swing * (base / drive) ** 2
    static *= 0.2 * amplitude * drive**2
    gap = GAPS[k % 3] * swing * rng.uniform(0.05, 0.6)
    start, velocity = rng.normal(size=n) * swing / ratios**2, rng.normal(size=n) * swing * base / ratios
    start -= contact * max(0.0, contact @ start - gap + 0.1 * swing) / (contact @ contact)
    restitution = RESTITUTIONS[k % len(RESTITUTIONS)] if k % 2 else float(rng.uniform(0.2, 1))
    rows = [row.tolist() for row in (omega, zeta, contact, load)]
    system = Modes(*rows, gap=float(gap), restitution=restitution, static=static.tolist())
    return system, Drive(float(drive), float(amplitude)), State(start.tolist(), velocity.tolist())


def _regular(system: Modes, drive: Drive, start: State) -> dict[str, Any] | None:
    """The entry of a system, None where it rests, grazes, hits too seldom or is too sensitive."""
    period = 2 * math.pi / drive.omega
    rough = Motion(system, drive, start, digits=20, tiny=1e-6)
    rough.run(count=IMPACTS, t_end=120 * period)
    if not _is_plain(rough.events) or _growth(system, drive, start, 1e-12, 20)[0] > AGREE / NUDGE:
        return None
    growth, events = _growth(system, drive, start, NUDGE, DIGITS_SYSTEMS)
    if growth > AGREE / NUDGE:
        return None
    return {**_inputs(system, drive, start), **_hits(events), "amplification": growth}


def _is_plain(events: list[Event]) -> bool:
    """All impacts there, none of them the begin of a rest, none much weaker than the strongest."""
    if len(events) < IMPACTS or any(event.kind != "impact" for event in events):
        return False
    speeds = [event.speed for event in events]
    return min(speeds) > WEAK * max(speeds)


def _growth(system: Modes, drive: Drive, start: State, nudge: float, digits: int) -> tuple[float, list[Event]]:
    """The impacts, and their largest change, in periods and of the largest velocity, over that of the start."""
    with mpmath.workdps(digits + 5):
        size = max(abs(x) for x in start.displacement)
        moved = replace(start, displacement=[mpf(x) + mpf(nudge) * size for x in start.displacement])
        runs = [Motion(system, drive, state, digits=digits, tiny=1e-6) for state in (start, moved)]
        for run in runs:
            run.run(count=IMPACTS, t_end=120 * 2 * mpmath.pi / drive.omega)
        a, b = (run.events for run in runs)
        if not (_is_plain(a) and _is_plain(b)):
            return math.inf, a
        period, fastest = 2 * mpmath.pi / drive.omega, max(event.speed for event in a)
        apart = [abs(e.time - f.time) / period for e, f in zip(a, b, strict=True)]
        apart += [abs(e.speed - f.speed) / fastest for e, f in zip(a, b, strict=True)]
        return float(max(apart) / nudge), a


# ------------------------------------------------------------------------------------------------ grazing


def grazing_cases() -> Iterator[dict[str, Any]]:
    """Touch and miss at seven depths for systems of 1, 2 and 3 modes."""
    rng = np.random.default_rng(SEED + 1)
    for n in (1, 2, 3):
        system, drive, start, crest = _with_crest(rng, n)
        for share in (1e-2, 1e-4, 1e-6, 1e-7):
            for kind in ("touch", "miss"):
                yield _graze(system, drive, start, crest, share, kind)
        for share in (1e-8, 1e-9, 1e-10):
            for kind in ("touch", "miss"):
                near = _aim(system, drive, start, crest, share if kind == "touch" else -share)
                yield _graze(system, drive, near, _crest(system, drive, near), share, kind)


def _aim(system: Modes, drive: Drive, start: State, crest: dict[str, mpf], share: float) -> State:
    """A start a few thousand ulps away whose crest lies so deep (below for share < 0) beyond a double.

    Depths below an ulp of the gap cannot be had by choosing the gap. The height changes by A with an ulp of the first
    displacement and by B with one of the first velocity: of all j, l the height + jA + lB − depth nearest a double.
    """
    x, v = start.displacement[0], start.velocity[0]
    moved = [replace(start, displacement=[math.nextafter(x, math.inf), *start.displacement[1:]])]
    moved += [replace(start, velocity=[math.nextafter(v, math.inf), *start.velocity[1:]])]
    a, b = (float(_crest(system, drive, near)["height"] - crest["height"]) for near in moved)
    base = float(crest["height"])
    depth = mpf(share) * abs(mpf(share)) * crest["speed_scale"] ** 2 / (2 * crest["deceleration"])
    rest = float(crest["height"] - base - depth)
    j, k = np.meshgrid(np.arange(3000), np.arange(400), indexing="ij")
    ulps = (rest + j * a + k * b) / math.ulp(base)
    at = int(np.argmin(np.abs(ulps - np.round(ulps))))
    x += int(j.flat[at]) * math.ulp(x)
    v += int(k.flat[at]) * math.ulp(v)
    return replace(start, displacement=[x, *start.displacement[1:]], velocity=[v, *start.velocity[1:]])


def _graze(
    system: Modes, drive: Drive, start: State, crest: dict[str, mpf], share: float, kind: Literal["touch", "miss"]
) -> dict[str, Any]:
    """One case: the gap is tuned to the crest, rounded to a double, and the truth taken with that double."""
    aimed = (share * crest["speed_scale"]) ** 2 / (2 * crest["deceleration"])
    gap = float(crest["height"] - aimed if kind == "touch" else crest["height"] + aimed)
    depth = crest["height"] - mpf(gap)
    placed = replace(system, gap=gap)
    t_end = float(crest["time"]) + 20 * 2 * math.pi / float(drive.omega)
    motion = Motion(placed, drive, start, digits=DIGITS)
    motion.run(count=3, t_end=t_end)
    near = bool(motion.events) and abs(motion.events[0].time - crest["time"]) < 0.1 / mpf(drive.omega)
    if (depth > 0) != (kind == "touch") or near != (kind == "touch"):
        raise ArithmeticError(f"the crest is not what it was taken for: {kind}, {share}")
    name = f"{kind}, {len(system.omega)} modes, {share:g}"
    print(name, mpmath.nstr(depth, 5), flush=True)
    return {
        "name": name,
        "kind": kind,
        **_inputs(placed, drive, start),
        "speed_over_scale": share,
        "velocity_scale": float(crest["speed_scale"]),
        "crest_time": _digits(crest["time"]),
        "depth": _digits(depth),
        "depth_over_size": float(depth / max(crest["size"], abs(gap))),
        "t_end": t_end,
        **_hits(motion.events),
    }


def _with_crest(rng: np.random.Generator, n: int) -> tuple[Modes, Drive, State, dict[str, mpf]]:
    """A random system and start whose contact displacement first rises to a crest above its start."""
    while True:
        ratios = np.r_[1.0, rng.uniform(2, 12, n - 1)]
        rows = [row.tolist() for row in (ratios * rng.uniform(0.5, 20), rng.uniform(0.005, 0.3, n))]
        rows += [(rng.normal(size=n) / ratios**0.5).tolist(), rng.normal(size=n).tolist()]
        drive = Drive(float(rows[0][0] * rng.uniform(0.6, 2.6)), float(rng.uniform(0.2, 1)))
        start = State((rng.normal(size=n) / ratios).tolist(), (rows[0][0] * rng.normal(size=n)).tolist())
        system = Modes(*rows, gap=1e6, restitution=float(rng.uniform(0.4, 0.9)))
        crest = _crest(system, drive, start)
        if crest["height"] > max(0.3, crest["start"] + 0.3):
            return system, drive, start, crest


def _crest(system: Modes, drive: Drive, start: State) -> dict[str, mpf]:
    """The first crest of the free contact displacement: short steps to where it turns, then Newton's method."""
    step = mpf(1) / 50 / max(*map(mpf, system.omega), drive.omega)
    motion = Motion(system, drive, start, digits=DIGITS)
    row = [mpf(c) for c in system.contact]
    speeds = [_speed(row, motion)]
    while not speeds[-1] <= 0 < max(speeds[-2:]):
        motion.run(t_end=motion.state().time + step)
        speeds.append(_speed(row, motion))
    for _ in range(8):
        motion.shift(-_speed(row, motion) / motion.contact_acceleration())
    parts = [c * x for c, x in zip(row, motion.state().displacement, strict=True)]
    return {
        "time": motion.state().time,
        "height": sum(parts),
        "size": max(abs(part) for part in parts),
        "start": sum(c * mpf(x) for c, x in zip(row, start.displacement, strict=True)),
        "speed_scale": max(abs(speed) for speed in speeds),
        "deceleration": -motion.contact_acceleration(),
    }


def _speed(row: list[mpf], motion: Motion) -> mpf:
    return sum(c * v for c, v in zip(row, motion.state().velocity, strict=True))


# ------------------------------------------------------------------------------------------------ chatter


def chatter_cases() -> Iterator[dict[str, Any]]:
    """Pressed systems of 1 and 3 modes: impacts accumulate, the stop holds, the drive pulls off again."""
    one = Modes([1.0], [0.05], [1.0], [1.0], gap=-0.5, restitution=0.6)
    three = Modes(
        [1.0, 3.1, 7.3], [0.05, 0.02, 0.1], [1.0, 0.5, -0.3], [1.0, 0.2, 0.1], -0.5, 0.6, static=[0.3, 0.0, 0.0]
    )
    pull, start = Drive(0.75, 1.8), State([-0.55], [0.0])
    yield _chatter("1 mode, R 0.6", one, pull, start)
    yield _chatter("1 mode, R 0.8", replace(one, restitution=0.8), pull, start)
    yield _chatter("1 mode overdamped, R 0.72", replace(one, zeta=[1.5], restitution=0.72), pull, start)
    begin = State([-0.6, 0.02, 0.0], [0.0, 0.0, 0.1])
    yield _chatter("3 modes, R 0.6", three, pull, begin)
    yield _chatter("3 modes, R 0.3", replace(three, restitution=0.3), pull, begin)


def _chatter(name: str, system: Modes, drive: Drive, start: State) -> dict[str, Any]:
    motion = Motion(system, drive, start, digits=DIGITS)
    motion.run(count=1, until="rest", t_end=4 * math.pi / drive.omega)
    if motion.events[-1].kind != "rest":
        raise ArithmeticError(f"{name}: no rest within two periods")
    impacts, rest = motion.events[:-1], motion.events[-1]
    motion.run(count=1, until="release")
    release = motion.events[-1]
    motion.run(count=1)
    fastest = max(event.speed for event in impacts)
    print(name, len(impacts), *(mpmath.nstr(e.time, 8) for e in (rest, release, motion.events[-1])), flush=True)
    return {
        "name": name,
        **_inputs(system, drive, start),
        **_hits([event for event in impacts if event.speed > 1e-12 * fastest]),
        "rest_time": _digits(rest.time),
        "rest_displacement": [_digits(x) for x in rest.displacement],
        "rest_velocity": [_digits(v) for v in rest.velocity],
        "release_time": _digits(release.time),
        "next_time": _digits(motion.events[-1].time),
        "next_velocity": _digits(motion.events[-1].speed),
    }


# ------------------------------------------------------------------------------------------------ output


def _inputs(system: Modes, drive: Drive, start: State) -> dict[str, Any]:
    rows = {name: list(getattr(system, name)) for name in ("omega", "zeta", "contact", "load")}
    return {
        **rows,
        "static": list(system.static or [0.0] * len(system.omega)),
        "gap": system.gap,
        "restitution": system.restitution,
        "drive": {"omega": drive.omega, "amplitude": drive.amplitude},
        "start": {"displacement": list(start.displacement), "velocity": list(start.velocity)},
    }


def _hits(events: list[Event]) -> dict[str, list[str]]:
    hits = [event for event in events if event.kind == "impact"]
    return {"times": [_digits(hit.time) for hit in hits], "velocities": [_digits(hit.speed) for hit in hits]}


def _digits(value: mpf) -> str:
    return mpmath.nstr(value, 30, min_fixed=0, max_fixed=0)


if __name__ == "__main__":
    main()
