"""Loop of a motion as pieces of VTU files: beams, stops and, where there is one, the opposite beam."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.vtu import Step, VtuPiece, centre_line
from vibeam.figures.sheet import Sheet
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from collections.abc import Mapping


def steps_of(sheets: Sequence[Sheet]) -> list[Step]:
    """Steps of all loops, in s from the drive's phase 0; shorter loops end before longer ones.

    Every piece has the fields ``displacement``, ``velocity`` and ``rotation`` (k, 3), ``thickness`` (k,), and
    ``impact`` (k,): on the point that is struck its velocity just before, in the frame nearest to the impact, else 0.
    Beams and stops stand on the x axis and their displacement is along z, a stop's that of a beam that touches it, so
    that "Warp By Vector" with any factor keeps the contact. The same of an opposite beam, which stands off by the gap.
    """
    known = [sheet for sheet in sheets if not sheet.fault]
    times = np.unique(np.concatenate([np.empty(0), *(sheet["time"] for sheet in known)]))
    found: dict[float, dict[str, VtuPiece]] = {float(time): {} for time in times}
    for sheet in known:
        for frame, time in enumerate(sheet["time"]):
            found[float(time)] |= _pieces(sheet, frame, len(known) > 1)
    return list(found.items())


def _pieces(sheet: Sheet, frame: int, named: bool) -> Mapping[str, VtuPiece]:
    prefix = f"{sheet.fidelity} " if named else ""
    made = {f"{prefix}beam": _beam(sheet, "beam", frame, sheet["beam_position"], 0.0)}
    if "met" in sheet.columns:
        where, arm = sheet["met_position"]
        along = sheet["opposite_position"] - where - arm + sheet["stop_position"][0]
        made[f"{prefix}opposite"] = _beam(sheet, "opposite", frame, along, float(sheet["stop_height"][0]))
    return made | {f"{prefix}{name}": piece for name, piece in _stops(sheet, frame).items()}


def _beam(sheet: Sheet, name: str, frame: int, places: Array, lift: float) -> VtuPiece:
    deflection, slope, velocity = (sheet[f"{name}_{what}"][frame] for what in ("deflection", "slope", "velocity"))
    nothing = np.zeros_like(places)
    data = {
        **centre_line(places, lift, deflection, slope),
        "velocity": np.column_stack((nothing, nothing, velocity)),
        "thickness": sheet[f"{name}_height"],
        "impact": nothing,
    }
    return VtuPiece(np.column_stack((places, nothing, nothing)), data)


def _stops(sheet: Sheet, frame: int) -> dict[str, VtuPiece]:
    struck = _struck(sheet, frame)
    heights = sheet["stop_height"] + (sheet["met"][frame] if "met" in sheet.columns else 0.0)
    places = sheet["stop_position"]
    nothing = np.zeros(1)
    return {
        "stop" if index == 0 else f"stop {index + 1}": VtuPiece(
            np.array([[places[index], 0.0, 0.0]]),
            {
                **centre_line(nothing, 0.0, heights[index : index + 1], nothing),
                "velocity": np.zeros((1, 3)),
                "thickness": nothing,
                "impact": struck[index : index + 1],
            },
        )
        for index in range(len(places))
    }


def _struck(sheet: Sheet, frame: int) -> Array:
    """Largest velocity (stops,) of the impacts nearest to a frame, m/s; 0 without one."""
    count, span = len(sheet["time"]), sheet["periods"][0] / sheet.frequency
    nearest = np.mod(np.rint(sheet["impact_time"] / span * count), count)
    found = np.zeros(len(sheet["stop_position"]))
    hits = nearest == frame
    np.maximum.at(found, sheet["impact_contact"][hits].astype(int), sheet["impact_velocity"][hits])
    return found
