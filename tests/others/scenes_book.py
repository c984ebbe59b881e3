"""Section of the book with our hard scenes run by other programs: verdicts, costs, and the tables of them.

    pip install -e '.[peers]'                            # and Debian's python3-siconos
    python -m tests.others.book --run scenes             # four minutes of CPU time

Every run has a process of its own, and so many seconds of CPU time once its program has compiled what it compiles.
"""

from __future__ import annotations

import importlib.util
import os
import platform
from importlib.metadata import version
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

from tests.others.scenes.attempt import Attempt, attempt
from tests.others.scenes.chosen import ASTRAY, BEYOND, CHOSEN, MADE, Found, Scene, Verdict, judged
from tests.others.scenes.flight import motion
from tests.others.scenes.told import told

RESULTS = Path(__file__).parent / "results" / "scenes.json"
PEERS = (  # file of ``scenes/`` and number in it
    ("flight", 0), ("scipy_events", 0), ("heyoka_taylor", 0), ("diffrax_events", 0), ("siconos_both", 0),
    ("siconos_both", 1), ("sundials_cvode", 0), ("mujoco_engine", 0),
)  # fmt: skip
NEEDED = ("heyoka", "diffrax", "sksundae", "mujoco")
PATIENCE = 30  # CPU seconds of a run
PROOFS = 20  # runs of which the mean is the time with the proof


def measured() -> dict[str, Any]:
    """Every peer at every scene."""
    absent = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if absent:
        raise SystemExit(f"without {', '.join(absent)}: pip install -e '.[peers]'")
    scenes, peers = [], {}
    for title, make in CHOSEN.items():
        scene = make()
        tried = [attempt(file, number, told(scene), PATIENCE) for file, number in PEERS]
        rows = {each.peer: row_of(scene, each) for each in tried}
        peers |= {each.peer: (each.package, each.setting) for each in tried}
        scenes.append(
            {"scene": make.__name__, "title": title, "impacts": len(scene.firm), "proof": proof(scene), "peers": rows}
        )
        print(title, *(f"{name}: {said(row)}" for name, row in rows.items()), sep="\n    ", flush=True)
    settings = {
        name: {
            "package": package, "version": version_of(package), "setting": setting,
            "ready": median(each["peers"][name]["ready"] for each in scenes),
        } for name, (package, setting) in peers.items()
    }  # fmt: skip
    return {"patience": PATIENCE, "machine": machine(), "settings": settings, "scenes": scenes}


def row_of(scene: Scene, tried: Attempt) -> dict[str, Any]:
    """Verdict, CPU seconds of a run and of getting ready."""
    answer = tried.answer
    if answer is None:
        verdict = Verdict(words=[tried.complaint])
    else:
        verdict = judged(scene, Found(answer.impacts, answer.places, tried.complaint, answer.state))
    times = {"seconds": tried.seconds, "ready": tried.ready}
    return {"ended": answer is not None, "fine": verdict.fine} | vars(verdict) | times


def proof(scene: Scene) -> dict[str, Any]:
    """vibeam's certificate: complete or not, and CPU seconds of the motion with it."""
    fly = motion(told(scene))
    path = fly(certify=True)
    begun = process_time()
    for _ in range(PROOFS):
        fly(certify=True)
    assert path.certificate is not None
    return {"complete": path.certificate.complete, "seconds": (process_time() - begun) / PROOFS}


def version_of(package: str) -> str:
    """Of a Python package; of Siconos as Debian's package tells."""
    if package != "siconos":
        return version(package)
    from tests.others.scenes.siconos_both import VERSION

    return str(VERSION)


def machine() -> str:
    """Processor and versions."""
    names = [line.split(":")[1] for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line]
    also = ", ".join(f"{name} {version(name)}" for name in ("numpy", "jax"))
    return f"{os.cpu_count()} × {names[0].strip()}, Python {platform.python_version()}, {also}"


