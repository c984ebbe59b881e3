"""The check of an installation: right where it is, and each kind of fault is seen, with its cure."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from vibeam.flight import trajectory
from vibeam.flight.engine import browser
from vibeam.flight.engine.loading import KernelsUnavailable
from vibeam.studies.doctor import Finding, Severity, verdict
from vibeam.studies.doctor.packages import Requirement, package, requirements
from vibeam.studies.doctor.self_check import CHECKS, checked, pages, reason, self_check

DOCTOR = "from vibeam.cli.main import main; main()"

BLOCKED = "import sys; sys.modules.update(dict.fromkeys(sys.argv.pop().split(',')))\n" + DOCTOR


def doctor(code: str = DOCTOR, *words: str, **variables: str) -> tuple[int, dict[str, dict[str, str]], str]:
    """Exit code, findings by name, stderr."""
    asked = [sys.executable, "-c", code, "doctor", "--json", *words]
    done = subprocess.run(asked, capture_output=True, encoding="utf-8", env=os.environ | variables, check=False)
    answer = json.loads(done.stdout)
    found = {each["name"]: each for each in answer["findings"]}
    assert answer["faults"] == sum(each["state"] == "fault" for each in answer["findings"])
    return done.returncode, found, done.stderr


def test_the_first_line_is_the_verdict() -> None:
    right = [Finding("packages", name, Severity.GOOD, "3.11.7 (here)") for name in ("Python", "vibeam")]
    off = [Finding("self-check", name, Severity.FAULT, "off", "cure") for name in ("orbit", "rest")]
    assert verdict([*right, *off]) == "The installation has 2 faults: orbit, rest."
    assert verdict(right).startswith("The installation is whole: vibeam 3.11.7 on Python 3.11.7, 2 packages imported, ")


def test_a_whole_installation_has_no_fault() -> None:
    code, found, stderr = doctor()
    assert (code, [name for name, each in found.items() if each["state"] == "fault"], stderr) == (0, [], "")
    assert found["Python"]["value"].startswith(".".join(map(str, sys.version_info[:3])))
    assert {"numpy", "scipy", "numba", "kernels"} <= set(found)
    assert {found[name]["state"] for name in CHECKS} == {"ok"}
    assert found["kernels of pages"]["value"].startswith("wasm, 4 libraries, ")


def test_a_page_that_can_carry_no_engine_is_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(names: object) -> dict[str, str]:
        raise KernelsUnavailable("a page cannot carry the engine: damaged")

    monkeypatch.setattr(browser, "browser_libraries", gone)
    (found,) = pages()
    assert (found.state, found.value) == (Severity.NOTE, "a page cannot carry the engine: damaged")
    assert found.cure


def test_packages_that_cannot_be_imported_are_named_and_the_rest_is_examined() -> None:
    blocked = ("h5py", "rich", "matplotlib", "meshio", "pyuff")
    code, found, _ = doctor(BLOCKED, ",".join(blocked))
    assert code == 1
    for name in ("h5py", "rich", "matplotlib", "meshio"):
        assert found[name]["state"] == "fault"
        assert "cannot be imported" in found[name]["value"]
        assert found[name]["cure"].startswith(f"pip install --force-reinstall '{name}>=")
    assert found["impacts of an oscillator"]["state"] == "ok"
    assert found["results file"]["state"] == "fault"
    assert found["numpy"]["state"] == "ok"


def test_kernels_that_are_not_there_are_one_fault() -> None:
    code, found, _ = doctor(VIBEAM_KERNELS="none of them")
    assert code == 1
    assert found["kernels"]["state"] == "fault"
    assert "VIBEAM_KERNELS" in found["kernels"]["cure"]
    assert found["impacts of an oscillator"]["state"] == "note"
    assert found["frequency of a cantilever"]["state"] == "ok"


def test_why_numba_compiles_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VIBEAM_KERNELS", "numba")
    assert reason() == "VIBEAM_KERNELS=numba"


def test_a_motion_that_is_a_little_off_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a restitution that is wrong by 10⁻⁸."""
    from dataclasses import replace

    right = trajectory.simulate

    def wrong(system: Any, *given: Any, **further: Any) -> Any:
        return right(replace(system, restitution=system.restitution * (1 + 1e-8)), *given, **further)

    monkeypatch.setattr(trajectory, "simulate", wrong)
    found = {each.name: each for each in self_check()}
    assert found["impacts of an oscillator"].state is Severity.FAULT
    assert "is allowed" in found["impacts of an oscillator"].value
    assert found["frequency of a cantilever"].state is Severity.GOOD


@pytest.mark.parametrize("off", [float("nan"), 1e-3])
def test_a_deviation_beyond_what_is_allowed_is_a_fault(off: float) -> None:
    found = checked("it", lambda: off, 1e-6)
    assert (found.state, bool(found.cure)) == (Severity.FAULT, True)
    assert checked("it", lambda: 1e-7, 1e-6).state is Severity.GOOD
    assert checked("it", lambda: 1 / 0, 1e-6).value == "ZeroDivisionError: division by zero"


def test_requirements_are_those_of_the_project() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = requirements()
    assert {str(each) for each in found if not each.extra} == {
        each for each in project["dependencies"] if ";" not in each
    }
    extras = {each.name: each.extra for each in found if each.extra}
    assert (extras["numba"], extras["pyuff"]) == ("jit", "lab")
    assert "pytest" not in extras


@pytest.mark.parametrize(
    ("version", "met"), [("1.15", True), ("1.15.3", True), ("2.0rc1", True), ("1.9.9", False), ("1.14", False)]
)
def test_a_version_is_judged_by_its_numbers(version: str, met: bool) -> None:
    assert Requirement("scipy", "1.15").met_by(version) is met


def test_a_package_that_is_absent_or_old_has_its_cure() -> None:
    assert package(Requirement("no-such-package", "2")) == Finding(
        "packages", "no-such-package", Severity.FAULT, "not installed", "pip install 'no-such-package>=2'"
    )
    old = package(Requirement("numpy", "999"))
    assert (old.state, old.cure) == (Severity.FAULT, "pip install --upgrade 'numpy>=999'")
    extra = package(Requirement("no-such-package", "2", "lab"))
    assert (extra.state, extra.cure) == (Severity.ABSENT, "to have it: pip install 'vibeam[lab]'")
