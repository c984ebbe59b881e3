"""Record cases: what [drive], [record] and [start] say, and what is told of what cannot be."""

# ruff: noqa: E501  (a message stays on its line)

import re
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

import vibeam
from vibeam.casefile.read import parse
from vibeam.runs.transient.overview import remarks_on

RIG = {
    "beam": {
        "length": "180 mm",
        "width": "15 mm",
        "thickness": "0.5 mm",
        "youngs_modulus": "210 GPa",
        "density": "7850 kg/m^3",
        "damping_ratio": 0.017,
    },
    "mass": {"mass": "0.2 kg", "position": "132 mm"},
    "stop": {"gap": "1 mm", "restitution": 0.7},
    "sensor": {"position": "100 mm"},
    "fidelity": {
        "one": {"reduction": "static_mode"},
        "eight": {"reduction": "modal", "modes": 8},
    },
}
PULSE = {"shape": "half_sine", "acceleration": "50 g", "duration": "11 ms"}
WHITE = {"density": "0.01 g^2/Hz", "band": ["10 Hz", "2 kHz"], "seed": 3}
ONE_MODE = {"natural_frequency": "1 rad/s", "damping_ratio": 0.02}
PLATFORM = {"mass": "5 kg", "frequency": "3 Hz", "damping_ratio": 0.05, "coupling": "two-way"}
GRAVITY = 9.80665


def tables(drive=None, record=None, start=None, **more):
    own = {"drive": drive, "record": record or {"duration": "0.5 s"}, "start": start}
    return {**RIG, **{name: each for name, each in own.items() if each is not None}, **more}


def case(*said, **more):
    return vibeam.Case.of(tables(*said, **more))


def faults(*said, **more):
    with pytest.raises(vibeam.CaseError) as caught:
        case(*said, **more)
    return [str(each).removeprefix("case.toml: ") for each in caught.value.faults]


@pytest.mark.parametrize(
    ("drive", "at", "value"),
    [
        (PULSE, 0.0055, 50 * GRAVITY),
        ({"shape": "saw_tooth", "acceleration": "10 g", "duration": "10 ms"}, 0.0075, 7.5 * GRAVITY),
        ({"shape": "initial_saw_tooth", "acceleration": "10 g", "duration": "10 ms"}, 0.0075, 2.5 * GRAVITY),
        ({"shape": "trapezoid", "acceleration": "10 g", "duration": "10 ms", "rise": "2 ms"}, 0.001, 5 * GRAVITY),
        ({"shape": "step", "acceleration": "1 g", "delay": "0.1 s"}, 0.45, GRAVITY),
        ({"shape": "step", "acceleration": "1 g", "delay": "0.1 s"}, 0.05, 0.0),
        ({"shape": "sine", "acceleration": "1 g", "frequency": "10 Hz"}, 0.475, -GRAVITY),
        ({"shape": "chirp", "acceleration": "1 g", "frequency": ["1 Hz", "3 Hz"]}, 0.25, GRAVITY * np.sin(0.75 * pi)),
        ({"shape": "tone_burst", "acceleration": "1 g", "frequency": "10 Hz", "cycles": 2, "window": "rectangular"},
         0.025, GRAVITY),
        ({"shape": "sine_beat", "acceleration": "1 g", "frequency": "10 Hz", "cycles": 2.5}, 0.125, GRAVITY),
        ({"shape": "half_sine", "force": "20 N", "at": "100 mm", "duration": "11 ms"}, 0.0055, 20.0),
        ({"shape": "half_sine", "moment": "2 N m", "at": "100 mm", "duration": "11 ms"}, 0.0055, 2.0),
    ],
)  # fmt: skip
def test_a_shape_is_the_record_of_its_peak(drive: dict, at: float, value: float) -> None:
    made = case(drive).input("one")
    assert made.at(at) == pytest.approx(value, rel=1e-9, abs=1e-12)
    of = next((name for name in ("force", "moment") if name in drive), "acceleration")
    assert made.quantity == of
    scaled = case(drive).input("one", level=2.0)
    assert scaled.at(at) == pytest.approx(2 * value, rel=1e-9, abs=1e-12)


