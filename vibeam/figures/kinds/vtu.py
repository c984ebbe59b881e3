"""Figure kind ``vtu``: one loop of a settled motion of the whole beam and its stops, as VTU files for ParaView.

Frame k of m a drive period T is at t = kT/m from the drive's phase 0; a motion of period n has nm frames, and the one
after the last is the first. All is seen from the base, as the beam's coordinates are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.beam_field import Fields, field_system, fields, stop_places
from vibeam.case.plans import ShowPlan
from vibeam.exchange.vtu import Step, VtuPiece, centre_line, write_series
from vibeam.figures.settled_motion import Settled, exact_motion, settled
from vibeam.figures.sheet import Column, Columns, NoMotion, Sheet
from vibeam.flight.trajectory import Trajectory
from vibeam.observe.periodicity import repetition, strobe_time
from vibeam_models.arrays import Array
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_models.scene import Scene

LONGEST = 8  # longest period, in drive periods, that a loop follows
ENDLESS = 4  # drive periods shown of a motion that does not repeat
REPEATS = 1e-3  # share of the motion by which it may miss its begin at the loop's end
FRAMES, MOST = 36, 144  # frames a drive period, and most in all, where the table does not say
MOST_MODES = 200  # of a solid whose motion is written
MET = "where the opposite beam is met, and its arm"


@dataclass(frozen=True, eq=False)
class Recorded:
    """Motion over the first drive periods: ``values`` (…, 2, n) at any times, its impacts and contacts struck."""

    begin: Settled
    path: Trajectory | None
    times: Array
    samples: Array
    hits: Array
    struck: NDArray[np.int64]

    def at(self, t: NDArray[Any]) -> Array:
        """Modal displacements and velocities (m, 2, n); of samples interpolated linearly between them."""
        if self.path is not None:
            return self.path.modes_at(t)
        rows = self.samples.reshape(len(self.times), -1)
        found = np.stack([np.interp(t, self.times, row) for row in rows.T], axis=1)
        return found.reshape(len(t), *self.samples.shape[1:])


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Columns of one loop; NoMotion or ValueError, with the reason, where there is none or no beam."""
    system, pointed, bodies = _field_system(case, name)
    begin = settled(case, name, frequency, plan, system=system, before=branch(case, name, frequency, plan))
    motion = _recorded(begin, 2 * max(LONGEST, plan.periods or 0) + 1)
    repeats = _period(motion)
    periods = plan.periods or repeats or ENDLESS
    seamless, frames = bool(repeats) and periods % repeats == 0, plan.own["frames"] or _frames_for(periods)
    return {
        **_frames(motion, fields(pointed, begin.system), periods, frames),
        **_bodies(motion, bodies, periods, frames),
        **_impacts(motion, periods),
        **_stops(pointed, begin.system),
        "periods": Column(np.array([float(periods)]), "1", "drive periods of the loop"),
        "seamless": Column(np.array([float(seamless)]), "1", "1: the motion repeats after the loop, 0: it does not"),
    }  # fmt: skip


def branch(case: Case, name: str, frequency: float, plan: ShowPlan) -> list[float]:
    """Frequencies (Hz) of the sweep before ``frequency`` on the plan's branch; none: it begins at rest.

    A sweep down comes from where that up ended, if the case sweeps both.
    """
    if plan.own["direction"] in (None, "both"):
        return []
    if case.scene_of(name).harmonics:
        raise NoMotion("under several harmonics no branch is followed: leave direction out")
    grid = case.sweep.frequency
    if plan.own["direction"] == "up":
        return [float(each) for each in grid[grid < frequency]]
    before = grid if case.sweep.direction == "both" else grid[:0]
    return [float(each) for each in (*before, *grid[grid > frequency][::-1])]


