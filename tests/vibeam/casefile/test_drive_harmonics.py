"""Further harmonics of the drive in a case file: their keys, what does not go with them, what a run makes of them."""

# ruff: noqa: E501  (a message stays on its line)

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import RIG, one_mode

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError

TEXT = RIG.read_text(encoding="utf-8").split("[fidelity")[0] + '[fidelity.beam]\nreduction = "modal"\nmodes = 2\n'
HARMONICS = {
    "drive.harmonic": [2, 3],
    "drive.harmonic_share": ["5 %", 0.02],
    "drive.harmonic_phase": ["30 deg", "1 rad"],
}
FEW = {"sweep.frequency": ["15.2 Hz"], "sweep.direction": "up", "sweep.settle": 30, "sweep.hold": 6}
FREE = one_mode(
    '["1.8 rad/s", "2.2 rad/s"]', 400, 8,
    "[fidelity.exact]", '[show.orders]\nkind = "harmonics"\nfrequency = "1.8 rad/s"\nhighest = 4',
    "[show.line]\nkind = \"history\"\nfrequency = \"1.8 rad/s\"", gap=1.0,
)  # fmt: skip


def case(**more: Any) -> vibeam.Case:
    return parse(TEXT, "mine.toml", FEW | HARMONICS | more)


def faults(settings: dict[str, Any], text: str = TEXT) -> str:
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml", FEW | settings)
    return str(caught.value)


def test_they_are_read() -> None:
    found = case()
    assert found.scene.harmonics == ((2, 0.05, pytest.approx(np.pi / 6)), (3, 0.02, 1.0))
    again = parse(found.text, "mine.toml")
    assert again.scene == found.scene
    assert again.key == found.key
    without_phase = parse(TEXT, "mine.toml", FEW | {"drive.harmonic": [2], "drive.harmonic_share": ["5 %"]})
    assert without_phase.scene.harmonics == ((2, 0.05, 0.0),)


def test_a_case_without_them_says_nothing_of_them() -> None:
    found = parse(TEXT, "mine.toml", FEW)
    assert "harmonic" not in found.numbers + found.text
    assert found.scene.harmonics == ()
    assert found.key != case().key


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"drive.harmonic": [1]}, "drive.harmonic: entry 1 of the list: 1 is outside [2, 1000]"),
        ({"drive.harmonic": [2.5]}, "drive.harmonic: entry 1 of the list: must be a whole number, not 2.5"),
        ({"drive.harmonic": [2, 2]}, "drive.harmonic: names one of its entries twice"),
        ({"drive.harmonic": None, "drive.harmonic_phase": None},
         "drive.harmonic: missing (the orders that shares and phases are of): write harmonic = [2]"),
        ({"drive.harmonic_share": None}, 'drive.harmonic_share: missing (how large each is): write harmonic_share = ["5 %"]'),
        ({"drive.harmonic_share": [0.1]}, "drive.harmonic_share: 1 numbers, and harmonic has 2"),
        ({"drive.harmonic_share": [0.1, -0.1]}, "drive.harmonic_share: number 2 of the list: -0.1 must be ≥ 0"),
        ({"drive.harmonic_phase": [0]}, "drive.harmonic_phase: 1 numbers, and harmonic has 2"),
        ({"drive.harmonic_phase": ["1 mm", 0]}, "drive.harmonic_phase: number 1 of the list: '1 mm' is a length, not an angle"),
        ({"platform.mass": "5 kg", "platform.frequency": "3 Hz", "platform.coupling": "two-way",
          "platform.damping_ratio": 0.05, "platform.calibrated_at": "15 Hz"},
         "drive.harmonic: [platform] filters each harmonic its own way, which is not computed: take harmonic, or it, away"),
        ({"further_stop": [{"position": "150 mm", "gap": "1 mm", "restitution": 0.7}]},
         "drive.harmonic: is carried to one contact, and there is a further_stop: take one of the two away"),
        ({"fidelity.beam.solver": "orbit"},
         "fidelity.beam.solver: 'orbit' knows a drive of one harmonic: write \"flight\" or \"direct\" or \"moreau\", or take "
         "drive.harmonic away"),
        ({"show.it.kind": "participation", "show.it.frequency": "15 Hz"},
         'show.it.kind: kind = "participation" knows a drive of one harmonic, and beam has several: name others in '
         "fidelities, or take drive.harmonic away"),
    ],
)  # fmt: skip
def test_what_does_not_go_with_them(settings: dict[str, Any], said: str) -> None:
    given = {name: value for name, value in (HARMONICS | settings).items() if value is not None}
    line = faults(given)
    assert line.startswith(("--set ", "mine.toml:"))
    assert line.endswith(f" {said}")
    assert len(line.splitlines()) == 1


