"""Wrong cases: each fault with its file, line, key and cure, all of them at once; never another exception."""

# ruff: noqa: E501  (a message stays on its line)

import os
import pickle
import re

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stand_in import one_mode

import vibeam
from vibeam.casefile.documentation import rows_of
from vibeam.casefile.examples import PLACES, texts
from vibeam.casefile.read import parse
from vibeam.casefile.synonyms import SYNONYMS
from vibeam.casefile.template import template
from vibeam.casefile.toml_writing import to_toml
from vibeam.exchange.faults import CaseError, Fault, printable
from vibeam.solvers import SOLVERS as DECLARED
from vibeam_reductions.declaration import REDUCTIONS

RIG = """units = "SI"
[beam]
length = "180 mm"
width = "20 mm"
thickness = "1 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.017
elements = 36
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0 mm"
restitution = 0.72
[sensor]
position = "100 mm"
[drive]
voltage = "0.6 V"
gain = 5e-4
[sweep]
frequency = { from = "14 Hz", to = "17 Hz", points = 4 }
settle = 3
hold = 5
[fidelity.sdof]
reduction = "static_mode"
"""
SDOF = one_mode('["0.3 Hz"]', 0, 1, "[fidelity.exact]")
FREQUENCY = '{ from = "14 Hz", to = "17 Hz", points = 4 }'
REFERENCE = '[reference.exact]\nfile = "no.csv"\nfidelity = "sdof"\nquantity = "amplitude"\ntolerance = "1 %"\n'


def faults_of(text, set=None):
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml", set)
    assert str(caught.value).splitlines() == [str(fault) for fault in caught.value.faults]
    return str(caught.value)


def test_the_text_that_the_wrong_ones_start_from_is_right():
    assert parse(RIG)
    assert parse(SDOF)


BASES = " | ".join(f'"{name}"' for name in REDUCTIONS)

