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
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.casefile.quantities import FREQUENCY, RATIO, TIME, suits, to_si
from vibeam.exchange.curves.columns import size_in
from vibeam.exchange.curves.record import tell
from vibeam.exchange.units import TIME as OF_TIME
from vibeam.exchange.units import unit_size
from vibeam.extensions.identification.decay import identify_decay
from vibeam.extensions.identification.residues import MOST
from vibeam.extensions.identification.response import (
    DRIVES,
    FORMS,
    identify_frequency_response,
    identify_response,
    identify_spectrum,
    usable,
)
from vibeam.extensions.identification.signals import NAMES, UNITS, Signal, ascends, name_in, read_signal
from vibeam.studies.fit.linear_estimates import Identification
from vibeam.studies.measured_panel import MeasuredCurve, label
from vibeam_models.arrays import Array

KINDS = ("decay", "spectrum", "response", *FORMS)
OVER_FREQUENCY = KINDS[1:]
RATIOS = ("transmissibility", "relative transmissibility")
ALLOWED = {"time": KINDS[:1], "frequency": OVER_FREQUENCY}
#: words of a head, and the kinds of what is called so
WORDS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("fft", "dft", "spectrum", "spektrum", "spectre", "fourier"), ("spectrum",)),
    **dict.fromkeys(("frf", "response", "transfer", "frequenzgang", "h", "h1", "h2", "tf"), KINDS[2:]),
    **dict.fromkeys(("receptance", "compliance", "admittance"), ("receptance",)),
    "mobility": ("mobility",), "accelerance": ("accelerance",), "inertance": ("accelerance",),
    "transmissibility": RATIOS, "relative": ("relative transmissibility",),
}  # fmt: skip
MOTIONS = ("m", "m/s", "m/s^2", "N", "V")
#: SI units of pictures: of ratios and amplitudes, and of power
AMPLITUDES = ("1", *MOTIONS, *(f"{each}{per}" for each in MOTIONS for per in ("/N", "/V", "/A", "/Hz", " s")))
SQUARES = tuple(f"{each}{per}" for each in ("m^2", "(m/s)^2", "(m/s^2)^2", "N^2", "V^2") for per in ("/Hz", ""))
POWERS = {"psd", "power", "autopower", "density", "leistungsdichte"}
#: units of values, what they are of, and the kinds
OF_UNITS: Sequence[tuple[str, str, tuple[str, ...]]] = (
    *((FORMS[form][0], f"of {form}", (form,)) for form in KINDS[3:6]),
    ("1", "of a transmissibility", RATIOS),
    *((unit, "of the reciprocal of a response: take the reciprocal", ()) for unit in ("N/m", "N s/m", "kg")),
)


@dataclass(frozen=True)
class Clue:
    """Observation in words, and the readings that it allows."""

    words: str
    allows: Sequence[str]


