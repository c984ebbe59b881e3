"""Uncertain inputs: what a case may say, indices and means of known functions, a rig in closed form."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize
from stand_in import curve

import vibeam
from vibeam.case.study_plans import Uncertain
from vibeam.casefile.read import parse
from vibeam.report import uncertainty as report
from vibeam.studies.uncertainty.mean_of_peak import Allocation, Pilot, _models, allocation, estimate
from vibeam.studies.uncertainty.orbit_peaks import OrbitPeaks, orbits_known
from vibeam.studies.uncertainty.samples import (
    ClosedFormPeaks,
    Responses,
    Sampler,
    Surface,
    _changes,
    inputs_of,
    known,
    runs,
)
from vibeam.studies.uncertainty.statistics import LEVELS, Distribution, indices, saltelli
from vibeam.studies.uncertainty.study import uncertainty

pytestmark = pytest.mark.usefixtures("undrawn")

CASES = Path(__file__).parents[3] / "cases"

CASE = """
title = "rig"
[beam]
length = "180 mm"
width = "20 mm"
thickness = "3 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.02
elements = 8
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "10 mm"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
amplitude = "0.02 mm"
[sweep]
frequency = { from = "30 Hz", to = "60 Hz", points = 7 }
direction = "up"
settle = 60
hold = 5
[fidelity.sdof]
reduction = "static_mode"
[fidelity.beam]
reduction = "modal"
modes = 3
"""


def said(text):
    return parse(f"{CASE}\n[uncertain]\n{text}").uncertain


def test_distributions_are_about_the_case_s_own_values():
    found = said(
        '"mass.mass" = "± 2 g"\n"beam.thickness" = "3 mm +/- 0.01 mm"\n"beam.damping_ratio" = "± 5 %"\n'
        'stop.restitution = "0.6 … 0.8"\n"stop.gap" = "9 mm ... 11 mm"\n"drive.amplitude" = "± 1 µm"'
    )
    assert found == (
        Uncertain("mass.mass", "normal", 0.2, 0.002),
        Uncertain("beam.thickness", "normal", 0.003, 1e-5),
        Uncertain("beam.damping_ratio", "normal", 0.02, 0.001),
        Uncertain("stop.restitution", "uniform", 0.6, 0.8),
        Uncertain("stop.gap", "uniform", 0.009, 0.011),
        Uncertain("drive.amplitude", "normal", 2e-5, 1e-6),
    )
    assert found[3].deviation == pytest.approx(0.2 / np.sqrt(12))
    text = parse(f'{CASE}\n[uncertain]\n"mass.mass" = "± 2 g"').text
    assert parse(text).uncertain == found[:1]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('"mass.mas" = "± 2 g"', "unknown key 'mass.mas'"),
        ('"sweep.hold" = "± 2"', "sweep is shared by all fidelities: uncertain may be beam"),
        ('"beam.elements" = "± 2"', "holds no single number that could be uncertain"),
        ('"beam.ends" = "± 2"', "holds no single number that could be uncertain"),
        ('"platform.mass" = "± 1 kg"', "has no number in this case: write the key itself first"),
        ('"mass.mass" = 3', "must be text, not 3"),
        ('"mass.mass" = "2 g"', "'2 g' is no distribution"),
        ('"mass.mass" = "± 2 mm"', "'2 mm' is a length, not a mass"),
        ('"mass.mass" = "± -2 g"', "must be ≥ 0"),
        ('"mass.mass" = "± 0 g"', "a standard deviation is above 0"),
        ('"mass.mass" = "0.3 kg ± 2 g"', "'0.3 kg' is not the value of the case itself, 0.2 in SI units"),
        (
            '"stop.restitution" = "± 0.1"',
            "5 standard deviations from 0.7, '1.2' is outside [0, 1]: write a range instead",
        ),
        ('"stop.restitution" = "0.6 … 1.2"', "is outside [0, 1]"),
        ('"stop.restitution" = "0.8 … 0.6"', "goes from the lower value to the higher one, not from 0.8 to 0.6"),
    ],
)
def test_what_is_no_distribution_is_refused_at_its_line(line, message):
    with pytest.raises(vibeam.CaseError, match=re.escape(message)) as raised:
        said(line)
    (fault,) = raised.value.faults
    assert fault.line == 1 + f"{CASE}\n[uncertain]\n".count("\n")
    assert fault.key.startswith("uncertain.")


def test_nothing_uncertain_and_odd_numbers_of_samples_are_refused():
    with pytest.raises(ValueError, match="the case says nothing of what is uncertain"):
        uncertainty(parse(CASE))
    with pytest.raises(ValueError, match="samples: 48, must be a power of two, 16 or more"):
        uncertainty(parse(f'{CASE}\n[uncertain]\n"mass.mass" = "± 2 g"'), samples=48)


def test_inputs_are_quantiles_of_their_distributions():
    shares = np.array([[0.5, 0.25], [0.8413447460685429, 1.0 - 1e-12]])
    found = inputs_of((Uncertain("a", "normal", 2.0, 0.5), Uncertain("b", "uniform", -1.0, 3.0)), shares)
    np.testing.assert_allclose(found, [[2.0, 0.0], [2.5, 3.0]], rtol=1e-9, atol=1e-9)


def test_indices_of_the_ishigami_function_are_the_known_ones():
    """f = sin x₁ + 7 sin² x₂ + 0.1 x₃⁴ sin x₁ on [−π, π]³: Ishigami & Homma 1990, in closed form."""
    x = np.pi * (2 * saltelli(3, 1024, 1) - 1)
    f = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    found = indices(np.stack([f, np.full(len(f), 2.0), np.where(x[:, 0] > 3, np.nan, f)]), 3, 0)
    np.testing.assert_allclose(found.first[:, 0], [0.3139, 0.4424, 0.0], atol=0.04)
    np.testing.assert_allclose(found.total[:, 0], [0.5576, 0.4424, 0.2437], atol=0.04)
    assert np.all((found.low[:, 0] < [0.5576, 0.4424, 0.2437]) & (found.high[:, 0] > [0.5576, 0.4424, 0.2437]))
    assert np.isnan(found.total[:, 1:]).all()
    again = indices(np.stack([f, np.full(len(f), 2.0)]), 3, 0)
    np.testing.assert_array_equal([again.low[:, 0], again.high[:, 0]], [found.low[:, 0], found.high[:, 0]])


def test_intervals_of_quantiles_hold_them():
    """Of independent samples of any distribution: 95 % at least, little more of a hundred."""
    drawn = np.random.default_rng(9).exponential(size=(2000, 100))
    truth = -np.log1p(-np.array(LEVELS))
    ends = np.array([Distribution.of(1.0, each).within for each in drawn])
    held = np.mean((ends[..., 0] < truth) & (truth < ends[..., 1]), axis=0)
    assert (held > 0.94).all()
    assert (held < 0.99).all()
    assert np.mean((ends[..., 0] < 1.3 * truth) & (1.3 * truth < ends[..., 1]), axis=0)[2] < 0.8


def test_few_samples_bound_no_outer_quantile():
    first, *_, last = Distribution.of(1.0, np.arange(32.0)).within
    assert first == (-np.inf, 4.0)
    assert last == (27.0, np.inf)
    assert Distribution.of(1.0, np.array([1.0, np.nan])).within == ()


def pilot(rng, count, correlation, costs):
    """Values of three models with exact correlations with the first, of other means and deviations."""
    one, two, three = rng.standard_normal((3, count))
    values = {
        "finest": 5 + 2 * one,
        "middle": 1 + 3 * (correlation[0] * one + np.sqrt(1 - correlation[0] ** 2) * two),
        "cheap": -4 + 0.5 * (correlation[1] * one + np.sqrt(1 - correlation[1] ** 2) * three),
    }
    return Pilot(values, dict(zip(values, costs, strict=True)))


def test_the_allocation_has_the_least_variance_for_its_cost():
    """Against a numerical minimum over the numbers of runs, with the variance of the nested estimator (eq. 3.3)."""
    known = pilot(np.random.default_rng(5), 100_000, (0.95, 0.8), (1.0, 0.1, 0.01))
    chosen = allocation(known)
    assert chosen.names == ("finest", "middle", "cheap")
    squares, costs = np.array([1, 0.95**2, 0.8**2, 0]), np.array([1.0, 0.1, 0.01])

    def variance(logs):
        numbers = np.exp(np.concatenate([[0.0], logs]))
        numbers *= 1 / (numbers @ costs)
        return float(np.sum((squares[:-1] - squares[1:]) / numbers))

    best = minimize(variance, [1.0, 3.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14})
    assert chosen.gain == pytest.approx(1 / best.fun, rel=0.01)
    np.testing.assert_allclose(chosen.ratios[1:], np.exp(best.x), rtol=0.02)
    np.testing.assert_allclose(chosen.weights[1:], [0.95 * 2 / 3, 0.8 * 2 / 0.5], rtol=0.01)


def test_a_model_that_follows_the_finest_exactly_is_not_run_without_end():
    one = np.random.default_rng(5).standard_normal(50)
    chosen = allocation(Pilot({"finest": one, "same": 2 * one + 1e-12 * one**2}, {"finest": 1.0, "same": 0.01}))
    assert chosen.counts(40, [80, 8000]) == (40, 8000)


def test_models_that_save_nothing_are_left_out():
    chosen = allocation(pilot(np.random.default_rng(5), 4000, (0.3, 0.1), (1.0, 0.9, 0.8)))
    assert chosen.names == ("finest",)
    assert chosen.gain == 1


def test_the_estimate_is_unbiased_covers_and_has_the_predicted_error():
    """100 repeats: 95 % intervals hold the truth 5 in 90 of them or more, the spread is that of eq. 3.6."""
    chosen = allocation(pilot(np.random.default_rng(5), 100_000, (0.95, 0.8), (1.0, 0.1, 0.01)))
    counts = chosen.counts(40, [np.inf] * 3)
    found = []
    for seed in range(100):
        drawn = pilot(np.random.default_rng(100 + seed), max(counts), (0.95, 0.8), (1.0, 0.1, 0.01)).values
        values = {name: drawn[name][:number] for name, number in zip(chosen.names, counts, strict=True)}
        found.append(estimate(chosen, values, 1.0, seed))
    means = np.array([each.mean for each in found])
    steps = np.array([1 - 0.95**2, 0.95**2 - 0.8**2, 0.8**2])
    error = 2 * np.sqrt(np.sum(steps / counts))
    assert means.mean() == pytest.approx(5, abs=4 * error / np.sqrt(100))
    assert means.std(ddof=1) == pytest.approx(error, rel=0.2)
    assert np.mean([each.error for each in found]) == pytest.approx(error, rel=0.1)
    assert 89 <= sum(each.low < 5 < each.high for each in found) <= 99


def test_intervals_of_few_samples_hold_as_often_as_of_many():
    """Of twelve samples the bootstrap's own 95 % hold in 89 of 100."""
    alone = Allocation(("finest",), (1.0,), (1.0,), 1.0)
    drawn = np.random.default_rng(11).standard_normal((600, 12))
    found = [estimate(alone, {"finest": row}, 1.0, 0) for row in drawn]
    assert np.mean([each.low < 0 < each.high for each in found]) > 0.93
    assert np.mean([abs(each.mean) < 1.96 * each.error for each in found]) > 0.93