def table(found: dict[str, Any]) -> str:
    """The tables: what each found and its cost; the end; settings."""
    names, scenes = list(found["settings"]), found["scenes"]
    rows = [[each["title"], significant(each["impacts"]), *(cell(each, name) for name in names)] for each in scenes]
    counts = [sum(each["peers"][name]["fine"] for each in scenes) for name in names]
    rows.append(["**fine**", "", *(f"**{count} of {len(scenes)}**" for count in counts)])
    ends = [[each["title"], *(ending(each["peers"][name]) for name in names)] for each in scenes]
    settings = [
        [name, f"{told['package']} {told['version']}", told["setting"], duration(told["ready"])]
        for name, told in found["settings"].items()
    ]
    proofs = [each["proof"]["seconds"] / each["peers"]["vibeam"]["seconds"] for each in scenes]
    return "\n\n".join([
        lines(["scene", "impacts", *names], rows),
        f"With the proof a motion of vibeam takes {significant(median(proofs))} times as long, in the median.",
        "Error of the contact's place in the end, as a share of the motion's reach; where nothing drives, energy above "
        "the true one, as a share of that at the start:",
        lines(["scene", *names], ends),
        lines(["column", "version", "setting", "imported and compiled in"], settings),
        f"Measured on {found['machine']}.",
    ])  # fmt: skip


def cell(scene: dict[str, Any], name: str) -> str:
    """What a peer found and its cost over vibeam's; bold where it is right and faster, † where its times are better."""
    row, ours = scene["peers"][name], scene["peers"]["vibeam"]
    if row is ours:
        return f"{said(row)}; {'proved' if scene['proof']['complete'] else 'not proved throughout'}"
    if not row["ended"]:
        return said(row)
    better = row["fine"] and row["timed"] and row["late"] < ours["late"] / 2
    text = f"{said(row)} ({significant(row['seconds'] / ours['seconds'])} ×){' †' if better else ''}"
    return f"**{text}**" if row["fine"] and row["seconds"] < ours["seconds"] else text


def said(row: dict[str, Any]) -> str:
    """Missed, invented, astray, worst error of a time, CPU time of a run."""
    parts = list(row["words"])
    parts += [f"{row[count]} {count}" for count in ("missed", "invented") if row[count] and row["ended"]]
    parts += [f"{percent(row['beyond'])} through the stop"] if row["beyond"] > BEYOND else []
    parts += [f"ends {percent(row['off'])} off"] if row["off"] > ASTRAY else []
    made = row["made"] or 0.0
    parts += [f"{'makes' if made > 0 else 'loses'} {percent(abs(made))} of energy"] if abs(made) > MADE else []
    parts = parts or ["ok"]
    parts += [power(row["late"])] if row["timed"] else []
    return "; ".join(parts + ([duration(row["seconds"])] if row["ended"] else []))


def ending(row: dict[str, Any]) -> str:
    """Errors of the place and the energy in the end."""
    if not row["ended"]:
        return "–"
    made = row["made"]
    sign = "" if not made else "−" if made < 0 else "+"
    return power(row["off"]) + ("" if made is None else f"; {sign}{power(abs(made))}")


def power(value: float) -> str:
    """One digit and its power of ten."""
    return f"{value:.0e}".replace("e-0", "e-").replace("e+00", "") if value else "0"


def percent(share: float) -> str:
    """A whole number of percent."""
    return f"{100 * share:.0f} %"


def lines(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    return "\n".join("| " + " | ".join(each) + " |" for each in [head, ["---"] * len(head), *rows])


def duration(seconds: float) -> str:
    """A time in its unit, two digits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= 0.995 * size:
            return f"{significant(seconds / size)} {unit}"
    return f"{significant(seconds / 1e-6)} µs"


def significant(value: float) -> str:
    """Two digits, thousands apart."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}".replace(",", " ") if rounded >= 10 else f"{rounded:.2g}"