@lru_cache(maxsize=8)
def _field_system(case: Case, name: str) -> tuple[ImpactSystem, Scene, Mapping[str, Any]]:
    """System whose outputs hold the fields, scene with its points, and of a solid its bodies by the system's modes."""
    scene, fidelity = case.scene_of(name), case.fidelities[name]
    if not scene.in_three_dimensions:
        return (*field_system(scene, fidelity), {})
    made: tuple[ImpactSystem, Scene, Mapping[str, Any]] = loaded(scene.spatial).solid_system(scene, fidelity)
    return made


def _frames_for(periods: int) -> int:
    """Frames a drive period: a divisor of the usual number, so that all fidelities share times."""
    return next((n for n in range(FRAMES, 3, -1) if FRAMES % n == 0 and n * periods <= MOST), 4)


def _recorded(begin: Settled, periods: int) -> Recorded:
    if begin.samples:
        found = begin.solver.motion(begin.drive, begin.reached, 0.0, periods * begin.period)
        hits = np.stack((found.impact_times, found.impact_velocities), axis=1)
        return Recorded(begin, None, found.times, found.values, hits, np.zeros(len(hits), dtype=np.int64))
    path = exact_motion(begin, periods)
    hits = np.stack((path.impact_times, path.impact_velocities), axis=1)
    return Recorded(begin, path, np.zeros(0), np.zeros(0), hits, path.impact_contacts)


def _period(motion: Recorded) -> int:
    """Drive periods after which the motion repeats, 0 where it does not within ``LONGEST``."""
    span = motion.begin.period
    hits = motion.hits[:, 0]
    strobes = motion.at(strobe_time(hits[hits < span], 0.0, span) + span * np.arange(2 * LONGEST))
    return repetition(strobes, motion.begin.system.omega, motion.begin.drive.omega, REPEATS, LONGEST)


def _frames(motion: Recorded, shapes: Fields, periods: int, each: int) -> Columns:
    """Deflection, slope and velocity of every beam at each frame (frames, points)."""
    times: Array = motion.begin.period / each * np.arange(periods * each, dtype=np.float64)
    poses = motion.at(times)
    found = {"time": Column(times, "s", "time of the frames from the drive's phase 0")}
    for beam, shape in shapes.items():
        found |= {
            f"{beam}_position": Column(shape.positions, "m", f"points along the {_called(beam)}"),
            f"{beam}_height": Column(shape.height, "m", "of the section in the direction of motion"),
            f"{beam}_deflection": Column(poses[:, 0] @ shape.deflection.T, "m", f"of the {_called(beam)}"),
            f"{beam}_slope": Column(poses[:, 0] @ shape.slope.T, "1", f"of the {_called(beam)}, rad"),
            f"{beam}_velocity": Column(poses[:, 1] @ shape.deflection.T, "m s-1", "after impacts"),
        }
    if "opposite" in shapes:
        met = poses[:, 0] @ motion.begin.system.output("opposite")
        found["met"] = Column(met, "m", "displacement of the opposite beam where it is met")
    return found


def _bodies(motion: Recorded, bodies: Mapping[str, Any], periods: int, each: int) -> Columns:
    """Nodes and cells of a solid's bodies, displacements by modes, and the modes at each frame."""
    if not bodies:
        return {}
    size = motion.begin.system.size
    if size > MOST_MODES:
        raise NoMotion(f"a solid in {size} modes, and files are written of {MOST_MODES} at most: write modes = …")
    poses = motion.at(motion.begin.period / each * np.arange(periods * each, dtype=np.float64))
    found = {"modes": Column(poses, "1", "modal displacements and velocities (frames, 2, modes), kg^½ m and kg^½ m/s")}
    for name, body in bodies.items():
        found |= {
            f"{name}_node": Column(body.points, "m", f"places (k, 3) of the nodes of the {_called(name)}"),
            f"{name}_cell": Column(body.cells.astype(float), "1", "nodes of its cells, in VTK's order"),
            f"{name}_mode": Column(body.displacement(np.eye(size)), "1", "displacements (modes, k, 3) in each, kg^-½"),
        }
    return found


def _called(beam: str) -> str:
    return "beam" if beam == "beam" else "opposite beam"


