"""Sections that the pages of all results have: scene, checks, figures of the case, provenance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Any

from vibeam.case.case import Case
from vibeam.exchange.faults import CaseError
from vibeam.figures import FIGURES
from vibeam.figures.units import METRIC, units_of
from vibeam.report.checks import check_report
from vibeam.report.output import StudySheet
from vibeam.report.page.drawing import drawing, mode_shapes
from vibeam.report.page.parts import KINDS, Picture, embedded, picture
from vibeam.runs.result import Result
from vibeam.runs.systems import Overview

PAGE_BYTES, MAP_BYTES = 1_350_000, 160_000  # of data and pictures together, of a picture that a map has beside it
PLANES = ("stability", "verdict")  # pictures of maps that a study makes


def standing(
    result: Any,
    modes: int,
    overview: Overview | None,
    provenance: Mapping[str, str],
    left_out: Sequence[str],
    room: int,
) -> dict[str, Any]:
    """Values of the sections that the pages of all results have.

    ``modes``: whose shapes are drawn; ``overview``: of the rig; ``room``: of the figures of the case, bytes.
    """
    pictures, absent = _pictures(result, room)
    return {
        "title": result.case.title,
        "result": result,
        "case": result.case,
        "drawings": _drawings(result.case, modes),
        "overview": overview,
        "no_beam": result.case.scene.no_beam,
        "checks": _checks(result, left_out),
        "pictures": pictures,
        "absent": absent,
        "provenance": sorted(provenance.items()),
    }


def _checks(result: Result, left_out: Sequence[str]) -> StudySheet:
    """References, regression values and measured numbers of the case, where each fidelity was run by itself."""
    from vibeam.studies.regression.check import check, compare_measured

    case = result.case
    lost = [f"{name}: no such file beside the results: name the case with --case to check it" for name in left_out]
    try:
        units = METRIC if case.swept is None else units_of(case)
        found = check_report(check(case, result), compare_measured(case, result), units)
    except CaseError as fault:
        return StudySheet(f"Not checked: {fault}", notes=lost)
    return replace(found, notes=[*lost, *found.notes])


def _drawings(case: Case, modes: int) -> list[Picture]:
    """The scene and so many mode shapes; none where it has no beam."""
    scene = case.scene
    shapes = mode_shapes(scene, modes)
    if shapes is None:
        return []
    return [Picture("Side view", "Side view to scale; what has no known shape is a box.", drawing(scene)), shapes]


def _pictures(result: Result, room: int) -> tuple[list[Picture], list[str]]:
    """Further figures and maps of the case as far as ``room`` (bytes) goes; which are not shown, and why."""
    from vibeam.report.figures import figure

    shown, absent = [], []
    shows = result.case.shows.items()
    plans = [(name, plan) for name, plan in shows if name in result.shown and not FIGURES[plan.kind].ending]
    made = (picture(name, f"Figure {name}: {plan.kind}", partial(figure, result, plan)) for name, plan in plans)
    for each in chain(made, (_map(result, name) or name for name in result.case.maps)):
        if isinstance(each, str):
            absent.append(f"Map {each}, which vibeam map draws beside the results")
        elif len(each.data) > room:
            absent.append(f"{each.words}, too large for this page")
        else:
            shown.append(each)
            room -= len(each.data)
    kept = [len(each.numbers) <= room // max(len(shown), 1) for each in shown]
    return [each if own else replace(each, numbers="") for each, own in zip(shown, kept, strict=True)], absent


def _map(result: Result, name: str) -> Picture | None:
    """Picture of a map beside the results: its own where that is no older than the map, else drawn from its motions."""
    from vibeam.maps.run import stored_map
    from vibeam.report.maps.page import map_figure

    path = result.path or result.case.path
    files = [path.with_name(f"{stem}_{name}.h5") for stem in (path.stem, result.case.path.stem)]
    found = next(filter(None, (stored_map(result.case, name, file) for file in files)), None)
    if found is None:
        return None
    stats = {file: file.stat() for kind in KINDS if (file := found.path.with_suffix(kind)).is_file()}
    sizes = {file: each.st_size for file, each in stats.items() if each.st_mtime >= found.path.stat().st_mtime}
    if sizes and min(sizes.values()) < MAP_BYTES:
        smallest = min(sizes, key=lambda file: sizes[file])
        return Picture(name, f"Map {name}", embedded(KINDS[smallest.suffix], smallest.read_bytes()))
    if found.plan.picture in PLANES:  # more than a picture: they would be studied anew
        return None
    words = f"Map {name}" + ", without its exact lines" * found.plan.boundaries
    return picture(name, words, partial(map_figure, found, exact=False))