def test_a_model_may_have_no_sample_more_than_the_one_before():
    """A model as dear as the finest: the second part of the nested samples is empty."""
    drawn = pilot(np.random.default_rng(8), 400, (0.95, 0.8), (1.0, 0.1, 0.01)).values
    chosen = Allocation(("finest", "middle", "cheap"), (1.0, 1.0, 10.0), (1.0, 0.6, 3.0), 2.0)
    values = {name: drawn[name][:count] for name, count in zip(chosen.names, (40, 40, 400), strict=True)}
    found = estimate(chosen, values, 1.0, 0)
    two = Allocation(("finest", "cheap"), (1.0, 10.0), (1.0, 3.0), 2.0)
    assert found.mean == pytest.approx(estimate(two, values, 1.0, 0).mean, rel=1e-12)
    assert found.low < found.mean < found.high
    parts = values["finest"] - 3 * values["cheap"][:40], 3 * values["cheap"]
    variance = parts[0].var() / 40 + parts[1].var() / 400 + 2 * np.cov(parts[0], parts[1][:40])[0, 1] / 400
    assert found.error == pytest.approx(np.sqrt(variance), rel=0.1)


@pytest.mark.parametrize("name", ["sdof", "own"])
def test_a_scene_of_other_values_is_that_of_the_case_read_anew(name):
    text = CASE + '[fidelity.own]\nreduction = "modal"\nmodes = 2\nset = { "mass.mass" = "0.25 kg" }\n'
    text += '[[added_mass]]\nmass = "2 g"\nposition = "50 mm"\n'
    keys = ("mass.mass", "beam.damping_ratio", "added_mass.0.mass", "stop.gap", "drive.amplitude", "beam.thickness")
    values = (0.21, 0.03, 0.003, 0.011, 3e-5, 0.0031)
    case = parse(text)
    settings = dict(zip(keys, values, strict=True))
    quick = case.model(name).at(settings).scene()
    own = {f'fidelity.own.set."{key}"': value for key, value in settings.items()}
    slow = case.with_keys(settings if name == "sdof" else own).scene_of(name)
    assert quick == slow
    assert quick != case.scene_of(name)


