"""Uncertain inputs: what a case may say, indices and means of known functions, a rig in closed form."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import t as student
from stand_in import curve

import vibeam
from vibeam.case.study_plans import Uncertain
from vibeam.casefile.read import parse
from vibeam.report import uncertainty as report
from vibeam.runs.comparison.errors import Asked
from vibeam.runs.comparison.places import places_of
from vibeam.runs.comparison.responses import Response, compared
from vibeam.studies.uncertainty.replicates import quantiles, replicates, scrambled
from vibeam.studies.uncertainty.samples import Sampler, _changes, inputs_of
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
    f = ishigami(saltelli(3, 1024, 1))
    found = indices(np.stack([f, np.full(f.shape, 2.0), np.where(f > 3, np.nan, f)], axis=-1))
    np.testing.assert_allclose(found.first[:, 0], [0.3139, 0.4424, 0.0], atol=0.04)
    np.testing.assert_allclose(found.total[:, 0], [0.5576, 0.4424, 0.2437], atol=0.04)
    assert np.isnan(found.total[:, 1:]).all()
    assert np.isnan(indices(ishigami(saltelli(3, 16, 1))[..., None]).low).all()  # two samples a replicate


def ishigami(shares):
    x = np.pi * (2 * shares - 1)
    return np.sin(x[..., 0]) + 7 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0])


def test_replicates_are_independent_scramblings():
    found = scrambled(2, 128, 5)
    assert found.shape == (replicates(128), 16, 2)
    assert len(np.unique(found)) == found.size
    for each in found:  # one point in each of sixteen intervals
        np.testing.assert_array_equal(
            np.sort((16 * each).astype(int), axis=0), np.arange(16)[:, None].repeat(2, axis=1)
        )
    np.testing.assert_array_equal(found, scrambled(2, 128, 5))
    assert not np.isin(found, scrambled(2, 128, 6)).any()


@pytest.mark.parametrize("samples", [32, 128])
def test_intervals_of_a_known_function_hold_its_mean_quantiles_and_indices(samples):
    """A hundred studies of Ishigami's function, whose mean and indices are known and whose quantiles a fine grid tells.

    An interval of 95 % holds in 87 of a hundred at least (three standard deviations of a count), those of the mean in
    93; none is more than 1.3 times as wide as the scatter of the estimates asks for.
    """
    count, axis = replicates(samples), (np.arange(100) + 0.5) / 100
    grid = ishigami(np.stack(np.meshgrid(axis, axis, axis), axis=-1)).ravel()
    found = [ishigami(saltelli(3, samples, seed)) for seed in range(100)]
    spreads = [Distribution.of(0.0, each[:, :2].reshape(count, -1)) for each in found]
    width = student.ppf(0.975, count - 1)

    def held(values, ends, truth):
        low, high = np.array(ends).T
        ratio = np.mean(high - low) / 2 / (width * np.std(values, ddof=1))
        return int(np.sum((low <= truth) & (truth <= high))), ratio

    hits, ratio = held([each.mean for each in spreads], [each.mean_within for each in spreads], 3.5)
    assert hits >= 93
    assert ratio < 1.3
    for place, truth in enumerate(quantiles(grid, LEVELS)):
        ends = [each.within[place] for each in spreads]
        if np.isfinite(ends).all():
            hits, ratio = held([each.quantiles[place] for each in spreads], ends, truth)
            assert hits >= 87
            assert ratio < 1.3
    assert np.isfinite([each.within[2] for each in spreads]).all()
    if samples >= 64:
        every = [indices(each[..., None]) for each in found]
        for place, truth in enumerate((0.5576, 0.4424, 0.2437)):
            ends = [(each.low[place, 0], each.high[place, 0]) for each in every]
            hits, ratio = held([each.total[place, 0] for each in every], ends, truth)
            assert hits >= 87
            assert ratio < 1.3


def test_few_samples_bound_no_outer_quantile():
    first, *_, last = Distribution.of(1.0, np.random.default_rng(1).random((8, 16))).within
    assert (first, last) == ((-np.inf, np.inf), (-np.inf, np.inf))
    assert Distribution.of(1.0, np.array([[1.0, np.nan]])).within == ()
    some = np.random.default_rng(1).random((8, 32))
    some[3] = np.nan  # a replicate without the number
    found = Distribution.of(1.0, some)
    assert found.share == 7 / 8
    assert not np.isfinite([found.mean_within, *found.within]).any()


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
        assert row.peak.deviation / row.peak.nominal == pytest.approx(0.01, rel=0.08)
        assert row.peak.mean == pytest.approx(row.peak.nominal, rel=1e-3)
        np.testing.assert_allclose(row.bands[-1] / row.nominal, 1.01645, rtol=3e-3)
        np.testing.assert_allclose(row.bands[0] / row.nominal, 0.98355, rtol=3e-3)
        assert row.peak_frequency.deviation == 0
        assert np.isnan(row.jump.nominal)
    assert (study.over_frequency.low[0] < 1).all()
    assert (study.over_frequency.high[0] > 1).all()
    np.testing.assert_allclose(study.over_frequency.total[0], 1, atol=0.2)
    np.testing.assert_allclose(study.over_frequency.total[1], 0, atol=1e-12)


def test_the_nominal_curve_is_that_of_the_run(study):
    result = vibeam.run(study.case)
    for row in study.rows:
        np.testing.assert_array_equal(row.nominal, result[row.fidelity].up.amplitude)


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
    made, line = shown.details
    assert made.startswith("64 samples of 2 inputs: 8 independent scramblings of 8 Sobol' points each")
    assert line.startswith("Mean and quantiles of beam's peak, 95 % intervals: mean between ")
    low, high = (f"{1e3 * end:.4g} mm" for end in study.finest.peak.within[2])
    assert f"50 % between {low} and {high}" in line
    assert [len(table.rows) for table in (*shown.tables, *shown.more)] == [2, 2, 1, 2]  # no motion changes
    files = shown.write(tmp_path / "case.csv", study.case.figure)
    assert {path.suffix for path in files} == {".png", ".svg", ".csv"}
    with (tmp_path / "case.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 14
    assert float(rows[-1]["quantile_0.95"]) == pytest.approx(study.finest.bands[-1, -1])


def test_a_sample_that_the_case_may_not_have_is_refused():
    case = parse(f'{CASE}\n[uncertain]\n"mass.position" = "100 mm … 200 mm"')
    with pytest.raises(vibeam.CaseError, match=r"mass\.position"):
        Sampler(case, ("mass.position",)).each(np.array([[0.1], [0.2]]), {"sdof": np.array([True, True])})


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
    found = Sampler(case, ("stop.gap",)).each(gaps[:, None], {"sdof": np.ones(3, dtype=bool)})["sdof"]
    assert (found.begin <= frequency[first] + 1e-9).all()
    assert (found.begin >= frequency[first - 1] - 1e-9).all()  # a step of the sweep may strike a little before


@pytest.mark.parametrize("direction", ["up", "down"])
def test_samples_side_by_side_are_those_of_the_case_with_their_values(direction):
    """Two fidelities of one sample from one structure; each row is that of a sweep of the case read anew."""
    case = vibeam.load(
        CASES / "uncertain" / "neutral.toml",
        {"sweep.frequency.points": 7, "beam.elements": 8, "sweep.direction": direction, "reference": None},
    )
    keys = tuple(each.key for each in case.uncertain)
    inputs = inputs_of(case.uncertain, np.random.default_rng(2).random((5, len(keys))))
    asked = {"sdof": np.array([True, False, True, True, False]), "beam": np.ones(5, dtype=bool)}
    found = Sampler(case, keys).each(inputs, asked)
    for name, which in asked.items():
        for row, values in enumerate(inputs[which]):
            own = case.with_keys(dict(zip(keys, values.tolist(), strict=True)))
            alone = Sampler(own, ()).nominal(name)
            np.testing.assert_allclose(found[name].amplitude[row], alone.amplitude[0], rtol=1e-9)
            assert found[name].peak[row] == pytest.approx(alone.peak[0], rel=1e-9)


def test_errors_beside_the_finest_are_those_of_the_runs_of_each_sample() -> None:
    """Contact begins between two of seven frequencies; every sample is run as a case of its own."""
    text = f'{CASE}[uncertain]\n"stop.gap" = "0.08 mm … 0.14 mm"\n'.replace('"10 mm"', '"0.1 mm"')
    case = parse(text)
    study = uncertainty(case, samples=16)
    inputs = inputs_of(case.uncertain, saltelli(1, 16, 0)).reshape(16, 3, 1)[:, :2].reshape(-1)
    sizes, widths, enough = [], [], []
    for gap in inputs.tolist():
        runs = vibeam.run(case.with_keys({"stop.gap": gap}), show=False)
        responses = [Response({"up": places_of(dict(runs[name].items())["up"])}) for name in ("sdof", "beam")]
        found = compared(*responses)
        sizes.append(found.amplitude_error)
        widths.append(max(found.frequency_error, found.kind_width))
        enough.append(found.suffices(Asked.of(0.05)))
    row = study.rows[0]
    known = np.array(sizes)[np.isfinite(sizes)]
    assert np.ptp(known) > 0
    np.testing.assert_allclose(row.amplitude_error.quantiles, quantiles(known, LEVELS), rtol=1e-9)
    np.testing.assert_allclose(row.end_error.quantiles, quantiles(np.array(widths), LEVELS), rtol=1e-9)
    assert row.suffices == pytest.approx((enough.count(True) / 32, 1 - enough.count(False) / 32))
    assert study.finest.suffices == (1.0, 1.0)
    table = report.beside(study)
    assert table is not None
    assert len(table.rows) == 1


def test_a_fidelity_that_is_the_finest_again_may_suffice_in_every_sample() -> None:
    """Its ends are known to steps of 5 Hz alone: surely it does where there is none."""
    text = f'{CASE}[uncertain]\n"stop.gap" = "± 1 %"\n'.replace('"10 mm"', '"0.1 mm"')
    study = uncertainty(parse(f'{text}[fidelity.again]\nreduction = "modal"\nmodes = 3\n'), samples=16)
    [again] = [row for row in study.rows[:-1] if row.fidelity in {"again", "beam"}]
    assert (again.suffices[1], again.end_error.quantiles[-1]) == (1.0, 0.0)
    assert again.amplitude_error.quantiles[-1] == 0.0
