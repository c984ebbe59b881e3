"""Which part may import which, and what is loaded before it is needed."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OURS = {"vibeam", "vibeam_models", "vibeam_reductions"}
PACKAGES = {
    "vibeam_models": (ROOT / "models" / "vibeam_models", set()),
    "vibeam_reductions": (ROOT / "reductions" / "vibeam_reductions", {"vibeam_models"}),
    "vibeam": (ROOT / "vibeam", {"vibeam_models", "vibeam_reductions"}),
}
HEAVY = ("scipy", "matplotlib", "numba", "skfem", "h5py", "meshio")


def imported(path: Path) -> set[str]:
    """The top-level names that a file imports, anywhere in it, relative ones by their dots."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add("." * node.level + (node.module or "").split(".")[0])
        elif isinstance(node, ast.Call) and called(node) == "import_module" and node.args:
            found.add(ast.unparse(node.args[0]).strip("'\"").split(".")[0])
    return found


def called(node: ast.Call) -> str:
    """Last name of what is called."""
    return str(getattr(node.func, "attr", getattr(node.func, "id", "")))


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_lean_one_way(package: str) -> None:
    folder, allowed = PACKAGES[package]
    files = list(folder.rglob("*.py"))
    assert files
    for path in files:
        names = imported(path)
        assert not names & (OURS - allowed - {package}), path
        assert not any(name.startswith(".") for name in names), f"{path}: relative import"
        assert not names & {"tests", "models", "reductions"}, path


def test_the_check_sees_imports_of_every_kind(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text("import vibeam.runs\ndef f():\n    from vibeam_models import scene\n    from .x import y\n")
    assert imported(path) == {"vibeam", "vibeam_models", ".x"}


def loaded(code: str) -> list[str]:
    """Which heavy packages a fresh interpreter has loaded after ``code``."""
    script = f"import sys\n{code}\nprint('LOADED', *[name for name in {HEAVY!r} if name in sys.modules])"
    places = {"PYTHONPATH": os.pathsep.join(str(ROOT / part) for part in ("", "models", "reductions"))}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, env=os.environ | places, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1].split()[1:]


HELP = """
from vibeam.cli.main import main
sys.argv = ["vibeam", "{words}"]
try:
    main()
except SystemExit as end:
    assert not end.code
"""


OBSERVE = "import vibeam\nfor name in dir(vibeam.observe):\n    getattr(vibeam.observe, name)"


@pytest.mark.parametrize(
    "code", ["import vibeam", OBSERVE, HELP.format(words="--help"), HELP.format(words="--version")]
)
def test_nothing_heavy_is_loaded_before_it_is_needed(code: str) -> None:
    assert loaded(code) == []


def test_the_help_loads_no_numpy() -> None:
    assert loaded(HELP.format(words="--help") + "\nassert 'numpy' not in sys.modules") == []


def test_the_loading_check_can_fail() -> None:
    assert loaded("import h5py") == ["h5py"]


COMMANDS = {
    "help": ["--help"],
    "keys": ["keys"],
    "new": ["new", "new.toml"],
    "a wrong case": ["run", "wrong.toml"],
    "too many modes": ["run", str(ROOT / "cases" / "dtu_neutral.toml"), "--set", "fidelity.beam.modes=500"],
    "a wrong value": ["run", str(ROOT / "cases" / "dtu_neutral.toml"), "--set", "stop.gap=1 Hz"],
}


AFTER_EACH = """
import contextlib
from vibeam.cli.main import main
for name, words in {commands!r}.items():
    sys.argv = ["vibeam", *words]
    with contextlib.suppress(SystemExit):
        main()
    assert not [each for each in {heavy!r} if each in sys.modules], name
"""


def test_commands_without_a_solver_load_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wrong.toml").write_text("[beam]\nlenght = 1\n")
    assert loaded(AFTER_EACH.format(commands=COMMANDS, heavy=HEAVY)) == []
    assert (tmp_path / "new.toml").exists()


def test_a_finished_run_builds_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = ["--set", "sweep.frequency.points=2", "--set", "sweep.settle=2", "--set", "sweep.hold=2"]
    words = [str(ROOT / "cases" / "dtu_neutral.toml"), "--out", "short.h5", *short]
    run, check = (
        "import contextlib\nfrom vibeam.cli.main import main\n"
        f"sys.argv = {['vibeam', command, *words]!r}\nwith contextlib.suppress(SystemExit):\n    main()"
        for command in ("run", "check")
    )
    assert "scipy" in loaded(run)
    assert loaded(run) == ["h5py"]
    assert loaded(check) == ["h5py"]