@pytest.fixture(scope="module")
def study():
    """A rig that never touches its stop answers in proportion to its drive, whatever the frequency.

    It settles for so long that a sweep costs more than the making of its model, whatever else the machine does.
    """
    text = CASE.replace("settle = 60", "settle = 3000")
    case = parse(f'{text}\n[uncertain]\n"drive.amplitude" = "± 1 %"\n"stop.restitution" = "0.6 … 0.8"')
    return uncertainty(case, samples=64)


def test_inputs_are_shown_in_the_units_of_all_other_tables(study):
    shown = report.inputs(study)
    columns = {str(each.header): list(map(str, each.cells)) for each in shown.columns}
    assert columns["unit"] == ["µm", ""]
    assert columns["mean"] == ["20", "0.7"]
    assert columns["distribution"][1] == "uniform, 0.6 … 0.8"
    assert "SI" not in str(shown.caption)


def test_indices_beyond_1_lie_in_their_panel(study):
    over = study.over_frequency
    scattered = replace(study, over_frequency=replace(over, total=over.total * 0 + np.array([[1.3], [-0.2]])))
    low, high = report.bands(scattered, report.units_in(study)).axes[1].get_ylim()
    assert low < -0.2 < 1.3 < high


def test_a_linear_rig_spreads_as_its_drive(study):
    for row in study.rows:
        assert row.peak.deviation / row.peak.nominal == pytest.approx(0.01, rel=0.03)
        assert row.peak.mean == pytest.approx(row.peak.nominal, rel=1e-3)
        np.testing.assert_allclose(row.bands[-1] / row.nominal, 1.01645, rtol=1.5e-3)
        np.testing.assert_allclose(row.bands[0] / row.nominal, 0.98355, rtol=1.5e-3)
        assert row.peak_frequency.deviation == 0
        assert np.isnan(row.jump.nominal)
    np.testing.assert_allclose(study.over_frequency.total[0], 1, atol=0.1)
    np.testing.assert_allclose(study.over_frequency.total[1], 0, atol=1e-12)


