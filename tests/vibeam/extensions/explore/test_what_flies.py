"""Table of the room's page: which fidelities of the repository's cases fly in a page, by which engine, and why not."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest
from case_files import COARSE, SWEPT

import vibeam
from vibeam.case.case import Case
from vibeam.extensions.explore import regime_models
from vibeam.extensions.explore.models import model_of, page_refusal
from vibeam.system.impact_system import ImpactSystem

ROOT = Path(__file__).parents[4]
CASES = ROOT / "cases"
FILES = SWEPT
PAGE = ROOT / "vibeam/extensions/explore/README.md"
ROW = re.compile(r"^\| `([\w/]+)` \| (\d+) \| (\d+) \| (\d+) \| (.*) \|$", re.MULTILINE)
REASONS = {  # in a row, by the beginning of the sentence
    "another solver": "Found by the solver",
    "several contacts": "It has contacts in several places",
    "too many modes": "It has the contact law",
}


def listed() -> dict[str, tuple[int, int, int, str]]:
    """The page's rows: fidelities that fly plain, by regimes, not at all, and why."""
    rows = ROW.findall(PAGE.read_text("utf-8"))
    return {name: (int(plain), int(regimes), int(none), why) for name, plain, regimes, none, why in rows}


def counted(case: Case) -> tuple[int, int, int, str]:
    """The row of a case."""
    engines, reasons = Counter[str](), list[str]()
    for name in case.fidelities:
        system = case.system(name)
        refusal = page_refusal(case, name, system)
        engines["none" if refusal else "regimes" if system.beyond_plain else "plain"] += 1
        reasons += [next(word for word, said in REASONS.items() if refusal.startswith(said))] if refusal else []
    return engines["plain"], engines["regimes"], engines["none"], ", ".join(dict.fromkeys(reasons))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_the_page_lists_what_flies(file: Path) -> None:
    """A case that is not in the table flies plain with all of its fidelities."""
    case = vibeam.load(file, set=COARSE.get(file.stem))
    assert listed().get(str(file.relative_to(CASES).with_suffix("")), (len(case.fidelities), 0, 0, "")) == counted(case)


def test_every_row_is_a_case() -> None:
    assert len(listed()) > 20
    assert all((CASES / f"{name}.toml").exists() for name in listed())


def test_a_model_by_regimes_has_what_its_engine_needs() -> None:
    case = vibeam.load(CASES / "rigs/tube.toml")
    model = model_of(case, "tube")
    assert (model["engine"], model["refusal"], model["damped"]) == ("regimes", "", False)
    assert model["regimes"]["lower"]["into"]["shape"] == [24, 24]
    assert "nodes" not in model["regimes"]


def test_reasons_are_sentences() -> None:
    system = vibeam.load(CASES / "rigs/tube.toml").system("tube")
    many = ImpactSystem.from_modes(range(1, 30), 0.1, 1.0, 1.0, law=system.law)
    several = vibeam.load(CASES / "rigs/two_stops.toml").system("sdof")
    integrated = vibeam.load(CASES / "rigs/afm_tip.toml").system("sdof")
    for refused, said in ((many, "24 modes at most"), (several, "contacts in several places")):
        sentence = regime_models.regimes_refusal(refused, "contact")
        assert said in sentence
        assert sentence.endswith(".")
    assert regime_models.regimes_refusal(integrated, "contact") == ""


def test_a_gap_that_drifts_comes_along() -> None:
    case = vibeam.load(CASES / "experiment/fig21.toml")
    assert [("drift" in model_of(case, name)) for name in case.fidelities] == [
        case.scene_of(name).stop.drift is not None for name in case.fidelities
    ]
