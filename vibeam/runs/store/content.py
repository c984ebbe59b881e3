"""Content of a results file: a new one, the owner of an old one, its adaptation to a changed case or format."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.runs.store.branch import ROWS, Branch, count_points, lay_out, points_of, read_rows, write_rows
from vibeam.runs.store.checksum import CHECKSUM, sign
from vibeam.runs.store.disk import Image
from vibeam.runs.store.errors import StoreError, reading
from vibeam.runs.store.layout import fixed
from vibeam.runs.store.models import COMPARISON
from vibeam.runs.store.provenance import write_provenance
from vibeam.runs.store.reuse import Reuse, Wanted, adapt, groups_with_points, lost_with, reported, reuse_of

if TYPE_CHECKING:
    import h5py

    from vibeam.system.quantities import OutputUnits


def lay_out_anew(file: h5py.File, branch: Branch, units: OutputUnits, *, signed: bool) -> None:
    """Convert an older branch of the same case to the present layout, with its points.

    ``signed``: its points have checksums; ValueError where one does not fit.
    """
    group = file[branch.group]
    done = points_of(group)
    rows = read_rows(group) if signed else group
    values = {name: rows[name][:done] for name in ROWS}
    del file[branch.group]
    file[branch.fidelity].attrs.pop(CHECKSUM, None)  # data beside the branch no longer fit it
    present = lay_out(file, branch, units)
    if done:
        write_rows(present, 0, values)
        count_points(present, done)


FORMAT = "vibeam results 3"
UNSIGNED = "vibeam results 1"  # format with a key for the whole case alone, no checksums
OLDER = ("vibeam results 2", UNSIGNED)  # formats with other keys
Values = Mapping[str, Any]
SIGNATURE = b"\x89HDF\r\n\x1a\n"
OURS = re.compile(rb"vibeam results \d")
ELSEWHERE = "choose another --out, or start over with --fresh"


def blank(wanted: Wanted) -> Image:
    """New file: the case, the provenance, every branch with room for all its points."""
    import h5py

    image = Image()
    with h5py.File(image, "w") as file:
        file.attrs["format"] = fixed(FORMAT)
        _write_case(file, wanted)
        write_provenance(file.create_group("provenance"))
        for branch in wanted.branches:
            lay_out(file, branch, wanted.units)
    return image


def is_ours(content: bytes) -> bool:
    """Test whether bytes are those of a results file, even a damaged one."""
    return content.startswith(SIGNATURE) and OURS.search(content) is not None


def format_of(file: h5py.File) -> str | None:
    """Format number stored in the file."""
    return str(file.attrs["format"].decode()) if "format" in file.attrs else None


def adapted(file: h5py.File, path: Path, wanted: Wanted) -> str | None:
    """Adapt the file to ``wanted``: the changes in one line, empty where no number changes, None without any.

    StoreError where it is another case's, so that nothing in it would stay, where it has more points, or is damaged.
    """
    older = format_of(file) in OLDER
    if older:
        _refuse_another(file, path, wanted)
        with reading(path, "its groups"):
            _convert(file, wanted)
    reuses = [_reuse(file, path, branch) for branch in wanted.branches]
    if all(reuse.fits for reuse in reuses) and _says(file, path, wanted):
        return "brought to the present format" if older else _renewed(file, path, wanted)
    if _text(file, path, "shared") != wanted.shared and lost_with(file, reuses):
        raise _another_case(path, _values(file, path, "shared"), _flat(wanted.shared))
    for reuse in reuses:
        if reuse.shrinks:
            points = f"{reuse.stored} points of {reuse.branch.group}, and this case has {len(reuse.branch.frequency)}"
            raise StoreError(f"{path}: holds {points}: {ELSEWHERE}")
    return _adapt(file, path, wanted, reuses)


def _adapt(file: h5py.File, path: Path, wanted: Wanted, reuses: list[Reuse]) -> str:
    with reading(path, "its groups"):
        named = {branch.group for branch in wanted.branches}
        others = [name for name in groups_with_points(file) if name not in named]
        adapt(file, reuses, wanted.units)
        file.pop(COMPARISON, None)
        del file["case"]
        _write_case(file, wanted)
    return reported(reuses, others)


def _renewed(file: h5py.File, path: Path, wanted: Wanted) -> str | None:
    """Bring title, checks and figures of the case up to date, which decide no number of a branch: nothing to tell."""
    if wanted.whole in ("", whole_case(file, path)):
        return None
    with reading(path, "/case"):
        del file["case"]
        _write_case(file, wanted)
    return ""


def whole_case(file: h5py.File, path: Path) -> str:
    """The case of the file as TOML; of a file that does not hold it, what decides its numbers."""
    with reading(path, "/case"):
        return _text(file, path, "whole" if "whole" in file["case"] else "text")


def _reuse(file: h5py.File, path: Path, branch: Branch) -> Reuse:
    with reading(path, f"/{branch.group}"):
        reuse = reuse_of(file, branch)
        if not reuse.fits and branch.group in file:
            read_rows(file[branch.group])  # damage is reported as such, not as another case
        return reuse


def _another_case(path: Path, stored: Values, present: Values) -> StoreError:
    """Error for a file of a case that shares nothing with this one: names the first difference."""
    key = next((key for key in {**stored, **present} if stored.get(key) != present.get(key)), "its key")
    there, here = (repr(values.get(key, "nothing")) for values in (stored, present))
    return StoreError(f"{path}: holds another case ({key} = {there} there, {here} here): {ELSEWHERE}")


def _refuse_another(file: h5py.File, path: Path, wanted: Wanted) -> None:
    """Refuse an older file of another case; its keys are others, its text says what it is of."""
    stored, present = _values(file, path, "text"), _flat(wanted.text)
    if stored != present:
        raise _another_case(path, stored, present)


def _convert(file: h5py.File, wanted: Wanted) -> None:
    """Convert every branch of an older file; curves, figures and studies are computed again."""
    for branch in wanted.branches:
        lay_out_anew(file, branch, wanted.units, signed=format_of(file) != UNSIGNED)
    del file["case"]
    _write_case(file, wanted)
    file.attrs["format"] = fixed(FORMAT)


def _write_case(file: h5py.File, wanted: Wanted) -> None:
    group = file.create_group("case")
    group.attrs["key"] = fixed(wanted.key)
    group["text"], group["shared"] = fixed(wanted.text), fixed(wanted.shared)
    if wanted.whole:
        group["whole"] = fixed(wanted.whole)
    sign(group)


def _text(file: h5py.File, path: Path, name: str) -> str:
    with reading(path, f"/case/{name}"):
        return str(file["case"][name][()].decode())


def _says(file: h5py.File, path: Path, wanted: Wanted) -> bool:
    """Test whether the file says of its case what ``wanted`` says."""
    with reading(path, "/case"):
        key = file["case"].attrs["key"].decode()
    found = (key, _text(file, path, "text"), _text(file, path, "shared"))
    return found == (wanted.key, wanted.text, wanted.shared)


def _values(file: h5py.File, path: Path, name: str) -> Values:
    text = _text(file, path, name)
    with reading(path, f"/case/{name}"):
        return _flat(text)


def _flat(text: str) -> Values:
    """Values of a case by dotted key, less what is empty."""
    return {key: value for key, value in _dotted(tomllib.loads(text), "") if value != []}


def _dotted(table: Values, above: str) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _dotted(value, f"{above}{key}.")
        else:
            yield above + key, value
