"""Recommended numbers of coordinates of random beams, flown beside all modes, for each kind of stop.

    python tests/benchmarks/recommended_beams.py [--beams 200] [--stop NAME …]   # writes results/recommended_beams.json

Length, section, material, damping, ends, mass, places of stop and sensor, gap, restitution, drive and sweep are
drawn. ``vibeam.reduce`` recommends for 5 %; each basis with its n and all modes are then swept by ``vibeam run``. A
point counts where both motions repeat with the same period, or both stay clear of the stop; a recommendation that is
off by more than 5 % at one of these is missed.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from vibeam.studies.modes_needed.reduction import ReductionStudy

import vibeam
from tests.benchmarks.recommended import alone, fidelities
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.system.response import join, periodic

TARGET = Path(__file__).with_name("results") / "recommended_beams.json"
WITHIN = 0.05
ENDS = ("clamped-free", "clamped-free", "clamped-pinned", "clamped-clamped", "pinned-pinned")
Row = dict[str, Any]


def stop_of(kind: str, rng: np.random.Generator, moving: float, omega: float) -> str:
    """Keys of a stop: R held, or elastic with a contact of a tenth to a thousandth of a drive period."""
    held = f"restitution = {rng.uniform(0.3, 0.9)}"
    if kind in ("contact", "first mode"):
        return f'{held}\nrestitution_of = "{kind}"'
    stiffness = moving * (omega * 10 ** rng.uniform(1, 2.5)) ** 2
    if kind == "linear":
        return f'law = "linear"\nstiffness = "{stiffness} N/m"\n{held}'
    hertz = f'law = "{kind}"\nhertz_stiffness = {stiffness * 10 ** rng.uniform(2, 3)}'
    return hertz if kind == "hertz" else f'{hertz}\n{held}\nvelocity = "{10 ** rng.uniform(-2, 0)} m/s"'


def drawn(kind: str, seed: int, points: int = 9) -> Case:
    """Case of one seed, swept about twice the lowest frequency of its beam."""
    rng = np.random.default_rng([seed, sum(map(ord, kind))])
    length = rng.uniform(0.1, 0.6)
    width, thickness = length * rng.uniform(0.03, 0.2), length * rng.uniform(0.004, 0.02)
    modulus, density = ((210e9, 7850.0), (70e9, 2700.0))[int(rng.integers(2))]
    mass = length * width * thickness * density * 10 ** rng.uniform(-0.5, 1)
    place = length * rng.uniform(0.3, 0.95)
    stop, sensor = (length * rng.uniform(0.3, 0.95) if rng.random() < 0.5 else place for _ in range(2))
    if kind == "first mode":  # elsewhere no contact gives mode 1 the restitution
        stop, mass = place, 4 * mass
    text = f"""title = "beam {seed}, {kind}"
