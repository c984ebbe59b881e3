"""Brute force of uncertain rigs: stored intervals hold it, and nothing beside it; its peaks are those of sweeps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.others.uncertain.intervals import held, hits, inside, read, scatter
from tests.others.uncertain.plain_samples import drawn
from tests.others.uncertain.rigs import RIGS, Assembled, Rig
from tests.others.uncertainty_book import ENOUGH, FEW, REPETITIONS, SAMPLES, SEED, flown, study, table
from vibeam.studies.uncertainty.samples import inputs_of
from vibeam.studies.uncertainty.statistics import saltelli
from vibeam.studies.uncertainty.study import uncertainty

STORED = json.loads((Path(__file__).parent / "results" / "uncertainty.json").read_text(encoding="utf-8"))
ROWS = [pytest.param(rig, row, id=rig.name) for rig, row in zip(RIGS, STORED["rigs"], strict=True)]
OFF = 1e-3  # of a peak beside its sweep: next to a fold the sweep has not settled


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_intervals_hold_the_truth_in_93_of_100(rig: Rig, row: dict[str, Any]) -> None:
    assert (STORED["samples"], STORED["repetitions"]) == (SAMPLES, REPETITIONS)
    counts = held(row)
    assert set(counts) == {"several", "alone", "5%", "25%", "50%", "75%", "95%"}
    assert min(counts.values()) >= ENOUGH, counts


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_intervals_hold_no_other_truth(rig: Rig, row: dict[str, Any]) -> None:
    """Moved by three half widths, either way; the mean by one and a half too."""
    for way in (-1.0, 1.0):
        assert max(held(row, 3.0 * way).values()) < FEW
        assert held(row, 1.5 * way)["several"] < 50


@pytest.mark.parametrize(("rig", "row"), ROWS)
def test_stated_errors_are_not_too_small(rig: Rig, row: dict[str, Any]) -> None:
    """Means scatter as stated, or less: the finest's samples are Sobol's. Bands hold 9 of 10, as 256 samples do."""
    assert 0.2 < scatter(row, "several") < 1.2
    assert scatter(row, "alone") < 0.5
    count = row["points"]
    assert inside(row).mean() == pytest.approx(0.9 * (count - 1) / (count + 1), abs=0.01)  # of uniform samples


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
    """The mean of the finest alone to round-off; the other as far as numbers of runs hang on CPU times."""
    found = study(rig, Assembled(rig, rig.case()), 0, row["flown"]["seconds"])
    assert found.mean.alone.mean == pytest.approx(read(row["alone"]["mean"])[0], rel=1e-8)
    assert found.peak.quantiles[0] == pytest.approx(read(row["bands"][0])[0], rel=1e-8)
    several = found.mean.several
    assert several.mean == pytest.approx(row["mean"], abs=5 * several.error)
    assert several.error == pytest.approx(read(row["several"]["error"])[0], rel=0.3)


def test_exact_peaks_stand_for_the_sweeps_of_a_study() -> None:
    """One whole study: its mean of the finest alone and its bands are those of the exact peaks at its points."""
    rig = RIGS[2]
    model = Assembled(rig, rig.case())
    found = uncertainty(model.case, samples=16, seed=3)
    inputs = inputs_of(model.case.uncertain, saltelli(len(rig.inputs), 16, 3))[:32]
    peaks = rig.exact(model, {each.key: column for each, column in zip(rig.inputs, inputs.T, strict=True)})
    assert found.mean_peak.alone.mean == pytest.approx(peaks.mean(), rel=2e-5)
    assert found.finest.peak.within[2] == pytest.approx(tuple(np.sort(peaks)[[9, 22]]), rel=1e-4)


def test_a_truth_known_to_an_error_widens_intervals_as_independent_ones_do() -> None:
    low, high = np.array([0.0, 0.0]), np.array([2.0, 1.0])
    assert hits(low, high, 1.5, 0.0) == 1
    assert hits(low, high, 1.5, 0.5) == 2
    assert hits(low, high, 4.0, 0.5) == 0


def test_the_table_has_every_rig_in_both_parts() -> None:
    said = table(STORED)
    assert all(said.count(f"| {rig.name} |") == 2 for rig in RIGS)
