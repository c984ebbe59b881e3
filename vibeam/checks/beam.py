"""What the tables of the beam say together: places along it, its rigid zone, its damping."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.lines import Path
from vibeam.reading import Complaint


def beam_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the beam and what is fixed to it."""
    yield from _positions(case)
    yield from _rigid_zone(case)
    yield from _damping(case.beam)


def _positions(case: SimpleNamespace) -> Iterator[Complaint]:
    named = {"mass": case.mass, "sensor": case.sensor, "stop": case.stop}
    places: dict[Path, SimpleNamespace] = {(name, "position"): table for name, table in named.items()}
    places |= {("added_mass", index, "position"): added for index, added in enumerate(case.added_mass)}
    length = case.beam.length
    for path, table in places.items():
        if length is not None and table.position is not None and table.position > length:
            yield path, f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"


def _rigid_zone(case: SimpleNamespace) -> Iterator[Complaint]:
    middle, half, length = case.mass.position, case.mass.rigid_half_width, case.beam.length
    path = ("mass", "rigid_half_width")
    if half is None or middle is None:
        return
    if half >= middle:
        yield path, f"{half:g} m reaches the clamp: mass.position is {middle:g} m"
    elif length is not None and half < 1e-3 * length:
        yield path, f"{half:g} m is below a thousandth of beam.length and changes nothing: leave it out"
    elif length is not None and middle <= length <= middle + half:
        yield path, f"{half:g} m reaches the tip, {length - middle:g} m beyond mass.position"


def _damping(beam: SimpleNamespace) -> Iterator[Complaint]:
    path, ratios = ("beam", "damping_ratio"), beam.damping_ratio
    if isinstance(beam.damping, tuple):
        if ratios is not None:
            yield path, "beam.damping lists the ratios already: keep one of the two"
    elif beam.damping is not None and ratios is None:
        yield path, "missing (damping ratio of the first mode): write damping_ratio = 0.017"
    elif beam.damping == "rayleigh" and len(ratios) != 2:
        yield path, 'damping = "rayleigh" needs the ratios of modes 1 and 2: write damping_ratio = [0.017, 0.02]'
    elif beam.damping is not None and beam.damping != "rayleigh" and len(ratios) != 1:
        yield path, f'damping = "{beam.damping}" needs one number; a list of ratios goes into damping'