def identify_signal(
    path: Path, of: str | None = None, x: str | None = None, y: str | None = None, *, drive: str | None = None,
    level: float | None = None, stretch: tuple[float | None, float | None] = (None, None),
) -> Identification:  # fmt: skip
    """Natural frequencies, damping ratios and gains from the signal of a file, with what it was taken as and why.

    ``of``: one of ``KINDS``; None: found out. ``x``, ``y``: heads of the columns, or numbers from 1. ``drive``,
    ``level``: of a response. ``stretch``: times (s) or frequencies (Hz) from which and to which it is taken. CaseError
    with the place and the cure; ValueError where it is none, or cannot be told.
    """
    whole = read_signal(path, "" if of is None else "time" if of == KINDS[0] else "frequency", x, y)
    signal = whole.within(stretch)
    tell(signal.taken)
    signal = _causal(signal)
    if not usable(signal.value):
        raise ValueError("values are too large or too small; the largest lies between 1e-60 and 1e+60 in its unit")
    told = [*_of_abscissa(signal), *_of_value(signal), *_of_numbers(signal)]
    if drive is not None or level is not None:
        forms = () if level is not None else KINDS[3:6] if drive == "force" else RATIOS
        told.append(Clue("a drive is given, --drive or --level", ("response", *forms)))
    if power := _is_power(signal):
        told.append(Clue(f"{signal.units[1] or repr(signal.heads[1])} is of power, whose root is taken", ("spectrum",)))
        signal = replace(signal, value=np.sqrt(np.maximum(signal.value, 0.0)))
    methods = _methods(signal, drive, level)
    kind, why = (of, _against(of, told)) if of else reading(told, methods)
    found = methods[kind]()
    if kind == RATIOS[0] and not of and all(RATIOS[1] in each.allows for each in told):
        kind, found = min(((each, methods[each]()) for each in RATIOS), key=lambda each: _parameters(each[1]))
    notes = (*signal.notes, *found.notes, *_of_drive(kind, signal, drive, level))
    curve = None if found.curve is None else replace(_curve(whole, found.curve, kind, power), name=path.name)
    return replace(found, of=kind, why=why, notes=notes, curve=curve)


def _curve(whole: Signal, fitted: MeasuredCurve, kind: str, power: bool) -> MeasuredCurve:
    """All that was read, in SI where its unit is known, with what is used of it and the fit; of power its root."""
    value = whole.value if fitted.timed else np.abs(whole.value)
    size, unit = _si(whole.units[1], power)
    if power:
        value, size, unit = np.sqrt(np.maximum(value, 0.0)), size**0.5, f"√({unit})" if unit else ""
    assert fitted.fit is not None
    at, model = fitted.fit
    fit = at, (1.0 if kind in FORMS else size) * model
    named = kind if len(whole.parts) > 2 else " and ".join(whole.parts)
    labels = (
        label(*(("time", "s") if fitted.timed else ("frequency", "Hz"))),
        label(f"{'root of ' * power}{f'modulus of {named}' if named else whole.heads[1]}", unit),
    )
    return MeasuredCurve(
        whole.at, size * value, np.isin(whole.at, fitted.at[fitted.used]), fit, labels, timed=fitted.timed
    )


def _si(unit: str, power: bool) -> tuple[float, str]:
    """Factor of a unit and the SI unit that it is one of; itself where none of the usual ones is."""
    known = SQUARES if power else AMPLITUDES
    return next(((size, each) for each in known if unit and (size := size_in(unit, each))), (1.0, unit))


def identify_stretch(path: Path, since: str | None, until: str | None, **said: Any) -> Identification:
    """As ``identify_signal``, from one time or frequency to another: numbers in s or Hz, or with a unit of these."""
    ends = {name: _end(text) for name, text in (("--from", since), ("--to", until)) if text}
    first, last = (to_si(text, _end(text)) if text else None for text in (since, until))
    made = identify_signal(path, stretch=(first, last), **said)
    for name, kind in ends.items():
        if kind.unit not in ("", "s" if made.of == "decay" else "Hz"):
            raise ValueError(f"{name} in {kind.unit}, and it is a {made.of}: say another unit, or none")
    return made


def _end(text: str) -> Any:
    """Kind of a quantity that is a time where it is neither a plain number nor a frequency."""
    return RATIO if suits(text, RATIO) and "%" not in text else FREQUENCY if suits(text, FREQUENCY) else TIME


def _parameters(found: Identification) -> tuple[int, bool, float]:
    """Order of fits by what they need, and leave."""
    return len(found.rows), "no residual term" not in found.method, found.residual


