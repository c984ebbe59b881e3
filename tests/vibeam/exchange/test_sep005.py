"""Signals handed on as SEP 5 has them: dictionaries into records, records and motions into dictionaries."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np
import pytest

import vibeam

RATE = 1000.0
TIME = np.arange(50) / RATE
VALUES = np.sin(2 * np.pi * 60 * TIME)
G = 9.80665


def channel(**more: Any) -> dict[str, Any]:
    return {"name": "table", "data": VALUES, "fs": RATE, "unit_str": "m/s^2"} | more


@pytest.mark.parametrize(
    ("one", "form", "quantity", "scale"),
    [
        (channel(), {}, "acceleration", 1.0),
        (channel(unit_str="g"), {}, "acceleration", G),
        (channel(unit_str="mm/s²", quantity="Acceleration"), {}, "acceleration", 1e-3),
        (channel(unit_str="kN"), {}, "force", 1e3),
        (channel(unit_str="N m", quantity="moment"), {}, "moment", 1.0),
        (channel(unit_str="V", quantity="acc"), {"unit": "g"}, "acceleration", G),
        (channel(unit_str="V"), {"unit": "g", "quantity": "acceleration"}, "acceleration", G),
        (channel(data=VALUES.tolist(), start_timestamp="2024-03-01T10:00:00+00:00"), {}, "acceleration", 1.0),
        (channel(time=TIME), {}, "acceleration", 1.0),
    ],
)
def test_a_channel_is_a_record(one: dict[str, Any], form: dict[str, Any], quantity: str, scale: float) -> None:
    for channels in (one, [one], (one,)):
        record = vibeam.record_of_sep005(channels, **form)
        assert (record.quantity, record.spacing) == (quantity, pytest.approx(1 / RATE))
        assert record.at(record.times) == pytest.approx(scale * VALUES, rel=1e-12, abs=1e-12)


def test_velocities_and_displacements_of_a_base_are_its_acceleration() -> None:
    record = vibeam.record_of_sep005(channel(unit_str="mm"), interpolation=None)
    same = vibeam.Record.sampled(1e-3 * VALUES, rate=RATE, quantity="displacement")
    assert record == same
    assert vibeam.record_of_sep005(channel(unit_str="mm/s")).samples == "velocity"


def test_one_of_several_channels_by_its_name() -> None:
    both = [channel(), channel(name="tip", data=2 * VALUES)]
    assert vibeam.record_of_sep005(both, "tip").peak == pytest.approx(2 * vibeam.record_of_sep005(both, "table").peak)


WRONG: list[tuple[Any, dict[str, Any], str]] = [
    ([channel(), channel(name="tip")], {}, "2 channels, table, tip: say its name"),
    ([channel(), channel()], {"name": "table"}, "2 channels, table, table: 2 are called 'table'"),
    ([channel()], {"name": "tabel"}, "0 are called 'tabel': did you mean 'table'?"),
    ([], {}, "0 channels, none: say its name"),
    ([3], {}, "a channel must have data, name, unit_str, and fs or time, and one has 3"),
    ({"name": "a", "Data": VALUES, "fs": 1.0}, {}, "a channel must have data, .* and one has name, Data, fs"),
    ({"name": "a", "data": VALUES, "unit_str": "g"}, {}, "and fs or time, and one has name, data, unit_str"),
    (channel(unit_str=""), {}, "channel 'table': its unit '' is not of one quantity of a record: say quantity"),
    (channel(unit_str="K"), {}, "its unit 'K' is not of one quantity of a record: say quantity"),
    (channel(unit_str="N", quantity="acceleration"), {}, "its unit 'N' is not of acceleration: say quantity"),
    (channel(unit_str="N"), {"quantity": "acceleration"}, "its unit 'N' is not of acceleration: say quantity"),
    (channel(unit_str="g", quantity="strain"), {}, "its unit 'g' is not of strain: say quantity"),
    (channel(time=TIME[1:]), {}, "times"),
    (channel(data=np.full(50, np.nan)), {}, "no finite number"),
]  # fmt: skip


@pytest.mark.parametrize(("channels", "form", "message"), WRONG)
def test_what_does_not_follow_the_rules_is_refused(channels: Any, form: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        vibeam.record_of_sep005(channels, **form)


def require_rules(channels: Any) -> None:
    """The rules as published (sdypy-sep005 1.0): types, keys that must be there, lengths, dates."""
    assert type(channels) is list
    for each in channels:
        assert type(each) is dict
        assert {"data", "name", "unit_str"} <= set(each)
        assert {"time", "fs"} & set(each)
        assert type(each["data"]) is np.ndarray
        assert "time" not in each or len(each["time"]) == len(each["data"])
        assert not any(key.lower() == "timestamp" for key in each)
        assert all(datetime.fromisoformat(each[key]) for key in each if "timestamp" in key)


RECORD = vibeam.Record.sampled(VALUES, rate=RATE)
UNEVEN = vibeam.Record.sampled([0.0, 1.0, 0.0], times=[0.0, 0.1, 0.4], quantity="force")


@pytest.mark.parametrize("record", [RECORD, RECORD.shifted(2.0), UNEVEN, vibeam.Record.half_sine(100.0, 0.011)])
def test_a_record_goes_out_and_comes_back(record: vibeam.Record) -> None:
    made = vibeam.to_sep005(record, name="shaker", start_timestamp="2024-03-01T10:00:00")
    require_rules(made)
    assert (made[0]["name"], made[0]["quantity"]) == ("shaker", record.quantity)
    back = vibeam.record_of_sep005(made)
    assert back.times == pytest.approx(record.times, abs=1e-12)
    assert back.at(record.times) == pytest.approx(record.at(record.times), abs=1e-9)


def test_a_motion_goes_out_at_a_rate() -> None:
    system = vibeam.ImpactSystem.from_modes(47.7, 0.017, 2.12, 0.46, gap=1e-3)
    path = vibeam.simulate(system, RECORD, t_end=0.1)
    (made,) = found = vibeam.to_sep005(path, 2000.0)
    require_rules(found)
    assert (made["unit_str"], made["quantity"], made["fs"], len(made["data"])) == ("m", "displacement", 2000.0, 201)
    assert made["data"] == pytest.approx(path.at(np.arange(201) / 2000), abs=0)
    for rate, message in ((None, "rate: of a motion it must be said, in Hz"), (-1.0, "rate: ")):
        with pytest.raises(ValueError, match=message):
            vibeam.to_sep005(path, rate)
    with pytest.raises(ValueError, match="Invalid isoformat string: 'yesterday'"):
        vibeam.to_sep005(RECORD, start_timestamp="yesterday")


def test_the_package_of_the_proposal_agrees() -> None:
    checked = pytest.importorskip("sdypy_sep005.sep005")
    checked.assert_sep005(vibeam.to_sep005(RECORD) + vibeam.to_sep005(UNEVEN, start_timestamp="2024-03-01T10:00:00"))