SOLVERS = " | ".join(f'"{name}"' for name in DECLARED)
WRONG = [
    # keys
    ("density =", "densty =", "7: beam.densty: unknown key; did you mean 'density'?"),
    ("[sensor]", "[sensro]", "16: sensro: unknown key; did you mean 'sensor'?"),
    ("settle", "xyz = 1\nsettle", "23: sweep.xyz: unknown key; known here: frequency, direction, settle, hold, output"),
    ("points = 4", "pionts = 4", "22: sweep.frequency.pionts: unknown key; did you mean 'points'?"),
    (
        'width = "20 mm"\n',
        "",
        "2: beam.width: missing (width of the section): write width = \"… mm\""
    ),
    ('[sensor]\nposition = "100 mm"\n', "", " sensor: the table is missing: add [sensor]"),
    ('[fidelity.sdof]\nreduction = "static_mode"\n', "", " fidelity: the table is missing: add [fidelity.NAME]"),
    ("[fidelity.sdof]\nreduction = \"static_mode\"", "[fidelity]", "25: fidelity: no fidelity: add a table [fidelity.NAME]"),
    ("[fidelity.sdof]\nreduction = \"static_mode\"", "[fidelity]\nbeam = { modes = 8 }", "26: fidelity.beam.reduction: missing (what of the structure is kept: one static deflection, the first few modes, all of the finite elements, …): write reduction = \"modal\""),
    ("reduction = \"static_mode\"", "", "25: fidelity.sdof.reduction: missing (what of the structure is kept: one static deflection, the first few modes, all of the finite elements, …): write reduction = \"static_mode\""),
    ("[sensor]", "[solid]\nmesh = \"rig.msh\"\nmesh_unit = \"mm\"\nmaterial = { density = 1 }\n[sensor]", "19: solid.material: must be a list of tables, [[solid.material]], not a table"),
    ("[sensor]", "[solid]\nmass = 3\n[sensor]", "17: solid.mass: must be a list of tables, [[solid.mass]], not 3"),
    ("[beam]", "added_mass = [1]\n[beam]", "2: added_mass.0: must be a table, [[added_mass]], not 1"),
    ("[fidelity.sdof]", "[fidelity]", "26: fidelity.reduction: must be a table, [fidelity.reduction], not 'static_mode'"),
    ("[stop]", "[[stop]]", "13: stop: must be a table, [stop], not a list"),
    ("[fidelity.sdof]", '[fidelity."a/b"]', "25: fidelity.\"a/b\": the name 'a/b' must be 1 to 64 letters, digits, - or _"),
    ("[sensor]", "[sdof]\ndamping_ratio = 0.1\n[sensor]", "2: beam: [beam] and [sdof] do not go together: keep [sdof], or the beam's tables"),
    # values by themselves
    ('"180 mm"', '"180 kg"', "3: beam.length: '180 kg' is a mass, not a length"),
    ('"180 mm"', '"-180 mm"', "3: beam.length: '-180 mm' must be > 0"),
    ('"180 mm"', "nan", "3: beam.length: nan is not a finite number"),
    ("gap = \"0 mm\"", "gap = inf", "14: stop.gap: inf is not a finite number"),
    ("gap = \"0 mm\"", "gap = 2020-01-01", "14: stop.gap: must be a length such as '180 mm', not the date or time 2020-01-01"),
    ("0.72", "1.2", "15: stop.restitution: 1.2 is outside [0, 1]"),
    ("0.72", '"-1 %"', "15: stop.restitution: '-1 %' is outside [0, 1]"),
    ("0.017", "-0.017", "8: beam.damping_ratio: -0.017 must be ≥ 0"),
    ("0.017", "[]", "8: beam.damping_ratio: a list of 0 numbers is outside [1, 1000000]"),
    ("elements = 36", "elements = 2001", "9: beam.elements: 2001 is outside [1, 2000]"),
    ("elements = 36", "elements = 36.0", "9: beam.elements: must be a whole number, not 36.0"),
    ("elements = 36", "elements = true", "9: beam.elements: must be a whole number, not true"),
    ('"SI"', '"SI"\ntitle = 5', "2: title: must be text in quotes, not 5"),
    ("settle = 3", "settle = -1", "23: sweep.settle: -1 is outside [0, 1000000]"),
    ("hold = 5", "hold = 0", "24: sweep.hold: 0 is outside [1, 1000000]"),
    ("points = 4", "points = 0", "22: sweep.frequency.points: 0 is outside [1, 1000000]"),
    ("points = 4", "points = 1000001", "22: sweep.frequency.points: 1000001 is outside [1, 1000000]"),
    ('"14 Hz"', '"0 Hz"', "22: sweep.frequency.from: '0 Hz' must be > 0"),
    ("hold = 5", 'direction = "upp"\nhold = 5', "24: sweep.direction: 'upp' is not one of \"up\" | \"down\" | \"both\"; did you mean 'up'?"),
    ("static_mode", "nothing", f"26: fidelity.sdof.reduction: 'nothing' is not one of {BASES}"),
    ("static_mode\"", "full\"\nsolver = \"ode\"", f"27: fidelity.sdof.solver: 'ode' is not one of {SOLVERS}"),
    ('{ from = "14 Hz", to = "17 Hz", points = 4 }', '"14 Hz"', "22: sweep.frequency: must be { from, to, points } or a list of Hz > 0, not '14 Hz'"),
    ('{ from = "14 Hz", to = "17 Hz", points = 4 }', "[14, -1]", "22: sweep.frequency: number 2 of the list: -1 must be > 0"),
    ('{ from = "14 Hz", to = "17 Hz", points = 4 }', "[14, 13]", "22: sweep.frequency: the list must ascend, each number once; the direction is said elsewhere"),
    ('{ from = "14 Hz", to = "17 Hz", points = 4 }', "[]", "22: sweep.frequency: a list of 0 numbers is outside [1, 1000000]"),
    # keys together
    ('"132 mm"', '"0.2 m"', "12: mass.position: 0.2 m is beyond the tip: beam.length is 0.18 m"),
    ('"100 mm"', "0", "17: sensor.position: 0 must be > 0"),
    ('"100 mm"', "0.19", "17: sensor.position: 0.19 m is beyond the tip: beam.length is 0.18 m"),
    ("[stop]", '[stop]\nposition = "18.1 cm"', "14: stop.position: 0.181 m is beyond the tip: beam.length is 0.18 m"),
    ("[stop]", "[[added_mass]]\nmass = 1\nposition = 1\n[stop]", "15: added_mass.0.position: 1 m is beyond the tip: beam.length is 0.18 m"),
    ("[stop]", "rigid_half_width = 0.132\n[stop]", "13: mass.rigid_half_width: 0.132 m reaches the clamp: mass.position is 0.132 m"),
    ("[stop]", "rigid_half_width = 0.05\n[stop]", "13: mass.rigid_half_width: 0.05 m reaches the tip, 0.048 m beyond mass.position"),
    ("elements = 36", 'damping = "rayleigh"', "8: beam.damping_ratio: damping = \"rayleigh\" needs the ratios of modes 1 and 2: write damping_ratio = […, …]"),
    ("elements = 36", "damping = [0.1, 0.2]", "8: beam.damping_ratio: beam.damping lists the ratios already: keep one of the two"),
    ("0.017", "[0.017, 0.02]", "8: beam.damping_ratio: damping = \"constant\" needs one number; a list of ratios goes into damping"),
    ("damping_ratio = 0.017\n", "", "2: beam.damping_ratio: missing (damping ratio of the first mode): write damping_ratio = …"),
    ("damping_ratio", "damping_ratoi", "8: beam.damping_ratoi: unknown key; did you mean 'damping_ratio'?"),
    ("gain = 5e-4\n", "", "18: drive.gain: missing: voltage needs it beside it"),
    ('voltage = "0.6 V"\n', "", "18: drive.voltage: missing: gain needs it beside it"),
    ('voltage = "0.6 V"\ngain = 5e-4\n', "", "18: drive: the base motion is missing: write voltage and gain, or amplitude, velocity or acceleration; or force or moment with at"),
    ("gain = 5e-4", "amplitude = 1e-4", "20: drive.amplitude: the base motion is said twice: keep amplitude, or voltage"),
    ("static_mode", "modal", "25: fidelity.sdof.modes: missing: reduction = \"modal\" needs how many; write modes = 8"),
    ("static_mode\"", "full\"\nmodes = 3", "27: fidelity.sdof.modes: reduction = \"full\" counts none: take it out, or write reduction = \"modal\""),
    ("static_mode\"", "modal\"\nmodes = 73", "27: fidelity.sdof.modes: 73 are more than the model has: beam.elements gives 72 at most"),
    ('"17 Hz"', '"13 Hz"', "22: sweep.frequency.to: is below from; to sweep downwards write direction = \"down\""),
    ("points = 4", "points = 1", "22: sweep.frequency.points: 1 point does not span from … to: make them equal, or take more points"),
    ('"17 Hz"', '"14 Hz"', "22: sweep.frequency.points: 4 points from a frequency to itself: points = 1, or another to"),
    ("[sweep]", "[uncertainty]\nsamples = 48\n[sweep]", "22: uncertainty.samples: 48 is no power of two: write 32"),
]  # fmt: skip


