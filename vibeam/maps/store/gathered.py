"""The file of a finished map: HDF5 that NetCDF's readers take, written block by block and put in place whole."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, prod, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.outputs import units_of_output
from vibeam.exchange.whole_files import regular
from vibeam.maps.axes import shape_of
from vibeam.maps.block import DTYPES, Block, Grid, Values
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.refined import FLOWN, over_grid
from vibeam.run.store.errors import StoreError, unwritable
from vibeam.run.store.provenance import write_provenance
from vibeam.system.quantities import LAYOUT, Quantity, unit_of

if TYPE_CHECKING:
    import h5py

    from vibeam.case.case import Case
    from vibeam.case.plans import MapPlan

FORMAT = "vibeam map 1"

SHOWN = 4_000_000  # points of a quantity that are read back at most: for pictures

OWN: Mapping[str, Quantity] = {
    "energy": Quantity("time-mean energy of all modes", "E"),
    "lyapunov": Quantity("largest Lyapunov exponent", "1/s"),  # type: ignore[arg-type]
    FLOWN: Quantity("1: flown itself; 0: has what its cell's corner has", "1"),
    "strobes": Quantity("output at the end of the last drive periods", "q"),
}


@dataclass(frozen=True)
class Source:
    """Blocks of one grid in order, each with its values, and the digest that each had."""

    grid: Grid
    blocks: Iterable[tuple[Block, Values, str]]


def gather(path: Path, case: Case, plan: MapPlan, keys: Mapping[str, str], sources: Iterable[Source]) -> None:
    """Write the file of a map from its blocks, one in memory at a time; StoreError where the disk fails."""
    import h5py

    target = regular(path)
    part = target.with_name(f".{target.name}.part")  # the lock is held: there is no other
    try:
        with h5py.File(part, "w") as file:
            file.attrs.update({"format": FORMAT, "map": plan.name, "case": case.text, "keys": json.dumps(dict(keys))})
            write_provenance(file.create_group("provenance"))
            for source in sources:
                _write(file.create_group(source.grid.fidelity), case, plan, source)
        handle = os.open(part, os.O_RDONLY)
        os.fsync(handle)
        os.close(handle)
        os.replace(part, target)
    except OSError as fault:
        raise unwritable(path, fault, "make room, then run again to go on") from None
    finally:
        part.unlink(missing_ok=True)


def _write(group: h5py.Group, case: Case, plan: MapPlan, source: Source) -> None:
    scales, units = _scales(group, plan, source.grid), units_of_output(case, plan.output)

    def made(name: str, *shape: int, **more: Any) -> h5py.Dataset:
        data = group.create_dataset(name, shape, DTYPES.get(name, "f8"), **more)
        _label(data, scales, LAYOUT.get(name, OWN.get(name)), units)
        return data

    digests = (_by_points if source.grid.refine else _by_lines)(group, source, made)
    group.attrs["blocks"] = json.dumps(digests)


def _by_lines(group: h5py.Group, source: Source, made: Callable[..., h5py.Dataset]) -> list[str]:
    """Write block by block; the digests of the blocks."""
    grid, digests = source.grid, list[str]()
    whole = (len(grid.ways) or 1, *shape_of(grid.axes), *grid.shape[2:])
    for block, values, digest in source.blocks:
        digests.append(digest)
        for name, rows in values.items():
            if name not in group:
                made(name, *whole, *rows.shape[len(grid.shape) + 1 :])
            for at, lines in runs(grid, block):
                piece = np.moveaxis(rows[lines], 0, 1)
                group[name][(slice(None), *at)] = piece if at else piece[:, 0]
    return digests


def _by_points(group: h5py.Group, source: Source, made: Callable[..., h5py.Dataset]) -> list[str]:
    """Write a refined grid, all points of which have a number."""
    blocks = list(source.blocks)
    every = over_grid(source.grid, [(block, values) for block, values, _ in blocks], source.grid.quantities)
    for name, values in every.items():
        made(name, *values.shape, data=values)
    return [digest for *_, digest in blocks]


def runs(grid: Grid, block: Block) -> Iterator[tuple[tuple[Any, ...], slice]]:
    """Places of a block's lines in the axes above the last: whole stretches of the innermost of these."""
    above = shape_of(grid.axes)[:-1]
    if not above:
        yield (), slice(0, 1)
        return
    inner, line = above[-1], block.first
    while line < block.last:
        *outer, first = (int(each) for each in np.unravel_index(line, above))
        last = min(first + block.last - line, inner)
        yield (*outer, slice(first, last)), slice(line - block.first, line - block.first + last - first)
        line += last - first