def test_the_nominal_curve_is_that_of_the_run(study):
    result = vibeam.run(study.case)
    for row in study.rows:
        np.testing.assert_array_equal(row.nominal, result[row.fidelity].up.amplitude)


def test_several_fidelities_give_the_mean_of_the_finest(study):
    found = study.mean_peak
    assert found.correlations["sdof"] == pytest.approx(1, abs=1e-6)
    assert found.several.mean == pytest.approx(study.finest.peak.nominal, rel=3e-3)
    assert found.several.low < found.several.mean < found.several.high


def test_errors_stand_side_by_side():
    text = (
        '[measured.lab]\nfidelity = "beam"\nquantity = "peak"\nvalue = "0.1 mm"\nuncertainty = "1 %"\nsource = "log"\n'
    )
    text += '[chosen_by]\n"drive.amplitude" = ["lab"]\n'
    study = uncertainty(parse(f'{CASE}\n{text}\n[uncertain]\n"drive.amplitude" = "± 1 %"'), samples=16)
    sdof, beam = study.errors
    assert sdof.form == pytest.approx(sdof.peak - beam.peak)
    assert beam.comparison == pytest.approx(beam.peak - 1e-4)
    known = [each for each in (beam.numerical, beam.given, 1e-6) if np.isfinite(each)]
    assert beam.validation == pytest.approx(np.sqrt(np.sum(np.square(known))))
    assert np.isnan(sdof.validation)
    assert "variance" not in report.answer(study)  # of one input
    said = [each for each in report.notes(study) if "validates" in each]
    assert said == ["The measured peak chose drive.amplitude of beam: it validates nothing there."]