def test_a_pulse_has_a_direction_and_a_sine_an_amplitude() -> None:
    away = case(PULSE | {"acceleration": "-50 g"})
    assert away.input("one").at(0.0055) == pytest.approx(-50 * GRAVITY, rel=1e-9)
    both = case(PULSE, {"duration": "0.1 s", "values": [-1, 1]})
    assert both.record.values == (-1.0, 1.0)
    assert both.input("one", level=-1.0).at(0.0055) == pytest.approx(-50 * GRAVITY, rel=1e-9)
    assert faults(PULSE, {"duration": "0.1 s", "over": "speed", "values": [-1, 1]}) == [
        "record.values.0: speed: -1 must be > 0"
    ]
    with pytest.raises(vibeam.CaseError, match=r"drive\.acceleration: must be ≥ 0: it is the amplitude of a sine"):
        vibeam.load("cases/dtu_neutral.toml", {"drive": {"acceleration": "-1 g"}})


def test_a_held_shape_lasts_to_the_end_whatever_the_speed() -> None:
    held = case({"shape": "step", "acceleration": "1 g"})
    for speed in (0.5, 1.0, 2.0):
        assert held.input("one", speed=speed).end == pytest.approx(0.5, rel=1e-14)


def test_a_random_input_is_a_realisation_for_each_seed() -> None:
    random = case(WHITE, {"duration": "0.1 s", "realisations": 3})
    assert random.record.seeds == (3, 4, 5)
    made = {seed: random.input("eight", seed=seed) for seed in random.record.seeds}
    assert made[3] == random.input("one") == vibeam.Record.random(0.01 * GRAVITY**2, 0.1, seed=3, band=(10.0, 2000.0))
    assert len({each.digest for each in made.values()}) == 3
    per_hertz = [["10 Hz", "0.01 g^2/Hz"], ["2 kHz", f"{0.01 * GRAVITY**2} (m/s^2)^2/Hz"]]
    table = case({"density": per_hertz, "seed": 3})
    assert table.input("one").quantity == "acceleration"
    forced = case({"density": "0.01 N^2/Hz", "band": ["10 Hz", "2 kHz"], "seed": 3, "at": "100 mm"})
    assert forced.input("one").quantity == "force"


def test_a_file_is_read_in_its_unit_and_says_how_long_it_is(tmp_path: Path) -> None:
    (tmp_path / "shock.csv").write_text("t [s],a [g]\n" + "".join(f"{i / 1000},{i % 7}\n" for i in range(101)))
    text = vibeam.Case.of(tables(PULSE)).text
    text = re.sub(r"(?s)\[drive\].*?\n\n", '[drive]\nfile = "shock.csv"\n\n', text).replace("duration = 0.5\n", "")
    (tmp_path / "own.toml").write_text(text)
    measured = vibeam.load(tmp_path / "own.toml")
    assert measured.record.duration == pytest.approx(0.1, rel=1e-12)
    assert measured.input("one").at(0.006) == pytest.approx(6 * GRAVITY, rel=1e-12)
    (tmp_path / "shock.csv").write_text("t [s],a [g]\n" + "".join(f"{i / 1000},{i % 5}\n" for i in range(101)))
    other = vibeam.load(tmp_path / "own.toml")
    assert (other.key != measured.key, other.own["one"] != measured.own["one"]) == (True, True)


def test_a_column_of_a_wave_file_is_a_channel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    wavfile.write("two.wav", 1000, np.array([[0.0, 1.0], [0.25, 3.0], [0.5, 2.0]], dtype=np.float32))
    made = case({"file": "two.wav", "column": 2, "scale": 2.0})
    assert made.input("one").at(0.001) == pytest.approx(6.0)


def test_the_keys_of_a_fidelity_know_the_input_and_neither_values_nor_seeds() -> None:
    own = case(PULSE).own
    assert own == case(PULSE, {"duration": "0.5 s", "values": [0.5, 1, 2]}).own
    assert case(WHITE).own == case(WHITE | {"seed": 9}, {"duration": "0.5 s", "realisations": 8}).own
    assert case(WHITE).key != case(WHITE | {"seed": 9}).key
    for changed in (
        case(PULSE | {"acceleration": "51 g"}),
        case(PULSE, {"duration": "0.6 s"}),
        case(PULSE, start={"displacement": "-1 mm"}),
        case(PULSE, {"duration": "0.5 s", "over": "stop.gap", "values": ["1 mm"]}),
    ):
        assert changed.own["one"] != own["one"]


