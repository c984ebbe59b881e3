"""A user's own effect: declared in a few lines, registered, run from a case file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from test_stop_keys import RIG
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.studies.effects import influence
from vibeam_models.beam import assemble_with_space
from vibeam_models.effects import EFFECTS
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect

pytestmark = pytest.mark.usefixtures("undrawn")


@dataclass(frozen=True)
class Spring(Effect):
    """A spring to the base holds the beam; absent = nothing does."""

    stiffness: float = quantity("N/m", "of the spring", "50 N/m", above=0)
    position: float = quantity("m", "distance from the clamp", "60 mm", above=0)
    name: ClassVar[str] = "spring"

    @classmethod
    def faults(cls, table, case):
        if table.position is not None and case.beam.length is not None and table.position > case.beam.length:
            yield "position", "is beyond the tip"

    def apply(self, structure, space, scene):
        row = space.row(self.position)
        return structure.with_(K=structure.K + self.stiffness * np.outer(row, row)), space


CASE = RIG.replace("STOP", "restitution = 0.72") + '[spring]\nstiffness = "80 N/m"\nposition = "60 mm"\n'
QUICK = {"beam.elements": 6, "influence.points": 3}


def test_an_effect_of_ones_own_runs_from_a_case_file(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(CASE)
    with vibeam.register_effect(Spring):
        case = vibeam.load(tmp_path / "own.toml")
        assert case.scene.effects[-1] == Spring(80.0, 0.06)
        plain, space = assemble_with_space(replace(case.scene, effects=case.scene.effects[:-1]))
        stiff = plain.K + 80.0 * np.outer(space.row(0.06), space.row(0.06))
        expected = plain.with_(K=stiff).modes(2).omega
        np.testing.assert_allclose(case.system("two").omega, expected, rtol=1e-12)
        assert np.all(np.isfinite(vibeam.run(case)["two"].up.amplitude))
        assert parse(case.text).key == case.key
        assert "[spring]" in CliRunner().invoke(app, ["keys"], env={"COLUMNS": "200"}).output
        assert [row.effect for row in influence(parse(CASE, set=QUICK)).rows] == ["spring"]
    with pytest.raises(CaseError, match="spring: unknown key"):
        vibeam.load(tmp_path / "own.toml")


@dataclass(frozen=True)
class Foundation(Effect):
    """A foundation under the whole beam, held at the mass."""

    foundation: float = quantity("N/m", "of a spring under the mass; absent = none", "50 N/m", above=0)
    name: ClassVar[str] = "mass.foundation"

    def apply(self, structure, space, scene):
        return Spring(self.foundation, scene.attached(self.name).position).apply(structure, space, scene)


def test_a_key_of_ones_own_is_an_effect_of_the_mass() -> None:
    text = RIG.replace("STOP", "restitution = 0.72")
    with vibeam.register_effect(Foundation):
        case = parse(text, set={"mass.foundation": "80 N/m"} | QUICK)
        spring = replace(case.scene, effects=(*case.scene.effects[:-1], Spring(80.0, 0.132)))
        assert np.array_equal(assemble_with_space(case.scene)[0].K, assemble_with_space(spring)[0].K)
        assert parse(case.text).key == case.key != parse(text, set=QUICK).key
        assert [row.effect for row in influence(case).rows] == ["mass.foundation"]
        with pytest.raises(CaseError, match=r"mass\.foundation: '1 m' is a length, not a stiffness"):
            parse(text, set={"mass.foundation": "1 m"})
    with pytest.raises(CaseError, match=r"mass\.foundation: unknown key"):
        parse(text, set={"mass.foundation": "80 N/m"})


def test_wrong_keys_of_an_effect_of_ones_own_are_told_at_their_line() -> None:
    wrong = CASE.replace('"80 N/m"', '"80 N"').replace('position = "60 mm"\n', 'place = "60 mm"\n')
    with vibeam.register_effect(Spring), pytest.raises(CaseError) as caught:
        parse(wrong, "own.toml")
    line = wrong.splitlines().index("[spring]") + 1
    assert str(caught.value).splitlines() == [
        f'own.toml:{line}: spring.position: missing (distance from the clamp): write position = "… mm"',
        f"own.toml:{line + 1}: spring.stiffness: '80 N' is a force, not a stiffness",
        f"own.toml:{line + 2}: spring.place: unknown key; known here: stiffness, position",
    ]
    with vibeam.register_effect(Spring), pytest.raises(CaseError, match=r"spring\.position: is beyond the tip"):
        parse(CASE, set={"spring.position": "1 m"})


def test_a_massless_beam_is_condensed_after_an_effect_of_ones_own() -> None:
    with vibeam.register_effect(Spring):
        scene = parse(CASE, set={"beam.massless": True, "fidelity.two.modes": 1}).scene
    structure, _ = assemble_with_space(scene)
    bare, _ = assemble_with_space(scene.without("spring"))
    assert (structure.size, bare.size) == (1, 1)
    bends = 6 * scene.beam.bending_stiffness
    at, below = 0.132, 0.06
    mass, spring, both = 2 * at**3 / bends, 2 * below**3 / bends, below**2 * (3 * at - below) / bends
    stiffened = mass - 80.0 * both**2 / (1 + 80.0 * spring)
    ratio = structure.modes().omega[0] / bare.modes().omega[0]
    assert ratio == pytest.approx((mass / stiffened) ** 0.5, rel=1e-6)


def test_a_registration_leaves_the_order_of_the_others_and_no_trace() -> None:
    before = list(EFFECTS)
    with vibeam.register_effect(Spring):
        assert list(EFFECTS) == [*before, "spring"]
        with pytest.raises(ValueError, match="'spring' is taken"):
            vibeam.register_effect(Spring)
    assert list(EFFECTS) == before


def test_what_is_wrong_with_a_declaration_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    @dataclass(frozen=True)
    class Wrong(Effect):
        """Nothing."""

        far: float = quantity("parsec", "how far", "1 parsec")
        short: float = quantity("m", "how short", "1 kg")
        bare: float = 0.0
        name: ClassVar[str] = "wrong one"

    with pytest.raises(ValueError, match="effect Wrong: the name 'wrong one' must be") as caught:
        vibeam.register_effect(Wrong)
    assert "bare: declare it by quantity" in str(caught.value)
    assert "far: 'parsec' has the unknown unit" in str(caught.value)
    assert "short: '1 kg' is a mass, not a length" in str(caught.value)
    monkeypatch.setattr(Wrong, "name", "mass.far")
    with pytest.raises(ValueError, match=r"the key 'mass\.far' needs one field, named 'far'"):
        vibeam.register_effect(Wrong)
    with pytest.raises(ValueError, match="must be a frozen dataclass made from Effect"):
        vibeam.register_effect(dict)  # type: ignore[arg-type]