def _impacts(motion: Recorded, periods: int) -> Columns:
    """Impacts within the loop."""
    inside = motion.hits[:, 0] < periods * motion.begin.period
    return {
        "impact_time": Column(motion.hits[inside, 0], "s", "impacts"),
        "impact_velocity": Column(motion.hits[inside, 1], "m s-1", "just before"),
        "impact_contact": Column(motion.struck[inside].astype(float), "1", "which stop is struck, from 0 on"),
    }


def _stops(scene: Scene, system: ImpactSystem) -> Columns:
    """Places of all stops, in the order of the contacts struck: along the beam, and across it."""
    along, across, side = np.array(stop_places(scene, system)).T
    met = [(each.position, each.arm) for each in scene.named("opposite")]
    return {
        "stop_position": Column(along, "m", "of the stops along the beam"),
        "stop_height": Column(across, "m", "deflection at which the beam touches them"),
        "stop_side": Column(side, "1", "1: above the beam, −1: below"),
        **({"met_position": Column(np.array(met[0]), "m", MET)} if met else {}),
    }  # fmt: skip


def write(path: Path, shown: Sequence[Sheet], mark: str) -> None:
    """Write the loops as a VTU series with ``mark`` in it: ``path`` is its PVD file."""
    write_series(steps_of(shown), path, mark)


def steps_of(sheets: Sequence[Sheet]) -> list[Step]:
    """Steps of all loops, in s from the drive's phase 0; shorter loops end before longer ones.

    Every piece has the fields ``displacement``, ``velocity`` and ``rotation`` (k, 3), ``thickness`` (k,), and
    ``impact`` (k,): on the point that is struck its velocity just before, in the frame nearest to the impact, else 0.
    Beams and stops stand on the x axis and their displacement is along z, a stop's that of a beam that touches it, so
    that "Warp By Vector" with any factor keeps the contact. The same of an opposite beam, which stands off by the gap.
    The bodies of a solid are pieces of their own, of cells with the first two fields, each in its own thickness.
    """
    known = [sheet for sheet in sheets if not sheet.fault]
    times = np.unique(np.concatenate([np.empty(0), *(sheet["time"] for sheet in known)]))
    found: dict[float, dict[str, VtuPiece]] = {float(time): {} for time in times}
    for sheet in known:
        for frame, time in enumerate(sheet["time"]):
            found[float(time)] |= _pieces(sheet, frame, len(known) > 1)
    return list(found.items())


def _opposite_places(sheet: Sheet) -> Array:
    """Places of the opposite beam's points along the beam, m: where they are met stands at the stop."""
    where, arm = sheet["met_position"]
    return np.asarray(sheet["opposite_position"] - where - arm + sheet["stop_position"][0])


def _pieces(sheet: Sheet, frame: int, named: bool) -> Mapping[str, VtuPiece]:
    prefix = f"{sheet.fidelity} " if named else ""
    made = {f"{prefix}beam": _beam(sheet, "beam", frame, sheet["beam_position"], 0.0)}
    if "met" in sheet.columns:
        lift = float(sheet["stop_height"][0])
        made[f"{prefix}opposite"] = _beam(sheet, "opposite", frame, _opposite_places(sheet), lift)
    made |= {f"{prefix}solid {name}": piece for name, piece in _solid_pieces(sheet, frame)}
    return made | {f"{prefix}{name}": piece for name, piece in _stop_pieces(sheet, frame).items()}


def _solid_pieces(sheet: Sheet, frame: int) -> Iterator[tuple[str, VtuPiece]]:
    for name in ("beam", "opposite"):
        if f"{name}_node" in sheet.columns:
            place, rate = (np.einsum("m,mki->ki", pose, sheet[f"{name}_mode"]) for pose in sheet["modes"][frame])
            cells = sheet[f"{name}_cell"].astype(np.int64)
            data = {"displacement": place, "velocity": rate}
            yield name, VtuPiece(sheet[f"{name}_node"], data, cells)


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


def _stop_pieces(sheet: Sheet, frame: int) -> dict[str, VtuPiece]:
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
