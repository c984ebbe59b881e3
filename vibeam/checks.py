"""What the keys of a case say together: positions on the beam, one way to say the drive, fidelities that exist.

Each check takes what could be read (None: could not) and yields complaints, so that one fault does not hide another.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path as File
from types import SimpleNamespace

from vibeam.effect_checks import effect_checks
from vibeam.faults import cure, shown
from vibeam.lines import Path
from vibeam.reading import Complaint
from vibeam.schema import EXTENTS, QUANTITIES
from vibeam.show import LIMITS, READ
from vibeam.show_checks import NAME, expectation_of_a_figure, measurement_checks, named_fidelity, show_checks
from vibeam.solvers import STATIONARY


def cross_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Every complaint about keys that do not go together; files are looked for from ``folder``."""
    if hasattr(case, "beam"):
        yield from _positions(case)
        yield from _law(case.stop, EXAMPLES, " m")
        yield from _drift(case.stop)
        yield from _rigid_zone(case)
        yield from _damping(case.beam)
        yield from (_drive(case.drive) if case.platform is None else _driven_platform(case))
        yield from effect_checks(case)
        yield from _output(case)
        yield from _modes(case)
    else:
        yield from _law(case.stop, NONDIMENSIONAL, "")
        yield from _drift(case.stop)
    yield from _wear(case)
    yield from _grid(case.sweep.frequency)
    yield from _names(case)
    yield from _references(case, folder)
    yield from _expectations(case)
    yield from show_checks(case)
    yield from measurement_checks(case.measurement)
    yield from _cost(case)
    if getattr(case, "influence", None) is not None:
        yield from named_fidelity(case, ("influence", "fidelity"), case.influence.fidelity)
    yield from _accuracy(case)


def _positions(case: SimpleNamespace) -> Iterator[Complaint]:
    named = {"mass": case.mass, "sensor": case.sensor, "stop": case.stop}
    places: dict[Path, SimpleNamespace] = {(name, "position"): table for name, table in named.items()}
    places |= {("added_mass", index, "position"): added for index, added in enumerate(case.added_mass)}
    length = case.beam.length
    for path, table in places.items():
        if length is not None and table.position is not None and table.position > length:
            yield path, f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"


NEEDS = {  # keys that a contact law must have; those that it may have
    "restitution": (("restitution",), ()),
    "velocity restitution": (("restitution", "velocity"), ("exponent",)),
    "table": (("speeds", "restitutions"), ()),
    "linear": (("stiffness",), ("damping", "restitution")),
    "hertz": (("hertz_stiffness",), ("exponent",)),
    "hunt-crossley": (("hertz_stiffness", "restitution", "velocity"), ("exponent",)),
}
EXAMPLES = {
    "restitution": ("speed after over speed before an impact", "restitution = 0.72"),
    "velocity": ("at which the restitution holds", 'velocity = "0.1 m/s"'),
    "stiffness": ("force over penetration", 'stiffness = "1e6 N/m"'),
    "hertz_stiffness": ("N/m^exponent", "hertz_stiffness = 1e9"),
    "speeds": ("of the table", 'speeds = ["0.02 m/s", "0.2 m/s"]'),
    "restitutions": ("at the speeds", "restitutions = [0.8, 0.6]"),
}

NONDIMENSIONAL = EXAMPLES | {
    "velocity": ("at which the restitution holds", "velocity = 0.01"),
    "stiffness": ("force over mass and penetration", "stiffness = 400"),
    "hertz_stiffness": ("force over mass and penetration^exponent", "hertz_stiffness = 1e4"),
    "speeds": ("of the table", "speeds = [0.002, 0.02]"),
}


