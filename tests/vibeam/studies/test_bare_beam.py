"""A beam without an attached mass is a rig too; what has no meaning then is left out, and said."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite, pi

import numpy as np
import pytest
from stand_in import HELD_AT_CONTACT, curve
from stand_in import case as stand_in_case
from typer.testing import CliRunner

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.casefile.template import template
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.report.derive import contact_table
from vibeam.report.maps.stability import sheet
from vibeam.report.modes import modal
from vibeam.runs.result import Result
from vibeam.runs.summary import ill_posed, remarks
from vibeam.studies.derive import derive
from vibeam.studies.modes import mode_table
from vibeam.studies.stability import stability
from vibeam.system.response import Branches
from vibeam_models.beam import assemble

TEXT = HELD_AT_CONTACT.split("[reference")[0]
DRIVEN = {"drive.voltage": None, "drive.gain": None, "drive.amplitude": "0.05 mm"}
BARE = {"mass": None, "stop.position": "132 mm"} | DRIVEN
SHORT = {"sweep.frequency.points": 3, "sweep.settle": 4, "sweep.hold": 2}


def bare(**settings: object) -> Case:
    return parse(TEXT, set=BARE | settings)


def test_the_model_of_a_bare_beam_is_that_of_the_textbook() -> None:
    """The first frequency of a uniform cantilever, 1.8751² √(EI/ρA)/L², and a stop where it is put."""
    case = bare()
    beam = case.scene.beam
    omega = 1.8751040687**2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length) / beam.length**2
    assert case.scene.mass is None
    assert case.scene.stop.position == 0.132
    assert assemble(case.scene).modes(1).omega[0] == pytest.approx(omega, rel=1e-6)
    assert case.scene.moving_mass == pytest.approx(beam.mass_per_length * beam.length)
    assert case.scene.weights == ()


def test_a_vanishing_mass_goes_over_into_none() -> None:
    light = parse(
        TEXT, set=DRIVEN | {"mass.mass": "1e-9 kg", "mass.rotary_inertia": None, "mass.rigid_half_width": None}
    )
    both = [case.system("beam") for case in (light, bare())]
    np.testing.assert_allclose(both[0].omega, both[1].omega, rtol=1e-6)
    np.testing.assert_allclose(np.abs(both[0].contact), np.abs(both[1].contact), rtol=1e-6)


def test_it_runs() -> None:
    result = vibeam.run(bare(**SHORT))
    assert np.all(result["beam"].up.ended == 0)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"mass": None} | DRIVEN, "stop.position: missing (without [mass] the stop is nowhere): write position"),
        ({"mass": None, "stop.position": "132 mm"}, "drive.gain: is of a beam with an attached mass: write amplitude"),
        (BARE | {"beam.massless": True}, "beam.massless: nothing is left that has mass: add [mass]"),
        (
            BARE
            | {"torsion.eccentricity": "1 mm", "torsion.polar_inertia": "10 kg mm^2", "torsion.poissons_ratio": 0.3},
            "torsion: has the polar inertia of the attached mass: add [mass]",
        ),
    ],
)
def test_what_needs_the_mass_is_refused_with_the_cure(settings: dict[str, object], told: str) -> None:
    with pytest.raises(CaseError) as refusal:
        parse(TEXT, set=settings)
    assert told in str(refusal.value)
    assert len(refusal.value.faults) == 1


def test_the_template_keeps_its_mass() -> None:
    assert "\n[mass]\nmass = " in template()
    assert parse(template()).scene.mass is not None


def test_rows_of_an_attached_mass_are_left_out_and_said() -> None:
    table = vibeam.derive(bare())
    assert {row.symbol for row in table} == {"K_S", "M_S", "ω_n", "f_n", "Δ"}
    assert all(isfinite(row.error) and abs(row.error) < 0.05 for row in table)
    omega = table["circular frequency, with the beam's mass"]
    assert table["frequency, with the beam's mass"].value == pytest.approx(omega.value / (2 * pi))
    assert table.notes[0] == (
        "left out: shape at the mass, rows with a massless beam, damping ratio, base factor and drive: "
        "there is no attached mass"
    )
    assert "ill-posed" in table.notes[1]
    assert (
        len(vibeam.derive(bare(**{"stop.law": "hertz", "stop.hertz_stiffness": 1e8, "stop.restitution": None})).notes)
        == 1
    )


def test_a_mass_that_the_beam_outweighs_has_no_row_of_a_massless_beam() -> None:
    light = vibeam.derive(parse(TEXT, set={"mass.mass": "0.1 g", "mass.rotary_inertia": None}))
    assert max(abs(row.error) for row in light) < 0.05
    point = 1e-4 * light["shape at the mass"].value ** 2
    beam = vibeam.derive(bare())["mass, with the beam's mass"].value
    assert f"{100 * point / (point + beam):.2g} % of what moves" in light.notes[0]
    whole = vibeam.derive(parse(TEXT))
    assert whole.notes == ()
    assert {row.name for row in whole} > {row.name for row in light}


def test_a_negative_restitution_of_mode_1_is_said_in_words() -> None:
    scene = bare().scene
    assert ill_posed({"sdof": 0.7, "law": float("nan")}, scene) == []
    told = ill_posed({"two": -0.1, "beam": -0.6714}, scene)
    assert len(told) == 1
    assert told[0].startswith("two (-0.1) and beam (-0.67): R₁ < 0, mode 1 goes on into the stop")
    assert mode_table(bare().scene, 5).notes[0].startswith("from 3 modes on (-0.16): R₁ < 0")
    assert mode_table(parse(TEXT).scene, 5).notes == ()


def bare_text() -> str:
    """The case file without its table [mass] and what drives it, and with its stop at 132 mm."""
    beam, _, rest = TEXT.partition("[mass]")
    kept = [line for line in rest[rest.index("[stop]") :].splitlines() if not line.startswith(("voltage", "gain"))]
    return beam + "\n".join(kept).replace("[stop]", '[stop]\nposition = "132 mm"')


@pytest.mark.parametrize("more", [{}, {"stop.gap_at": "sensor", "stop.second_gap": "2 mm", "stop.restitution": 0}])
def test_the_table_that_a_message_writes_makes_the_stop_yield(more: dict[str, object]) -> None:
    """Pasted as it is, the case runs, and has neither the message nor the coefficient any more."""
    text, asked = bare_text(), {"drive.amplitude": "0.3 mm"}
    rigid = parse(text, set=asked | more)
    note = mode_table(rigid.scene, 5).notes[0]
    before, _, after = text.partition("[stop]")
    pasted = f"{before}{note[note.rindex('[stop]') :]}\n\n{after[after.index('[sensor]') :]}"
    made = parse(pasted, set=asked | SHORT | {"sweep.frequency.points": 1, "sweep.frequency.to": "14 Hz"})
    old, new = rigid.scene.stop, made.scene.stop
    assert (new.gap, new.position, new.second_gap) == (old.gap, old.position, old.second_gap)
    assert (new.gap_at, new.law.restitution) == (old.gap_at, max(old.restitution, 0.05))
    assert mode_table(made.scene, 5).notes == ()
    assert vibeam.run(made)["beam"].up.impacts[0] > 0


def test_the_modes_write_it_where_no_coefficient_shows_mode_1_what_is_held() -> None:
    held = bare(**{"stop.restitution_of": "first mode"})
    note = mode_table(held.scene, 5).notes[0]
    assert "at the contact, and none is above 1" in note
    assert 'law = "hunt-crossley"\n' in note
    with pytest.raises(ValueError, match="or let the stop yield: vibeam modes writes its table"):
        held.system("beam")


def test_derive_shows_the_contact_of_a_stop_that_yields() -> None:
    """Of a sphere Hertz's formulas of a free mass 1/S, S of the modes below 3/2t_c, to 1e-6."""
    bodies = {"stop.law": "hertz", "stop.radius": "5 mm", "stop.youngs_modulus": "210 GPa", "stop.poissons_ratio": 0.3}
    case = bare(**bodies, **{"beam.poissons_ratio": 0.3, "stop.restitution": None})
    table = derive(case)
    assert [row.speed for row in table.contacts] == [0.01, 0.1, 1.0]
    modes = assemble(case.scene).modes()
    modulus = case.scene.beam.youngs_modulus / (2 * 0.91)
    for row in table.contacts:
        assert 1 / row.mass == pytest.approx(np.sum((assemble(case.scene).contact @ modes.shapes[:, : row.modes]) ** 2))
        assert row.duration == pytest.approx(2.868 * (row.mass**2 / (0.005 * modulus**2 * row.speed)) ** 0.2, rel=2e-4)
        assert modes.frequency[row.modes - 1] < 1.5 / row.duration < modes.frequency[row.modes]
        assert row.pressure == pytest.approx(2 * modulus * row.radius / (pi * 0.005), rel=1e-6)
    assert "Hertz's theory is of small contacts: from" in table.notes[-1]
    assert "pressure" in [column.header for column in contact_table(table.contacts).columns]
    assert derive(bare()).contacts == ()