def _methods(signal: Signal, drive: str | None, level: float | None) -> Mapping[str, Callable[[], Identification]]:
    at, value, uncertainty, unit = signal.at, signal.value, signal.uncertainty, signal.units[1]
    size = 1.0 if level is None else level
    motions = [
        power for power, each in enumerate(("m", "m/s", "m/s^2")) for below in ("", "/V", "/N", "/A")
        if unit and size_in(unit, each + below)
    ]  # fmt: skip
    return {
        "decay": lambda: identify_decay(at, value),
        "spectrum": lambda: identify_spectrum(at, value, uncertainty=uncertainty),
        "response": lambda: identify_response(
            at,
            value,
            drive=drive or DRIVES[0],
            level=size,
            uncertainty=uncertainty,
            modes=MOST,
            motion=max(motions, default=0),
        ),
        **{form: partial(_of_form, signal, form) for form in FORMS},
    }


def _of_form(signal: Signal, form: str) -> Identification:
    """Modes of a response whose unit tells its form, in SI."""
    unit, wanted = signal.units[1], FORMS[form][0]
    silent = (f"{signal.heads[1]!r} has no unit: it is taken in {wanted}",) if not unit and wanted != "1" else ()
    size = size_in(unit, wanted) if unit else 1.0
    if size is None:
        raise ValueError(f"{signal.heads[1]!r} is no {form}: the unit {unit!r} is not one of {wanted}")
    uncertainty = None if signal.uncertainty is None else size * signal.uncertainty
    found = identify_frequency_response(signal.at, size * signal.value, of=form, uncertainty=uncertainty)
    return replace(found, notes=(*silent, *found.notes))


def _causal(signal: Signal) -> Signal:
    """A signal with the phases of exp(iωt): that of a motion behind its cause falls with the frequency."""
    value = signal.value[..., np.argsort(signal.at, kind="stable")]
    if not np.iscomplexobj(value) or float(np.sum(np.imag(np.conj(value[..., :-1]) * value[..., 1:]))) <= 0:
        return signal
    told = "its phases rise with the frequency: they are taken with the other sign, as those of exp(−iωt)"
    return replace(signal, value=np.conj(signal.value), notes=(*signal.notes, told))


def _is_power(signal: Signal) -> bool:
    """Test whether values are squares, by their unit or, without one, by their head; decibels are of amplitudes."""
    unit, words = signal.units[1], _words(signal.heads[1])
    size = unit_size(re.sub(r"(?<![A-Za-z])G(?![A-Za-z])", "g", re.sub(r"\s*/\s*\(?Hz\)?$", "", unit)))
    powers = [] if size is None else [power for base, power in size[1].items() if base != OF_TIME]  # m^2/s^3, too
    square = powers and all(power % 2 == 0 for power in powers)
    return not signal.decibels and bool(square or (words & POWERS and not unit))


def _words(head: str) -> set[str]:
    return {*re.findall(r"[^\W\d_]+\d?", head.casefold())}


def _of_drive(kind: str, signal: Signal, drive: str | None, level: float | None) -> Iterator[str]:
    """Note on the drive that is assumed of a response, and what the other one would give."""
    if kind != "response" or drive is not None:
        return
    other = _methods(signal, "force", level)["response"]()
    yield f"a base displacement is assumed to drive it; to a force it would be {_short(other)}: say --drive"


def reading(clues: Sequence[Clue], methods: Mapping[str, Callable[[], Identification]]) -> tuple[str, str]:
    """The one reading that all clues allow, and why; ValueError, with what the others would give, where none is."""
    left = [kind for kind in KINDS if all(kind in each.allows for each in clues)]
    if len(left) == 1 or (left and (left[0] == "response" or {*left} == {*RATIOS})):
        return left[0], _told(clues)
    if not left:
        raise ValueError(
            f"cannot tell what it is: {_told(clues, ', but ', True)}: name other columns, --x HEAD --y HEAD, or say "
            f"which it is, --of {', '.join(KINDS[:2])}, {KINDS[2]} or its form, {', '.join(FORMS)}"
        )
    left = _plainly(left)
    would = " or ".join(f"{_a(each)}{_would(methods[each])}" for each in left)
    cure = " or ".join(f"--of {each}" for each in left)
    raise ValueError(f"may be {would}: {_told(clues)}; no head, unit or number says which: say {cure}")


