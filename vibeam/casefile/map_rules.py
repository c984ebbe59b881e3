"""Rules between the keys of a map: random starts, what a picture needs, what can be refined."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from vibeam.case.faults import Complaint, KeyPath
from vibeam.case.grid_keys import STARTS


def random_complaints(path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about random starts."""
    if table.starts is not None and table.spread is None:
        yield (*path, "spread"), 'missing: says how far from 0 motions start; write spread = "1 mm"'
    elif table.starts is None and table.spread is not None:
        yield (*path, "spread"), "goes with starts: say how many, or leave it away"


def picture_complaints(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about what the picture needs and the axes give."""
    axes, starts = len(table.axes or ()), [axis.key_ for axis in table.axes or () if axis.key_ in STARTS]
    if table.picture == "spectra" and any((axis.key_ or "").endswith(".modes") for axis in table.axes or ()):
        yield (*path, "picture"), '"spectra" is of one number of modes: take another axis'
    if table.quantity is not None and table.picture != "values":
        yield (*path, "quantity"), 'goes with picture = "values": leave it away'
    if table.picture in ("bifurcation", "spectra") and axes > 1:
        yield (*path, "axes"), f'picture = "{table.picture}" is of one axis, not {axes}'
    elif table.picture == "period" and axes == 1:
        yield (*path, "axes"), 'picture = "period" is of two axes or three: add one, or write picture = "values"'
    elif axes > 3:
        yield (*path, "axes"), f"{axes} axes cannot be drawn: three at most"
    if table.picture == "basins" and not starts and table.starts is None:
        said = "start.displacement and start.velocity as axes, or starts = 50"
        yield (*path, "picture"), f'"basins" is of motions with starts of their own: write {said}'
    elif table.picture == "basins" and starts and axes > 2:
        yield (*path, "axes"), 'picture = "basins" with starts as axes is of two axes at most'
    elif table.picture != "basins" and table.starts is not None:
        yield (*path, "picture"), f'"{table.picture}" shows one motion a point: with starts write "basins"'
    hold = case.sweep.hold if table.hold is None else table.hold
    if table.strobes is not None and hold is not None and table.strobes > hold:
        yield (*path, "strobes"), f"{table.strobes} values need as many periods held: hold is {hold}"


def refine_complaints(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a refined map: of points that are independent, and of labels."""
    at, keys = (*path, "refine"), [axis.key_ for axis in table.axes or ()]
    if table.picture not in ("period", "basins"):
        yield at, f'"{table.picture}" shows numbers, and refining follows labels: leave it away'
        return
    if table.starts is not None:
        yield at, "is of one motion a point: leave starts or refine away"
        return
    if direction_of(table, keys, case.sweep.direction) != "apart":
        yield (
            at,
            'flies points by themselves, and here the state is carried along the last axis: write direction = "apart"',
        )
    if len(keys) < 2 or (table.picture == "basins" and not all(key in STARTS for key in keys[-2:])):
        said = "start.displacement and start.velocity" if table.picture == "basins" else "two axes or three"
        yield at, f"halves cells of a plane: the axes must be {said}"
        return
    fewest = min(count_of(axis) for axis in table.axes[-2:])
    if 2**table.refine > fewest - 1:
        most = max(fewest - 1, 1).bit_length() - 1
        yield at, f"begins with every {2**table.refine}th point, and an axis has {fewest}: {most} at most"


def direction_of(table: Any, keys: list[str], swept: str | None) -> str:
    """Which way the last axis is swept: as said, else apart where motions have starts of their own, else the sweep's.

    Along a key that changes the modes nothing can be carried: also apart.
    """
    if table.direction is not None:
        return str(table.direction)
    return "apart" if table.starts is not None or any(key in STARTS for key in keys) else swept or "both"


def count_of(axis: SimpleNamespace) -> int:
    """Number of values of an axis."""
    return len(axis.values) if axis.values else axis.points or 1
