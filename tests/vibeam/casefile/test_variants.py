"""A fidelity's own physics: what it sets and what it leaves out, in its scene, in the key, and in the messages."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import one_mode

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam_models.effects.masses import AddedMass
from vibeam_models.scene import Scene
from vibeam_models.sdof import SdofScene

CASES = Path(__file__).parents[3] / "cases"
SDOF = one_mode('["2 rad/s"]', 100, 2, "[fidelity.plain]", direction="up")


def with_lines(*lines: str) -> Case:
    return parse(SDOF + "\n".join(lines) + "\n")


def faults(text: str, **changes: Any) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse(text, "case.toml", changes)
    return str(caught.value).splitlines()


def rig(**changes: Any) -> Case:
    return vibeam.load(CASES / "dtu_neutral.toml", set=changes)


def test_each_fidelity_has_its_own_scene() -> None:
    case = with_lines("[fidelity.other]", 'set = { "stop.restitution" = "60 %", stop.gap = 0.5e-3 }')
    assert case.scene == case.scene_of("plain") == SdofScene(1.0, 0.015, 0.0, 0.9, 0.5e-3)
    assert case.scene_of("other") == SdofScene(1.0, 0.015, 0.5e-3, 0.6, 0.5e-3)
    assert (case.system("other").gap, case.system("other").restitution) == (0.5e-3, 0.6)
    assert (case.system("plain").gap, case.system("plain").restitution) == (0.0, 0.9)
    with pytest.raises(KeyError, match="plain, other"):
        case.scene_of("third")


def test_a_family_runs_as_its_members_would_alone() -> None:
    case = with_lines("[fidelity.other]", 'set = { "stop.restitution" = 0.6, "drive.amplitude" = 1e-3 }')
    alone = parse(SDOF, set={"stop.restitution": 0.6, "drive.amplitude": 1e-3})
    ours, theirs = vibeam.run(case)["other"].up, vibeam.run(alone)["plain"].up
    assert ours is not None
    assert theirs is not None
    assert np.array_equal(ours.amplitude, theirs.amplitude)
    plain = vibeam.run(case)["plain"].up
    assert plain is not None
    assert plain.amplitude[0] != ours.amplitude[0]


def test_effects_are_left_out_of_one_fidelity_alone() -> None:
    added = {"added_mass": [{"mass": "2.4 g", "position": "90 mm"}]}
    left = ["added_mass", "mass.rotary_inertia", "mass.rigid_half_width"]
    case = rig(**added, **{"fidelity.bare.reduction": "static_mode", "fidelity.bare.without": left})
    whole, bare = case.scene_of("beam"), case.scene_of("bare")
    assert isinstance(whole, Scene)
    assert isinstance(bare, Scene)
    assert [effect.name for effect in whole.effects] == left
    assert whole.effects[0] == AddedMass(0.0024, 0.09)
    assert bare == replace(whole, effects=())
    assert case.fidelities["bare"].without == tuple(left)


def test_leaving_out_what_is_not_there_changes_nothing() -> None:
    case = rig(**{"fidelity.sdof.without": ["added_mass"]})
    assert case.scene_of("sdof") == case.scene


def test_a_unit_is_read_and_the_drive_is_the_fidelitys_own() -> None:
    case = rig(**{"fidelity.sdof.set": {"drive.voltage": "1.2 V", "stop.gap": "-0.1 mm"}})
    assert case.amplitude_of("sdof") == 2 * case.amplitude_of("beam") == 2 * case.base_amplitude
    assert case.scene_of("sdof").stop.gap == -1e-4  # type: ignore[union-attr]


def test_equal_changes_have_equal_keys_and_others_do_not() -> None:
    def key(changes: dict[str, Any]) -> str:
        return rig(**{"fidelity.sdof.set": changes}).key

    assert key({"stop.gap": "0.1 mm"}) == key({"stop": {"gap": "1e-4 m"}}) == key({"stop.gap": "100 µm"})
    assert len({key({"stop.gap": "0.1 mm"}), key({"stop.gap": "0.2 mm"}), rig().key}) == 3
    left = rig(**{"fidelity.sdof.without": ["mass.rotary_inertia"]})
    assert left.key != rig().key


def test_the_text_of_a_case_loads_as_the_same_case() -> None:
    case = rig(**{"fidelity.sdof.set": {"stop.gap": "0.1 mm", "beam.damping": [0.01, 0.02]},
                  "fidelity.sdof.without": ["beam.damping_ratio"]})  # fmt: skip
    again = parse(case.text, case.path)
    assert again.numbers == case.numbers
    assert again.scenes == case.scenes


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ('set = { "stop.restitution" = 1.2 }', 'set."stop.restitution": 1.2 is outside [0, 1]'),
        ("set = { stop.restitution = 1.2 }", "set.stop.restitution: 1.2 is outside [0, 1]"),
        ('set = { "stop.gap" = "3 kg" }', "set.\"stop.gap\": '3 kg' is a mass, not a plain number"),
        ('set = { "stop.gp" = 1 }', "set.\"stop.gp\": unknown key 'stop.gp'; did you mean 'gap'?"),
        ('set = { "stp.gap" = 1 }', "set.\"stp.gap\": unknown key 'stp.gap'; did you mean 'stop'?"),
        ('set = { "stop.gap.x" = 1 }', "set.\"stop.gap.x\": 'stop.gap.x' goes beyond a value"),
        ('set = { "sweep.settle" = 1 }', 'set."sweep.settle": sweep is shared by all fidelities: a fidelity changes '
         "sdof, stop, drive, measurement, start alone"),
        ('set = { "fidelity.plain.solver" = "mapping" }', 'set."fidelity.plain.solver": fidelity is shared by all '
         "fidelities: a fidelity changes sdof, stop, drive, measurement, start alone"),
        ("set = 3", 'set: must be table { "stop.gap" = value, … }, not 3'),
        ("set = {}", "set: sets nothing: name a key, or leave it away"),
        ('without = ["stop.gap"]', "without.0: stop.gap cannot be left out: every case needs it; set it instead"),
        ('without = ["stop"]', "without.0: stop cannot be left out: every case needs it; set it instead"),
        ('without = ["sdof.natural_freq"]', "without.0: unknown key 'sdof.natural_freq'; did you mean "
         "'natural_frequency'?"),
        ('without = "sdof.natural_frequency"', "without: must be a list of dotted keys, not 'sdof.natural_frequency'"),
        ('without = ["stop.gap", "stop.gap"]', "without: names one of its entries twice"),
    ],
)  # fmt: skip
def test_wrong_changes_are_told_at_their_line(line: str, fault: str) -> None:
    found = faults(SDOF + "[fidelity.other]\n" + line)
    assert f"case.toml:16: fidelity.other.{fault}" in found


def test_setting_and_leaving_out_at_once() -> None:
    lines = '[fidelity.other]\nwithout = ["sdof.natural_frequency"]\nset = { sdof.natural_frequency = 2.0 }'
    said = "sdof.natural_frequency is left out and set at once: keep one of the two"
    assert faults(SDOF + lines) == [f"case.toml:16: fidelity.other.without.0: {said}"]


def test_keys_that_do_not_go_together_after_the_change() -> None:
    text = (CASES / "dtu_neutral.toml").read_text().split("[reference")[0]
    found = faults(text, **{"fidelity.sdof.set": {"drive.amplitude": "1 mm"}})
    said = "the base motion is said twice: keep amplitude, or voltage and gain"
    assert found == [f'--set fidelity.sdof.set."drive.amplitude": {said}']
    found = faults(text, **{"fidelity.sdof.set": {"beam.length": "120 mm"}})
    assert any("with what it changes, mass.position: 0.132 m is beyond the tip" in line for line in found)


def test_a_fault_of_the_case_itself_is_told_once() -> None:
    found = faults(SDOF.replace("0.9", "1.9") + '[fidelity.other]\nset = { "stop.gap" = 1e-3 }')
    assert found == ["case.toml:6: stop.restitution: 1.9 is outside [0, 1]"]
