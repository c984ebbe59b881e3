"""What the tables of the beam say together: places along it, its rigid zone, its damping."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.lines import KeyPath
from vibeam.reading import Complaint


def beam_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the beam and what is fixed to it."""
    yield from _positions(case)
    yield from _bare(case) if case.mass is None else _rigid_zone(case)
    yield from _damping(case.beam)


def _positions(case: SimpleNamespace) -> Iterator[Complaint]:
    named = {"mass": case.mass, "sensor": case.sensor, "stop": case.stop}
    places: dict[KeyPath, SimpleNamespace] = {(name, "position"): table for name, table in named.items()}
    places |= {("added_mass", index, "position"): added for index, added in enumerate(case.added_mass)}
    length = case.beam.length
    for path, table in places.items():
        if length is not None and table is not None and table.position is not None and table.position > length:
            yield path, f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"


def _bare(case: SimpleNamespace) -> Iterator[Complaint]:
    """What a beam without an attached mass has to say otherwise."""
    if case.stop.position is None:
        yield (
            ("stop", "position"),
            'missing (without [mass] the stop is nowhere): write position = "132 mm", or add [mass]',
        )
    if case.beam.massless and not case.added_mass:
        yield ("beam", "massless"), "nothing is left that has mass: add [mass], or take massless out"
    if case.torsion is not None:
        yield ("torsion",), "has the polar inertia of the attached mass: add [mass], or take [torsion] out"
    if case.drive.gain is not None:
        yield ("drive", "gain"), 'is of a beam with an attached mass: write amplitude = "0.05 mm", or add [mass]'


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