@pytest.mark.parametrize(
    ("drive", "record", "start"),
    [
        (PULSE, {"duration": "0.1 s", "over": "stop.gap", "values": ["0.1 mm", "0.2 mm"]}, None),
        (WHITE, {"duration": "0.1 s", "outputs": ["sensor", "contact"], "certify": True, "rate": "10 kHz"}, None),
        (None, None, {"displacement": "-2 mm", "output": "sensor"}),
        ({"density": [["1 Hz", "1 N^2/Hz"], ["9 Hz", "2 N^2/Hz"]], "seed": 0, "at": "100 mm"}, None, None),
    ],
)
def test_a_record_case_loads_from_its_text_as_the_same(
    drive: dict | None, record: dict | None, start: dict | None
) -> None:
    made = case(drive, record, start)
    again = parse(made.text)
    assert again == made
    assert (again.key, again.own, again.inputs) == (made.key, made.own, made.inputs)


def test_varied_keys_are_read_in_their_unit() -> None:
    made = case(PULSE, {"duration": "0.1 s", "over": "stop.gap", "values": ["0.1 mm", "0.2 mm"]})
    assert (made.record.over, made.record.values) == ("stop.gap", (1e-4, 2e-4))
    assert made.with_keys({"stop.gap": 1e-4}).scene.stop.gap == 1e-4


def test_nothing_that_needs_a_sweep_runs_without_a_word() -> None:
    with pytest.raises(vibeam.CaseError, match=r"record: takes the place of \[sweep\]"):
        _ = case(PULSE).sweep
    for asked in (lambda: case(PULSE).base_amplitude, lambda: case(PULSE).amplitude_of("one")):
        with pytest.raises(vibeam.CaseError, match="record: has an input over time and no amplitude"):
            asked()
    swept = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3})
    with pytest.raises(vibeam.CaseError, match=r"dtu_neutral.toml:\d+: drive: is a sine"):
        swept.input("sdof")
    assert (swept.record, dict(swept.inputs)) == (None, {})


def test_a_plucked_rig_is_in_the_static_shape_of_its_force() -> None:
    plucked = case(None, None, {"displacement": "-2 mm", "output": "sensor"})
    for name in plucked.fidelities:
        system, state = plucked.system(name), plucked.start(name)
        row = system.output("sensor")
        assert row @ state.displacement == pytest.approx(-2e-3, rel=1e-12)
        force = state.displacement * system.omega**2
        assert force == pytest.approx(row * (force @ row) / (row @ row), rel=1e-9)  # along the sensor's row alone
        assert not state.velocity.any()
    pushed = case(None, None, {"force": "-1 N", "output": "sensor"})
    system, state = pushed.system("eight"), pushed.start("eight")
    assert state.displacement == pytest.approx(-system.output("sensor") / system.omega**2, rel=1e-12)


def test_a_dropped_rig_goes_on_as_its_base_stops() -> None:
    dropped, moving = case(None, None, {"height": "0.5 m"}), case(None, None, {"base_velocity": "-2 m/s"})
    for name in dropped.fidelities:
        load = dropped.system(name).load
        assert dropped.start(name).velocity == pytest.approx(load * sqrt(2 * GRAVITY * 0.5), rel=1e-12)
        assert moving.start(name).velocity == pytest.approx(-2 * load, rel=1e-12)
    of_output = case(None, None, {"velocity": "1 m/s", "output": "sensor"})
    assert of_output.system("eight").output("sensor") @ of_output.start("eight").velocity == pytest.approx(1.0)


def test_a_start_beyond_the_stop_is_refused_by_the_fidelity_that_it_is_of() -> None:
    plucked = case(None, None, {"displacement": "2 mm"})
    with pytest.raises(vibeam.CaseError, match=r"start: of fidelity eight, the contact is 0.001 beyond the stop"):
        plucked.start("eight")


def test_a_platform_is_one_more_mode_that_a_force_drives() -> None:
    made = case({"shape": "half_sine", "force": "20 N", "duration": "11 ms"}, platform=PLATFORM)
    record, system = made.input("eight"), made.system("eight")
    assert (record.quantity, record.at(0.0055)) == ("force", pytest.approx(20.0))
    # the platform's acceleration at once is e_bᵀ M⁻¹ e_b F
    row = system.output("platform")
    alone = 20.0 * (row @ row)
    assert row @ system.load * record.at(0.0055) == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("density", ["0.1 N^2 m^2/Hz", "0.1 (N m)^2/Hz"])
