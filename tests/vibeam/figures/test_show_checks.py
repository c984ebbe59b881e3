"""What is wrong with figures, with numbers expected of them and with the measuring chain is told with its cure."""

from __future__ import annotations

import numpy as np
import pytest
from figures import SDOF, beam, forced, free
from stand_in import SI

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures import FIGURES
from vibeam.figures.sheet import module_of
from vibeam.solvers import SOLVERS
from vibeam.studies.regression import check as expect

HARMONICS = '[show.it]\nkind = "harmonics"'
EXPECT = '[expect.it]\nfidelity = "sdof"\nvalue = {value}\ntolerance = "0.1 %"\n'


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ('[show.it]\nkind = "ringing"', 'show.it.near: missing: kind = "ringing" needs it'),
        ('[show.it]\nkind = "modal"\nperiods = 3', 'show.it.periods: kind = "modal" has no use for it: leave it away'),
        (HARMONICS + "\nsubdivision = 3\nperiods = 4", "show.it.periods: 4 drive periods hold no whole number of the "
         "longest ones: write a multiple of subdivision = 3"),
        (HARMONICS + '\noutput = "tip"', 'show.it.output: a single degree of freedom has no "tip": write "sensor"'),
        (HARMONICS + '\n[fidelity.steps]\nsolver = "direct"', 'show.it.fidelities: kind = "harmonics" needs an exact '
         'motion, "direct" of steps gives samples: name in fidelities those by flight, orbit, mapping'),
        ('[show.it]\nkind = "portrait"\nfrequency = 1\n[measurement]\nsampling = 9\n[fidelity.steps]\n'
         'solver = "moreau"',
         'show.it.fidelities: [measurement] needs an exact motion, "moreau" of steps gives samples: name in fidelities '
         "those by flight, orbit, mapping"),
        ('[measurement]\nsampling = 9\norder = 3',
         'measurement.order: goes with a filter: write low_pass = "bessel", or leave it away'),
        ('[measurement]\nsampling = 9\nlow_pass = "bessel"\ncut_off = 1',
         "measurement.order: missing: the filter needs it; write order = 4"),
        ('[measurement]\nsampling = 9\nlow_pass = "bessel"\ncut_off = 1\norder = 4\nripple = 1',
         'measurement.ripple: goes with low_pass = "elliptic" alone: leave it away'),
        ('[measurement]\nsampling = 9\nlow_pass = "elliptic"\ncut_off = 1\norder = 4\nripple = 9\nattenuation = 2',
         "measurement.ripple: 9 dB is not below attenuation, 2 dB"),
        ("[measurement]\nsampling = 9\nnoise = 1e-6", "measurement.seed: missing: the noise needs one; write seed = 1"),
        ("[measurement]\nsampling = 9\nseed = 1", "measurement.seed: goes with noise: leave it away"),
        (EXPECT.format(value=1) + 'quantity = "harmonic"',
         "expect.it.show: missing: name the [show.NAME] that 'harmonic' is read off"),
        (HARMONICS + "\n" + EXPECT.format(value=1) + 'quantity = "harmonic"\nshow = "at"\nfrequency = 1',
         "expect.it.show: no [show.at]; known here: it"),
        (HARMONICS + "\n" + EXPECT.format(value=1) + 'quantity = "jump"\nshow = "it"\nfrequency = 1\nnumber = 1',
         'expect.it.quantity: kind = "harmonics" has "harmonic"'),
        (HARMONICS + "\n" + EXPECT.format(value=1) + 'quantity = "harmonic"\nshow = "it"\nfrequency = 1',
         'expect.it.number: missing: which order of kind = "harmonics" is meant; write number = 2'),
        (HARMONICS + "\n" + EXPECT.format(value=1) + 'quantity = "harmonic"\nshow = "it"\nnumber = 1',
         'expect.it.frequency: missing: kind = "harmonics" is read at one frequency'),
        ('[show.it]\nkind = "modal"\n' + EXPECT.format(value=1)
         + 'quantity = "mode_frequency"\nshow = "it"\nnumber = 1\nfrequency = 1',
         'expect.it.frequency: kind = "modal" has no use for it: leave it away'),
    ],
)  # fmt: skip
def test_faults(lines: str, fault: str) -> None:
    with pytest.raises(CaseError) as caught:
        parse(SDOF + lines + "\n", set=SI)
    assert [str(each).split(": ", 1)[1] for each in caught.value.faults] == [fault]