def test_tables_sentences_and_files(study, tmp_path):
    shown = report.sheet(study)
    assert shown.answer.startswith("The peak of beam is ")
    assert "of their variance involves drive.amplitude; the peak of sdof is " in shown.answer
    assert shown.answer.endswith(" standard deviations of the samples.")
    assert any("multi-fidelity Monte Carlo" in line for line in shown.details)
    low, high = (f"{1e3 * end:.4g} mm" for end in study.finest.peak.within[2])
    (line,) = (each for each in shown.details if each.startswith("Quantiles of beam's peak"))
    assert f"50 % between {low} and {high}" in line
    assert [len(table.rows) for table in (*shown.tables, *shown.more)] == [2, 2, 2]  # no motion changes
    files = shown.write(tmp_path / "case.csv", study.case.figure)
    assert {path.suffix for path in files} == {".png", ".svg", ".csv"}
    with (tmp_path / "case.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 14
    assert float(rows[-1]["quantile_0.95"]) == pytest.approx(study.finest.bands[-1, -1])


def test_a_sample_that_the_case_may_not_have_is_refused():
    case = parse(f'{CASE}\n[uncertain]\n"mass.position" = "100 mm … 200 mm"')
    with pytest.raises(vibeam.CaseError, match=r"mass\.position"):
        Sampler(case, ("mass.position",))("sdof", np.array([[0.1], [0.2]]))


def test_changes_of_the_motion_are_found_in_the_way_of_the_sweep():
    """Impacts begin once before the first doubling; a sweep that begins with impacts has no begin of them."""
    seen = curve(np.arange(1.0, 9.0), 1e-3, np.array([-1, -1, 1, 1, 2, 2, 1, 2]))
    assert _changes(seen) == (3.0, 5.0)
    assert _changes(curve(np.arange(9.0, 1.0, -1.0), 1e-3, np.array([1, 1, 2, 1, -1, -1, 1, 1]))) == (3.0, 7.0)
    begin, doubling = _changes(curve(np.arange(1.0, 4.0), 1e-3, np.array([1, 0, 2])))
    assert np.isnan([begin, doubling]).all()


def test_where_impacts_begin_follows_the_gap():
    """One mode below its resonance: impacts begin where |u| of the linear response passes the gap, to the grid."""
    grid = '{ from = "20 Hz", to = "31 Hz", points = 61 }'
    text = CASE.replace('gap = "10 mm"', 'gap = "0.025 mm"').replace(
        '{ from = "30 Hz", to = "60 Hz", points = 7 }', grid
    )
    case = parse(text.replace("settle = 60", "settle = 300") + '\n[uncertain]\n"stop.gap" = "± 1 µm"')
    system, frequency = case.system("sdof"), np.sort(case.sweep.frequency)
    omega, natural = 2 * np.pi * frequency, system.omega[0]
    stiffness = natural**2 - omega**2 + 2j * system.zeta[0] * natural * omega
    reach = np.abs(system.contact[0] * system.load[0] * omega**2 * 2e-5 / stiffness)
    first = np.array([20, 35, 50])
    gaps = (reach[first - 1] + reach[first]) / 2
    found = Sampler(case, ("stop.gap",))("sdof", gaps[:, None])
    assert (found.begin <= frequency[first] + 1e-9).all()
    assert (found.begin >= frequency[first - 1] - 1e-9).all()  # a step of the sweep may strike a little before


def test_peaks_in_closed_form_are_those_of_the_flown_sweeps():
    """Struck at every frequency: the largest motion with one impact a period is the sweep's, where that has settled."""
    case = vibeam.load(CASES / "uncertain" / "neutral.toml", set={"sweep.frequency.points": 31})
    keys = tuple(each.key for each in case.uncertain)
    inputs = inputs_of(case.uncertain, np.random.default_rng(2).random((3, len(keys))))
    assert known(case, "beam")
    for name in ("sdof", "beam"):
        flown, closed = Sampler(case, keys)(name, inputs), ClosedFormPeaks(case, keys)(name, inputs)
        assert closed.peak == pytest.approx(flown.peak, rel=1e-4)


def test_a_rig_without_closed_forms_is_known_to_have_none():
    text = CASE.replace("restitution = 0.7", 'law = "linear"\nstiffness = "1e6 N/m"\ndamping = "1 N s/m"')
    assert not known(parse(text), "sdof")


def _square(fidelity, inputs):
    """A model whose peak is of degree two, without a value where its first input is large."""
    x, y, z = inputs.T
    peak = np.where(x > 2.5, np.nan, 3 - x + 0.5 * x * y + 2 * z**2)
    return Responses.of_peaks(fidelity, inputs, peak, np.full(len(inputs), 0.25))


def test_a_surface_of_degree_two_is_exact_for_one():
    rng = np.random.default_rng(4)
    assert runs(3) == 30  # ten coefficients
    found = Surface.of(_square, "beam", rng.uniform(0.5, 1.5, (runs(3), 3)))
    assert found.seconds == 7.5
    inputs = rng.uniform(0.7, 1.3, (9, 3))
    np.testing.assert_allclose(found("beam", inputs).peak, _square("beam", inputs).peak, rtol=1e-10)


def test_a_surface_goes_on_straight_where_it_has_no_runs():
    found = Surface.of(_square, "beam", np.random.default_rng(4).uniform(0.5, 1.5, (runs(3), 3)))
    line = np.ones((6, 3))
    line[:, 2] = [-3.0, -2.0, -1.0, 3.0, 4.0, 5.0]
    low, high = found("beam", line).peak.reshape(2, 3)
    np.testing.assert_allclose([np.diff(low, n=2), np.diff(high, n=2)], 0, atol=1e-12)
    assert high[0] < _square("beam", line[3:4]).peak[0] - 1  # 2 z² without end


def test_a_surface_needs_twice_as_many_peaks_as_coefficients():
    inputs = np.random.default_rng(4).normal(1.0, 0.5, (runs(3), 3))
    inputs[15:, 0] = 3.0
    assert Surface.of(_square, "beam", inputs) is None


def test_the_surface_of_a_rig_is_known_by_the_runs_that_it_took():
    """Amplitudes in proportion to the drive are of degree one: correlation 1 with the flown sweeps."""
    case = parse(f'{CASE}\n[uncertain]\n"drive.amplitude" = "± 1 %"\n"stop.restitution" = "0.6 … 0.8"')
    sampler = Sampler(case, tuple(each.key for each in case.uncertain))
    inputs = inputs_of(case.uncertain, np.random.default_rng(6).random((6, 2)))
    models = _models(sampler, {"sdof": sampler("sdof", inputs), "beam": sampler("beam", inputs)}, "beam", 0)
    assert [name for name in models if name.startswith("beam")] == [
        "beam", "beam, closed form", "beam, quadratic surface",
    ]  # fmt: skip
    surface = models["beam, quadratic surface"]
    np.testing.assert_allclose(surface.peaks(inputs)[0], models["beam"].known.peak, rtol=1e-3)
    assert surface.before > runs(2) * surface.seconds  # its own runs are no evaluations of a polynomial
    assert all(each.before == 0 for name, each in models.items() if name != "beam, quadratic surface")


STOPS = {
    "Hertz": 'law = "hertz"\nhertz_stiffness = 1e9',
    "linear": 'law = "linear"\nstiffness = "1e5 N/m"\ndamping = "10 N s/m"',
}


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
def test_peaks_by_orbits_are_those_of_sweeps_where_no_closed_form_is_known(stop, tmp_path):
    text = (CASES / "dtu_neutral.toml").read_text("utf-8").split("[reference.exact]")[0]
    text = text.replace('restitution = 0.72\nrestitution_of = "first mode"', stop)
    own = '\n[uncertain]\n"drive.voltage" = "± 2 %"\n"stop.gap" = "0 … 0.005 mm"\n'
    (tmp_path / "it.toml").write_text(text + own, "utf-8")
    case = vibeam.load(
        tmp_path / "it.toml",
        {"sweep.frequency.points": 25, "sweep.direction": "up", "sweep.settle": 400, "beam.elements": 8},
    )
    keys = tuple(each.key for each in case.uncertain)
    inputs = inputs_of(case.uncertain, np.random.default_rng(6).random((6, 2)))
    orbits, sampler = OrbitPeaks(case, keys), Sampler(case, keys)
    assert orbits_known(case, "two_modes")
    assert not known(case, "two_modes")
    swept, shot = sampler("two_modes", inputs), orbits("two_modes", inputs)
    assert np.ptp(swept.peak) > 1e-3 * swept.peak.max()
    np.testing.assert_allclose(shot.peak, swept.peak, rtol=1e-6)  # 400 periods leave less
    assert shot.seconds.mean() < swept.seconds.mean()
    assert orbits.begun("two_modes") > 0