def test_a_density_of_a_moment_turns_the_beam(density: str) -> None:
    turned = case({"density": density, "band": ["10 Hz", "2 kHz"], "seed": 3, "at": "100 mm"})
    pulse = case({"shape": "step", "moment": "1 N m", "at": "100 mm"})
    assert turned.input("one").quantity == "moment"
    assert turned.system("eight").load == pytest.approx(pulse.system("eight").load, rel=1e-12)
    pushed = case({"shape": "step", "force": "1 N", "at": "100 mm"})
    assert np.abs(pulse.system("eight").load - pushed.system("eight").load).max() > 1


def test_a_platform_that_nothing_drives_is_not_left_out() -> None:
    said = faults(None, None, {"displacement": "-1 mm"}, platform=PLATFORM | {"coupling": "one-way"})
    assert said[0].startswith('platform.coupling: "one-way" filters a sine')


def test_one_mode_in_its_own_units() -> None:
    made = vibeam.Case.of(
        {
            "sdof": ONE_MODE,
            "stop": {"gap": 0.5, "restitution": 0.8},
            "record": {"duration": "30 s"},
            "start": {"displacement": -0.3, "velocity": 0.1},
            "fidelity": {"one": {}},
        }
    )
    state = made.start("one")
    assert (state.displacement.tolist(), state.velocity.tolist()) == ([-0.3], [0.1])
    assert (made.input("one").peak, made.input("one").end) == (0.0, 30.0)
    assert parse(made.text) == made


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({}, "drive: nothing moves the rig: write file, shape or density here, or add [start]"),
        ({"drive": {"shape": "half_sine", "acceleration": "1 g"}}, 'drive.duration: missing: shape = "half_sine" needs it; write duration = "… ms"'),
        ({"drive": {"shape": "step"}}, 'drive.shape: its peak is missing: write acceleration = "50 g", or force or moment with at'),
        ({"drive": PULSE, "record": {"outputs": "sensor"}}, 'record.duration: missing (how long the motion is followed): write duration = "0.5 s"'),
        ({"drive": PULSE | {"density": "1 g^2/Hz"}}, "drive.density: the input is said twice: keep shape, or density"),
        ({"drive": PULSE | {"seed": 3}}, "drive.seed: goes with density, and the input is a shape: take it out"),
        ({"drive": PULSE | {"cycles": 3}}, 'drive.cycles: shape = "half_sine" has no use for it: take it out'),
        ({"drive": PULSE | {"harmonic": [2]}}, "drive.harmonic: is of the sine of a [sweep]: take it out"),
        ({"drive": PULSE | {"acceleration": "2e6 g"}}, "drive.acceleration: is 2e+06 g, and no base is shaken by 10⁶ g: check the unit"),
        ({"drive": PULSE | {"rise": "20 ms", "shape": "trapezoid"}}, "drive.rise: and fall, 0.04 s, are longer than the whole shape, duration = 0.011 s"),
        ({"drive": {"shape": "sine", "frequency": "50 Hz", "acceleration": "1 g", "delay": "2 s"}, "record": {"duration": "1 s"}}, "drive.delay: the motion is over before: record.duration is 1 s"),
        ({"drive": {"acceleration": "1 g"}}, 'drive.acceleration: is of a shape: write shape = "half_sine" and duration, or shape = "sine" and frequency, beside it'),
        ({"drive": {"amplitude": "1 mm"}}, 'drive.amplitude: is of the sine of a [sweep]: with [record] write acceleration, force or moment beside shape = "sine"'),
        ({"drive": {**WHITE, "rate": "3 kHz"}}, "drive.rate: 3000 Hz is below twice the highest frequency: write 4000 Hz"),
        ({"drive": {"density": "1 g^2/Hz", "band": ["1 Hz", "2 Hz"]}}, "drive.seed: missing: a random input needs one; write seed = 1"),
        ({"drive": {"density": "1 g/Hz", "seed": 1}}, "drive.density: '1 g/Hz' is a quantity of dimension angle^-1 mass^1 time^1, not a density of an acceleration"),
        ({"drive": {"density": 0.01, "seed": 1}}, "drive.density: 0.01 has no unit: write '0.01 g^2/Hz' or '0.01 m^2/s^4/Hz', or units = \"SI\" at the top of the case"),
        ({"drive": {"density": [["2 Hz", "1 g^2/Hz"], ["1 Hz", "1 g^2/Hz"]], "seed": 1}}, "drive.density: the frequencies must ascend, each once"),
        ({"drive": {"density": "1 N^2/Hz", "band": ["1 Hz", "2 Hz"], "seed": 1}}, 'drive.density: a force acts on the beam: write at = "120 mm"'),
        ({"drive": {"file": "nowhere.csv"}}, "drive.file: no file 'nowhere.csv' in the case file's folder"),
        ({"drive": PULSE, "record": {"duration": "1 s", "realisations": 4}}, "record.realisations: of a random input alone: write drive.density, or take it away"),
        ({"drive": PULSE, "record": {"duration": "1 s", "over": "stop.gapp", "values": [1]}}, "record.over: unknown key 'stop.gapp'; did you mean 'gap'?; or level, speed"),
        ({"drive": PULSE, "record": {"duration": "1 s", "over": "stop.gap", "values": ["1 kg"]}}, "record.values.0: stop.gap: '1 kg' is a mass, not a length"),
        ({"drive": PULSE, "record": {"duration": "1 s", "over": "stop.gap", "values": ["1 mm"]}, "fidelity": {"a": {"reduction": "static_mode", "set": {"stop.gap": "1 mm"}}}}, "fidelity.a.set: keeps stop.gap at one value, and record.over varies it: take it out"),
        ({"drive": PULSE, "record": {"duration": "1 s", "over": "mass.position", "values": ["132 mm", "190 mm"]}}, "record.values.1: mass.position = 0.19 in fidelity one, mass.position: 0.19 m is beyond the tip: beam.length is 0.18 m"),
        ({"drive": PULSE, "record": {"duration": "1 s", "outputs": "sensr"}}, "record.outputs: 'sensr' is not one of \"sensor\" | \"contact\" | \"tip\" | \"platform\"; did you mean 'sensor'?"),
        ({"drive": PULSE, "sweep": {"frequency": ["15 Hz"]}}, "record: and [sweep] do not go together: a case has one of the two"),
        ({"drive": PULSE, "cost": {"budget": "4 s"}}, "cost: is of a [sweep]: take it away; vibeam run says the CPU time of every fidelity"),
        ({"drive": PULSE, "measurement": {"sampling": "1 kHz"}}, "measurement: is of the figures of a [sweep]: take it away; record.rate samples histories"),
        ({"drive": PULSE, "show": {"a": {"kind": "portrait", "frequency": "15 Hz"}}}, 'show.a.kind: "portrait" is of a [sweep]; of a [record]: '),
        ({"drive": PULSE, "show": {"a": {"kind": "history", "output": "tip"}}}, "show.a.output: is not kept: name 'tip' in record.outputs too"),
        ({"drive": PULSE, "show": {"a": {"kind": "history", "frequency": "15 Hz"}}}, 'show.a.frequency: kind = "history" has no use for it'),
        ({"drive": PULSE, "start": {}}, 'start: says nothing: write displacement = "2 mm", velocity, force or base_velocity; or take it away'),
        ({"drive": PULSE, "start": {"displacement": "1 mm", "force": "1 N"}}, "start.force: goes without displacement: keep one of the two"),
        ({"drive": PULSE, "fidelity": {"a": {"reduction": "static_mode", "solver": "averaging"}}}, 'fidelity.a.solver: "averaging" knows sines alone: write "flight" or "direct" or "moreau"'),
        ({"drive": PULSE, "platform": PLATFORM}, "drive.acceleration: a motion of the base has the platform in it already: take [platform] away, or give the force on it"),
        ({"drive": {"shape": "step", "force": "1 N"}, "platform": PLATFORM | {"coupling": "one-way"}}, 'platform.coupling: "one-way" filters a sine; over time a platform moves as one more mode, which the beam pushes too: write coupling = "two-way"'),
        ({"drive": PULSE | {"at": "0.1 m"}}, 'drive.at: is where a force or a moment acts: write force, or quantity = "force", or take at away'),
        ({"drive": PULSE | {"force": "1 N"}}, "drive.force: the peak is said twice: keep acceleration, or force"),
    ],
)  # fmt: skip
def test_every_fault_says_its_cure(said: dict, message: str) -> None:
    found = faults(**said)
    assert any(each.startswith(message) for each in found), found


