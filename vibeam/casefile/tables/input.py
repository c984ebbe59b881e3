"""Keys of [drive] in a record case: a file, a shape or a random input; the rules between them, and the plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

from vibeam.case.input_plan import FIELDS, SHAPES, WAYS, InputPlan
from vibeam.case.plans import moving
from vibeam.casefile.fields import Entry, JsonSchema, ValueEntry
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import NUMBER_WITH_UNIT, SI, TIME, Dimension, UnitSystem, suits, to_si, with_unit
from vibeam.casefile.tables.references import fault_of_file
from vibeam.casefile.tables.table import Frequency
from vibeam.casefile.toml_writing import to_fill_in
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.system.record_samples import GRAVITY, MOST
from vibeam_models.base import Base
from vibeam_models.keys import keys_of

MOTIONS = ("acceleration", "velocity", "displacement")  # of the base
LOADS = ("force", "moment")
PEAKS = ("acceleration", *LOADS)  # what a shape's peak is said by
OF_A_SINE = tuple(name for name in keys_of(Base) if name not in (*PEAKS, "at", "frequency"))

DENSITIES = {
    "acceleration": Dimension(
        "a density of an acceleration",
        "m^2/s^4/Hz",
        "0.01 g^2/Hz",
        ("g^2/Hz", "m^2/s^4/Hz"),
        own=("g^2/Hz", "96.1703842225"),
    ),
    "force": Dimension("a density of a force", "N^2/Hz", "0.1 N^2/Hz"),
    "moment": Dimension("a density of a moment", "N^2 m^2/Hz", "0.001 N^2 m^2/Hz"),
}  # fmt: skip
WRITTEN = {"(m/s^2)^2/Hz": "m^2/s^4/Hz", "(N m)^2/Hz": "N^2 m^2/Hz", "g²/Hz": "g^2/Hz", "N²/Hz": "N^2/Hz"}


def _level(value: Any, units: UnitSystem | None) -> tuple[float, str | None]:
    """A level in SI, and what it is the density of (None: written without a unit)."""
    if not isinstance(value, str):
        number = to_si(value, DENSITIES["acceleration"], units)
        found = None
    else:
        for long, unit in WRITTEN.items():
            value = value.replace(long, unit)
        found = next((name for name, kind in DENSITIES.items() if suits(value, kind)), "acceleration")
        number = to_si(value, DENSITIES[found])
    if not number > 0:
        raise ValueError(f"{as_shown_in_message(value)} must be > 0: a table ends where there is nothing more")
    return number, found


@dataclass(frozen=True)
class DensityEntry(Entry):
    """A level of a spectral density, or a list of [frequency, level]: SI numbers, and what they are the density of.

    ``plain``: in a case without dimensions.
    """

    plain: bool = False

    def read(self, value: Any, units: UnitSystem | None) -> tuple[Any, str | None]:
        """As ``Entry.read``."""
        units = SI if self.plain else units
        if not isinstance(value, list):
            return _level(value, units)
        if len(value) < 2 or not all(isinstance(row, list) and len(row) == 2 for row in value):
            said = 'must be a level, "0.01 g^2/Hz", or a list of two or more [frequency, level]'
            raise ValueError(f"{said}, not {as_shown_in_message(value)}")
        rows = [(Frequency.read(row[0], units), *_level(row[1], units)) for row in value]
        if any(one[0] >= two[0] for one, two in pairwise(rows)):
            raise ValueError("the frequencies must ascend, each once")
        if len(kinds := {kind for *_, kind in rows}) > 1:
            raise ValueError(f"its levels are of several kinds: {', '.join(str(each or 'no unit') for each in kinds)}")
        return tuple((frequency, level) for frequency, level, _ in rows), rows[0][2]

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "g^2/Hz | m^2/s^4/Hz | N^2/Hz | N^2 m^2/Hz, or list of [Hz, these]"

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        level = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": NUMBER_WITH_UNIT}]}
        row = {"type": "array", "items": level, "minItems": 2, "maxItems": 2}
        return {"anyOf": [*level["anyOf"], {"type": "array", "items": row, "minItems": 2}]}

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        if not isinstance(value, tuple):
            return value
        levels, of = value
        kind = None if of is None else DENSITIES[of]

        def written(level: float) -> Any:
            return level if kind is None else with_unit(level, kind)

        return [[f, written(s)] for f, s in levels] if isinstance(levels, tuple) else written(levels)

    def nondimensional(self) -> Entry:
        """As ``Entry.nondimensional``."""
        return DensityEntry(plain=True)


def _head(value: Any) -> str | int | None:
    number = isinstance(value, int) and not isinstance(value, bool) and 0 < value <= 10_000
    return value if number or (isinstance(value, str) and value) else None


START = ValueEntry(
    lambda value: value if value == "first sample" else to_si(value, TIME), '"first sample" | time',
    {"type": "string"}, lambda value: value if value == "first sample" else with_unit(value, TIME),
)  # fmt: skip
COLUMN = ValueEntry(_head, "head in quotes | number from 1", {"type": ["string", "integer"]})


def way_of(drive: Any) -> str | None:
    """Key by which the input is said; None where nothing drives."""
    return next((name for name in WAYS if getattr(drive, name, None) is not None), None)


def said_of(case: Any) -> str | None:
    """Quantity of the input as the case says it; None: not said."""
    drive, way = case.drive, way_of(case.drive)
    if way == "shape":
        return next((name for name in PEAKS if getattr(drive, name, None) is not None), None)
    unit = drive.density[1] if way == "density" and drive.density is not None else None
    return drive.quantity or unit


def _load_of(case: Any) -> str:
    """Quantity of an input that does not say it: of what drives the rig."""
    row = getattr(case, case.kind, None) if case.kind in ("matrices", "modes") else None
    pushed = getattr(case.drive, "at", None) is not None or getattr(row, "force", None) is not None
    return "force" if pushed or getattr(case, "platform", None) is not None else "acceleration"


def input_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the input of a record case."""
    drive, said = case.drive, [name for name in WAYS if getattr(case.drive, name, None) is not None]
    if len(said) > 1:
        yield ("drive", said[1]), f"the input is said twice: keep {said[0]}, or {said[1]}"
        return
    yield from _foreign(drive, said[0] if said else None)
    yield from _platform(case)
    yield from _row(case)
    if not said:
        if not moving(case.start) and not any(getattr(drive, name, None) is not None for name in keys_of(Base)):
            yield ("drive",), "nothing moves the rig: write file, shape or density here, or add [start]"
        return
    yield from {"file": _file, "shape": _shape, "density": _random}[said[0]](case, folder)
    yield from _kind(case)