def _law(stop: SimpleNamespace, examples: Mapping[str, tuple[str, str]], metres: str) -> Iterator[Complaint]:
    law = stop.law or "restitution"
    tabled = law == "velocity restitution" and (stop.speeds is not None or stop.restitutions is not None)
    needed, allowed = NEEDS["table" if tabled else law]
    for name in needed:
        if getattr(stop, name) is None:
            meaning, example = examples[name]
            yield ("stop", name), f"missing ({meaning}): write {example}"
    every = {name for names in NEEDS.values() for part in names for name in part}
    for name in sorted(every - {*needed, *allowed}):
        if getattr(stop, name) is not None:
            yield ("stop", name), f'does not go with law = "{law}"{" and a table" if tabled else ""}: take it out'
    if law == "linear" and (stop.damping is None) == (stop.restitution is None):
        said = "is not said" if stop.damping is None else "is said twice"
        yield ("stop", "damping"), f"the loss of the linear stop {said}: write damping, or restitution"
    if (law == "hunt-crossley" and stop.restitution == 0) or (law == "linear" and stop.restitution == 0):
        yield ("stop", "restitution"), f'0 is more than law = "{law}" can lose: write a number above 0'
    if law == "velocity restitution" and not tabled and stop.restitution == 0:
        yield ("stop", "restitution"), "0 leaves nothing to fall with the velocity: write a number above 0"
    if law in ("hertz", "hunt-crossley") and stop.exponent is not None and stop.exponent < 1:
        yield ("stop", "exponent"), f"{stop.exponent:g} is below 1: the stop would be infinitely stiff at first touch"
    if tabled and stop.speeds and stop.restitutions and (len(stop.speeds) != len(stop.restitutions)):
        yield ("stop", "restitutions"), f"{len(stop.restitutions)} numbers for {len(stop.speeds)} speeds"
    elif tabled and stop.speeds and len(stop.speeds) < 2:
        yield ("stop", "speeds"), "one speed makes no table: write two or more"
    if law not in ("restitution",) and getattr(stop, "restitution_of", None) == "first mode":
        yield ("stop", "restitution_of"), f'"first mode" does not go with law = "{law}": the loss is the contact\'s'
    if stop.second_gap is not None and stop.gap is not None and stop.second_gap <= -stop.gap:
        yield ("stop", "second_gap"), f"must be above −gap = {-stop.gap:g}{metres}, or nothing fits between the stops"


def _drift(stop: SimpleNamespace) -> Iterator[Complaint]:
    if stop.drift is None and stop.drift_frequency is None:
        return
    for name, other in (("drift", "drift_frequency"), ("drift_frequency", "drift")):
        if getattr(stop, name) is None:
            yield ("stop", name), f"missing: {other} needs it beside it"
            return
    if len(stop.drift) != len(stop.drift_frequency):
        yield ("stop", "drift"), f"{len(stop.drift)} numbers for {len(stop.drift_frequency)} frequencies"


def _wear(case: SimpleNamespace) -> Iterator[Complaint]:
    """A fidelity that leaves the wear out is judged by itself, without it."""
    for name, fidelity in case.fidelity.items() if case.stop.wear is not None else ():
        if fidelity.solver in STATIONARY and not {"stop.wear", "stop"} & {*(fidelity.without or ())}:
            yield (
                ("fidelity", name, "solver"),
                f"{shown(fidelity.solver)} counts no impacts, so stop.wear has nothing to go by: "
                'write solver = "flight", or without = ["stop.wear"]',
            )


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


def _drive(drive: SimpleNamespace) -> Iterator[Complaint]:
    shaker = [name for name in ("voltage", "gain") if getattr(drive, name) is not None]
    if drive.force is not None:
        yield ("drive", "force"), "acts on a platform: add [platform], or take force away"
        return
    if drive.amplitude is not None and shaker:
        yield ("drive", "amplitude"), f"the base motion is said twice: keep amplitude, or {' and '.join(shaker)}"
    elif drive.amplitude is None and not shaker:
        yield ("drive",), "the base motion is missing: write voltage and gain, or amplitude"
    elif len(shaker) == 1 and drive.amplitude is None:
        other = "gain" if shaker == ["voltage"] else "voltage"
        yield ("drive", other), f"missing: {shaker[0]} needs it beside it"


def _driven_platform(case: SimpleNamespace) -> Iterator[Complaint]:
    """On a platform the drive is a shaker's voltage, a force, or a base motion that holds at one frequency."""
    drive, calibrated = case.drive, case.platform.calibrated_at
    said = [name for name in ("voltage", "gain", "amplitude", "force") if getattr(drive, name) is not None]
    if case.shaker is not None:
        for name in said:
            if name != "voltage":
                yield (
                    ("drive", name),
                    "the shaker's voltage says the drive already: keep voltage, or take [shaker] away",
                )
        if "voltage" not in said:
            yield ("drive",), 'the shaker needs its voltage: write voltage = "0.6 V"'
    elif "force" in said:
        for name in said:
            if name != "force":
                yield ("drive", name), f"the drive is said twice: keep force, or {name}"
    else:
        yield from _drive(drive)
    by_itself = case.shaker is not None or "force" in said
    if calibrated is None and not by_itself:
        yield (
            ("platform", "calibrated_at"),
            'missing (where the drive\'s motion holds): write calibrated_at = "15.5 Hz"',
        )
    elif calibrated is not None and by_itself:
        yield ("platform", "calibrated_at"), "goes with a base motion alone: a force or a shaker says the drive already"


def _output(case: SimpleNamespace) -> Iterator[Complaint]:
    moves = case.platform is not None and case.platform.coupling in ("two-way", None)
    if case.sweep.output == "platform" and not moves:
        yield ("sweep", "output"), 'the platform has no motion of its own: add [platform] with coupling = "two-way"'