def test_a_sweep_says_which_keys_are_of_a_record() -> None:
    with pytest.raises(vibeam.CaseError) as caught:
        vibeam.load("cases/dtu_neutral.toml", {"drive.shape": "half_sine", "start.displacement": "1 mm"})
    assert [str(each) for each in caught.value.faults] == [
        "--set drive.shape: is of an input over time: write [record] in place of [sweep], or take it out",
        "--set start: is of a [record]; a sweep goes on from point to point: take it away",
    ]
    with pytest.raises(vibeam.CaseError, match=r"is of a \[record\], and this case sweeps: name another"):
        vibeam.load("cases/dtu_neutral.toml", {"show": {"a": {"kind": "impact_velocities"}}})
    with pytest.raises(vibeam.CaseError, match=r"sweep: the table is missing: add \[sweep\], or \[record\] for an"):
        vibeam.load("cases/dtu_neutral.toml", {"sweep": None})


NUMBER = {"fidelity": "one", "quantity": "peak", "value": "1 mm", "tolerance": "1 %"}


def test_numbers_of_a_record_are_read_in_the_unit_of_their_signal() -> None:
    said = {
        "peak": NUMBER,
        "hard": NUMBER | {"output": "sensor_acceleration", "value": "200 g", "at": "0.2 mm"},
        "fast": NUMBER | {"quantity": "hardest_impact", "value": "30 mm/s"},
        "work": NUMBER | {"quantity": "work", "value": "20 mJ", "number": 1},
        "many": NUMBER | {"quantity": "impacts", "value": 20},
        "first": NUMBER | {"quantity": "first_impact", "value": "12 ms"},
        "apart": NUMBER | {"quantity": "horizon", "against": "eight", "value": "0.1 s"},
        "off": NUMBER | {"against": "eight", "value": "3 %"},
    }
    over = {"duration": "0.1 s", "over": "stop.gap", "values": ["0.1 mm", "0.2 mm"]}
    made = case(PULSE, over, expect=said)
    values = [each.value for each in made.expectations.values()]
    assert values == pytest.approx([1e-3, 200 * GRAVITY, 0.03, 0.02, 20, 0.012, 0.1, 0.03])
    assert made.expectations["hard"].at == 2e-4
    assert parse(made.text) == made


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"value": "1 kg"}, "value: '1 kg' is a mass, not a plain number"),
        ({"quantity": "amplitude"}, 'quantity: "amplitude" is of a [sweep]; of a [record]: peak, least'),
        ({"frequency": "15 Hz"}, "frequency: is of a [sweep]: take it out"),
        (
            {"output": "sensor_acc"},
            "output: no signal 'sensor_acc': there are sensor, sensor_velocity, sensor_acceleration",
        ),
        (
            {"quantity": "work", "value": "1 J", "output": "sensor"},
            'output: "work" is of the whole motion: take it out',
        ),
        ({"number": 2}, "number: is that of a mode, of an energy: take it out"),
        ({"quantity": "horizon", "value": "1 s"}, 'against: missing: "horizon" is of two fidelities; name the other'),
        ({"seed": 4}, "seed: is not among the realisations"),
        ({"at": 2.0}, "at: 2.0 is none of record.values"),
    ],
)
def test_a_number_that_no_record_has_is_refused(said: dict, message: str) -> None:
    found = faults(PULSE, expect={"it": NUMBER | said})
    assert any(each.startswith(f"expect.it.{message}") for each in found), found


