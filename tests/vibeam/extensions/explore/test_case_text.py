"""The case as a page writes it: at the case's own values the same case, at others what ``--set`` makes of it."""

import re
import shlex
import tomllib

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.extensions.explore.case_text import filled, fixed_keys, template
from vibeam.extensions.explore.sliders import case_sliders

CASES = (
    "dtu_neutral", "sdof_nominal", "rigs/two_stops", "rigs/elastic_stop", "matrices/dtu_modes", "experiment/fig19",
    "stuttgart/two_beams",
)  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_template_at_the_cases_own_values_is_the_case(name):
    case = vibeam.load(f"cases/{name}.toml")
    sliders = case_sliders(case)
    parts = template(case, sliders)
    assert parse(filled(parts, {key: each.value for key, each in sliders.sliders.items()}), case.path) == case


@pytest.mark.parametrize("name", CASES)
def test_a_template_at_other_values_is_the_case_with_these_keys(name):
    case, rng = vibeam.load(f"cases/{name}.toml"), np.random.default_rng(7)
    sliders = case_sliders(case)
    values = {key: float(rng.uniform(each.low, each.high)) for key, each in sliders.sliders.items()}
    said = [each.settings(values[key]) for key, each in sliders.sliders.items() if key != "frequency"]
    wanted = case.with_keys({key: value for each in said for key, value in each.items()})
    made = parse(filled(template(case, sliders), values), case.path)
    assert made.key == wanted.key != case.key
    tomllib.loads(filled(template(case, sliders), values))


def test_a_drive_over_frequency_is_multiplied_whole():
    table = {"drive.frequency": ["14 Hz", "17 Hz"], "drive.acceleration": ["0.8 m/s^2", "1 m/s^2"]}
    case = vibeam.load("cases/dtu_neutral.toml", table | {"drive.voltage": None, "drive.gain": None})
    sliders = case_sliders(case)
    values = {key: each.value for key, each in sliders.sliders.items()} | {"drive": 0.5}
    made = parse(filled(template(case, sliders), values), case.path)
    assert made.keys.value("drive.acceleration") == (0.4, 0.5)


def test_what_no_slider_moves_is_changed_by_its_command():
    case = vibeam.load("cases/rigs/two_stops.toml")
    rows = fixed_keys(case, case_sliders(case))
    assert [each["key"] for each in rows] == ["further_stop", "beam", "mass", "sensor"]
    assert rows[1]["command"] == """vibeam run two_stops.toml --set 'beam.length="180 mm"'"""
    for row in rows:
        program, command, file, option, setting = shlex.split(row["command"])
        assert (program, command, file, option) == ("vibeam", "run", "two_stops.toml", "--set")
        key, _, value = setting.partition("=")
        assert vibeam.load(case.path, {key: value}).key == case.key
        other = re.sub(r"[0-9.e-]+", lambda found: repr(0.99 * float(found[0])), value, count=1)
        assert vibeam.load(case.path, {key: other}).key != case.key
