"""Rules of places that supports hold: what must move stands elsewhere, and rigid zones are clear of them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise
from types import SimpleNamespace
from typing import Any

from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.beams.beam import CANTILEVER, ENDS

SAME = 1e-6  # share of the length within which two places are one
ROUND_OFF = 1e-9  # share of the length within which two nodes are one
SHORTEST = 1e-3  # share of the length below which a rigid zone changes nothing
LEAST = 1e-4  # share of the length below which an element is so stiff that its round-off drowns the beam's stiffness


def held_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about what cannot move where it stands, and about rigid zones that meet something."""
    for on, beam in (("beam", case.beam), ("opposite", case.opposite)):
        length = None if beam is None else beam.length or case.beam.length
        if length is not None:
            yield from _zones(case, on, _held(case, on, beam.ends, length), SAME * length)
            yield from _near(case, on, length)
    if case.beam.length is not None:
        yield from _moving(case, _held(case, "beam", case.beam.ends, case.beam.length), case.beam.length)
    if case.opposite is not None and (case.opposite.length or case.beam.length) is not None:
        yield from _met(case)


def _held(case: SimpleNamespace, on: str, ends: str | None, length: float) -> dict[float, bool]:
    """Places of a beam that cannot be deflected; true where they cannot turn either."""
    both = zip((0.0, length), (ends or CANTILEVER).split("-"), strict=True)
    fixed = {x: ENDS[end][1] > 0 for x, end in both if ENDS[end][0] > 0}
    rigid = [each.position for each in _on(case.support, on) if each.stiffness is None and each.position is not None]
    return dict.fromkeys(rigid, False) | fixed


def _on(tables: Any, on: str) -> list[Any]:
    return [each for each in tables or () if each.on == on]


def _at(place: float | None, held: dict[float, bool], length: float) -> float | None:
    """The held place that a place is; None: it can be deflected."""
    near = (x for x in held if place is not None and abs(place - x) <= SAME * length)
    return next(near, None)


def _moving(case: SimpleNamespace, held: dict[float, bool], length: float) -> Iterator[Complaint]:
    def complaint(path: KeyPath, place: float | None, what: str) -> Iterator[Complaint]:
        if _at(place, held, length) is not None:
            yield path, f"the beam is held at {place:g} m: {what}"

    if case.mass is not None:
        cure = "take [mass] out, or write [[added_mass]] for what turns there"
        yield from complaint(("mass", "position"), case.mass.position, f"a mass does not move there; {cure}")
    if case.opposite is None:
        unmet = "it never meets a stop there; move the stop"
        yield from complaint(("stop", "position"), case.stop.position, unmet)
        for index, stop in enumerate(case.further_stop or ()):
            yield from complaint(("further_stop", index, "position"), stop.position, unmet)
    yield from complaint(("sensor", "position"), case.sensor.position, "a sensor reads 0 there; move it")
    at = _at(case.drive.at, held, length)
    if at is not None and case.drive.force is not None:
        yield from complaint(("drive", "at"), case.drive.at, "a force moves nothing there; move it")
    elif at is not None and case.drive.moment is not None and held[at]:
        yield from complaint(("drive", "at"), case.drive.at, "a moment moves nothing there; move it")
    readers: dict[KeyPath, Any] = {("sweep",): case.sweep} | {("show", name): each for name, each in case.show.items()}
    for path, reader in readers.items():
        if reader is not None and reader.output == "tip":
            yield from complaint((*path, "output"), length, 'the tip does not move; write output = "sensor"')


def _met(case: SimpleNamespace) -> Iterator[Complaint]:
    """The opposite beam gives way where it is met."""
    other, length = case.opposite, case.opposite.length or case.beam.length
    held = _held(case, "opposite", other.ends, length)
    at = _at(other.position, held, length)
    if at is not None and (held[at] or not other.arm):
        yield (
            ("opposite", "position"),
            f"the opposite beam is held at {other.position:g} m and does not give way: meet it elsewhere, "
            "or take [opposite] out",
        )


def _near(case: SimpleNamespace, on: str, length: float) -> Iterator[Complaint]:
    """Places that must be nodes are one, or far enough from each other for an element between them."""
    places = sorted((x, path) for path, x in _nodes(case, on) if x is not None and 0 <= x <= length)
    for (x, _), (y, path) in pairwise([(0.0, ()), *places, (length, ())]):
        if ROUND_OFF * length < y - x < LEAST * length and (path or places):
            other = f"{x:g} m" if path else "the end of the beam"
            said = (
                f"{y - x:.2g} m from {other}, a stretch below {LEAST:g} of the length is all round-off: make them one"
            )
            yield path or places[-1][1], said


def _nodes(case: SimpleNamespace, on: str) -> Iterator[tuple[KeyPath, float | None]]:
    """Places where the section, the support or what is carried changes."""
    for name in ("section", "plate"):
        for index, each in enumerate(getattr(case, name) or ()):
            if each.on == on:
                yield from (((name, index, end), getattr(each, end)) for end in ("start", "end"))
    yield from (
        (("support", i, "position"), each.position) for i, each in enumerate(case.support or ()) if each.on == on
    )
    if on == "beam" and case.mass is not None:
        yield ("mass", "position"), case.mass.position
    for path, middle, half in _rigid(case, on):
        if half >= SHORTEST * (case.beam.length or 0.0):  # of a shorter one its own rule speaks
            yield from ((path, x) for x in (middle - half, middle + half))


def _zones(case: SimpleNamespace, on: str, held: dict[float, bool], least: float) -> Iterator[Complaint]:
    """Rigid zones of a beam are clear of each other and of what holds the beam."""
    zones = _rigid(case, on)
    for path, middle, half in zones:
        inside = next((x for x in _supports(case, on) if x in held and abs(x - middle) <= half + least), None)
        if inside is not None:
            yield path, f"{half:g} m reaches the support at {inside:g} m, which does not yield: give that a stiffness"
    for (_, one, its), (path, other, half) in combinations(zones, 2):
        if abs(one - other) <= its + half + least:
            clear = abs(one - other) - its
            cure = f"make it less than {clear:g} m" if clear > least else "make both one mass"
            yield path, f"{half:g} m meets the rigid zone at {one:g} m: {cure}"


def _rigid(case: SimpleNamespace, on: str) -> list[tuple[KeyPath, float, float]]:
    """Path, middle and half-width of the rigid zones of a beam."""
    tables: list[tuple[KeyPath, Any]] = [(("mass",), case.mass)] if on == "beam" and case.mass is not None else []
    tables += [(("added_mass", i), each) for i, each in enumerate(case.added_mass or ()) if each.on == on]
    return [
        ((*path, "rigid_half_width"), each.position, each.rigid_half_width)
        for path, each in tables
        if None not in (each.position, getattr(each, "rigid_half_width", None))
    ]


def _supports(case: SimpleNamespace, on: str) -> list[float]:
    return [each.position for each in _on(case.support, on) if each.position is not None]