def test_a_platform_that_is_not_there_shows_nothing() -> None:
    with pytest.raises(CaseError, match="the platform has no motion of its own"):
        beam("portrait", frequency="15.5 Hz", output="platform")


@pytest.mark.parametrize(("value", "passed"), [(1.0, True), (1.002, False)])
def test_a_number_read_off_a_figure(value: float, passed: bool) -> None:
    lines = 'quantity = "harmonic"\nshow = "it"\nnumber = 1\nfrequency = "1.8 rad/s"'
    case = free(HARMONICS, EXPECT.format(value=value * forced(1.8)) + lines)
    (row,) = expect.check(case, vibeam.run(case, show=False))
    assert row.passed == passed
    (again,) = expect.check(case, vibeam.run(case))  # from the run's own figure
    assert again.worst == row.worst


def test_a_figure_without_a_motion_is_missed_with_its_reason() -> None:
    lines = 'quantity = "true_restitution"\nshow = "it"\nfrequency = "1.8 rad/s"'
    case = free('[show.it]\nkind = "restitution"', EXPECT.format(value=0.9) + lines)
    (row,) = expect.check(case, vibeam.run(case, show=False))
    assert not row.passed
    assert row.notes[0].startswith("no impacts")


def test_a_chain_changes_no_sweep_and_every_figure() -> None:
    chain = '[measurement]\nsampling = "10 Hz"'
    bare, measured = free(HARMONICS), free(HARMONICS, chain)
    assert bare.key == measured.key
    assert bare.shows["it"].key != measured.shows["it"].key
    assert bare.chain is None


def test_a_fidelity_may_have_a_chain_of_its_own_or_none() -> None:
    case = free(
        '[measurement]\nsampling = "10 Hz"\nlow_pass = "bessel"\norder = 4\ncut_off = "1 Hz"\nnoise = 1e-6\nseed = 3',
        '[fidelity.sharp]\nset = { "measurement.low_pass" = "elliptic" }',
        '[fidelity.exact]\nwithout = ["measurement"]',
    )
    observe, chain = vibeam.observe, case.chain_of("sdof")
    assert chain == observe.Chain(10.0, observe.LowPass("bessel", 4, 1.0), 1e-6, 3)
    sharp = case.chain_of("sharp")
    assert sharp is not None
    assert sharp.low_pass == observe.LowPass("elliptic", 4, 1.0, 0.1, 60.0)
    assert case.chain_of("exact") is None
    assert "[measurement]" in case.text
    assert parse(case.text).chain == chain


def test_a_filter_has_settled_when_it_says() -> None:
    low_pass = vibeam.observe.LowPass("butterworth", 1, 1.0)
    assert low_pass.settling(1e-3) == pytest.approx(np.log(1e3) / (2 * np.pi))


def test_what_is_declared_is_there() -> None:
    from importlib import import_module

    for declared in SOLVERS.values():
        module, kind = str(declared.home).split(":")
        made = getattr(import_module(module), kind)
        methods = {"exact": "simulate", "samples": "motion"}
        assert {name for name, method in methods.items() if hasattr(made, method)} == {declared.motion} - {"none"}
        assert declared.curves == hasattr(made, "curves")
    read = [(name, unit) for kind in FIGURES.values() for name, unit in kind.reads.items()]
    assert len(dict(read)) == len(set(read))  # a name has one unit, whichever kinds have it
    case = free(HARMONICS)
    assert module_of(case.shows["it"]).__name__ == FIGURES["harmonics"].home
