"""All tests on this machine as other machines would run them: other kernels, other processors, one core.

    python tests/environments.py                # each environment, one after the other; what fell in each
    python tests/environments.py v2 ulp         # some by name
    python tests/environments.py --tests tests/vibeam/flight v2

``kernels``: one environment for each level of compiled kernels that this processor runs, and numba in their place;
``NPY_DISABLE_CPU_FEATURES``: numpy without AVX-512, and without AVX2 and FMA too, as older processors have it;
one core; and every result of scipy's ``solve_ivp`` a unit in the last place away. A test that falls in one of them
hangs on one processor. The exit code is 1 where one falls.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
AVX512 = "X86_V4 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR"  # numpy's names, old and new
AVX2 = f"{AVX512} X86_V3 AVX2 FMA3"
LOWER = {"x86-64-v3": ("x86-64-v3", "x86-64-v2")}  # levels that a processor of the highest runs


@dataclass(frozen=True)
class Environment:
    """Tests as another machine runs them: variables, and a command that comes before the interpreter."""

    name: str
    meaning: str
    variables: dict[str, str] = field(default_factory=dict)
    before: tuple[str, ...] = ()
    processes: str = "auto"


@dataclass(frozen=True)
class Outcome:
    """What came of the tests: their number, the names of those that fell, and wall time (s)."""

    passed: int
    fallen: list[str]
    seconds: float


def environments() -> list[Environment]:
    """Those that this machine can take on."""
    from vibeam.flight.engine.loading import level_of_processor

    level = level_of_processor() or ""
    levels = LOWER.get(level, (level,) if level else ())
    kernels = [Environment(each.split("-")[-1], f"kernels: {each}", {"VIBEAM_KERNELS": each}) for each in levels]
    slow = {"VIBEAM_TEST_PATIENCE": "15"}  # kernels are compiled by the first test that calls them
    return [
        *kernels,
        Environment("numba", "kernels: compiled by numba", {"VIBEAM_KERNELS": "numba", **slow}),
        Environment("avx2", "numpy without AVX-512", {"NPY_DISABLE_CPU_FEATURES": _disabled(AVX512)}),
        Environment("sse", "numpy without AVX2 and FMA", {"NPY_DISABLE_CPU_FEATURES": _disabled(AVX2)}),
        Environment("core", "one core", {}, ("taskset", "-c", "0"), "1"),
        Environment("ulp", "solve_ivp moved by a unit in the last place", {"VIBEAM_TEST_ULP": "1"}),
    ]


def _disabled(wanted: str) -> str:
    """Of these features those that numpy chooses between here: it warns of others."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return " ".join(each for each in wanted.split() if each in __cpu_dispatch__ and __cpu_features__.get(each))


def run(here: Environment, tests: list[str]) -> Outcome:
    """The tests in one environment."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "outcome.xml"
        command = [*here.before, sys.executable, "-m", "pytest", "-n", here.processes, f"--junitxml={file}", *tests]
        subprocess.run(command, cwd=ROOT, env=os.environ | here.variables, stdout=subprocess.DEVNULL)
        cases = list(ElementTree.parse(file).iter("testcase")) if file.exists() else []
    fallen = [_name(each) for each in cases if each.find("failure") is not None or each.find("error") is not None]
    passed = sum(len(each) == 0 or each[0].tag.startswith("system") for each in cases)
    return Outcome(passed, fallen if cases else ["no test ran"], time.monotonic() - begun)


def _name(case: ElementTree.Element) -> str:
    return f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}"


def main() -> int:
    """Each environment's row, with the tests that fell below it."""
    known = {each.name: each for each in environments()}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join(known)}; all where none is given")
    parser.add_argument("--tests", action="append", default=[], help="file or folder of tests, in place of all")
    given = parser.parse_args()
    if unknown := [each for each in given.names if each not in known]:
        parser.error(f"no environment {', '.join(unknown)} here; there are {', '.join(known)}")
    fell = False
    for name in given.names or known:
        outcome = run(known[name], given.tests)
        fell = fell or bool(outcome.fallen)
        print(f"{name:6s} {known[name].meaning:45s} {outcome.passed:6d} passed  {len(outcome.fallen):4d} fell", end="")
        print(f"  {outcome.seconds:6.0f} s", *(f"\n       {each}" for each in outcome.fallen), sep="", flush=True)
    return int(fell)


if __name__ == "__main__":
    sys.exit(main())
