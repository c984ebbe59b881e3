"""Plan of the input of a record case: a file, a shape or a spectral density, and the record that it makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.system.record_pieces import BASELINES
from vibeam.system.record_samples import LEAST
from vibeam.system.record_shapes import WINDOWS
from vibeam_models import keys as declare

if TYPE_CHECKING:
    from vibeam.system.record import Record


@dataclass(frozen=True)
class InputShape:
    """Shape of an input: the keys that it ``needs`` and ``takes``; ``held``: to the end where no duration is said.

    ``method``: of ``Record``, with the keywords of ``fixed``; None: its name.
    """

    needs: tuple[str, ...]
    takes: tuple[str, ...] = ()
    held: bool = False
    method: str | None = None
    fixed: Mapping[str, Any] = field(default_factory=dict)


SHAPES = {
    "half_sine": InputShape(("duration",)),
    "saw_tooth": InputShape(("duration",)),
    "initial_saw_tooth": InputShape(("duration",), method="saw_tooth", fixed={"kind": "initial"}),
    "trapezoid": InputShape(("duration", "rise"), ("fall",)),
    "step": InputShape((), ("duration", "rise"), held=True),
    "sine": InputShape(("frequency",), ("duration",), held=True),
    "chirp": InputShape(("frequency",), ("duration",), held=True),
    "tone_burst": InputShape(("frequency", "cycles"), ("window",)),
    "sine_beat": InputShape(("frequency", "cycles"), ("beats", "pause")),
}
#: keys by which an input is said, and those that go with each
WAYS = {
    "file": ("column", "time", "unit", "remove", "scale", "rate", "interpolation", "quantity", "start", "from", "to"),
    "shape": ("duration", "rise", "fall", "cycles", "window", "beats", "pause", "delay"),
    "density": ("band", "seed", "rate", "interpolation", "quantity"),
}


FIELDS = {"from": "from_"}  # of keys that are words of Python


@dataclass(frozen=True, kw_only=True)
class InputPlan:
    """Input over time of a record case, SI units; ``file`` is absolute; all None: nothing drives.

    ``peak``: of a shape, in the unit of its ``quantity``; ``frequency``: in Hz, of a chirp the first and the last.
    ``quote``: messages may quote the file.
    """

    file: str | None = declare.text(
        "input measured over time, from the case file's folder: CSV, WAV, MATLAB (.mat), HDF5 (.h5), universal file 58",
        "shock.csv", None,
    )  # fmt: skip
    column: Any = declare.text(
        "head of the file's column, or its number from 1; variable, dataset, channel; absent = the only one",
        "a [g]",
        None,
    )
    time: Any = declare.text("the same of the file's times; absent = time or t, or drive.rate", "t [ms]", None)
    quantity: str | None = declare.word(
        ("acceleration", "velocity", "displacement", "force", "moment"),
        "what a file, or a density, is of: a motion of the base, or a load; absent = acceleration, or "
        "force where a force drives", "acceleration", None,
    )  # fmt: skip
    unit: str | None = declare.text("of the file's values, where its head does not say it; absent = SI", "g", None)
    scale: float | None = declare.quantity("", "factor of the file's values", 2.0, None)
    start: Any = declare.text(
        "time of the file that becomes 0; absent = as the file has it, its first sample where its clock begins before "
        "0 or after the run", "first sample", None,
    )  # fmt: skip
    from_: float | None = declare.quantity("s", "first time of the file that is taken, by its clock", "0.2 s", None)
    to: float | None = declare.quantity("s", "last time of the file that is taken, by its clock", "1.5 s", None)
    remove: str | None = declare.word(
        tuple(BASELINES),
        "drift taken off a file: mean of the load, slope of the line nearest to the base's velocity, or the "
        "line that ends the base at rest where it began; absent = nothing", "displacement", None,
    )  # fmt: skip
    shape: str | None = declare.word(
        tuple(SHAPES), "input of a shape; its peak is acceleration, force or moment", "half_sine", None
    )
    duration: float | None = declare.quantity(
        "s", "of a shape; of a step, sine or chirp absent = to the end", "11 ms", None, above=0
    )
    rise: float | None = declare.quantity("s", "of a trapezoid or a step", "1 ms", None, least=0)
    fall: float | None = declare.quantity("s", "of a trapezoid; absent = as its rise", "1 ms", None, least=0)
    cycles: float | None = declare.quantity("", "of a tone_burst or a sine_beat", 5, None, above=0)
    window: str | None = declare.word(tuple(WINDOWS), "of a tone_burst; absent = hann", "hann", None)
    beats: int | None = declare.count(1, 100_000, "of a sine_beat; absent = 1", 5, None)
    pause: float | None = declare.quantity("s", "between two beats; absent = 0", "2 s", None, least=0)
    delay: float | None = declare.quantity("s", "before a shape begins; absent = 0", "1 ms", None, least=0)
    density: tuple[Any, ...] | float | None = declare.quantity(
        "m^2/s^4/Hz", "random input: its one-sided power spectral density, of white noise in drive.band, or a list of "
        "[frequency, density], joined by lines in log-log axes",
        [["10 Hz", "0.01 g^2/Hz"], ["2 kHz", "0.01 g^2/Hz"]], None,
    )  # fmt: skip
    band: tuple[float, ...] | None = declare.quantity(
        "Hz", "lowest and highest frequency of white noise; absent = 0 to half of drive.rate", ["10 Hz", "2 kHz"], None,
        least=0, several=True, ascending=True,
    )  # fmt: skip
    rate: float | None = declare.quantity(
        "Hz", "samples a second: of a random input, absent = 10 times its highest frequency; of a file without times, "
        "or with rounded ones",
        "20 kHz", None, above=0,
    )  # fmt: skip
    interpolation: str | None = declare.word(
        tuple(LEAST), "between samples of an acceleration or a load; absent = linear of a file, cubic of random "
        "input", "cubic", None,
    )  # fmt: skip
    seed: int | None = declare.count(0, 2**31 - 1, "of a random input, of its first realisation", 1, None)
    peak: float = 0.0
    frequency: tuple[float, ...] = ()
    quote: bool = True

    @property
    def random(self) -> bool:
        """Test whether it is one of many realisations."""
        return self.density is not None

    def record(self, duration: float, seed: int | None = None, level: float = 1.0, speed: float = 1.0) -> Record:
        """Input over ``duration`` s, ``level`` times as large and ``speed`` times as fast; CaseError of a faulty file.

        ``seed``: of a random input, None: its own first. ValueError for what no record can be.
        """
        own = self.seed if seed is None else seed
        made = _made(self, duration * speed, own) if self.file is None else self.measured(duration * speed)
        return made if level == speed == 1.0 else made.scaled(level=level, speed=speed)

    def said(self, *names: str) -> dict[str, Any]:
        """Those of its values that are given, by name."""
        return {name: each for name in names if (each := getattr(self, FIELDS.get(name, name))) is not None}

    def _shaped(self, record: type[Record], shape: InputShape, duration: float) -> Record:
        said = self.said(*shape.needs, *shape.takes)
        if shape.held:
            said.setdefault("duration", duration - (self.delay or 0.0))
        if "frequency" in said:
            names = ("frequency",) if len(self.frequency) == 1 else ("first", "last")
            said |= dict(zip(names, said.pop("frequency"), strict=True))
        make = getattr(record, shape.method or str(self.shape))
        made: Record = make(self.peak, quantity=self.quantity, start=self.delay or 0.0, **said, **shape.fixed)
        return made

    def measured(self, duration: float | None = None) -> Record:
        """Record of the file in a run of ``duration`` s, None: as long as it is itself; CaseError for a faulty file."""
        from vibeam.exchange.time_series import record_in_run

        return record_in_run(Path(self.file or ""), duration, self.quote, self.said(*WAYS["file"]))


@lru_cache(maxsize=1)  # all fidelities run under one, and one may have millions of samples
def _made(plan: InputPlan, duration: float, seed: int | None) -> Record:
    """Record of a shape or of noise, or of no load."""
    from vibeam.system.record import Record

    of = plan.quantity or "acceleration"
    if plan.shape is not None:
        return plan._shaped(Record, SHAPES[plan.shape], duration)
    if plan.density is None:
        return Record.step(0.0, duration, quantity=of)
    return Record.random(
        plan.density, duration, seed=seed or 0, quantity=of, **plan.said("band", "rate", "interpolation")
    )