def test_a_sweep_has_no_numbers_of_a_record() -> None:
    with pytest.raises(vibeam.CaseError) as caught:
        vibeam.load(
            "cases/dtu_neutral.toml",
            {"expect": {"a": NUMBER | {"fidelity": "sdof", "quantity": "work", "value": 1, "seed": 3}}},
        )
    assert [str(each).partition(": ")[2] for each in caught.value.faults] == [
        '"work" is of a [record]: name another',
        "is of a [record]: take it out",
    ]


def test_an_input_too_coarse_or_a_run_too_short_for_a_mode_says_what_is_needed() -> None:
    slow = vibeam.Record.sampled(np.zeros(101), rate=1000.0)
    system = case(PULSE).system("eight")
    coarse, short = remarks_on(slow, system, 0.05)
    highest, lowest = system.omega[-1] / (2 * pi), system.omega[0] / (2 * pi)
    needed = system.omega[-1] / sqrt(8 * 0.1)  # (ωh)²/8 = 0.1
    assert (
        f"has 1000 samples a second, the highest mode, {highest:.4g} Hz, needs {needed:.0f} to be off by 10%" in coarse
    )
    assert f"0.05 s is {0.05 * lowest:.2g} of a period of the lowest mode, {lowest:.4g} Hz" in short
    assert not [*remarks_on(case(PULSE).input("eight"), system, case(PULSE).record.duration)]
    for by, then in ((-0.02, "the motion at 0: what comes before"), (0.06, "when the motion is over")):
        first, *_ = remarks_on(slow.shifted(by), system, 0.05)
        assert first.startswith(f"the input begins at {by} s, {then}")