[beam]
length = "{length} m"
width = "{width} m"
thickness = "{thickness} m"
youngs_modulus = "{modulus} Pa"
density = "{density} kg/m^3"
damping_ratio = {10 ** rng.uniform(-2.3, -1.3)}
damping = "{("constant", "stiffness")[int(rng.random() < 0.3)]}"
elements = {int(rng.integers(7, 9))}
ends = "{ENDS[int(rng.integers(len(ENDS)))]}"
[mass]
mass = "{mass} kg"
position = "{place} m"
[stop]
gap = "0 m"
position = "{stop} m"
STOP
[sensor]
position = "{sensor} m"
[drive]
amplitude = "{length * 10 ** rng.uniform(-4.5, -3.5)} m"
[sweep]
frequency = ["1 Hz"]
direction = "{("up", "up", "down", "both")[int(rng.integers(4))]}"
settle = 150
hold = 24
[fidelity.one]
reduction = "modal"
modes = 1
"""
    first = float(parse(text.replace("STOP", "restitution = 0.5")).system("one").omega[0])
    text = text.replace("STOP", stop_of(kind, rng, mass, first))
    low = rng.uniform(1.5, 2.1)
    ends = first / (2 * np.pi) * low, first / (2 * np.pi) * low * rng.uniform(1.1, 1.4)
    grid = f'{{ from = "{ends[0]} Hz", to = "{ends[1]} Hz", points = {points} }}'
    text = text.replace('frequency = ["1 Hz"]', f"frequency = {grid}")
    system, base = parse(text).system("one"), parse(text).base_amplitude
    omega = 2 * np.pi * ends[0]
    swing = base * abs(float(system.load[0] * system.contact[0])) * omega**2 / abs(first**2 - omega**2)
    share = float(rng.choice([0.0, rng.uniform(-0.3, 0.6)]))
    return parse(text.replace('gap = "0 m"', f'gap = "{share * swing} m"'))


def misses(study: ReductionStudy) -> list[Row]:
    """One row a recommendation: how far it is off where it repeats as all modes do."""
    found = [each for each in study.recommended if each.modes is not None]
    result = vibeam.run(alone(parse(study.case.text, set=fidelities(study))))
    whole = join([part for _, part in result["r_full"].items()])
    rows = []
    for each in found:
        response = join([part for _, part in result[f"r_{each.basis}"].items()])
        both = periodic(response) & periodic(whole)
        alike = both & (response.period == whole.period)
        off = np.abs(response.amplitude / whole.amplitude - 1)
        rows.append({
            "basis": each.basis, "modes": each.modes, "by_losses": each.by_losses, "points": len(whole),
            "alike": int(alike.sum()), "other": int((both & ~alike).sum()),
            "struck": int((alike & (whole.period > 0)).sum()), "worst": float(off[alike].max(initial=0.0)),
            "rms": float(np.sqrt(np.mean(off[alike] ** 2))) if alike.any() else 0.0,
        })  # fmt: skip
    return rows


def trial(kind: str, beams: int) -> Row:
    """So many beams with one kind of stop; a beam that cannot be built is drawn anew."""
    rows: list[Row] = []
    refused: Counter[str] = Counter()
    spent, above, done = [0.0, 0.0], 0, 0
    for seed in range(1, 20 * beams):
        if done >= beams:
            break
        begun = time.process_time()
        try:
            study = vibeam.reduce(drawn(kind, seed), accuracy=WITHIN)
        except ValueError as fault:
            refused[f"not built: {fault}"[:60]] += 1
            continue
        if study.claim.refused.startswith("restitution"):
            refused["no contact gives mode 1 this restitution: another beam"] += 1
            continue
        done += 1
        spent[0] += time.process_time() - begun
        if study.claim.refused:
            refused[study.claim.refused] += 1
            continue
        above += sum(not each.why and each.modes is None for each in study.recommended)
        begun = time.process_time()
        rows += [row | {"seed": seed} for row in misses(study)]
        spent[1] += time.process_time() - begun
    worst = sorted(rows, key=lambda row: -float(row["worst"]))
    return {
        "stop": kind, "beams": beams, "recommendations": len(rows), "above_12": above, "refused": dict(refused),
        "points": sum(row["alike"] for row in rows), "struck": sum(row["struck"] for row in rows),
        "other_period": sum(row["other"] for row in rows),
        "missed": sum(row["worst"] > WITHIN for row in rows), "missed_rms": sum(row["rms"] > WITHIN for row in rows),
        "worst": worst[:5], "seconds": {"reduce": round(spent[0], 1), "flown": round(spent[1], 1)},
    }  # fmt: skip


STOPS = ("first mode", "contact", "linear", "hertz", "hunt-crossley")


def main() -> None:
    """Try R held and the linear stop, or the kinds that are named, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beams", type=int, default=200)
    parser.add_argument("--stop", action="append", choices=STOPS)
    given = parser.parse_args()
    for kind in given.stop or STOPS[:3]:
        row = trial(kind, given.beams)
        print(json.dumps(row, indent=1), flush=True)
        found: Row = json.loads(TARGET.read_text()) if TARGET.exists() else {}
        TARGET.write_text(json.dumps(found | {kind: row}, indent=1) + "\n")


if __name__ == "__main__":
    main()
