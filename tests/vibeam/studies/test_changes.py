"""Changes of numbers between two variants, in units of what is allowed."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest
from effect_studies import PEAK, case_of

from vibeam.runs.comparison.errors import ResponseComparison
from vibeam.studies.changes import AMPLITUDES, ENDS, KINDS, ModelVariant, changes
from vibeam.studies.effects import influence
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import Ensemble, ensembles


def ensemble(value: float) -> Ensemble:
    """A motion of which one number is known."""
    return Ensemble("", 1, {PEAK: np.array([[value]])}, np.zeros((1, 1)))


@pytest.mark.parametrize(
    ("ours", "whole", "share"),
    [(1.03, 1.0, 3.0), (0.98, 1.0, 2.0), (nan, 1.0, inf), (1.0, nan, inf), (1.0, 0.0, inf), (0.0, 0.0, 0.0)],
)
def test_a_change_counts_in_units_of_what_is_allowed_and_is_never_dropped(
    ours: float, whole: float, share: float
) -> None:
    *_, found = changes(ensemble(whole), ensemble(ours), ResponseComparison(), {PEAK: 0.01})
    assert found.share == pytest.approx(share)


def test_a_number_that_neither_has_is_no_change() -> None:
    *_, found = changes(ensemble(nan), ensemble(nan), ResponseComparison(), {PEAK: 0.01})
    assert not found.share > 0


def test_of_a_comparison_what_it_may_be_off_at_most_counts() -> None:
    """Two sweeps of one degree of freedom, whose own numbers are those of the comparison."""
    case = case_of(sweep__direction="both")
    ours, whole = (ensembles([(each, "beam")], [PEAK])[0] for each in (case_of(mass__rotary_inertia=None), case))
    study = influence(case)
    [row] = [each for each in study.rows if each.effect == "mass.rotary_inertia"]
    found = row.without.comparison
    assert found is not None
    assert found.scattered is not None
    by_number = {each.number: each for each in row.without.changes}
    assert by_number[AMPLITUDES].size == pytest.approx(found.scattered.most)
    assert by_number[ENDS].size == pytest.approx(max((abs(each.error) + each.open for each in found.ends), default=0))
    assert by_number[KINDS].size == pytest.approx(max((each.width + each.open for each in found.kinds), default=0))
    peaks = [float(each.of(PEAK)[0, 0]) for each in (ours, whole)]
    assert by_number[PEAK].change == pytest.approx(peaks[0] / peaks[1] - 1)
    assert by_number[PEAK].allowed == inf


@pytest.mark.parametrize("struck", [([0.1, 0.2], [np.nan, np.nan]), ([np.nan, np.nan], [0.1, 0.2])])
def test_contact_in_one_model_alone_is_never_within_what_is_allowed(struck: tuple[list[float], list[float]]) -> None:
    """Under a record whose motions have no impact there is no hardest one."""
    peak, hardest = AskedNumber("peak", "tip"), AskedNumber("hardest_impact")
    reference, other = (
        Ensemble("beam", 2, {peak: np.ones((1, 2)), hardest: np.array([each])}, np.ones((1, 2))) for each in struck
    )
    found = changes(reference, other, limits={peak: 0.05, hardest: 0.05})
    assert [each.share for each in found] == [0.0, np.inf]
    assert ModelVariant(found).worst == np.inf