@pytest.mark.parametrize(("right", "wrong", "message"), WRONG, ids=[message[:40] for *_, message in WRONG])
def test_one_fault_is_one_line_with_its_place_and_cure(right, wrong, message):
    said = faults_of(RIG.replace(right, wrong, 1)).splitlines()
    assert f"mine.toml:{message}" in said
    assert len(said) == 1 or "[sdof]" in message  # there every table is of the other kind


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ('"no.csv"', '"no.csv"', "29: reference.exact.file: no file 'no.csv' in the case file's folder"),
        ('"no.csv"', '"\\u0000"', "29: reference.exact.file: no file '\\x00' in the case file's folder"),
        ('"sdof"', '"sdoff"', "30: reference.exact.fidelity: no fidelity 'sdoff'; did you mean 'sdof'?"),
        (
            '"amplitude"',
            '"amplitud"',
            "31: reference.exact.quantity: 'amplitud' is not one of \"amplitude\" | \"reach\" | \"maximum\" | \"minimum\""
            " | \"impact_velocity\" | \"impacts_per_period\" | \"period\"; did you mean 'amplitude'?"
        ),
        ('"1 %"', '"1 mm"', "32: reference.exact.tolerance: '1 mm' is a length, not a plain number"),
        ('"1 %"', '"1 %"\ndirection = "up"', "33: reference.exact.direction: \"up\" is not swept: sweep.direction is \"down\""),
    ],
)  # fmt: skip
def test_references(right, wrong, message):
    text = RIG.replace("settle", 'direction = "down"\nsettle') + REFERENCE.replace(right, wrong)
    assert f"mine.toml:{message}" in faults_of(text).splitlines()


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("gap = 0", 'gap = "0 mm"', "5: stop.gap: '0 mm' is a length, not a plain number"),
        ("gap = 0", 'gap = 0\ngap_at = "sensor"', "6: stop.gap_at: unknown key; did you mean 'gap'?"),
        ("amplitude = 0.5e-3", "voltage = 1\namplitude = 0", "8: drive.voltage: unknown key; known here: amplitude, velocity, acceleration, frequency, harmonic, harmonic_share, harmonic_phase, file, column, time, quantity, unit, scale, start, from, to, remove, shape, duration, rise, fall, cycles, window, beats, pause, delay, density, band, rate, interpolation, seed"),
        ("[stop]", "natural_frequency = 2\n[stop]", "4: sdof.natural_frequency: 2 may be rad/s or Hz: write '2 rad/s' or '2 Hz'"),
        ("exact]", "exact]\nreduction = \"full\"", "14: fidelity.exact.reduction: 'full' is not one of \"static_mode\""),
        ("exact]", "exact]\nmodes = 2", "14: fidelity.exact.modes: unknown key; known here: reduction, solver, options, set, without, label"),
        ("[stop]", "[mass]\n[stop]", "4: mass: [mass] and [sdof] do not go together: keep [sdof], or the beam's tables"),
    ],
)  # fmt: skip
def test_a_single_degree_of_freedom(right, wrong, message):
    assert faults_of(SDOF.replace(right, wrong, 1)) == f"mine.toml:{message}"