def test_a_fidelity_may_have_them_or_not() -> None:
    own = TEXT + '[fidelity.own]\nreduction = "modal"\nmodes = 2\nSOLVER\nset = { "drive.harmonic" = [2], '
    own += '"drive.harmonic_share" = ["5 %"] }\n'
    found = parse(own.replace("SOLVER", ""), "mine.toml", FEW)
    assert found.scene_of("beam").harmonics == ()
    assert found.scene_of("own").harmonics == ((2, 0.05, 0.0),)
    assert "fidelity.own.solver: 'orbit' knows a drive of one" in faults({}, own.replace("SOLVER", 'solver = "orbit"'))
    left = TEXT + '[fidelity.left]\nreduction = "modal"\nmodes = 2\nsolver = "orbit"\n'
    left += 'without = ["drive.harmonic", "drive.harmonic_share", "drive.harmonic_phase"]\n'
    assert parse(left, "mine.toml", FEW | HARMONICS).scene_of("left").harmonics == ()


def test_a_run_is_the_sweep_of_its_system(tmp_path: Path) -> None:
    """A share is of the acceleration Ω²B whatever key says the drive; a file goes on where it was left."""
    found = case(**{"sweep.frequency": ["15 Hz", "15.2 Hz"]})
    omega = 2 * np.pi * found.sweep.frequency
    alone = vibeam.sweep(
        found.system("beam"), omega=omega, amplitude=found.amplitude(omega), settle=30, hold=6, output="sensor",
        harmonics=((2, 0.05, np.pi / 6), (3, 0.02, 1.0)),
    )  # fmt: skip
    run = vibeam.run(found, tmp_path / "it.h5")
    assert isinstance(alone, vibeam.FrequencyResponse)
    np.testing.assert_allclose(run["beam"].up.amplitude, alone.amplitude, rtol=1e-12)
    plain = vibeam.run(parse(TEXT, "mine.toml", FEW | {"sweep.frequency": ["15 Hz", "15.2 Hz"]}))
    assert np.all(np.abs(run["beam"].up.amplitude / plain["beam"].up.amplitude - 1) > 1e-3)
    assert vibeam.run(found, tmp_path / "it.h5").found == 2


def test_a_free_oscillators_harmonics_are_its_drives() -> None:
    """ω² = 1 rad²/s² and β = 0.015 by hand: |Ω²B s/(1 − j²Ω² + 2iβjΩ)| at j = 1, 2, 3."""
    found = vibeam.run(parse(FREE, "mine.toml", HARMONICS))
    sheet = found.shown["orders"][0]
    shares, rates = np.array([1.0, 0.05, 0.02]), 1.8 * np.arange(1, 4)
    expected = 1.8**2 * 0.5e-3 * shares / np.abs(1 - rates**2 + 2j * 0.015 * rates)
    at = [int(np.flatnonzero(sheet["order"] == order)[0]) for order in (1, 2, 3)]
    np.testing.assert_allclose(sheet["harmonic"][at], expected, rtol=2e-5)  # the transient's rest: e^{-0.015·1396}
    assert found["exact"].up.period.tolist() == [-1, -1]
    times, moved = sheet_of(found, "time"), sheet_of(found, "displacement")
    turned = (
        -(1.8**2) * 0.5e-3 / (1 - rates**2 + 2j * 0.015 * rates) * shares * np.exp(1j * np.array([0, np.pi / 6, 1]))
    )
    steady = (turned * np.exp(1j * rates * times[:, None])).imag.sum(axis=1)
    assert min(np.abs(moved - steady).max(), np.abs(moved + steady).max()) < 1e-4 * np.abs(steady).max()


def sheet_of(found: Any, column: str) -> Any:
    return found.shown["line"][0][column]


@pytest.mark.parametrize("study", [vibeam.cost, vibeam.stability])
def test_studies_of_one_harmonic_say_so(study: Any) -> None:
    with pytest.raises(ValueError, match=r"drive.harmonic: .* knows a drive of one harmonic: take drive.harmonic away"):
        study(case())


def test_the_fit_of_ringing_is_left_out_of_influence() -> None:
    whole = vibeam.influence(case(**{"influence.points": 3, "influence.quantities": ["ringing"]})).whole
    values = {number.quantity: float(value[0, 0]) for number, value in whole.numbers.items()}
    assert np.isfinite(values["peak"])
    assert np.isnan(values["ringing"])
    assert "the fit knows one harmonic of the drive" in whole.why.values()