def test_derive_gives_the_damping_that_is_the_same_in_every_fidelity() -> None:
    soft = {"stop.law": "linear", "stop.stiffness": "20 N/mm", "stop.restitution": 0.8}
    table = derive(bare(**soft))
    damping = float(table.notes[-1].partition('damping = "')[2].partition(" N s/m")[0])
    row = derive(bare(**soft | {"stop.restitution": None, "stop.damping": f"{damping} N s/m"})).contacts[0]
    assert (row.modes, row.restitution) == (table.contacts[0].modes, pytest.approx(0.8, abs=1e-4))


def test_no_impact_at_any_frequency_is_said() -> None:
    clear, touching = curve([14, 15], 1e-3, period=-1), curve([14, 15], 1e-3, period=[-1, 1])
    mixed = {"one": Branches(clear, clear), "three": Branches(clear, touching)}
    assert remarks(Result(stand_in_case(), mixed, None, 0, {})) == [
        "one: no impact at any frequency: narrow the gap, or drive harder"
    ]
    failed = replace(clear, ended=np.array([0, vibeam.Ended.NOT_FINITE.code]))
    assert remarks(Result(stand_in_case(), {"one": Branches(failed)}, None, 0, {})) == []


def test_the_map_says_what_it_cannot_show() -> None:
    found = stability(bare(), points=3, frequencies=3)
    assert any(note.startswith("beam (-0.67): R₁ < 0") for note in found.notes)
    assert sheet(found).answer.endswith("along the case's own gap at the sensor 0 µm there is no boundary.")


