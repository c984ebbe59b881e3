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
from vibeam.exchange.faults import suggest
from vibeam.exchange.time_series import UNITS
from vibeam.exchange.units import factor
from vibeam.system.record import Record
from vibeam_models.arguments import number, refuse

Channel = Mapping[str, Any]
CLOCK = {"fs", "time"}


def record_of_sep005(
    channels: Channel | Sequence[Channel], name: str | None = None, *, quantity: str | None = None,
    unit: str | None = None, interpolation: str | None = None, remove: str | None = None,
) -> Record:  # fmt: skip
    """Record of the channel by this ``name``, or of the only one.

    ``quantity``, ``interpolation``, ``remove``: as in ``Record.sampled``; None: the quantity that its unit is of.
    ``unit`` goes before the channel's. Timestamps are not kept. ValueError with the cure for what is no record.

    >>> import numpy as np, vibeam
    >>> shock = {"name": "table", "data": np.array([0.0, 2.0, 0.0]), "fs": 1000.0, "unit_str": "g"}
    >>> vibeam.record_of_sep005([shock])
    Record(acceleration, 0 … 0.002 s, 2 pieces, peak 19.6133 m/s², samples linear)
    """
    one = _chosen([channels] if isinstance(channels, Mapping) else list(channels), name)
    said = str(one["unit_str"] if unit is None else unit)
    asked = str(quantity or one.get("quantity") or "").casefold()
    fitting = [each for each, si in UNITS.items() if size_in(said, si) is not None and each.startswith(asked[:3])]
    if not said.strip() or len(fitting) != 1:
        told = f"its unit {said!r} is not of {asked or 'one quantity of a record'}"
        raise ValueError(f"channel {one['name']!r}: {told}: say quantity = … ({', '.join(UNITS)}), or unit = …")
    when = {"times": one["time"]} if "time" in one else {"rate": one["fs"]}
    data = np.asarray(one["data"], dtype=float) * factor(said, UNITS[fitting[0]])
    return Record.sampled(data, **when, quantity=fitting[0], interpolation=interpolation, remove=remove)


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
    when = {} if start_timestamp is None else {"start_timestamp": datetime.fromisoformat(start_timestamp).isoformat()}
    made = {"name": name or quantity, "quantity": quantity, "unit_str": UNITS[quantity], **clock, **when}
    return [made | {"data": np.asarray(motion.at(times))}]


def _chosen(channels: Sequence[Channel], name: str | None) -> Channel:
    """The channel by its name; ValueError where it is not one, or without what it must have."""
    for each in channels:
        if not isinstance(each, Mapping) or not {"data", "name", "unit_str"} <= each.keys() or not CLOCK & each.keys():
            there = ", ".join(each) if isinstance(each, Mapping) else repr(each)
            raise ValueError(f"a channel must have data, name, unit_str, and fs or time, and one has {there}")
    names = [str(each["name"]) for each in channels]
    fitting = [each for each in channels if name in (None, each["name"])]
    if len(fitting) != 1:
        cure = "say its name" if name is None else f"{len(fitting)} are called {name!r}: {suggest(name, names)}"
        raise ValueError(f"{len(channels)} channels, {', '.join(names[:12]) or 'none'}: {cure}")
    return fitting[0]