def _most_modes(case: SimpleNamespace) -> tuple[int, str]:
    """How many modes the beam can have at most (0: not known), and what gives them."""
    twists = case.torsion is not None
    if case.beam.massless:
        return 1 + (case.mass.rotary_inertia is not None) + len(
            case.added_mass
        ) + twists, "a massless beam's inertias give"
    return 2 * (case.beam.elements or 0) * (1 + twists), "beam.elements gives"


def _modes(case: SimpleNamespace) -> Iterator[Complaint]:
    most, gives = _most_modes(case)
    for name, fidelity in case.fidelity.items():
        path = ("fidelity", name, "modes")
        if fidelity.reduction == "modal" and fidelity.modes is None:
            yield path, 'missing: reduction = "modal" needs how many; write modes = 8'
        elif fidelity.reduction not in ("modal", None) and fidelity.modes is not None:
            yield path, f'goes with reduction = "modal" alone, not "{fidelity.reduction}"'
        elif fidelity.modes is not None and 0 < most < fidelity.modes:
            yield path, f"{fidelity.modes} are more than the model has: {gives} {most} at most"


def _grid(grid: SimpleNamespace | tuple[float, ...] | None) -> Iterator[Complaint]:
    if not isinstance(grid, SimpleNamespace) or grid.from_ is None or grid.to is None:
        return
    path = ("sweep", "frequency")
    if grid.from_ > grid.to:
        yield (*path, "to"), 'is below from; to sweep downwards write direction = "down"'
    elif grid.points == 1 and grid.from_ < grid.to:
        yield (*path, "points"), "1 point does not span from … to: make them equal, or take more points"
    elif grid.points is not None and grid.points > 1 and grid.from_ == grid.to:
        yield (*path, "points"), f"{grid.points} points from a frequency to itself: points = 1, or another to"


def _names(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.fidelity == {}:
        yield ("fidelity",), "no fidelity: add a table [fidelity.NAME]"
    named = {"fidelity": case.fidelity, "reference": case.reference, "expect": case.expect, "show": case.show}
    for kind, tables in named.items():
        for name in tables:
            if not NAME.fullmatch(name):
                yield (kind, name), f"the name {shown(name)} must be 1 to 64 letters, digits, - or _"
    if "show" in case.fidelity:
        yield ("fidelity", "show"), 'the name "show" is that of a group of the results file: choose another'


def _references(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    for name, reference in case.reference.items():
        yield from named_fidelity(case, ("reference", name, "fidelity"), reference.fidelity)
        if reference.file is not None and not _is_file(folder, reference.file):
            yield ("reference", name, "file"), f"no file {shown(reference.file)} in the case file's folder"
        yield from _swept(case, ("reference", name, "direction"), reference.direction)


def _swept(case: SimpleNamespace, path: Path, way: str | None) -> Iterator[Complaint]:
    swept = case.sweep.direction
    if way and swept and swept not in ("both", way):
        yield path, f'"{way}" is not swept: sweep.direction is "{swept}"'


def _expectations(case: SimpleNamespace) -> Iterator[Complaint]:
    for name, expect in case.expect.items():
        path: Path = ("expect", name)
        yield from named_fidelity(case, (*path, "fidelity"), expect.fidelity)
        yield from named_fidelity(case, (*path, "against"), expect.against)
        yield from _swept(case, (*path, "direction"), expect.direction)
        if expect.show is not None or expect.number is not None or expect.quantity in READ:
            yield from expectation_of_a_figure(case, path, expect)
        elif expect.quantity in EXTENTS and expect.frequency is not None:
            yield (*path, "frequency"), f'"{expect.quantity}" is of a whole branch: leave the frequency away'
        elif expect.quantity in QUANTITIES + LIMITS and expect.frequency is None:
            yield (*path, "frequency"), f'missing: "{expect.quantity}" is read at one frequency'


def _cost(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.cost is None:
        return
    if case.cost.modes and not hasattr(case, "beam"):
        yield ("cost", "modes"), "a single degree of freedom has one mode: leave this out"
    name, path = case.cost.reference, ("cost", "reference")
    if name is None:
        return
    if name not in case.reference:
        yield path, f"no reference {shown(name)}; {cure(name, filter(NAME.fullmatch, case.reference))}"
    elif case.reference[name].quantity not in ("amplitude", None):
        yield path, f"{shown(name)} gives {case.reference[name].quantity}: accuracy is that of the amplitude"


def _accuracy(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.accuracy is None:
        if case.accuracy_of is not None:
            yield ("accuracy_of",), 'goes with an accuracy: write accuracy = "1 %" beside it'
    elif "accuracy" in case.fidelity:
        yield ("fidelity", "accuracy"), "the name is that of the result where an accuracy is asked for: choose another"


def _is_file(folder: File, name: str) -> bool:
    try:
        return (folder / name).is_file()
    except (OSError, ValueError):
        return False