def _a(kind: str) -> str:
    return f"{'an' if kind[0] == 'a' else 'a'} {kind}"


def _plainly(kinds: Sequence[str]) -> list[str]:
    """Kinds without those that are responses, where a response of any form is among them."""
    return [each for each in kinds if each not in FORMS or "response" not in kinds]


def _told(clues: Sequence[Clue], between: str = ", ", meaning: bool = False) -> str:
    allowed = (" or ".join(_a(kind) for kind in _plainly(each.allows)) for each in clues)
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
    frequency, ratio = found.rows[:2]
    damping = f", damping ratio {ratio.value:.3g}" if ratio.determined else ""
    return f"{frequency.value:.5g} Hz{damping}"


def _of_abscissa(signal: Signal) -> Iterator[Clue]:
    """Clues of the head and of the unit of the abscissa."""
    (head, _), (unit, _) = signal.heads, signal.units
    known = [over for over, si in UNITS.items() if unit and size_in(unit, si)]
    yield from (Clue(f"{head!r} is in {unit}", ALLOWED[over]) for over in known)
    named = [over for over in NAMES if name_in(head, over) and over not in known]
    yield from (Clue(f"{head!r} is called a {over}", ALLOWED[over]) for over in named)


def _of_value(signal: Signal) -> Iterator[Clue]:
    """Clues of the head and of the unit of the values."""
    (_, head), (_, unit) = signal.heads, signal.units
    if signal.parts:
        yield Clue(f"{' and '.join(map(repr, signal.parts))} are complex numbers or several responses", OVER_FREQUENCY)
    for word in _words(head) & WORDS.keys():
        yield Clue(f"{head!r} is called a {'spectrum' if WORDS[word] == ('spectrum',) else 'response'}", WORDS[word])
    told = [each for each in OF_UNITS if unit and size_in(unit, each[0]) and ("/" in unit or each[2])]
    below = re.findall(r"/\s*\(?\s*([^\s/()*·]+)", unit)
    if told:
        yield Clue(f"{unit} is {told[0][1]}", told[0][2])
    elif "Hz" in unit or re.search(r"[·*\s]s$", unit):
        yield Clue(f"{unit} is the unit of a Fourier transform", ("spectrum",))
    elif not all(size_in(re.sub(r"\^?[23²³]$", "", each), "s") for each in below):
        yield Clue(f"{unit} is a ratio", ("response",))


SWING = 0.15  # of the largest departure from the middle, that counts as a swing
SWINGS = 3
ONE_SIDED = 0.1  # swing to one side over that to the other, below which values do not swing
SCATTER = 0.25  # of the intervals between swings: half of them are as near to their median, relative to it
EVEN = 0.8  # share of the steps that are equal, from which on a grid is even


def _of_numbers(signal: Signal) -> Iterator[Clue]:
    """Clues of the numbers: order and steps of the abscissa, swings and signs of the values."""
    at, value = signal.at, signal.value if signal.value.ndim == 1 else signal.value[0]
    if len(at) < 4:
        return
    value = np.abs(value) if np.iscomplexobj(value) else value
    if not ascends(at):
        if ascends(value):
            yield Clue(f"{signal.heads[1]!r} ascends and {signal.heads[0]!r} does not, as if they were exchanged", ())
        elif signal.over != "time":
            yield Clue(f"{signal.heads[0]!r} does not only ascend, as in a sweep", KINDS[2:])
    order = np.argsort(at, kind="stable")
    steps = np.diff(at[order])
    steps = steps[steps > 0]
    if signal.over != "time" and len(steps) and np.mean(np.abs(steps / np.median(steps) - 1) < 0.05) < EVEN:
        yield Clue("its steps are uneven, as those of no Fourier transform", ("decay", *KINDS[2:]))
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
