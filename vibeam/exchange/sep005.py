"""Signals as other Python programs hand them on: dictionaries of SDyPy's enhancement proposal 5 (SEP 5).

A channel has ``data``, ``name``, ``unit_str`` and ``fs`` or ``time``; it may have ``quantity`` and timestamps. Rules:
https://github.com/sdypy/sdypy/blob/main/docs/seps/sep-0005.rst, which the package sdypy-sep005 checks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import size_in
from vibeam.exchange.curves.record import factor
from vibeam.exchange.faults import suggest
from vibeam.exchange.files import read_by
from vibeam.exchange.time_series import UNITS
from vibeam.system.record import Record
from vibeam_models.arguments import number, refuse

Channel = Mapping[str, Any]


def record_of_sep005(
    channels: Channel | Sequence[Channel], name: str | None = None, *, quantity: str | None = None,
    unit: str | None = None, interpolation: str | None = None, remove: str | None = None,
) -> Record:  # fmt: skip
    """Record of the channel by this ``name``, or of the only one.

    ``quantity``, ``interpolation``, ``remove``: as in ``Record.sampled``; None: the channel's quantity, or the one
    that its unit is of. ``unit`` goes before the channel's. Timestamps are checked and not kept. ValueError with the
    cure for a channel that does not follow the rules, and for what is no record.

    >>> import numpy as np, vibeam
    >>> shock = {"name": "table", "data": np.array([0.0, 2.0, 0.0]), "fs": 1000.0, "unit_str": "g"}
    >>> vibeam.record_of_sep005([shock])
    Record(acceleration, 0 … 0.002 s, 2 pieces, peak 19.6133 m/s², samples linear)
    """
    one = _chosen([channels] if isinstance(channels, Mapping) else list(channels), name)
    said = str(one["unit_str"]) if unit is None else unit
    if not said.strip():
        raise ValueError(f"channel {one['name']!r}: its unit_str is empty: say unit = …")
    asked = quantity or _quantity(one, said)
    scale = factor(said, UNITS[asked]) if asked in UNITS else 1.0  # Record.sampled refuses other quantities
    when = {"times": one["time"]} if "time" in one else {"rate": one["fs"]}
    data = np.asarray(one["data"], dtype=float) * scale
    return Record.sampled(data, **when, quantity=asked, interpolation=interpolation, remove=remove)


def to_sep005(
    motion: Any, rate: float | None = None, *, name: str = "", start_timestamp: str | None = None
) -> list[dict[str, Any]]:
    """One channel of a ``Record``, or of the contact's displacement of a ``Trajectory``, ``rate`` samples a second.

    Without a rate a record is taken at its knots. ``start_timestamp``: date and time of time 0 as ISO 8601.

    >>> import vibeam
    >>> (channel,) = vibeam.to_sep005(vibeam.Record.sampled([0.0, 9.0, 0.0], rate=100.0))
    >>> channel["name"], channel["unit_str"], channel["fs"], channel["data"].tolist()
    ('acceleration', 'm/s^2', 100.0, [0.0, 9.0, 0.0])
    """
    faults: list[str] = []
    record = isinstance(motion, Record)
    quantity = motion.quantity if isinstance(motion, Record) else "displacement"
    if rate is not None:
        rate = number("rate", rate, faults, above=0.0)
    elif not record:
        faults.append("rate: of a motion it must be said, in Hz")
    refuse("to_sep005", faults)
    start, end = (motion.start, motion.end) if record else (motion.t_start, motion.t_end)
    times = motion.times if rate is None else start + np.arange(int((end - start) * rate * (1 + 1e-12)) + 1) / rate
    spacing = motion.spacing if rate is None else 1 / rate
    clock = {"fs": 1 / spacing} if spacing and not start else {"time": np.asarray(times)}
    when = {} if start_timestamp is None else {"start_timestamp": start_timestamp}
    made = {"name": name or quantity, "quantity": quantity, "unit_str": UNITS[quantity], **clock, **when}
    _require_rules(made | {"data": np.asarray(motion.at(times))})
    return [made | {"data": np.asarray(motion.at(times))}]


def _chosen(channels: Sequence[Channel], name: str | None) -> Channel:
    for each in channels:
        _require_rules(each)
    names = [str(each["name"]) for each in channels]
    fitting = [each for each in channels if name in (None, each["name"])]
    if len(fitting) != 1:
        told = "say its name" if name is None else f"{len(fitting)} are called {name!r}: {suggest(name, names)}"
        raise ValueError(f"{len(channels)} channels, {', '.join(names[:12]) or 'none'}: {told}")
    return fitting[0]


def _require_rules(one: Channel) -> None:
    """ValueError for a channel without what it must have, and with what it may not have."""
    if not isinstance(one, Mapping):
        raise ValueError("channels: must be dictionaries")
    missing = [key for key in ("data", "name", "unit_str") if key not in one]
    missing += [] if "time" in one or "fs" in one else ["fs or time"]
    if missing:
        raise ValueError(f"channel {one.get('name', '')!r}: without {', '.join(missing)}; it has {', '.join(one)}")
    for key in (key for key in one if key.lower().endswith("timestamp")):
        if key.lower() == "timestamp":
            raise ValueError(f"channel {one['name']!r}: 'timestamp' is none of the keys: write start_timestamp")
        with read_by(f"channel {one['name']!r}: {key} {one[key]!r} is not as ISO 8601 writes it", ValueError):
            datetime.fromisoformat(str(one[key]))


def _quantity(one: Channel, unit: str) -> str:
    """Quantity of a channel: the one that it says, or that its unit is of; ValueError where they differ."""
    said = str(one.get("quantity") or "").casefold()[:3]
    fitting = [quantity for quantity, si in UNITS.items() if size_in(unit, si) is not None]
    known = [quantity for quantity in UNITS if said and quantity.startswith(said)]
    if known and known[0] not in fitting:
        raise ValueError(f"channel {one['name']!r}: the quantity {known[0]!r} is not in {unit!r}: say unit = …")
    if not known and len(fitting) != 1:
        raise ValueError(f"channel {one['name']!r}: its unit {unit!r} is of no quantity of a record: say quantity = …")
    return (known or fitting)[0]