COUNTED = """
import contextlib, gc, sys
from vibeam.__main__ import main
sys.argv = {words!r}
with contextlib.suppress(SystemExit):
    main()
frozen = gc.get_freeze_count() > 0.9 * len(gc.get_objects())
own = [name for name in sys.modules if name.partition(".")[0] in {ours!r}]
tables = sys.modules.get("vibeam.casefile.tables.table")
kinds = {{tables.Table}} if tables else set()
while more := {{each for kind in kinds for each in kind.__subclasses__()}} - kinds:
    kinds |= more
print("COUNTS", frozen, len(own), len(kinds))
"""


def counts(*words: str) -> tuple[str, int, int]:
    """Is the end of the process spared a search for garbage; modules of this project loaded; tables declared."""
    command = [sys.executable, "-c", COUNTED.format(words=["vibeam", *words], ours=OURS)]
    done = subprocess.run(command, env={"PYTHONPATH": ":".join(sys.path)}, capture_output=True, text=True, check=True)
    frozen, modules, tables = done.stdout.splitlines()[-1].split()[1:]
    return frozen, int(modules), int(tables)


def test_a_start_makes_no_more_than_it_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounds of what takes the time of a start, just above what it is: 49, 159 and 225 modules, 49 tables."""
    monkeypatch.chdir(tmp_path)
    case = str(ROOT / "cases" / "dtu_neutral.toml")
    short = ["--set", "sweep.frequency.points=2", "--set", "sweep.settle=2", "--set", "sweep.hold=2"]
    frozen, modules, tables = counts("--help")
    assert (frozen, tables) == ("True", 0)
    assert modules <= 49
    frozen, modules, tables = counts("run", case, "--set", "stop.gap=1 Hz")
    assert frozen == "True"
    assert modules <= 159
    assert tables <= 49
    counts("run", case, *short)
    frozen, modules, tables = counts("run", case, *short)
    assert frozen == "True"
    assert modules <= 225
    assert tables <= 49


SHOCK = """
beam = { length = "120 mm", width = "12 mm", thickness = "1 mm", youngs_modulus = "200 GPa", density = "7850 kg/m^3", damping_ratio = 0.01 }
stop = { position = "110 mm", gap = "0.1 mm", restitution = 0.7 }
sensor = { position = "120 mm" }
drive = { shape = "half_sine", acceleration = "30 m/s^2", duration = "11 ms" }
record = { duration = "0.1 s" }
[fidelity.few]
reduction = "modal"
modes = 2
"""  # noqa: E501


def test_a_finished_run_under_a_record_builds_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No system, no motion, no figure: of the heavy packages only the one that reads the file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "shock.toml").write_text(SHOCK)
    run = (
        "import contextlib\nfrom vibeam.cli.main import main\n"
        "sys.argv = ['vibeam', 'run', 'shock.toml']\nwith contextlib.suppress(SystemExit):\n    main()"
    )
    assert {"skfem", "matplotlib"} <= set(loaded(run))
    assert loaded(run) == ["h5py"]


def test_a_page_to_explore_draws_no_figure_and_reads_no_results(tmp_path: Path) -> None:
    words = ["vibeam", "explore", str(ROOT / "cases" / "dtu_neutral.toml"), "--out", str(tmp_path / "a.html")]
    code = f"from vibeam.cli.main import main\nsys.argv = {words!r}\ntry:\n    main()\nexcept SystemExit:\n    pass"
    assert loaded(code) == ["scipy", "skfem"]
    assert (tmp_path / "a.html").exists()


def test_the_case_of_a_beam_loads_nothing_of_given_matrices_or_modes() -> None:
    case = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"
    code = (
        f"import sys, vibeam; vibeam.load({str(case)!r});"
        "assert not [name for name in sys.modules if 'matrices' in name or 'tables.given' in name], sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": ":".join(sys.path)})


def test_a_motion_at_a_rigid_stop_with_one_coefficient_loads_no_law() -> None:
    code = """
import sys, vibeam
system = vibeam.ImpactSystem.from_modes([47.7], 0.017, [2.0], [0.5], restitution=0.7)
vibeam.simulate(system, vibeam.Drive(95.0, 1e-4), 0.5)
vibeam.sweep(system, omega=[95.0], amplitude=1e-4, settle=3, hold=2)
assert not [name for name in sys.modules if name.startswith("vibeam_models.laws")], sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": ":".join(sys.path)})