def test_all_faults_come_at_once_in_the_order_of_lines():
    text = (
        RIG.replace("density", "densty").replace("0.72", "7").replace("hold = 5", "hold = -5").replace("0.6 V", "6 m")
    )
    assert faults_of(text, {"beam.elements": 0}).splitlines() == [
        "mine.toml:7: beam.densty: unknown key; did you mean 'density'?",
        "mine.toml:15: stop.restitution: 7 is outside [0, 1]: if it is a percentage, write '7 %'",
        "mine.toml:19: drive.voltage: '6 m' is a length, not a voltage",
        "mine.toml:24: sweep.hold: -5 is outside [1, 1000000]",
        "--set beam.elements: 0 is outside [1, 2000]",
    ]


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("sweep.frequency.points", 0, "sweep.frequency.points: 0 is outside [1, 1000000]"),
        ("sweep.frequency.points", "many", "sweep.frequency.points: must be a whole number, not 'many'"),
        ("sweep.frequency.point", 3, "sweep.frequency.point: unknown key; did you mean 'points'?"),
        ("sweep.frequency", {"from": 1, "to": 2}, 'sweep.frequency.points: missing (how many): write points = 121'),
        ("beam.length", "1 kg", "beam.length: '1 kg' is a mass, not a length"),
        ("beam.length", "nan", "beam.length: nan is not a finite number"),
        ("beam.length.x", 1, "beam.length.x: there is no 'x' in '180 mm'"),
        ("nothing", 1, "nothing: unknown key; known here: title, source, units, beam, mass, added_mass, clamp, further_stop, gravity, leaf, opposite, plate, section, support, torsion, stop, sensor, output, drive, platform, shaker, solid, measurement, sweep, record, start, fidelity, reference, expect, measured, chosen_by, show, map, uncertain, figure, cost, fit, derive, modes_needed, uncertainty, verdict, mode_share, influence"),
        ("fidelity.more.reduction", "modal", 'fidelity.more.modes: missing: reduction = "modal" needs how many; write modes = 8'),
        ("mass.rotary_inertia", None, "mass.rotary_inertia: cannot be taken away: it is not in the case"),
        ("measurement.seed", None, "measurement.seed: cannot be taken away: it is not in the case"),
        ("mass.position", object(), "mass.position: a object is no value of a case"),
        ("fidelity", {"\n": 1}, 'fidelity."\\n": must be a table, [fidelity."\\n"], not 1'),
        ("a..b", 1, "a..b: 'a..b' is not a key such as sweep.frequency.points"),
        ("a\nb", 1, "a\\nb: 'a\\nb' is not a key such as sweep.frequency.points"),
        ("title", "\ud800", "title: '\\ud800' holds characters that are not text"),
    ],
)  # fmt: skip
def test_overrides_are_named_as_they_were_given(key, value, message):
    assert faults_of(RIG, {key: value}) == f"--set {message}"


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("added_mass.1.mass", "the index 1 is out of range; the list has index 0 alone"),
        ("added_mass.-1.mass", "'-1' is no index of a list; the list has index 0 alone"),
        ("added_mass.mass", "'mass' is no index of a list; the list has index 0 alone"),
        (f"added_mass.{'9' * 5000}", f"'{'9' * 55} …' is no index of a list; the list has index 0 alone"),
        ("sweep.frequency.7", "the index 7 is out of range; the list has the indices 0 to 2"),
        ("beam.damping.0", "the index 0 is out of range; the list is empty"),
    ],
    ids=range(6),
)
def test_an_index_beyond_the_list(key, message):
    text = RIG.replace(FREQUENCY, "[14, 15, 16]").replace("elements = 36", "damping = []")
    assert faults_of(text + "[[added_mass]]\nmass = 1\nposition = 0.1\n", {key: 1}).splitlines()[-1] == (
        f"--set {key if len(key) <= 80 else key[:79] + '…'}: {message}"
    )


