"""Brute force of uncertain rigs: stored intervals hold it, and nothing beside it; its peaks are those of sweeps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.others.uncertain.intervals import NAMES, held, hits, inside, read, widths
from tests.others.uncertain.plain_samples import drawn
from tests.others.uncertain.rigs import RIGS, Assembled, Rig
from tests.others.uncertainty_book import ENOUGH, FEW, LEAST, REPETITIONS, SAMPLES, SEED, WIDE, flown, study, table
from vibeam.studies.uncertainty.samples import inputs_of
from vibeam.studies.uncertainty.statistics import saltelli
from vibeam.studies.uncertainty.study import uncertainty

STORED = json.loads((Path(__file__).parent / "results" / "uncertainty.json").read_text(encoding="utf-8"))
ROWS = [pytest.param(rig, row, id=rig.name) for rig, row in zip(RIGS, STORED["rigs"], strict=True)]
OFF = 1e-3  # of a peak beside its sweep: next to a fold the sweep has not settled


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_intervals_hold_the_truth(rig: Rig, row: dict[str, Any]) -> None:
    assert (STORED["samples"], STORED["repetitions"]) == (SAMPLES, REPETITIONS)
    counts = held(row)
    assert set(counts) == set(NAMES) == {"mean", "5%", "25%", "50%", "75%", "95%"}
    assert counts["mean"] >= ENOUGH, counts
    assert min(counts.values()) >= LEAST, counts


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_intervals_hold_no_other_truth(rig: Rig, row: dict[str, Any]) -> None:
    """Moved by three half widths, either way."""
    for way in (-1.0, 1.0):
        assert max(held(row, 3.0 * way).values()) < FEW


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_intervals_are_as_wide_as_the_scatter_asks_for(rig: Rig, row: dict[str, Any]) -> None:
    """And bands hold 9 of 10 of all, as 256 samples do."""
    assert max(widths(row).values()) <= WIDE
    assert min(widths(row).values()) > 0.8
    assert inside(row).mean() == pytest.approx(0.9, abs=0.01)


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_brute_force_is_as_stored_and_as_flown(rig: Rig, row: dict[str, Any]) -> None:
    model = Assembled(rig, rig.case())
    plain = drawn(rig.inputs, SAMPLES, SEED)
    assert abs(row["flown"]["mean"]) * row["mean"] < 0.2 * row["error"]
    assert row["flown"]["largest"] < OFF
    assert flown(rig, model, 6)["largest"] < OFF
    first = {key: values[:20] for key, values in plain.items()}
    np.testing.assert_allclose(rig.exact(model, first), read(row["first"]), rtol=1e-8)
    wrong = first | {"stop.gap": first["stop.gap"] + 5e-6}
    assert np.median(np.abs(rig.exact(model, wrong) / read(row["first"]) - 1)) > 2 * OFF


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_plain_samples_are_of_what_the_case_says(rig: Rig, row: dict[str, Any]) -> None:
    said = {each.key: each for each in rig.case().uncertain}
    for each in rig.inputs:
        assert (each.kind, each.first, each.second) == (
            said[each.key].kind, pytest.approx(said[each.key].first), pytest.approx(said[each.key].second),
        )  # fmt: skip
        values = each.drawn(np.random.default_rng(1), 4000)
        assert values.mean() == pytest.approx(said[each.key].middle, abs=4 * said[each.key].deviation / np.sqrt(4000))
        assert values.std() == pytest.approx(said[each.key].deviation, rel=0.05)


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_a_study_is_one_of_the_repetitions(rig: Rig, row: dict[str, Any]) -> None:
    found = study(rig, Assembled(rig, rig.case()), 0)
    for name, value, ends in zip(
        NAMES, (found.mean, *found.quantiles), (found.mean_within, *found.within), strict=True
    ):
        stored = row["studies"][name]
        assert [value, *ends] == pytest.approx([read(stored[key])[0] for key in ("value", "low", "high")], rel=1e-8)


def test_exact_peaks_stand_for_the_sweeps_of_a_study() -> None:
    """One whole study: its mean and median are those of the exact peaks at its points."""
    rig = RIGS[2]
    model = Assembled(rig, rig.case())
    found = uncertainty(model.case, samples=16, seed=3)
    inputs = inputs_of(model.case.uncertain, saltelli(len(rig.inputs), 16, 3))[:, :2].reshape(32, -1)
    peaks = rig.exact(model, {each.key: column for each, column in zip(rig.inputs, inputs.T, strict=True)})
    assert found.finest.peak.mean == pytest.approx(peaks.mean(), rel=2e-5)
    assert found.finest.peak.quantiles[2] == pytest.approx(np.median(peaks), rel=1e-4)


def test_a_truth_known_to_an_error_widens_intervals_as_independent_ones_do() -> None:
    low, high = np.array([0.0, 0.0]), np.array([2.0, 1.0])
    assert hits(low, high, 1.5, 0.0) == 1
    assert hits(low, high, 1.5, 0.5) == 2
    assert hits(low, high, 4.0, 0.5) == 0


def test_the_table_has_every_rig() -> None:
    said = table(STORED)
    assert all(said.count(f"| {rig.name} |") == 1 for rig in RIGS)
