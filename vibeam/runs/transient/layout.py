"""Layout of a fidelity's motions in the results file: a row each, impacts of all one after the other, with units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.transient.motions import Realisation
from vibeam.runs.transient.reading import READINGS, Reading
from vibeam.runs.transient.signals import TransientSignal
from vibeam.store.hdf5 import describe_codes, described, fixed, scale
from vibeam.system.response import Ended

if TYPE_CHECKING:
    import h5py

IDENTITY = ("value", "seed", "shown", "twin")
HISTORY = ("history_edges", "history_least", "history_greatest", "input_least", "input_greatest")
UNITS = {"q": "unit of the signal", "q2 Hz-1": "unit of the signal squared, s", "c/s": "m s-1", "E": "J"}
Row = tuple[dict[str, Any], Reading]


def write_group(
    group: h5py.Group, signals: Sequence[TransientSignal], period: float, motions: Sequence[tuple[Realisation, Reading]]
) -> None:  # fmt: skip
    """Write the motions of one fidelity: the datasets of ``READINGS`` over the motions and their own dimensions."""
    group.attrs["period"] = np.float64(period)
    for what in ("name", "output", "unit"):
        group[f"signal_{what}"] = [fixed(getattr(each, what)).item() for each in signals]
    group["signal_order"] = np.array([each.order for each in signals], dtype=np.int64)
    group["key"] = [fixed(motion.key).item() for motion, _ in motions]
    whole = [own for _, own in motions if "left" in own]
    group["read"] = np.array(["left" in own for _, own in motions], dtype=np.int64)
    row = scale(group, "motion", np.arange(len(motions)), "number of the motion", "1")
    for what in IDENTITY:
        values = np.array([int(getattr(motion, what)) for motion, _ in motions], dtype=np.int64)
        described(group, what, values, f"{what} of the motion", "1", row)
    described(group, "ended", np.array([int(own["ended"]) for _, own in motions], dtype=np.int64),
              READINGS["ended"].long_name, "1", row)  # fmt: skip
    describe_codes(group["ended"], Ended)
    if whole:
        _write_readings(group, whole)
    for motion, own in motions:
        if "history_edges" in own:
            history = group.create_group(f"histories/{motion.value}-{motion.seed}")
            for name in HISTORY:
                history.create_dataset(name, data=own[name], compression="gzip" if own[name].size > 2 else None)


def _write_readings(group: h5py.Group, whole: Sequence[Reading]) -> None:
    """Write the rows of the motions that were read."""
    for name, quantity in READINGS.items():
        unit = UNITS.get(quantity.unit, quantity.unit)
        if name == "ended":
            continue
        if quantity.dimensions == ("impact",):
            values = np.concatenate([own[name] for own in whole])
        else:
            values = _stacked([own[name] for own in whole])
        described(group, name, values, quantity.long_name, unit)
    group["impact_count"] = np.array([len(own["impact_times"]) for own in whole], dtype=np.int64)
    group["mode_count"] = np.array([len(own["left"]) for own in whole], dtype=np.int64)


def _stacked(values: Sequence[Any]) -> Any:
    """Arrays of one dimensionality as one: NaN where one is shorter, as with fewer modes."""
    shape = tuple(np.max([each.shape for each in values], axis=0)) if values[0].ndim else ()
    if all(each.shape == shape for each in values):
        return np.stack(values)
    found = np.full((len(values), *shape), np.nan)
    for at, each in enumerate(values):
        place: tuple[Any, ...] = (at, *(slice(0, size) for size in each.shape))
        found[place] = each
    return found


def read_group(group: h5py.Group) -> tuple[tuple[TransientSignal, ...], float, list[Row]]:
    """Signals of a fidelity, its first natural period, its motions: what each is, and its reading."""
    told = zip(*(group[f"signal_{what}"][()] for what in ("name", "output", "order", "unit")), strict=True)
    signals = tuple(TransientSignal(a.decode(), b.decode(), int(c), d.decode()) for a, b, c, d in told)
    identity = {what: group[what][()] for what in IDENTITY}
    readings = iter(_read_readings(group))
    rows: list[Row] = []
    for at, (key, read) in enumerate(zip(group["key"][()], group["read"][()], strict=True)):
        own: Reading = {"ended": np.asarray(group["ended"][at])}
        own |= next(readings) if read else {}
        what: dict[str, Any] = {name: int(values[at]) for name, values in identity.items()}
        what |= {"shown": bool(what["shown"]), "twin": bool(what["twin"]), "key": key.decode()}
        place = f"histories/{what['value']}-{what['seed']}"
        if what["shown"] and place in group:
            own |= {name: group[place][name][()] for name in HISTORY}
        rows.append((what, own))
    return signals, float(group.attrs["period"]), rows


def _read_readings(group: h5py.Group) -> list[Reading]:
    if "impact_count" not in group:
        return []
    counts, modes = group["impact_count"][()], group["mode_count"][()]
    ends = np.cumsum(counts)
    columns = {name: group[name][()] for name in READINGS if name != "ended"}
    found: list[Reading] = []
    for at, (end, count, size) in enumerate(zip(ends, counts, modes, strict=True)):
        own: Reading = {}
        for name, values in columns.items():
            kind = READINGS[name].dimensions
            own[name] = values[end - count : end] if kind == ("impact",) else np.asarray(values[at])
            if kind == ("mode",):
                own[name] = own[name][:size]
        found.append(own)
    return found
