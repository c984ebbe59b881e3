"""Kind of a measured signal, decay, spectrum or response, and the parameters that it gives.

A clue is what a head, a unit or the numbers show; it allows some of the three readings. Taken is the one that all clues
allow. Where none is left, or more than one, nothing is taken, and the message names what each would give. A reading
that is asked for is taken, and what contradicts it is said.

Magnitudes over even frequencies cannot be told by their numbers: the spectrum of a decay after a blow is a/D, the
response to a force g u/D. The lines of a Fourier transform are even.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.told import tell
from vibeam.studies.identification.estimates import Identification
from vibeam.studies.identification.response import DRIVES, identify_decay, identify_response, identify_spectrum, usable
from vibeam.studies.identification.signals import NAMES, UNITS, Signal, ascends, name_in, read_signal, suits
from vibeam_models.arrays import Array

KINDS = ("decay", "spectrum", "response")
OVER_FREQUENCY = KINDS[1:]
ALLOWED = {"time": KINDS[:1], "frequency": OVER_FREQUENCY}
SPECTRA = {"fft", "dft", "spectrum", "spektrum", "spectre", "fourier"}
RESPONSES = {
    "frf", "response", "transfer", "receptance", "compliance", "mobility", "accelerance", "inertance",
    "transmissibility", "frequenzgang", "h", "h1", "h2", "tf",
}  # fmt: skip
POWERS = {"psd", "power", "autopower", "density", "leistungsdichte"}


@dataclass(frozen=True)
class Clue:
    """Observation in words, and the readings that it allows."""

    words: str
    allows: Sequence[str]


def identify_signal(
    path: Path, of: str | None = None, x: str | None = None, y: str | None = None, *, drive: str | None = None,
    level: float | None = None, stretch: tuple[float | None, float | None] = (None, None),
) -> Identification:  # fmt: skip
    """Natural frequency, damping ratio and gain from the signal of a file, with what it was taken as and why.

    ``of``: one of ``KINDS``; None: found out. ``x``, ``y``: heads of the columns, or numbers from 1. ``drive``,
    ``level``: of a response. ``stretch``: times (s) or frequencies (Hz) from which and to which it is taken. CaseError
    with the place and the cure; ValueError where it is none, or cannot be told.
    """
    signal = read_signal(path, "" if of is None else "time" if of == KINDS[0] else "frequency", x, y).within(stretch)
    tell(signal.taken)
    if not usable(signal.value):
        raise ValueError("values are too large or too small; the largest lies between 1e-60 and 1e+60 in its unit")
    told = [*_of_abscissa(signal), *_of_value(signal), *_of_numbers(signal)]
    if drive is not None or level is not None:
        told.append(Clue("a drive is given, --drive or --level", ("response",)))
    methods = _methods(signal, drive, level)
    kind, why = (of, _against(of, told)) if of else reading(told, methods)
    found = methods[kind]()
    return replace(found, of=kind, why=why, notes=(*signal.notes, *found.notes, *_of_drive(kind, signal, drive, level)))


def _methods(signal: Signal, drive: str | None, level: float | None) -> Mapping[str, Callable[[], Identification]]:
    at, value, uncertainty = signal.at, signal.value, signal.uncertainty
    size = 1.0 if level is None else level
    return {
        "decay": lambda: identify_decay(at, value),
        "spectrum": lambda: identify_spectrum(at, value, uncertainty=uncertainty),
        "response": lambda: identify_response(
            at, value, drive=drive or DRIVES[0], level=size, uncertainty=uncertainty
        ),
    }  # fmt: skip


def _of_drive(kind: str, signal: Signal, drive: str | None, level: float | None) -> Iterator[str]:
    """Note on the drive that is assumed of a response, and what the other one would give."""
    if kind != "response" or drive is not None:
        return
    at, value, uncertainty = signal.at, signal.value, signal.uncertainty
    other = identify_response(at, value, drive="force", level=level or 1.0, uncertainty=uncertainty)
    yield f"a base displacement is assumed to drive it; to a force it would be {_short(other)}: say --drive"


def reading(clues: Sequence[Clue], methods: Mapping[str, Callable[[], Identification]]) -> tuple[str, str]:
    """The one reading that all clues allow, and why; ValueError, with what the others would give, where none is."""
    left = [kind for kind in KINDS if all(kind in each.allows for each in clues)]
    if len(left) == 1:
        return left[0], _told(clues)
    if not left:
        raise ValueError(
            f"cannot tell what it is: {_told(clues, ', but ', True)}: name other columns, --x HEAD --y HEAD, or say "
            f"which it is, --of {', '.join(KINDS[:-1])} or {KINDS[-1]}"
        )
    would = " or ".join(f"a {each}{_would(methods[each])}" for each in left)
    seen = f"{_told(clues)}; " if clues else ""
    cure = " or ".join(f"--of {each}" for each in left)
    raise ValueError(f"may be {would}: {seen}no head, unit or number says which: say {cure}")


def _told(clues: Sequence[Clue], between: str = ", ", meaning: bool = False) -> str:
    allowed = (" or ".join(f"a {kind}" for kind in each.allows) for each in clues)
    return between.join(
        each.words + (f" (of {kinds})" if meaning and kinds else "") for each, kinds in zip(clues, allowed, strict=True)
    )


def _against(of: str, clues: Sequence[Clue]) -> str:
    """Reason of a reading that is asked for: the option, and what speaks against it."""
    against = _told([each for each in clues if of not in each.allows])
    return "--of says so" + (f", though {against}" if against else "")


def _would(method: Callable[[], Identification]) -> str:
    try:
        return f" ({_short(method())})"
    except ValueError:
        return ""


def _short(found: Identification) -> str:
    frequency, ratio = found["natural frequency"], found["damping ratio"]
    damping = f", damping ratio {ratio.value:.3g}" if ratio.determined else ""
    return f"{frequency.value:.5g} Hz{damping}"


def _of_abscissa(signal: Signal) -> Iterator[Clue]:
    """Clues of the head and of the unit of the abscissa."""
    (head, _), (unit, _) = signal.heads, signal.units
    known = [over for over in UNITS if suits(unit, over)]
    yield from (Clue(f"{head!r} is in {unit}", ALLOWED[over]) for over in known)
    named = [over for over in NAMES if name_in(head, over) and over not in known]
    yield from (Clue(f"{head!r} is called a {over}", ALLOWED[over]) for over in named)


def _of_value(signal: Signal) -> Iterator[Clue]:
    """Clues of the head and of the unit of the values."""
    (_, head), (_, unit) = signal.heads, signal.units
    if signal.parts:
        yield Clue(f"{' and '.join(map(repr, signal.parts))} are parts of a complex number", OVER_FREQUENCY)
    words = {*re.findall(r"[^\W\d_]+\d?", head.casefold())}
    below = re.findall(r"/\s*\(?\s*([^\s/()*·]+)", unit)
    if words & POWERS or re.search(r"(\^2|²)\)?\s*/\s*Hz", unit):
        yield Clue(f"{head!r} is a density of power, which none of them is (its square root is a spectrum)", ())
    if words & SPECTRA:
        yield Clue(f"{head!r} is called a spectrum", ("spectrum",))
    if words & RESPONSES:
        yield Clue(f"{head!r} is called a response", ("response",))
    if "Hz" in unit or re.search(r"[·*\s]s$", unit):
        yield Clue(f"{unit} is the unit of a Fourier transform", ("spectrum",))
    elif not all(suits(re.sub(r"\^?[23²³]$", "", each), "time") for each in below):
        yield Clue(f"{unit} is a ratio", ("response",))


SWING = 0.15  # of the largest departure from the middle, that counts as a swing
SWINGS = 3
ONE_SIDED = 0.1  # swing to one side over that to the other, below which values do not swing
SCATTER = 0.25  # of the intervals between swings: half of them are as near to their median, relative to it
EVEN = 0.8  # share of the steps that are equal, from which on a grid is even


def _of_numbers(signal: Signal) -> Iterator[Clue]:
    """Clues of the numbers: order and steps of the abscissa, swings and signs of the values."""
    at, value = signal.at, signal.value
    if len(at) < 4:
        return
    if not ascends(at):
        if ascends(value):
            yield Clue(f"{signal.heads[1]!r} ascends and {signal.heads[0]!r} does not, as if they were exchanged", ())
        elif signal.over != "time":
            yield Clue(f"{signal.heads[0]!r} does not only ascend, as in a sweep", ("response",))
    order = np.argsort(at, kind="stable")
    steps = np.diff(at[order])
    steps = steps[steps > 0]
    if signal.over != "time" and len(steps) and np.mean(np.abs(steps / np.median(steps) - 1) < 0.05) < EVEN:
        yield Clue("its steps are uneven, as those of no Fourier transform", ("decay", "response"))
    if _swings(value[order]):
        yield Clue("its values swing about a middle and die away", ("decay",))
    elif signal.over == "frequency" and (value < 0).any():
        yield Clue("its values have both signs", ("decay",))
    elif (value >= 0).all() and float(np.median(value)) < 0.5 * float(value.max()):
        yield Clue("its values are magnitudes with a peak", OVER_FREQUENCY)


def _swings(value: Array) -> bool:
    """Test whether values swing evenly to both sides of where they come to rest, less and less."""
    off = value - np.median(value[-max(len(value) // 4, 4) :])
    sides = sorted((float(off.max()), float(-off.min())))
    early, late = (float(np.sum(part**2)) for part in np.array_split(off, 2))
    if not (sides[0] > ONE_SIDED * sides[1] and early > late):
        return False
    far = np.flatnonzero(np.abs(off) > SWING * sides[1])
    between = np.diff(far[1:][np.diff(np.sign(off[far])) != 0])
    if len(between) < SWINGS - 1:
        return False
    middle = np.median(between)
    return bool(np.median(np.abs(between - middle)) < SCATTER * middle)
