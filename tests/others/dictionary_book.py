"""Section of the book with the contact dictionary: every form against its program's own equation, and the programs.

R of each form of ``vibeam.contact_terms`` is that of the program's equation, typed from its source
(``program_contacts.py``) and integrated in mpmath at four speeds; programs that install run the same impact
(``dictionary_programs.py``); the threads ask for it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import vibeam
from tests.others.program_contacts import FORCES, IMPACT_MATERIAL, TSUJI_OF_2025, impact
from tests.others.threads import THREADS

RESULTS = Path(__file__).parent / "results" / "dictionary.json"
WANTED = (0.3, 0.5, 0.72, 0.9, 0.99)
SPEEDS = (0.01, 0.1, 1.0, 10.0)  # m/s
MASS, TIME, SPEED = 0.2, 1e-3, 0.1  # kg, s, m/s
STEPS = (50, 500, 5000)  # of the programs, in the contact time
SHOWN = 0.72
ITS_OWN = {  # how the program or its manual makes its parameter of a coefficient e, with where that stands
    "hertzdamp": ("xiNorm", lambda e: 8 / 5 * (1 - e) / e),  # OpenSeesDocumentation HertzDamp.rst
    "jankowski": (  # OpenSeesDocumentation JankowskiImpact.rst
        "xi", lambda e: 9 * 5**0.5 / 2 * (1 - e**2) / (e * (e * (9 * 3.141592653589793 - 16) + 16)),
    ),
    "chrono": ("restitution", float),
    "lammps hooke": ("e", float),
    "lammps hertz": ("e", float),
    "lammps tsuji": ("e", float),
}  # fmt: skip


def wiki_of_impact_material(e: float) -> dict[str, float]:
    """K1, K2 and δy by OpenSees' wiki (Impact Material), of the dictionary's Hertz stiffness, designed for SPEED."""
    stiffness = vibeam.contact_terms(e, mass=MASS, contact_time=TIME, speed=SPEED)["hertzdamp"].parameters["Kh"]
    deepest, a = (2.5 * MASS * SPEED**2 / 2 / stiffness) ** 0.4, 0.1
    lost, secant = stiffness * deepest**2.5 * (1 - e**2) / 2.5, stiffness * deepest**0.5
    return {
        "K1": secant + lost / (a * deepest**2), "K2": secant - lost / ((1 - a) * deepest**2), "Delta_y": -a * deepest,
    }  # fmt: skip


def form_rows() -> list[dict[str, Any]]:
    """Every form at every R: parameters, R by the dictionary and as integrated at four speeds, by its own formula."""
    rows = []
    for wanted in WANTED:
        for name, term in vibeam.contact_terms(wanted, mass=MASS, contact_time=TIME, speed=SPEED).items():
            row: dict[str, Any] = {"form": name, "program": term.program, "wanted": wanted, "source": term.source}
            row |= {"least": term.least, "most": term.most, "parameters": dict(term.parameters)}
            if term.parameters:
                flown = [impact(FORCES[name], term.parameters, MASS, v) for v in SPEEDS]
                said = partial(vibeam.restitution_in, name, mass=MASS, **term.parameters)
                row |= {
                    "integrated": [each.restitution for each in flown],
                    "said": [said(speed=v) for v in SPEEDS],
                    "contact_time": flown[SPEEDS.index(SPEED)].duration,
                }
            if name in ITS_OWN and term.parameters:
                key, formula = ITS_OWN[name]
                own = {**term.parameters, key: formula(wanted)}
                row["own"] = {"said": term.own, "integrated": impact(FORCES[name], own, MASS, SPEED).restitution}
            rows.append(row)
            print(wanted, name, flush=True)
    return rows


def other_rows() -> list[dict[str, Any]]:
    """Contacts that are in no dictionary: OpenSees' ImpactMaterial, and LAMMPS' tsuji without its √2."""
    rows = []
    for wanted in WANTED:
        given = wiki_of_impact_material(wanted)
        found = [impact(IMPACT_MATERIAL, given, MASS, v).restitution for v in SPEEDS]
        rows.append({"form": "impact material", "wanted": wanted, "parameters": given, "integrated": found})
        hertz = vibeam.contact_terms(wanted, mass=MASS, contact_time=TIME, speed=SPEED)["lammps hertz"].parameters
        old = impact(TSUJI_OF_2025, hertz | {"e": wanted}, MASS, SPEED).restitution
        rows.append({"form": "lammps tsuji 2025", "wanted": wanted, "parameters": hertz, "integrated": [old] * 4})
    return rows


def requests() -> list[dict[str, Any]]:
    """What the programs are asked: every form that one of them has, in three step sizes; further settings of users."""
    terms = vibeam.contact_terms(SHOWN, mass=MASS, contact_time=TIME, speed=SPEED)
    usual = {"mass": MASS, "speed": SPEED, "contact_time": TIME}
    asked = []
    for program, forms in {
        "mujoco": ("mujoco", "mujoco direct"),
        "opensees": ("hertzdamp", "jankowski", "viscoelastic gap"),
        "lammps": ("lammps hooke", "lammps hertz", "lammps tsuji"),
    }.items():
        for form in forms:
            for steps in STEPS:
                given = {"parameters": dict(terms[form].parameters), "step": TIME / steps}
                asked.append({"program": program, "form": form, "steps": steps} | usual | given)
    soft = {"parameters": dict(terms["mujoco"].parameters), "step": TIME / STEPS[-1], "solimp": "0.9 0.95 0.001"}
    for speed in SPEEDS:
        note = f"solimp as it comes, {speed:g} m/s"
        asked.append({"program": "mujoco", "form": "mujoco", "note": note} | usual | soft | {"speed": speed})
    slow = {"timeconst": 0.02, "dampratio": terms["mujoco"].parameters["dampratio"]}
    note = "timeconst 0.02 s and step 2 ms as they come"
    asked.append({"program": "mujoco", "form": "mujoco", "note": note, "parameters": slow} | usual | {"step": 2e-3})
    hertz = {"form": "lammps hertz", "step": TIME / STEPS[-1], "options": "limit_damping", "note": "limit_damping"}
    hertz |= {"parameters": dict(terms["lammps hertz"].parameters) | {"e": SHOWN}}
    asked.append({"program": "lammps"} | usual | hertz)
    ironed = {"form": "impact material", "step": TIME / STEPS[-1], "parameters": wiki_of_impact_material(SHOWN)}
    asked.append({"program": "opensees", "note": "wiki's K1, K2, δy"} | usual | ironed)
    return asked


def program_rows() -> dict[str, Any]:
    """The programs' answers; those stored before where the interpreter of VIBEAM_PROGRAMS has not the program."""
    asked = requests()
    python = os.environ.get("VIBEAM_PROGRAMS", sys.executable)
    script = str(Path(__file__).parent / "dictionary_programs.py")
    done = subprocess.run([python, script], input=json.dumps(asked), capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    rows = [each | {"restitution": r} for each, r in zip(asked, found["restitutions"], strict=True)]
    before = json.loads(RESULTS.read_text(encoding="utf-8"))["programs"] if RESULTS.exists() else {"rows": []}
    kept = [each for each in before["rows"] if not found["versions"][each["program"]]]
    names = {each["program"] for each in kept}
    versions = {name: before["versions"][name] if name in names else said for name, said in found["versions"].items()}
    return {"rows": [each for each in rows if each["program"] not in names] + kept, "versions": versions}


def measured() -> dict[str, Any]:
    """The section's results."""
    return {"forms": form_rows(), "others": other_rows(), "programs": program_rows(), "threads": list(THREADS)}


def worst(row: dict[str, Any]) -> float:
    """Largest difference of the dictionary's R from the integrated one, over the speeds."""
    return max(abs(a - b) for a, b in zip(row["said"], row["integrated"], strict=True))


def table(found: dict[str, Any]) -> str:
    """Tables: the forms at 0.72, what they reach and how right they are; programs' own runs; threads."""
    return "\n\n".join([_forms(found), _reached(found), _programs(found["programs"]), _threads(found["threads"])])


def _forms(found: dict[str, Any]) -> str:
    lines = [
        f"R = {SHOWN} for {MASS} kg at {SPEED} m/s, all contacts {1e3 * TIME:g} ms long. Own: R where that is put into "
        "the program's own formula. Error: largest difference of the dictionary's R from the program's equation, "
        "integrated in mpmath, over all R of the next table and 0.01 to 10 m/s. Pulls: before the depth is gone.",
        "",
        "| program | parameters | own | 0.01 m/s | 10 m/s | error | pulls | force from |",
        "|---|---|---:|---:|---:|---:|---|---|",
    ]
    for row in (each for each in found["forms"] if each["wanted"] == SHOWN):
        same = [each for each in found["forms"] if each["form"] == row["form"] and "said" in each]
        said = ", ".join(f"{name} {value:.4g}" for name, value in row["parameters"].items())
        own = f"{row['own']['integrated']:.4f}" if "own" in row else ""
        slow, fast = (f"{row['integrated'][at]:.4f}" for at in (0, -1))
        cells = (row["program"], said, own, slow, fast, f"{max(map(worst, same)):.0e}")
        cells += ("yes" if FORCES[row["form"]].pulls else "", f"`{row['source']}`")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _reached(found: dict[str, Any]) -> str:
    heads = [f"R = {wanted}" for wanted in WANTED]
    lines = [
        "R at 0.1 m/s by each program's own formula; – where the form does not reach it, empty without a formula.",
        "",
        f"| program | {' | '.join(heads)} | least R | largest |",
        f"|---|{'---:|' * (len(heads) + 2)}",
    ]
    rows = {(each["form"], each["wanted"]): each for each in found["forms"]}
    for form in dict.fromkeys(each["form"] for each in found["forms"]):
        own = [rows[form, wanted] for wanted in WANTED]
        cells = [
            f"{each['own']['integrated']:.4f}" if "own" in each else "" if each["parameters"] else "–" for each in own
        ]
        if any(cells):
            ends = f"{own[0]['least']:.3g}", f"{own[0]['most']:.4g}"
            lines.append(f"| {' | '.join([own[0]['program'], *cells, *ends])} |")
    for form, name in (
        ("lammps tsuji 2025", "LAMMPS of 22 July 2025, tsuji"),
        ("impact material", "OpenSees ImpactMaterial"),
    ):
        own = [each for each in found["others"] if each["form"] == form]
        cells = [f"{each['integrated'][SPEEDS.index(SPEED)]:.4f}" for each in own]
        lines.append(f"| {' | '.join([name, *cells, '', ''])} |")
    ironed = next(e for e in found["others"] if e["form"] == "impact material" and e["wanted"] == SHOWN)["integrated"]
    spread = ", ".join(f"{r:.3f} at {v:g} m/s" for r, v in zip(ironed, SPEEDS, strict=True))
    lines += ["", f"ImpactMaterial has an R at one speed only; by its wiki for {SHOWN}: {spread}."]
    return "\n".join(lines)


def _programs(found: dict[str, Any]) -> str:
    versions = ", ".join(f"{name} {said}" for name, said in found["versions"].items())
    lines = [
        f"The programs' own runs for R = {SHOWN} ({versions}), by steps in the contact time.",
        "",
        f"| program, form | {' | '.join(map(str, STEPS))} | |",
        "|---|---:|---:|---:|---|",
    ]
    plain = [each for each in found["rows"] if "steps" in each]
    for form in dict.fromkeys(each["form"] for each in plain):
        own = [each for each in plain if each["form"] == form]
        cells = [f"{each['restitution']:.4f}" for each in own]
        why = "this release has no √2 (above)" if form == "lammps tsuji" else ""
        lines.append(f"| {own[0]['program']}, {form} | {' | '.join(cells)} | {why} |")
    for each in (row for row in found["rows"] if "note" in row):
        lines.append(f"| {each['program']}, {each['form']} | | | {each['restitution']:.4f} | {each['note']} |")
    return "\n".join(lines)


def _threads(found: list[dict[str, str]]) -> str:
    lines = ["Who asks for it:", "", "| thread | program | state | asks |", "|---|---|---|---|"]
    for each in found:
        name, _, number = each["thread"].partition("#")
        link = f"[{each['thread']}](https://github.com/{name}/issues/{number})"
        lines.append(f"| {link} | {each['program']} | {each['state']} | {each['asks']} |")
    return "\n".join(lines)