def _foreign(drive: SimpleNamespace, way: str | None) -> Iterator[Complaint]:
    """Complaints about keys of another way to say an input, or of a sweep's sine."""
    own = WAYS.get(way or "", ())
    for name in keys_of(InputPlan):
        if getattr(drive, name, None) is not None and name not in (*own, *WAYS):
            ways = " or ".join(each for each, keys in WAYS.items() if name in keys)
            yield ("drive", name), f"goes with {ways}" + (f", and the input is a {way}: take it out" if way else "")
    for name in OF_A_SINE:
        if getattr(drive, name, None) is not None:
            cure = "take it out" if name.startswith("harmonic") or way in ("file", "density") else PEAK
            yield ("drive", name), f"is of the sine of a [sweep]: {cure}"
    for name in (*PEAKS, "frequency"):
        if getattr(drive, name, None) is not None and way != "shape":
            said = f"is of a shape, and the input is a {way}: take it out" if way else f"is of a shape: {WRITE_SINE}"
            yield ("drive", name), said


PEAK = 'with [record] write acceleration, force or moment beside shape = "sine"'
WRITE_SINE = 'write shape = "half_sine" and duration, or shape = "sine" and frequency, beside it'


def _shape(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    drive = case.drive
    shape, keys = SHAPES[drive.shape], keys_of(InputPlan)
    for name in shape.needs:
        if getattr(drive, name) is None:
            example = '"50 Hz"' if name == "frequency" else to_fill_in(keys[name].example)
            yield ("drive", name), f'missing: shape = "{drive.shape}" needs it; write {name} = {example}'
    for name in ("frequency", *WAYS["shape"]):
        if getattr(drive, name) is not None and name not in (*shape.needs, *shape.takes, "delay"):
            yield ("drive", name), f'shape = "{drive.shape}" has no use for it: take it out'
    wanted = 2 if drive.shape == "chirp" else 1
    if drive.frequency is not None and "frequency" in shape.needs and len(drive.frequency) != wanted:
        write = '["10 Hz", "100 Hz"]' if wanted == 2 else '"50 Hz"'
        yield ("drive", "frequency"), f'of shape = "{drive.shape}" is {write}, {len(drive.frequency)} are given'
    fall = drive.rise if drive.shape == "trapezoid" and drive.fall is None else drive.fall or 0.0
    if None not in (drive.rise, drive.duration) and drive.rise + fall > drive.duration:
        both = f"and fall, {drive.rise + fall:g} s, are " if fall else ""
        yield ("drive", "rise"), f"{both}longer than the whole shape, duration = {drive.duration:g} s"
    if None not in (drive.delay, case.record.duration) and drive.delay >= case.record.duration:
        yield ("drive", "delay"), f"the motion is over before: record.duration is {case.record.duration:g} s"
    said = [name for name in PEAKS if getattr(drive, name, None) is not None]
    if len(said) > 1:
        yield ("drive", said[1]), f"the peak is said twice: keep {said[0]}, or {said[1]}"
    elif not said and not any(getattr(drive, name, None) is not None for name in OF_A_SINE):
        yield ("drive", "shape"), 'its peak is missing: write acceleration = "50 g", or force or moment with at'
    peak: Any = getattr(drive, said[0]) if said else None
    if isinstance(peak, tuple):
        yield ("drive", said[0]), f"a list is of a [sweep]: a shape has one peak, write {said[0]} = one number"
    elif said == ["acceleration"] and abs(peak) > MOST and not KINDS[case.kind].plain:
        yield ("drive", "acceleration"), f"is {peak / GRAVITY:.3g} g, and no base is shaken by 10⁶ g: check the unit"


def _file(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    if fault := fault_of_file(folder, case.drive.file):
        yield ("drive", "file"), fault


def _random(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    drive: Any = case.drive
    levels, of = drive.density
    if drive.seed is None:
        yield ("drive", "seed"), "missing: a random input needs one; write seed = 1"
    if isinstance(levels, tuple):
        if drive.band is not None:
            yield ("drive", "band"), "is of white noise, and density has frequencies of its own: take it out"
        highest = levels[-1][0]
    elif drive.band is None and drive.rate is None:
        yield ("drive", "band"), 'missing (of white noise): write band = ["10 Hz", "2 kHz"], or a rate, and half of it'
        return
    else:
        highest = float(drive.rate or 0.0) / 2 if drive.band is None else float(drive.band[-1])
        if drive.band is not None and len(drive.band) != 2:
            yield ("drive", "band"), 'must be two frequencies: write band = ["10 Hz", "2 kHz"]'
    if drive.rate is not None and drive.rate < 2 * highest:
        yield ("drive", "rate"), f"{drive.rate:g} Hz is below twice the highest frequency: write {2 * highest:g} Hz"
    if drive.quantity in ("velocity", "displacement"):
        yield ("drive", "quantity"), 'of a density is "acceleration", "force" or "moment"'
    elif None not in (of, drive.quantity) and of != drive.quantity:
        yield ("drive", "quantity"), f'is "{drive.quantity}", and the unit of density that of {_article(of)}: keep one'


def _article(quantity: str) -> str:
    return f"an {quantity}" if quantity[0] == "a" else f"a {quantity}"


def _kind(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a load without its place, or a motion of the base where a load drives."""
    of, drive = said_of(case) or _load_of(case), case.drive
    key = of if way_of(drive) == "shape" else "quantity" if drive.quantity is not None else way_of(drive) or ""
    path = ("drive", key)
    if getattr(case, "platform", None) is not None:
        if of != "force":
            said = "a motion of the base has the platform in it already: take [platform] away, or give the force on it"
            yield path, said
    elif case.kind == "sdof":
        if of in LOADS:
            yield path, "a single degree of freedom is driven by its base: write acceleration, a force over the mass"
    elif case.kind != "beam":
        forced = getattr(case, case.kind).force is not None
        if forced != (of == "force"):
            what = f"{case.kind}.force says a force drives it" if forced else f"acts where {case.kind}.force says"
            yield path, f"{what}: write {'force' if forced else f'acceleration, or {case.kind}.force'}"
    elif of in LOADS and drive.at is None:
        yield path, f'{_article(of)} acts on the beam: write at = "120 mm"'
    elif of not in LOADS and drive.at is not None:
        yield ("drive", "at"), 'is where a force or a moment acts: write force, or quantity = "force", or take at away'


def _row(case: SimpleNamespace) -> Iterator[Complaint]:
    """A complaint about a given structure without the row that an input, or what is dropped, acts by."""
    table = getattr(case, case.kind) if case.kind in ("matrices", "modes") else None
    if table is None or table.base is not None or (table.force is not None and case.platform is None):
        return
    if table.force is not None:
        yield ("platform",), f"moves a base: write {case.kind}.base in place of {case.kind}.force"
    else:
        said = "missing (what a motion of the base moves, even where nothing drives): write base, or "
        yield (case.kind, "base"), f"{said}{case.kind}.force"


def _platform(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a platform that is not one more mode, which the beam pushes too, and about a shaker."""
    if getattr(case, "shaker", None) is not None:
        yield ("shaker",), "knows sines alone: take it away, and give the force on the platform"
    if getattr(case, "platform", None) is None:
        return
    if case.platform.coupling == "one-way":
        said = "filters a sine; over time a platform moves as one more mode, which the beam pushes too"
        yield ("platform", "coupling"), f'"one-way" {said}: write coupling = "two-way"'
    if case.platform.calibrated_at is not None:
        yield ("platform", "calibrated_at"), "goes with the base motion of a [sweep]: take it out"
    if getattr(case.drive, "at", None) is not None:
        yield ("drive", "at"), "is of a drive on the beam, and [platform] moves its base: take at, or it, away"


def input_plan(case: Any, folder: File) -> InputPlan:
    """The plan of the input of a checked record case."""
    drive, of = case.drive, said_of(case) or _load_of(case)
    own = {FIELDS.get(name, name): getattr(drive, name, None) for name in keys_of(InputPlan)}
    own["density"] = None if drive.density is None else drive.density[0]
    own["file"] = None if drive.file is None else str((folder / drive.file).absolute())
    return InputPlan(
        **own | {"quantity": of},
        peak=getattr(drive, of) if drive.shape is not None else 0.0,
        frequency=drive.frequency or (),
        quote=drive.file is None or (folder / drive.file).resolve().is_relative_to(folder.resolve()),
    )