def test_an_index_into_a_list_that_is_not_there():
    said = faults_of(RIG, {"added_mass.0.mass": "5 g"})
    assert said == (
        "--set added_mass.0.mass: the case has no [[added_mass]]: give the whole list, added_mass = [{ … }]"
    )


def test_an_entry_of_a_list_of_tables_is_set_by_its_index():
    text = RIG + "".join(f"[[added_mass]]\nmass = {each}\nposition = 0.1\n" for each in (1, 2))
    masses = parse(text, set={"added_mass.1.mass": "5 g"}).scene.effects
    assert [each.mass for each in masses] == [1.0, 0.005]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", ": is empty: a case has [beam] or [sdof], [stop], [drive], [sweep] and [fidelity.NAME]"),
        (b"# words\n", ": is empty: a case has [beam] or [sdof], [stop], [drive], [sweep] and [fidelity.NAME]"),
        (b"\x7fELF\x02\xff", ": is not text: byte 6 is not UTF-8; a case is a TOML file"),
        (b"a" * 10_000_000, ": has 10.0 MB; a case has at most 1 MB"),
        (b"a = 1\nb == 2\n", ":2: not TOML at column 4: Invalid value"),
        (b"a = 1\na = 2\n", ":2: not TOML at column 6: Cannot overwrite a value"),
        (b"a = 1\nb = [1,\n", ":3: not TOML: Invalid value"),
        (b"a = " + b"[" * 100_000, ": is nested too deeply for a case"),
        (b"a = " + b"1" * 5000, ": holds a number of thousands of digits"),
        (b"b = 1\n" + b".".join([b"a"] * 500) + b" = 1", ":2: is nested too deeply for a case"),
        (b".".join([b"a"] * 400_000) + b" = 1", ":1: is nested too deeply for a case"),
        (b".".join([b"'a'"] * 50) + b" = 1", ":1: is nested too deeply for a case"),
        (b"b = 1\na = " + b"[" * 30 + b"]" * 30, ":2: a: is nested too deeply for a case"),
        (b"a = " + b"{a=" * 30 + b"1" + b"}" * 30, ":1: a: is nested too deeply for a case"),
        ("a = 1\n".encode("utf-16"), ": is UTF-16 text: save it as UTF-8"),
        (b'a = "\0"\n', ":1: not TOML at column 6: Illegal character '\\x00'"),
    ],
    ids=range(16),
)
def test_what_is_no_case_at_all(tmp_path, content, message):
    file = tmp_path / "mine.toml"
    file.write_bytes(content)
    with pytest.raises(CaseError) as caught:
        vibeam.load(file)
    assert str(caught.value) == f"{file}{message}"


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ("[sensor]", '"\\u001b[2J\\u202e" = 1\n[sensor]', r"\u001b[2J\u202e"),
        ('"180 mm"', '"\\u001b]0;mine\\u0007 mm"', r"'\x1b]0;mine\x07 mm'"),
        ("[fidelity.sdof]", '[fidelity."a\\n\\u0085b"]', r'fidelity."a\n\x85b"'),
        ("sdof]", 'sdof]\noptions = { "\\u009b" = [] }', r"\x9b: must be"),
        ("sdof]", 'sdof]\nset = { "stop.g\\u2028ap" = 1 }', r"stop.g\u2028ap"),
    ],
)
def test_characters_that_would_steer_a_terminal_are_escapes_in_messages(right, wrong, said):
    text = faults_of(RIG.replace(right, wrong, 1))
    assert said in text
    assert text.replace("\n", "").isprintable()


