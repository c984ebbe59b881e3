"""vibeam fit where a bound ends an interval, and where the F test rejects a model whose misfit is likely."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.curves.record import ReferenceCurve
from vibeam.report.fit import fit_answer, sheet
from vibeam.studies.fit.estimate import minimise
from vibeam.studies.fit.profile import LEVEL

RIG = """
[modes]
frequency = {modes}
modal_mass = "1 kg"
damping_ratio = {zeta}
contact = {contact}
sensor = {sensor}
base = {base}
[stop]
gap = "{gap} mm"
restitution = 0.65
[drive]
amplitude = "{amplitude} mm"
[sweep]
frequency = {{ from = "{first} Hz", to = "{last} Hz", points = 41 }}
direction = "up"
settle = 200
hold = 20
[fidelity.beam]
reduction = "full"
[fit.keys]
"stop.restitution" = [0.3, 0.97]
"stop.gap" = [{low_gap}, {high_gap}]
"drive.amplitude" = [{low}, {high}]
"""

FREE = {
    "modes": '["9.0505 Hz"]', "zeta": 0.011435, "contact": [0.9641], "sensor": [0.9644], "base": [0.8823],
    "gap": 2.157, "amplitude": 0.1916, "first": 7.6, "last": 10.2, "low_gap": '"0.5 mm"', "high_gap": '"5 mm"',
    "low": '"0.05 mm"', "high": '"0.45 mm"',
}  # fmt: skip

#: Frequency Hz, amplitude mm: another program's, with noise of 1 %; gap 1.65935 mm, amplitude 0.15034 mm, R 0.6455.
ENDED = (
    (7.693, 0.32773), (7.829, 0.376346), (7.964, 0.439481), (8.1, 0.510771), (8.236, 0.610954), (8.372, 0.755689),
    (8.507, 0.951787), (8.643, 1.30109), (9.05, 1.66306), (9.186, 1.67377), (9.322, 1.67167), (9.458, 1.66407),
    (9.594, 1.66935), (9.729, 1.696), (9.865, 1.69051), (10.001, 1.73178), (10.137, 1.72526),
)  # fmt: skip

FALLING = {
    "modes": '["12.6553 Hz", "54.6315 Hz"]', "zeta": 0.00671, "contact": [1.3871, 0.4091], "sensor": [0.9448, 0.2721],
    "base": [1.0598, 0.275], "gap": 0.001, "amplitude": 0.09578, "first": 23.0, "last": 28.5, "low_gap": '"-0.58 mm"',
    "high_gap": '"0.58 mm"', "low": '"0.025 mm"', "high": '"0.2245 mm"',
}  # fmt: skip

#: The same with noise of 5 % of a restitution that falls with the impact velocity.
LAW = (
    (23.033, 0.174084), (23.335, 0.229879), (23.637, 0.281806), (23.94, 0.339087), (24.242, 0.378463),
    (24.544, 0.423682), (24.847, 0.479086), (25.149, 0.477306), (25.451, 0.515548), (25.754, 0.444854),
    (26.056, 0.425674), (26.358, 0.383679), (27.87, 0.335225), (28.172, 0.415045), (28.474, 0.395639),
)  # fmt: skip


def fitted(values, points, noise):
    """Fit of a rig to points."""
    case, (frequency, value) = parse(RIG.format(**values)), np.array(points).T
    given = case.with_reference(
        "lab", ReferenceCurve.of(frequency, 1e-3 * value, uncertainty=noise * 1e-3 * value), "beam"
    )
    return vibeam.fit(replace(given, fit=replace(case.fit, references=("lab",))))


def test_a_key_that_another_one_s_bound_ends_is_determined_and_the_bound_is_named():
    """Gap and amplitude are known to 1 % at any R within its bounds, and R is not."""
    study = fitted(FREE, ENDED, 0.01)
    restitution, gap, amplitude = study.rows
    assert not restitution.determined
    assert (restitution.low_bound, restitution.high_bound) == ("stop.restitution = 0.3", "stop.restitution = 0.97")
    assert gap.low < 1.65935e-3 < gap.high
    assert amplitude.low < 1.5034e-4 < amplitude.high
    assert (gap.low_bound, gap.high_bound) == ("stop.restitution = 0.3", "stop.restitution = 0.97")
    told = fit_answer(study)
    assert told.startswith("The 17 points do not determine stop.restitution within the bounds; --next")
    assert "stop.gap is 1.66 mm (1.641 mm by the bound stop.restitution = 0.3 to 1.671 mm by the bound" in told
    assert "(0.1492 mm to 0.1513 mm, both by the bound stop.restitution = 0.97)" in told


@pytest.mark.parametrize("key", [1, 2], ids=["gap", "amplitude"])
def test_an_end_is_the_crossing_of_the_least_misfit_over_all_of_another_key(key):
    """Over R from bound to bound the least is at the bound that is named, and at the level: no other minimum."""
    study = fitted(FREE, ENDED, 0.01)
    found = study.profiles[key]
    for end, bound in zip((found.low, found.high), found.open, strict=True):
        rise = [
            minimise(study.problem, study.minimum.x, study.minimum.chosen, {0: share, key: end})[1]
            for share in np.linspace(0.0, 1.0, 9)
        ]
        assert int(np.argmin(rise)) == (0, 8)[bound % 2]
        assert min(rise) - study.minimum.misfit == pytest.approx(LEVEL, rel=0.03)
        assert bound // 2 == 0


def test_the_first_sentence_is_that_the_residuals_reject_the_model():
    """R falls with v: the misfit alone is likely at 1 %, the F test is below 0.1 %."""
    study = fitted(FALLING, LAW, 0.05)
    assert study.judgement.described
    assert study.judgement.rejected
    made = sheet(study)
    assert made.answer.startswith("The residuals reject this model (F test, p below 0.1 %): over the impact velocity")
    assert "a law R(v); χ² = 24.8 for 12 degrees of freedom, p = 1.6 %. Its intervals do not hold." in made.answer
    assert not any("have a pattern" in each for each in made.notes)
    assert not replace(study.judgement, patterns=[]).rejected
    assert "describe the 15 points" in fit_answer(replace(study, judgement=replace(study.judgement, patterns=[])))