def test_a_map_shoots_at_models_that_no_closed_form_knows() -> None:
    own = {"fidelity.two_modes.set": {"stop.law": "linear", "stop.stiffness": "1e5 N/m"}}
    found = stability(parse(TEXT, set=own), points=2, frequencies=2, fidelities=["two_modes"])
    assert [one.name for one in found.maps] == ["two_modes"]
    assert found.notes[0].startswith('two_modes: by shooting, for no closed form knows the contact law "linear"')


def test_the_commands_say_it(tmp_path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.chdir(tmp_path)
    settings = BARE | SHORT | {"stop.gap": "5 mm"}
    lines = [f"{key}={value if value is not None else ''}" for key, value in settings.items() if value is not None]
    text = TEXT.partition("[mass]")
    after = text[2][text[2].index("[stop]") :]
    source = (text[0] + after).replace('voltage = "0.6 V"\n', "").replace('gain = "5.16e-4 1/V"\n', "")
    (tmp_path / "bare.toml").write_text(source, encoding="utf-8")
    words = [word for line in lines for word in ("--set", line)]
    for command in ("run", "derive", "modes"):
        done = CliRunner().invoke(app, [command, "bare.toml", *words])
        assert done.exit_code == 0, done.output
        assert ("no impact at any frequency" in done.output) is (command == "run")
        assert "ill-posed" in done.output


def test_a_stop_that_yields_has_no_coefficient_in_the_table_of_modes() -> None:
    yields = {"stop.law": "linear", "stop.stiffness": "1e6 N/m", "stop.restitution_of": "contact"}
    table = mode_table(bare(**yields).scene, 3)
    assert not any(isfinite(row.first_mode_restitution) or isfinite(row.contact_restitution) for row in table.rows)
    assert [column.header for column in modal(table).columns][-1] == "Σ share"
    struck = mode_table(bare(**{"stop.restitution_of": "contact"}).scene, 3)
    assert [column.header for column in modal(struck).columns][-1] == "R"


def test_derive_names_the_causes_that_hold_for_the_beam() -> None:
    row = "mass, with the beam's mass"
    assert derive(bare().scene)[row].assumption == "the static deflection of a uniform strip as mode shape"
    added = derive(bare(**{"added_mass": [{"mass": "1 g", "position": "90 mm"}], "beam.ends": "clamped-pinned"}).scene)
    cause = "the static deflection of the bare beam as mode shape"
    assert added[row].assumption == f"{cause}, added masses left out"
    assert added["stiffness"].assumption == cause
