"""Runs in environments that are not the usual one: the same data, no warning, nothing left behind."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from commands import DISTURBED, Run, difference, fault_of_message, undisturbed, usual_environment, vibeam, write_case
from scarce import may_mount
from verdict import Verdict
from workers import Stage

PROJECT = Path(__file__).parents[2]
PACKAGES = ("vibeam", "models", "reductions")
NOWHERE = "/proc/none"
HOMES = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR", "NUMBA_CACHE_DIR", "USERPROFILE")
HIDDEN = "import sys\nfor name in ('numba', 'llvmlite'):\n    sys.modules[name] = None\n"
PATH_OF_MANY = "two words, Träger 梁 'single' $HOME %s {x} #1"

Environment = Callable[[str, Path], Run]


def changed(**variables: str) -> Environment:
    """An environment with other variables."""
    return lambda name, folder: vibeam(
        ["run", f"{name}.toml"], folder, environment={**usual_environment(), **variables}
    )


def interpreted(*options: str) -> Environment:
    """The interpreter with options."""
    return lambda name, folder: vibeam(["run", f"{name}.toml"], folder, interpreter=options)


def without_home(name: str, folder: Path) -> Run:
    left = {key: value for key, value in usual_environment().items() if key not in HOMES}
    return vibeam(["run", f"{name}.toml"], folder, environment=left)


def without_numba(name: str, folder: Path) -> Run:
    with tempfile.TemporaryDirectory() as first:
        Path(first, "sitecustomize.py").write_text(HIDDEN)
        usual = usual_environment()
        return changed(PYTHONPATH=f"{first}:{usual['PYTHONPATH']}", VIBEAM_KERNELS="library")(name, folder)


def in_odd_folders(name: str, folder: Path) -> Run:
    """The case and its results in folders with spaces, quotes and letters of many alphabets in their names."""
    odd = folder / PATH_OF_MANY
    odd.mkdir()
    shutil.copy(folder / f"{name}.toml", odd)
    ran = vibeam(["run", f"{PATH_OF_MANY}/{name}.toml", "--out", f"{PATH_OF_MANY}/{PATH_OF_MANY}/"], folder)
    for path in (odd / PATH_OF_MANY).iterdir() if ran.code == 0 else ():
        path.rename(folder / path.name)
    shutil.rmtree(odd)
    return ran


def installed_read_only(name: str, folder: Path) -> Run:
    """The packages on a file system that cannot be written, without compiled bytecode."""
    with tempfile.TemporaryDirectory() as where:
        ignored = shutil.ignore_patterns("__pycache__")
        for package in PACKAGES:
            shutil.copytree(PROJECT / package, Path(where, package), ignore=ignored)
        paths = ":".join([where, *(f"{where}/{package}" for package in PACKAGES[1:])])
        script = f"mount --bind {where} {where} && mount -o remount,ro,bind {where} && ! touch {where}/x 2> /dev/null"
        script += f" && exec {sys.executable} -m vibeam run {name}.toml"
        done = subprocess.run(
            ["unshare", "-m", "sh", "-c", script], cwd=folder,
            env={**usual_environment(), "PYTHONPATH": paths}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        return Run(done.returncode, done.stdout, done.stderr, 0.0)


def of_lowest_versions(name: str, folder: Path) -> Run:
    """The oldest allowed versions: the gate's own script, in an environment that it makes."""
    done = subprocess.run([PROJECT / ".ci/lowest"], capture_output=True, text=True, check=False)
    ran = vibeam(["run", f"{name}.toml"], folder)
    return Run(done.returncode or ran.code, done.stdout, ran.err + (done.stderr if done.returncode else ""), 0.0)


ENVIRONMENTS: dict[str, Environment] = {
    "usual": changed(),
    "ASCII": changed(PYTHONIOENCODING="ascii", LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0"),
    "Latin-1": changed(PYTHONIOENCODING="latin-1"),
    "no home": without_home,
    "unwritable cache": changed(**dict.fromkeys(HOMES, NOWHERE)),
    "no folder for temporary files": changed(TMPDIR=NOWHERE, TEMP=NOWHERE, TMP=NOWHERE),
    "warnings are errors": interpreted("-W", "error"),
    "optimised twice": interpreted("-OO"),
    "development mode": interpreted("-X", "dev"),
    "other hashes": changed(PYTHONHASHSEED="7"),
    "narrow terminal": changed(COLUMNS="20", TERM="dumb", NO_COLOR="1"),
    "no numba": without_numba,
    "odd folders": in_odd_folders,
    "read-only installation": installed_read_only,
    "lowest versions": of_lowest_versions,
}
BY_ROOT = ("read-only installation",)
LONG = ("lowest versions",)  # minutes: it installs them


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """Case and environment of a number, in turn; the seed only says which case comes first."""
    environments = [each for each in ENVIRONMENTS if each not in LONG or number < len(ENVIRONMENTS)]
    where = environments[number % len(environments)]
    name = list(DISTURBED)[(seed + number // len(environments)) % len(DISTURBED)]
    verdict = Verdict()
    if where in BY_ROOT and not may_mount():
        verdict.count("no mount")
        return verdict
    stage(f"{where}, {name}")
    fault = fault_in(where, name)
    verdict.count(where)
    verdict.hold(not fault, f"{where}, {name}: {fault}")
    return verdict


def fault_in(where: str, name: str) -> str:
    """What was found in one environment; empty: nothing."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        write_case(name, folder)
        ran = ENVIRONMENTS[where](name, folder)
        if fault := fault_of_message(ran, [0]):
            return fault
        if warned := next((line for line in ran.err.splitlines() if "warning" in line.lower()), ""):
            return f"warning: {warned}"
        more = sorted({path.name for path in folder.iterdir()} ^ undisturbed(name).files)
        return difference(folder / f"{name}.h5", name) or (f"other files: {', '.join(more)}" if more else "")