def _scales(group: h5py.Group, plan: MapPlan, grid: Grid) -> list[h5py.Dataset]:
    """Coordinates: direction, the axes, random starts where there are."""
    direction = group.create_dataset("direction", data=np.array(list(grid.ways or ("apart",)), dtype="S5"))
    found = [direction]
    for axis in plan.axes:
        scale = group.create_dataset(axis.key, data=np.array(axis.values))
        scale.attrs["units"] = axis.unit or "1"
        scale.attrs["long_name"] = axis.key
        found.append(scale)
    if grid.starts is not None:
        found.append(group.create_dataset("start", data=np.arange(grid.starts.count)))
    if grid.strobes:
        found.append(group.create_dataset("strobe", data=np.arange(1 - grid.strobes, 1)))
        found[-1].attrs["long_name"] = "drive periods before the end"
    for scale in found:
        scale.make_scale(scale.name.rsplit("/", 1)[-1])
    return found


def _label(data: h5py.Dataset, scales: Sequence[h5py.Dataset], described: Quantity | None, units: Any) -> None:
    fitting = [scale for scale in scales if data.name.endswith("/strobes") or not scale.name.endswith("/strobe")]
    for dimension, scale in zip(data.dims, fitting, strict=False):
        dimension.attach_scale(scale)
    if described is not None:
        data.attrs["units"] = unit_of(described, units)
        data.attrs["long_name"] = described.long_name


def finished(path: Path, keys: Mapping[str, str]) -> bool:
    """Test whether the file of a map is there with all its points; StoreError where it is another's."""
    import h5py

    if not path.exists():
        return False
    try:
        with h5py.File(path, "r") as file:
            said, found = file.attrs.get("format"), file.attrs.get("keys", "{}")
    except OSError as fault:
        raise StoreError(f"{path}: cannot be read as a map ({fault}): choose another --out, or delete it") from None
    if said != FORMAT:
        raise StoreError(f"{path}: is no file of a map: choose another --out, or delete it")
    if json.loads(found) != dict(keys):
        raise StoreError(
            f"{path}: holds another map, or this one before its case changed: choose another --out, or start over "
            "with --fresh"
        )
    return True


def read_map(path: Path, grids: Mapping[str, Grid], most: int = SHOWN) -> dict[str, GridResponse]:
    """Quantities of each fidelity; of more than ``most`` points, every so many along the last two axes."""
    import h5py

    with h5py.File(path, "r") as file:
        return {name: _response(file[name], grid, most) for name, grid in grids.items()}


def _response(group: h5py.Group, grid: Grid, most: int) -> GridResponse:
    steps = steps_of(grid, most)
    axes = {axis.key: np.array(axis.values)[::step] for axis, step in zip(grid.axes, steps, strict=True)}
    where = (slice(None), *(slice(None, None, step) for step in steps))
    names = (*grid.quantities, *((FLOWN,) if grid.refine else ()))
    values: dict[str, NDArray[Any]] = {name: np.asarray(group[name][where]) for name in names}
    return GridResponse(grid.fidelity, axes, grid.ways or ("apart",), values)


def steps_of(grid: Grid, most: int) -> tuple[int, ...]:
    """Step along each axis with which no more than about ``most`` numbers of a quantity are kept."""
    shape = shape_of(grid.axes)
    numbers = prod(shape) * grid.shape[0] * prod(grid.shape[2:]) * max(grid.strobes, 1)
    last = min(2, len(shape))
    step = max(1, ceil(numbers / most)) if last == 1 else max(1, ceil(sqrt(numbers / most)))
    return (1,) * (len(shape) - last) + (step,) * last
