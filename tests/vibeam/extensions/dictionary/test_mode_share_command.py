"""``vibeam mode_share``: numbers, a faulty option, the public names."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vibeam.cli.main import app

RIG = str(Path(__file__).parents[4] / "cases" / "dtu_neutral.toml")


def test_an_impact_that_lasts_so_long_in_other_programs_terms() -> None:
    asked = json.loads(CliRunner().invoke(app, ["mode_share", RIG, "--json", "--contact-time", "0.5 ms"]).stdout)
    assert asked["contact_time"] == 0.0005
    assert asked["terms"]["mujoco"]["parameters"]["dampratio"] == pytest.approx(0.0704, rel=1e-3)


def test_a_contact_time_of_nothing_is_refused_by_its_option() -> None:
    done = CliRunner().invoke(app, ["mode_share", RIG, "--contact-time", "0 s"])
    assert (done.exit_code, "--contact-time: '0 s' must be > 0" in done.stderr) == (2, True)
