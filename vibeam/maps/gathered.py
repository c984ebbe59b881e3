"""The file of a finished map: HDF5 that NetCDF's readers take, written block by block, sealed, put in place whole."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, prod, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import units_of_output
from vibeam.exchange.whole_files import is_sealed, write_at
from vibeam.maps.block import DTYPES, Block, Grid
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.points import shape_of
from vibeam.store.blocks import Values
from vibeam.store.errors import ANEW, ELSEWHERE, StoreError, unopened
from vibeam.store.hdf5 import SIGNATURE, SparseImage, scale, without_values
from vibeam.store.place import Place
from vibeam.store.provenance import write_provenance
from vibeam.system.quantities import FURTHER, LAYOUT, DatasetQuantity, unit_of

if TYPE_CHECKING:
    import h5py

    from vibeam.case.case import Case
    from vibeam.case.grid_keys import MapPlan

FORMAT = "vibeam map 1"
BEGIN = 1 << 20  # bytes in which a file states its format: its first attribute
OTHER = f"is no file of a map: {ELSEWHERE}, or delete it"
UNSEALED = "its digest does not fit (it is damaged, was changed since, or is no map of this version)"
SHOWN = 4_000_000  # points of a quantity that are read back at most: for pictures


@dataclass(frozen=True)
class Source:
    """One grid, and its blocks in order, each with its values, as often as they are asked for."""

    grid: Grid
    blocks: Callable[[], Iterator[tuple[Block, Values]]]

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of each quantity over the grid: ways, axes, random starts, what it has of its own."""
        _, values = next(self.blocks())
        of_points = 1 + len(self.grid.shape)
        whole = (len(self.grid.ways) or 1, *shape_of(self.grid.axes), *self.grid.shape[2:])
        return {name: (*whole, *each.shape[of_points:]) for name, each in values.items()}

    def pieces(self) -> Iterator[tuple[str, int, NDArray[Any]]]:
        """Quantity by name, the number of its first value in the file, and values from there on."""
        for block, values in self.blocks():
            for name, rows in values.items():
                for way in range(rows.shape[1]):
                    line = way * self.grid.lines + block.first
                    yield name, line * prod(rows.shape[2:]), rows[:, way]


def gather(place: Place, case: Case, plan: MapPlan, keys: Mapping[str, str], sources: Sequence[Source]) -> None:
    """Write the file of a map from its blocks, one in memory at a time; StoreError where the disk fails."""
    import h5py

    image = SparseImage()
    with h5py.File(image, "w") as file:
        file.attrs.update({"format": FORMAT, "map": plan.name, "case": case.text, "keys": json.dumps(dict(keys))})
        write_provenance(file.create_group("provenance"))
        groups = [(source, file.create_group(source.grid.fidelity)) for source in sources]
        rooms = [(source, _laid_out(group, case, plan, source)) for source, group in groups]

    def fill(handle: int) -> None:
        image.write_to(handle)
        for source, room in rooms:
            for name, first, values in source.pieces():
                start, dtype = room[name]
                content = np.ascontiguousarray(values, dtype)
                write_at(handle, start + first * dtype.itemsize, content.data.cast("B"))

    place.fill(fill)


def _laid_out(group: h5py.Group, case: Case, plan: MapPlan, source: Source) -> dict[str, tuple[int, np.dtype[Any]]]:
    """Lay out the quantities of a grid; of each the first byte of its values in the file, and their type."""
    scales, units = _scales(group, plan, source.grid), units_of_output(case, plan.output)
    rooms = {}
    for name, shape in source.shapes().items():
        data, start = without_values(group, name, shape, dtype := np.dtype(DTYPES.get(name, "f8")))
        _label(data, scales, LAYOUT.get(name, FURTHER.get(name)), units)
        rooms[name] = start, dtype
    return rooms


def _scales(group: h5py.Group, plan: MapPlan, grid: Grid) -> list[h5py.Dataset]:
    """Coordinates: direction, the axes, random starts where there are."""
    found = [group.create_dataset("direction", data=np.array(list(grid.ways or ("apart",)), dtype="S6"))]
    found[0].make_scale("direction")
    found += [scale(group, axis.key, np.array(axis.values), axis.key, axis.unit or "1") for axis in plan.axes]
    if grid.starts is not None:
        found.append(group.create_dataset("start", data=np.arange(grid.starts.count)))
        found[-1].make_scale("start")
    if grid.strobes:
        found.append(group.create_dataset("strobe", data=np.arange(1 - grid.strobes, 1)))
        found[-1].attrs["long_name"] = "drive periods before the end"
        found[-1].make_scale("strobe")
    return found


def _label(data: h5py.Dataset, scales: Sequence[h5py.Dataset], described: DatasetQuantity | None, units: Any) -> None:
    fitting = [each for each in scales if data.name.endswith("/strobes") or not each.name.endswith("/strobe")]
    for dimension, each in zip(data.dims, fitting, strict=False):
        dimension.attach_scale(each)
    if described is not None:
        data.attrs["units"] = unit_of(described, units)
        data.attrs["long_name"] = described.long_name


def is_ours(path: Path) -> bool:
    """Test whether a file is that of a map, of any version, even a damaged one."""
    with path.open("rb") as file:
        begin = file.read(BEGIN)
    return begin.startswith(SIGNATURE) and re.search(rb"vibeam map \d+", begin) is not None


def finished(place: Place, keys: Mapping[str, str]) -> bool:
    """Test whether the file of a map is there with all its points; errors as ``stored_keys``."""
    return stored_keys(place) == dict(keys)


def stored_keys(place: Place) -> dict[str, str] | None:
    """Keys of the grids of the map in the file; None without one. StoreError where it is damaged or no map's."""
    import h5py

    path = place.path
    if not place.target.exists():
        return None
    try:
        if not is_ours(place.target):
            raise StoreError(f"{path}: {OTHER}")
        if not is_sealed(place.target):
            raise StoreError(f"{path}: {UNSEALED}: {ANEW}")
        with h5py.File(place.target, "r") as file:
            stated, keys = file.attrs.get("format"), json.loads(file.attrs.get("keys", "{}"))
    except OSError as fault:
        raise unopened(path, fault) from None
    if stated != FORMAT:
        raise StoreError(f"{path}: is a map of another version: {ANEW}")
    return dict(keys)


def read_map(path: Path, grids: Mapping[str, Grid]) -> dict[str, GridResponse]:
    """Quantities of each fidelity; of more than ``SHOWN`` points, every so many along the last two axes."""
    import h5py

    with h5py.File(path, "r") as file:
        return {name: _response(file[name], grid) for name, grid in grids.items()}


def _response(group: h5py.Group, grid: Grid) -> GridResponse:
    steps = steps_of(grid, SHOWN)
    axes = {axis.key: np.array(axis.values)[::step] for axis, step in zip(grid.axes, steps, strict=True)}
    where = (slice(None), *(slice(None, None, step) for step in steps))
    values: dict[str, NDArray[Any]] = {name: np.asarray(group[name][where]) for name in grid.quantities}
    return GridResponse(grid.fidelity, axes, grid.ways or ("apart",), values)


def steps_of(grid: Grid, most: int) -> tuple[int, ...]:
    """Step along each axis with which no more than about ``most`` numbers of a quantity are kept."""
    shape = shape_of(grid.axes)
    numbers = prod(shape) * grid.shape[0] * prod(grid.shape[2:]) * max(grid.strobes, 1)
    last = min(2, len(shape))
    step = max(1, ceil(numbers / most)) if last == 1 else max(1, ceil(sqrt(numbers / most)))
    return (1,) * (len(shape) - last) + (step,) * last