def test_files_that_are_none(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for file, message in [
        (tmp_path, "is a directory, not a case file"),
        (tmp_path / "absent.toml", "no such file"),
        ("/dev/null", "is not a file"),
        ("\0", "no such file"),
        (tmp_path / "pipe", "is not a file"),
        (tmp_path / ("a" * 300), "cannot be read: File name too long"),
    ]:
        with pytest.raises(CaseError, match=rf"^{re.escape(printable(str(file)))}: {message}$"):
            vibeam.load(file)


def survives(text, overrides=None):
    """A case or a CaseError with faults to show; anything else fails."""
    try:
        parse(text, "mine.toml", overrides)
    except CaseError as error:
        said = error
    else:
        return
    assert said.faults
    assert "".join(map(str, said.faults)).isprintable()


@settings(deadline=None)
@given(st.binary(max_size=300))
@example(b"\xef\xbb\xbf")
@example(b"beam = {}")
@example(b'"\\u0000" = 1')
@example(b'fidelity."\\n" = 1')
def test_garbage_bytes_are_a_case_error(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "garbage.toml"
    file.write_bytes(content)
    with pytest.raises(CaseError):
        vibeam.load(file)


@settings(deadline=None)
@given(st.text(max_size=100))
def test_garbage_text_is_a_case_error(text):
    survives(text)


PIECES = ["[", "]", "=", '"', "{", "\n", "nan", "1e999", "[]", "{}", "[[", "true", "9" * 400, '"1e400 m"', "\0", "\x1b"]
PIECES += ["a." * 500 + "a", "[" * 30 + "]" * 30, "{a=" * 30 + "1" + "}" * 30, '"\\u202e"', '"/dev/zero"', "\ufeff"]


@settings(deadline=None, max_examples=40)  # ``tests/hard/torture.py mutants`` replaces more, by name
@given(st.data())
def test_a_case_with_a_piece_replaced_is_a_case_or_a_case_error(data):
    text = data.draw(st.sampled_from([RIG + REFERENCE, SDOF, template(), *(texts(name)[0] for name in PLACES)]))
    start = data.draw(st.integers(0, len(text)))
    piece = data.draw(st.sampled_from(PIECES))
    survives(text[:start] + piece + text[start + data.draw(st.integers(0, 12)) :])


REFUSED = [
    (".", "'.' is a folder, not a file"),
    ("pipe.csv", "'pipe.csv' is not a regular file"),
    ("/dev/zero", "'/dev/zero' is not a regular file"),
    ("vast.csv", "'vast.csv' has 6000 MB; such a file may have 100 MB at most"),
    ("a\x1b.csv", "no file 'a\\x1b.csv' in the case file's folder"),
]


@pytest.mark.parametrize(("name", "message"), REFUSED)
def test_a_reference_that_is_no_table_is_refused_before_anything_runs(tmp_path, name, message):
    os.mkfifo(tmp_path / "pipe.csv")
    with (tmp_path / "vast.csv").open("wb") as file:
        file.truncate(6 * 10**9)
    text = RIG + REFERENCE.replace('"no.csv"', to_toml(name))
    with pytest.raises(CaseError) as caught:
        parse(text, tmp_path / "mine.toml")
    assert str(caught.value) == f"{tmp_path}/mine.toml:28: reference.exact.file: {message}"


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)
KEYS = [
    ".".join(["set"] * 500), "beam.length", "beam.damping", "beam.damping_ratio", "beam.elements", "stop.gap",
    "sensor.position", "drive.gain", "beam", "drive", "drive.amplitude", "sweep", "sweep.frequency",
    "sweep.frequency.to", "fidelity", "reference", "fidelity.sdof", "fidelity.sdof.modes", "reference.exact.file",
    "added_mass", "added_mass.0", "sdof",
]  # fmt: skip
keys = st.sampled_from(KEYS)


@settings(deadline=None)
@given(st.sampled_from([RIG + REFERENCE, SDOF]), st.dictionaries(keys | st.text(max_size=4), values, max_size=3))
def test_any_override_is_a_case_or_a_case_error(text, overrides):
    survives(text, overrides)


def test_faults_can_be_read_one_by_one_and_sent_elsewhere():
    error = CaseError(
        [Fault("a.toml", 2, "b", "wrong"), Fault("a.toml", 1, "a", "wrong"), Fault("a.toml", 1, "a", "wrong")]
    )
    assert [fault.line for fault in error.faults] == [1, 2]
    assert isinstance(error, ValueError)
    assert str(pickle.loads(pickle.dumps(error))) == str(error) == "a.toml:1: a: wrong\na.toml:2: b: wrong"


def test_faults_on_one_key_keep_the_order_in_which_they_were_found() -> None:
    """Whatever the seed of the hashes: eight of them would stay in order by chance once in forty thousand."""
    found = [Fault("case.toml", 3, "stop.gap", f"message {i}") for i in range(8)]
    assert CaseError([*found, *found]).faults == tuple(found)


def test_a_key_by_the_name_that_others_give_it():
    said = faults_of(RIG.replace("elements = 36", "section = 1\nmaterial = 2\nboundary = 3\nqqq = 4\nppp = 5"))
    assert [line.split(": ", 2)[2] for line in said.splitlines()[:3]] == [
        "unknown key; did you mean 'shape'?",
        "unknown key; did you mean 'youngs_modulus' and 'density'?",
        "unknown key; did you mean 'ends'?",
    ]
    assert said.count("known here: length, shape") == 1
    assert said.splitlines()[4].endswith("beam.ppp: unknown key; known here: see qqq")


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("beam.height", "beam.height: unknown key; did you mean 'thickness'?"),
        ("beam.E", "beam.E: unknown key; did you mean 'youngs_modulus'?"),
        ("stop.e", "stop.e: unknown key; did you mean 'youngs_modulus' and 'restitution'?"),
        ("stop.clearance", "stop.clearance: unknown key; did you mean 'gap'?"),
        ("excitation.amplitude", "excitation: unknown key; did you mean 'drive'?"),
        ("boundary", "boundary: unknown key; did you mean 'beam.ends'?"),
    ],
)
def test_a_synonym_is_known_in_an_override(key, message):
    with pytest.raises(CaseError) as caught:
        parse(RIG, set={key: 1})
    assert f"--set {message}" in str(caught.value).splitlines()


