"""Damaged maps: the next call says so in one message, or ends with the data of an undisturbed one.

A finished map is one file; of a half-done one a block or the manifest is damaged, which is then computed anew.
"""

from __future__ import annotations

import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from commands import data_of
from damage import KINDS, damaged
from limited import Limits, run_limited
from map_kills import CASE
from verdict import Verdict
from workers import Stage

import vibeam
from vibeam.maps import run as running
from vibeam.store.steps import StepFile

SHORT = {
    "points = 100": "points = 6", "points = 65": "points = 9", "points = 40": "points = 8",
    "settle = 400": "settle = 60", "settle = 200": "settle = 60",
}  # fmt: skip

NAMES = ("plane", "starts")


class Ended(Exception):
    """The run that a map was left half done by."""


def computed(name: str, folder: Path, blocks: int | None = None) -> Path:
    """Compute the map into ``folder``, in small blocks; ``blocks``: end when so many are there."""
    case, path = folder / "rig.toml", folder / f"{name}.h5"
    text = CASE
    for long, short in SHORT.items():
        text = text.replace(long, short)
    case.write_text(text, encoding="utf-8")
    append, left = StepFile.append, [blocks]

    def ending(file: StepFile, *given: Any) -> None:
        if left[0] == 0:
            raise Ended
        left[0] = None if left[0] is None else left[0] - 1
        append(file, *given)

    kept = running.lines_of_block, append
    running.lines_of_block, StepFile.append = (lambda case, grid: 2), ending  # type: ignore[method-assign]
    try:
        vibeam.run_map(vibeam.load(case), name, path, workers=1)
    finally:
        running.lines_of_block, StepFile.append = kept  # type: ignore[method-assign]
    return path


@cache
def undisturbed(name: str) -> tuple[dict[str, bytes], bytes]:
    """Data and bytes of a map that nothing disturbed."""
    with tempfile.TemporaryDirectory() as folder:
        path = computed(name, Path(folder))
        return data_of(path), path.read_bytes()


@cache
def half_done(name: str) -> dict[str, bytes]:
    """Files of a map whose run ended after two blocks, by name."""
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        try:
            computed(name, folder, blocks=2)
        except Ended:
            return {file.name: file.read_bytes() for file in (folder / f"{name}.h5.parts").glob("[!.]*")}
    raise AssertionError(f"{name}: has two blocks or less")


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One map, finished or half done, damaged and then asked for."""
    rng = np.random.default_rng([seed, number])
    name, kind, verdict = str(rng.choice(NAMES)), KINDS[number % len(KINDS)], Verdict()
    data, content = undisturbed(name)
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        if rng.random() < 0.6:
            what, path, left = "map", folder / f"{name}.h5", {}
        else:
            left = half_done(name)
            what = str(rng.choice(sorted(left)))
            path = folder / f"{name}.h5.parts" / what
            path.parent.mkdir()
            content = left[what]
        for file, whole in left.items():
            (path.parent / file).write_bytes(whole)
        path.write_bytes(changed := damaged(content, kind, rng))
        stage(f"{name}, {what}, {kind}")
        ended = run_limited(lambda: _used(name, folder), folder, Limits())
        fault = ended.fault(Limits()) or ("" if ended.code else _difference(folder / f"{name}.h5", data))
        how = "told" if ended.code else "unharmed" if changed == content else "computed anew"
        verdict.count(f"{'finished' if what == 'map' else 'half done'}, {how}")
        verdict.hold(not fault, f"{name}, {what}, {kind}: {fault}")
        verdict.hold(what != "map" or how != "computed anew", f"{name}, {what}, {kind}: was taken for whole")
    return verdict


def _used(name: str, folder: Path) -> None:
    try:
        computed(name, folder)
    except vibeam.StoreError as fault:
        sys.stderr.write(f"{fault}\n")
        sys.exit(2)


def _difference(file: Path, wanted: dict[str, bytes]) -> str:
    try:
        found = data_of(file)
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        return f"a file that was taken cannot be read: {error}"
    differing = sorted(key for key in found.keys() | wanted.keys() if found.get(key) != wanted.get(key))
    return f"{len(differing)} data differ: {', '.join(differing[:4])}" if differing else ""
