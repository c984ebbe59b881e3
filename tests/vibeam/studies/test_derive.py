import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.models.bench import POINT_MASS, RIG, STEEL
from vibeam import load
from vibeam.studies.derive import derive
from vibeam_models.base import Base
from vibeam_models.beams.beam import Damping
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop

CASES = Path(__file__).parents[3] / "cases"
MASSLESS, WITH_BEAM, WITH_BOTH = "massless beam", "with the beam's mass", "with beam mass and rotary inertia"


@pytest.fixture(scope="module")
def table():
    return derive(RIG)


@pytest.mark.parametrize(("kept", "percent"), [(MASSLESS, 5.2), (WITH_BEAM, 0.8)])
def test_the_ladder_of_frequencies(table, kept, percent):
    assert round(100 * table[f"frequency, {kept}"].error, 1) == percent


def test_with_both_inertias_five_hundredths_of_a_percent_remain(table):
    """Low, for the strip of eq. 45 bends freely under the discs; without that zone the rest is Rayleigh's, above."""
    assert round(100 * table[f"frequency, {WITH_BOTH}"].error, 2) == -0.05
    uniform = derive(RIG.without("mass.rigid_half_width"))
    assert 0 < uniform[f"frequency, {WITH_BOTH}"].error < 2e-4


def test_paper_values_of_the_rig(table):
    assert table["shape at the mass"].value == pytest.approx(1.5540324324324324)
    assert table["stiffness"].value == pytest.approx(1218.85, rel=1e-5)
    assert table[f"mass, {MASSLESS}"].value == pytest.approx(0.2 * 1.5540324324324324**2)
    assert table["base factor"].value == pytest.approx(1 / 1.5540324324324324)
    assert table["gain"].value == 5.16e-4
    assert table["drive"].value == pytest.approx(0.6 * 5.16e-4)


def test_frequencies_are_those_of_stiffness_and_mass(table):
    for kept in (MASSLESS, WITH_BEAM, WITH_BOTH):
        omega = table[f"circular frequency, {kept}"]
        assert omega.value**2 == pytest.approx(table["stiffness"].value / table[f"mass, {kept}"].value)
        assert omega.reference**2 == pytest.approx(table["stiffness"].reference / table[f"mass, {kept}"].reference)


def test_one_assumption_at_a_time(table):
    beam, point = table["error of the massless beam"].error, table["error of the point mass"].error
    rest = table[f"frequency, {WITH_BOTH}"].error
    assert (1 + beam) * (1 + point) * (1 + rest) == pytest.approx(1 + table[f"frequency, {MASSLESS}"].error)
    assert beam > point > 0


def test_where_every_assumption_holds_the_errors_vanish():
    ideal = replace(POINT_MASS, beam=replace(STEEL, density=7850e-9), stop=Stop(0.132, 1e-4, 0.72))
    table = derive(ideal)
    assert max(abs(row.error) for row in table) < 1e-6
    assert table["gap"].reference > 0


def test_the_gap_at_the_sensor():
    table = derive(replace(RIG, stop=Stop(0.132, 1e-4, 0.72, gap_at="sensor")))
    assert table["gap"].value == pytest.approx(1e-4 / 0.18)
    assert abs(table["gap"].error) < 0.01


@pytest.mark.parametrize("kind", ["constant", "stiffness"])
def test_the_damping_ratio_rises_with_the_frequency(kind):
    table = derive(replace(RIG, beam=replace(STEEL, damping=Damping(kind, (0.017,)))))
    assert table["damping ratio"].reference == pytest.approx(0.017, rel=1e-6)
    assert table["damping ratio"].error == pytest.approx(table[f"frequency, {MASSLESS}"].error, rel=1e-5)


def test_without_rotary_inertia_the_ladder_is_shorter():
    table = derive(replace(POINT_MASS, base=Base(amplitude=1e-4)))
    names = {row.name for row in table}
    assert f"mass, {WITH_BOTH}" not in names
    assert "gain" not in names
    with pytest.raises(KeyError, match="no row 'gain'"):
        table["gain"]


def test_a_case_stands_for_its_scene(table):
    assert derive(SimpleNamespace(scene=RIG)) == table


def test_the_table_is_one_of_pandas(table):
    rows = table.to_dataframe()
    assert len(rows) == len(table)
    assert set(rows.columns) == {"name", "symbol", "unit", "value", "reference", "assumption", "error"}


def test_the_sdof_itself_has_nothing_to_derive():
    with pytest.raises(ValueError, match="gives the SDOF model directly"):
        derive(SdofScene(1.0, 0.015, 0.0, 0.9, 5e-4))


def test_what_is_no_scene():
    with pytest.raises(TypeError, match="not int"):
        derive(3)


BY_HAND = json.loads((CASES.parent / "tests" / "independent" / "eq38.json").read_text(encoding="utf-8"))


def test_eq_44_to_46_by_hand() -> None:
    """The case of eq. 38–47 against its formulas in 30 digits (``make_eq38.py``, which imports nothing of this)."""
    rows = [row for row in derive(load(CASES / "paper" / "eq38.toml")) if row.name in BY_HAND]
    assert len(rows) == 9
    for row in rows:
        assert row.value == pytest.approx(BY_HAND[row.name], rel=1e-9)
        assert row.reference == pytest.approx(BY_HAND[row.name], rel=1e-9)  # its finite elements assume the same


def test_the_committed_table_is_that_of_the_main_case():
    """Pages take their numbers from it: ``vibeam derive cases/dtu_neutral.toml --json`` makes it."""
    kept = json.loads((CASES.parent / "tests" / "benchmarks" / "results" / "derive.json").read_text(encoding="utf-8"))
    made = {row.name: row for row in derive(load(CASES / "dtu_neutral.toml").scene)}
    assert [row["name"] for row in kept] == list(made)
    for row in kept:
        assert row["value"] == pytest.approx(made[row["name"]].value, rel=1e-9), row["name"]