def test_every_synonym_means_a_key_and_is_none() -> None:
    for name, places in SYNONYMS.items():
        assert all(map(rows_of, places)), name  # ValueError for a place that is none
        assert name == name.lower()


def test_a_key_that_a_synonym_stands_for_is_not_missing_as_well() -> None:
    assert faults_of(RIG.replace("density =", "rho =")).splitlines() == [
        "mine.toml:7: beam.rho: unknown key; did you mean 'density'?"
    ]


def test_of_very_many_faults_the_first_are_told_and_the_rest_counted():
    with pytest.raises(CaseError) as caught:
        parse(RIG.replace("elements = 36", "\n".join(f"k{number} = 1" for number in range(2000))))
    lines = str(caught.value).splitlines()
    assert (len(caught.value.faults), len(lines), lines[-1]) == (2000, 51, "… and 1950 more")
    assert len(str(caught.value)) < 5000


def test_a_results_file_is_no_case_and_says_what_reads_it(tmp_path):
    (tmp_path / "big.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(2_000_000))
    with pytest.raises(CaseError, match=r"is a results file \(HDF5\), not a case: vibeam report big\.h5 reads it"):
        vibeam.load(tmp_path / "big.h5")


@pytest.mark.parametrize("table", ["map.it", "map", "show.it"])
def test_fidelities_are_named_as_in_other_tables_too(table):
    axes = 'axes = [{ key = "stop.gap", values = ["0 mm"] }]\npicture = "values"\n'
    keys = 'kind = "portrait"\n' if table == "show.it" else axes
    text = f'{RIG}[{table}]\n{keys}frequency = "15 Hz"\nfidelity = "sdof"\n'
    case = parse(text)
    assert [plan.fidelities for plan in (*case.maps.values(), *case.shows.values())] == [("sdof",)]
    (said,) = faults_of(text.replace('"sdof"\n', '"sdfo"\n')).splitlines()
    line = text.splitlines().index('fidelity = "sdof"') + 1
    assert said.startswith(f"mine.toml:{line}: ")
    assert said.endswith("no fidelity 'sdfo'; did you mean 'sdof'?")


def test_a_scatter_is_an_uncertainty_at_its_line() -> None:
    text = (
        template()
        + '\n[measured.tap]\nfidelity = "sdof"\nquantity = "peak"\nvalue = "1 mm"\nscatter = "2 %"\nsource = "a log"\n'
    )
    assert parse(text).measured["tap"].uncertainty == pytest.approx(2e-5)
    with pytest.raises(CaseError, match=rf"case.toml:{len(text.splitlines()) - 1}: measured.tap.uncertainty: .*length"):
        parse(text.replace('"2 %"', '"1 ms"'))
