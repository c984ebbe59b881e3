"""Numbers without a unit: in the units that the case names at its top."""

import pytest

from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError

WITH_UNITS = """
[beam]
length = "180 mm"
width = "12 mm"
thickness = "1 mm"
density = "7850 kg/m^3"
youngs_modulus = "210 GPa"
damping_ratio = 0.017
[mass]
mass = "0.2 kg"
position = "140 mm"
rotary_inertia = "2.84e-5 kg m^2"
[stop]
gap = "0.047 mm"
restitution = 0.72
[sensor]
position = "132 mm"
[drive]
acceleration = "0.4 m/s^2"
harmonic_phase = ["30 deg"]
harmonic = [2]
harmonic_share = [0.1]
[sweep]
frequency = { from = "14 Hz", to = "17 Hz", points = 4 }
settle = 40
hold = 20
[fidelity.sdof]
reduction = "static_mode"
[fidelity.wide]
reduction = "static_mode"
set = { "stop.gap" = "0.1 mm" }
[expect.peak]
fidelity = "sdof"
quantity = "peak"
value = "0.4 mm"
tolerance = "1 %"
[measured.speed]
fidelity = "sdof"
quantity = "impact_velocity"
frequency = "15 Hz"
value = "30 mm/s"
uncertainty = "2 mm/s"
source = "by hand"
[map.gaps]
axes = [{ key = "stop.gap", values = ["0.1 mm", "0.2 mm"] }, { key = "start.velocity", from = "0 m/s", to = "0.1 m/s", points = 2 }]
frequency = "15 Hz"
[uncertain]
"stop.gap" = "± 0.01 mm"
"beam.length" = "179 mm … 181 mm"
"mass.mass" = "0.2 kg ± 1 %"
"""  # noqa: E501

WRITTEN = ('"180 mm"', '"12 mm"', '"1 mm"', '"7850 kg/m^3"', '"210 GPa"', '"0.2 kg"', '"140 mm"', '"2.84e-5 kg m^2"',
           '"0.047 mm"', '"132 mm"', '"0.4 m/s^2"', '"30 deg"', '"14 Hz"', '"17 Hz"', '"0.1 mm"', '"0.4 mm"',
           '"15 Hz"', '"30 mm/s"', '"2 mm/s"', '"0.2 mm"', '"0 m/s"', '"0.1 m/s"', "0.01 mm", "179 mm", "181 mm",
           "0.2 kg ±")  # fmt: skip

RADIANS = "0.5235987755982989"

#: the same numbers in each system: of N and mm follow t and MPa, of kN, mm and ms follow kg and GPa, and kHz
BARE = {
    "SI": "0.18 0.012 0.001 7850 210e9 0.2 0.14 2.84e-5 0.000047 0.132 0.4 RAD 14 17 0.0001 0.0004 15 0.03 0.002 "
    "0.0002 0 0.1 0.00001 0.179 0.181 0.2±",
    "mm N s t": "180 12 1 7.85e-9 210e3 0.0002 140 0.0284 0.047 132 400 RAD 14 17 0.1 0.4 15 30 2 "
    "0.2 0 100 0.01 179 181 0.0002±",
    "mm kN ms kg": "180 12 1 7.85e-6 210 0.2 140 28.4 0.047 132 0.0004 RAD 0.014 0.017 0.1 0.4 0.015 0.03 0.002 "
    "0.2 0 0.1 0.01 179 181 0.2±",
}  # fmt: skip


def bare(system):
    """The case with its numbers in a system's units, without these."""
    text = WITH_UNITS
    for quantity, number in zip(WRITTEN, BARE[system].replace("RAD", RADIANS).split(), strict=True):
        text = text.replace(quantity, number.replace("±", " ±"))
    return text


def faults(text, **changes):
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml", {key.replace("__", "."): value for key, value in changes.items()})
    return [str(fault) for fault in caught.value.faults]


REFERENCE = '[reference.r]\nfile = "r.csv"\nfidelity = "sdof"\nquantity = "amplitude"\nmeasured = true\n'

LENGTH = "1200 has no unit: write '1200 mm' or '1200 m', or units = \"SI\" at the top of the case"


def test_a_number_without_a_unit_is_refused_with_what_it_may_mean():
    assert faults(WITH_UNITS.replace('"180 mm"', "1200")) == [f"mine.toml:3: beam.length: {LENGTH}"]
    assert faults(WITH_UNITS, beam__length=1200) == [f"--set beam.length: {LENGTH}"]
    assert faults(WITH_UNITS, beam__length="1200") == [f"--set beam.length: {LENGTH}"]
    assert parse(WITH_UNITS, set={"units": "SI", "beam.length": 0.3}).scene.beam.length == 0.3


def test_every_number_that_has_a_dimension_is_named():
    said = "\n".join(faults(bare("SI"), sensor__position="132 mm"))
    keys = ("beam.width", "stop.gap", "drive.acceleration", "drive.harmonic_phase", "sweep.frequency.to",
            'fidelity.wide.set."stop.gap"', "expect.peak.value", "measured.speed.value", "measured.speed.uncertainty",
            "map.gaps.axes.0.values.1", "map.gaps.axes.1.to", "map.gaps.frequency")  # fmt: skip
    assert [key for key in keys if f" {key}: " not in said] == []
    assert "from" not in [line.split(": ")[1] for line in said.splitlines() if "axes.1" in line]  # 0 needs none
    assert not any(f" {key}" in said for key in ("sensor.position", "beam.damping_ratio", "stop.restitution"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[fit]\nkeys = { "stop.gap" = [1e-5, "0.2 mm"] }\n', 'fit.keys."stop.gap": 1e-05 has no unit'),
        (REFERENCE + "offset = 0.1\n", "offset: 0.1 has no unit"),
    ],
)
def test_bounds_and_offsets_need_their_units_too(tmp_path, text, said):
    (tmp_path / "r.csv").write_text("frequency_hz,direction,amplitude\n15,up,1e-3\n")
    with pytest.raises(CaseError) as caught:
        parse(WITH_UNITS + text, tmp_path / "mine.toml")
    assert said in str(caught.value)


@pytest.mark.parametrize("system", BARE)
def test_bare_numbers_are_in_the_units_that_the_case_names(system):
    case, same = parse(f'units = "{system}"\n{bare(system)}'), parse(WITH_UNITS)
    assert case.key == same.key
    assert case.maps == same.maps
    assert case.uncertain == same.uncertain
    assert case.expectations == same.expectations
    assert case.measured == same.measured
    assert case.scenes == same.scenes
    assert parse(case.text).text == case.text
