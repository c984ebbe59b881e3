"""A user's own contact laws: a restitution by a formula, a stop by its contact time; registered, run from a case."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, pi
from pathlib import Path
from typing import ClassVar

import free_mass
import numpy as np
import pytest
from test_stop_keys import RIG
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.studies.effects import influence
from vibeam_models.keys import declared, quantity
from vibeam_models.laws import LAWS, RESTITUTION, ContactLaw
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.mechanics import StopLaw
from vibeam_models.laws.restitution import TableRestitution

pytestmark = pytest.mark.usefixtures("undrawn")


@dataclass(frozen=True)
class Fading(StopLaw):
    """R = e^{−v/v₀}, a function of Python that no kernel knows."""

    decay: float
    name: ClassVar[str] = "fading"

    def at(self, velocity):
        return exp(-velocity / self.decay)


@dataclass(frozen=True)
class Untabled(ContactLaw):
    """R = e^{−v/v₀}, as it is."""

    fading_speed: float = quantity("m/s", "v0 of the fading law", "0.5 m/s", above=0)
    name: ClassVar[str] = "fading"

    def contact(self, mobility):
        return Fading(self.fading_speed)


@dataclass(frozen=True)
class Exponential(ContactLaw):
    """R = e^{−v/v₀}, as a table, which the kernels know."""

    decay: float = quantity("m/s", "v0 of the exponential law", "0.5 m/s", above=0)
    name: ClassVar[str] = "exponential"

    def contact(self, mobility):
        return TableRestitution.through(Fading(self.decay).at, np.linspace(0.0, 5 * self.decay, 50))


@dataclass(frozen=True)
class Brief(ContactLaw):
    """A linear stop that a free mass 1/S leaves after a given time."""

    contact_time: float = quantity("s", "half a period of mass and stop", "1 ms", above=0)
    restitution: float = declared(RESTITUTION)
    name: ClassVar[str] = "brief"
    compliant: ClassVar[bool] = True

    def contact(self, mobility):
        return LinearStop.matched((pi / self.contact_time) ** 2 / mobility, self.restitution, 1 / mobility)


CASE = RIG.replace("STOP", 'law = "exponential"\ndecay = "0.4 m/s"\nrestitution_of = "contact"')
SDOF = (
    "[sdof]\ndamping_ratio = 0.015\n[stop]\ngap = 0.1\nSTOP\n[drive]\namplitude = 1e-3\n[sweep]\n"
    'frequency = ["0.9 rad/s", "1.1 rad/s"]\nsettle = 10\nhold = 5\n[fidelity.one]\n'
)


def test_laws_of_ones_own_run_from_a_case_file(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(CASE)
    with vibeam.register_law(Exponential), vibeam.register_law(Brief):
        case = vibeam.load(tmp_path / "own.toml")
        assert case.scene.stop.law == Exponential(0.4)
        law = case.system("two").law
        assert isinstance(law, TableRestitution)
        assert law.at(0.1) == pytest.approx(exp(-0.25), rel=1e-3)
        assert np.all(np.isfinite(vibeam.run(case)["two"].up.amplitude))
        assert parse(case.text).key == case.key
        brief = parse(RIG.replace("STOP", 'law = "brief"\ncontact_time = "2 ms"\nrestitution = 0.7')).system("two")
        assert free_mass.duration(brief.law, 1 / float(brief.contact @ brief.contact)) == pytest.approx(2e-3, rel=0.1)
        told = CliRunner().invoke(app, ["keys", "stop", "-v"], env={"COLUMNS": "250"}).output
        assert "decay" in told
        assert '"exponential"' in told
    with pytest.raises(CaseError, match="is not one of"):
        vibeam.load(tmp_path / "own.toml")


def test_a_law_of_new_mechanics_works_where_its_capabilities_are_enough() -> None:
    """R(v) by Python is integrated as the table of it is flown; exact flight refuses it by its name, with the cure."""
    own = RIG.replace("STOP", 'law = "fading"\nfading_speed = "0.4 m/s"')
    with vibeam.register_law(Untabled), vibeam.register_law(Exponential):
        assert np.all(vibeam.run(parse(own + 'solver = "direct"\n'))["two"].up.impacts > 0)
        asked = {"omega": [95.0], "amplitude": 1e-4, "settle": 5, "hold": 2}
        fine = {"solver": "direct", "options": {"method": "DOP853", "rtol": 1e-10}}
        system = parse(own).system("two")
        tabled = replace(system, law=TableRestitution.through(system.law.at, np.linspace(0.0, 1.0, 2001)))
        found, flown = vibeam.sweep(system, **asked, **fine), vibeam.sweep(tabled, **asked)
        np.testing.assert_allclose(found.amplitude, flown.amplitude, rtol=1e-4)
        said = 'the contact law "fading" has no formula in the kernels of exact flight: let its contact give'
        with pytest.raises(CaseError, match=f"fidelity.two: {said}"):
            vibeam.run(parse(own))
        drive = vibeam.Drive(95.0, 1e-4)
        for fly in (
            lambda: vibeam.simulate(system, drive, 0.1),
            lambda: vibeam.lyapunov(system, drive, periods=20),
            lambda: vibeam.orbits(system, drive),
        ):
            with pytest.raises(ValueError, match=said):
                fly()
        with pytest.raises(ValueError, match='"fading" has no derivative'):
            system.contact_law.rebound_slope(np.ones(1))


class Flown(Fading):
    """The same by a table that kernels know, with no derivative of R(v) v."""

    def kernel_numbers(self):
        return TableRestitution.through(self.at, np.linspace(0.0, 1.0, 50)).kernel_numbers()


def test_a_law_without_a_derivative_flies_and_its_exponents_are_refused_before_any_motion():
    system, drive = replace(parse(RIG.replace("STOP", "restitution = 0.7")).system("two"), law=Flown(0.4)), (95.0, 1e-4)
    assert len(vibeam.simulate(system, vibeam.Drive(*drive), 0.5).impact_times)
    open_gap = replace(system, gap=1.0)  # no impact ever
    for asked in (
        lambda: vibeam.lyapunov(open_gap, vibeam.Drive(*drive), periods=20),
        lambda: vibeam.batch(open_gap, *drive, settle=1, hold=1, lyapunov=20),
    ):
        with pytest.raises(ValueError, match='for the contact law "fading": let the law have rebound_slope'):
            asked()


def test_a_stop_of_ones_own_goes_wherever_its_spring_does() -> None:
    """Certificate, exponents, static equilibrium: all by the closed form that the linear stop declares."""
    with vibeam.register_law(Brief):
        case = parse(RIG.replace("STOP", 'law = "brief"\ncontact_time = "2 ms"\nrestitution = 0.7'))
        system, drive = case.system("two"), vibeam.Drive(2 * pi * 15, 1e-4)
        path = vibeam.simulate(system, drive, 1.0, certify=True)
        assert path.certificate.complete
        assert len(path.contacts)
        assert np.all(np.isfinite(vibeam.lyapunov(system, drive, settle=20, periods=20).exponents))
        pressed = vibeam.simulate(replace(system, gap=-1e-4), vibeam.Drive(drive.omega, 0.0), 0.01)
        assert pressed.outcome is vibeam.Outcome.SETTLED_ON_STOP


def test_influence_leaves_a_law_of_ones_own_to_the_stop() -> None:
    quick = {"beam.elements": 6, "influence.points": 3}
    text = (
        CASE.replace("decay", "restitution = 0.9\ncontact_time")
        .replace("exponential", "brief")
        .replace("0.4 m/s", "2 ms")
    )
    with vibeam.register_law(Brief):
        with pytest.raises(ValueError, match="names no effect"):
            influence(parse(text, set=quick))
        study = influence(parse(text, set=quick | {"mass.rotary_inertia": "3e-5 kg m^2"}))
    assert [row.effect for row in study.rows] == ["mass.rotary_inertia"]
    assert not study.rows[0].alone.why
    assert not study.rows[0].without.why


@pytest.mark.parametrize("text", [RIG, SDOF])
def test_wrong_keys_of_a_law_of_ones_own_are_told(text: str) -> None:
    example = '"… m/s"' if text is RIG else "…"
    with vibeam.register_law(Exponential):
        with pytest.raises(CaseError) as caught:
            parse(text.replace("STOP", 'law = "exponential"\nvelocity = 0.1'))
        assert f"stop.decay: missing (v0 of the exponential law): write decay = {example}" in str(caught.value)
        assert 'stop.velocity: does not go with law = "exponential": take it out' in str(caught.value)
        with pytest.raises(CaseError, match=r'stop\.decay: does not go with law = "restitution"'):
            parse(text.replace("STOP", "restitution = 0.7\ndecay = 0.1"))
        with pytest.raises(CaseError, match="did you mean 'exponential'"):
            parse(text.replace("STOP", 'law = "exponentiel"\nrestitution = 0.7'))


def test_what_is_wrong_with_a_law_is_said_and_nothing_stays() -> None:
    @dataclass(frozen=True)
    class Wrong(ContactLaw):
        """Nothing."""

        velocity: float = quantity("m/s", "another velocity", "1 m/s")
        gap: float = quantity("m", "another gap", "1 mm")
        name: ClassVar[str] = "linear"

    before = dict(LAWS)
    with pytest.raises(ValueError, match="contact law Wrong: the name 'linear' is taken") as caught:
        vibeam.register_law(Wrong)
    assert "velocity: another law has this key" in str(caught.value)
    assert "gap: is a key of every stop" in str(caught.value)
    assert "a method 'contact' is missing" in str(caught.value)
    vibeam.register_law(Exponential).remove()
    assert before == LAWS