def test_what_others_call_it_leads_to_the_key() -> None:
    found = faults({"psd": "0.01 g^2/Hz", "accelerogram": "a.csv"}, {"t_end": "1 s", "seeds": 3}, {"v0": "1 m/s"})
    assert [each.partition(": ")[2] for each in found] == [
        "unknown key; did you mean 'file'?",
        "unknown key; did you mean 'density'?",
        "unknown key; did you mean 'realisations'?",
        "unknown key; did you mean 'duration'?",
        "unknown key; did you mean 'velocity'?",
    ]


MODES = {"frequency": ["5 Hz", "12 Hz"], "damping_ratio": 0.01, "contact": [0.7, 0.5], "sensor": [0.4, -0.6]}


def given(row, drive, **more):
    return vibeam.Case.of(
        {
            "modes": MODES | row,
            "stop": {"gap": "1 mm", "restitution": 0.6},
            "drive": drive,
            "record": {"duration": "1 s"},
            "fidelity": {"one": {"reduction": "modal", "modes": 1}, "all": {"reduction": "full"}},
            **more,
        }
    )


def test_a_given_structure_is_driven_where_its_table_says() -> None:
    moved, pushed = given({"base": [1.8, -0.5]}, PULSE), given({"force": [0.7, 0.5]}, PULSE_OF_FORCE)
    assert (moved.input("all").quantity, pushed.input("all").quantity) == ("acceleration", "force")
    assert moved.system("all").load == pytest.approx([1.8, -0.5], rel=1e-12)
    assert pushed.system("all").load == pytest.approx([0.7, 0.5], rel=1e-12)
    assert parse(pushed.text) == pushed
    noise = given({"force": [0.7, 0.5]}, {"density": "1 N^2/Hz", "band": ["1 Hz", "50 Hz"], "seed": 1})
    assert noise.input("one").quantity == "force"


PULSE_OF_FORCE = {"shape": "half_sine", "force": "-20 N", "duration": "11 ms"}


@pytest.mark.parametrize(
    ("row", "drive", "message"),
    [
        (
            {"base": [1, 1]},
            PULSE_OF_FORCE,
            "drive.force: acts where modes.force says: write acceleration, or modes.force",
        ),
        ({"force": [1, 1]}, PULSE, "drive.acceleration: modes.force says a force drives it: write force"),
        ({"base": [1, 1]}, PULSE | {"moment": "1 N m"}, "drive.moment: unknown key"),
    ],
)
def test_a_given_structure_takes_the_load_that_it_has_a_row_for(row: dict, drive: dict, message: str) -> None:
    with pytest.raises(vibeam.CaseError) as caught:
        given(row, drive)
    assert str(caught.value).removeprefix("case.toml: ").startswith(message)


def test_a_dropped_structure_needs_a_base() -> None:
    start = {"base_velocity": "1 m/s"}
    assert given({"base": [1.8, -0.5]}, {}, start=start).start("all").velocity == pytest.approx([1.8, -0.5])
    with pytest.raises(vibeam.CaseError, match=r"start\.base_velocity: stops the base of a rig, and a force"):
        given({"force": [1, 1]}, {}, start=start)


def test_a_given_structure_says_what_a_base_moves() -> None:
    for drive, start in ((PULSE, {}), ({}, {"start": {"displacement": "-1 mm"}})):
        with pytest.raises(vibeam.CaseError, match=r"modes\.base: missing \(what a motion of the base moves"):
            given({}, drive, **start)
    with pytest.raises(vibeam.CaseError, match=r"platform: moves a base: write modes\.base in place of modes\.force"):
        given({"force": [1, 1], "moving_mass": "9 kg"}, PULSE_OF_FORCE, platform=PLATFORM)
