"""Errors of a response against another one: of amplitudes, of ends of branches, differences in kind; what suffices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from vibeam.case.case import Case
from vibeam.periodic.motion_kind import SteadyKind, width
from vibeam.runs.comparison.ends import SweptEnd

GIVEN = "the case gives only these modes"
FIFTH = 0.2  # frequency error allowed, as a share of the amplitude error, where it is not said


@dataclass(frozen=True)
class Asked:
    """Errors allowed of a model: largest ``amplitude`` and ``frequency`` error, shares."""

    amplitude: float = 0.05
    frequency: float = 0.01

    @classmethod
    def of(cls, accuracy: float, frequency_accuracy: float | None = None) -> Asked:
        """By an accuracy, and a fifth of it for frequencies where that is not said."""
        return cls(accuracy, FIFTH * accuracy if frequency_accuracy is None else frequency_accuracy)


@dataclass(frozen=True)
class AmplitudeError:
    """Relative error of the amplitude at ``frequency`` in Hz, signed; ``ours`` and the ``reference``'s amplitude.

    ``scatter``: standard error of the error, of motions that do not repeat, ∞ of one reading alone; else 0.
    """

    error: float
    frequency: float
    direction: str
    ours: float
    reference: float
    scatter: float = 0.0

    def carried_on(self, factor: float) -> AmplitudeError:
        """The error so many times as large, the reference further off."""
        reference = self.ours - factor * (self.ours - self.reference)
        return replace(self, error=factor * self.error, reference=reference, scatter=factor * self.scatter)

    @property
    def least(self) -> float:
        """Size of the error less twice its scatter."""
        return max(abs(self.error) - 2 * self.scatter, 0.0)

    @property
    def most(self) -> float:
        """Size of the error and twice its scatter."""
        return abs(self.error) + 2 * self.scatter


@dataclass(frozen=True)
class EndError:
    """Relative error of an end of a branch, signed, known to ± ``open``: ``ours`` beside the ``reference``'s."""

    error: float
    open: float
    ours: SweptEnd
    reference: SweptEnd

    def carried_on(self, factor: float) -> EndError:
        """The error so many times as large, the reference's end further off."""
        at = self.ours.frequency - factor * (self.ours.frequency - self.reference.frequency)
        moved = replace(self.reference, frequency=at)
        return replace(self, error=factor * self.error, open=factor * self.open, reference=moved)

    @property
    def late(self) -> bool:
        """True where the sweep comes to our end after the reference's."""
        return (self.error > 0) == (self.ours.direction == "up")


@dataclass(frozen=True)
class KindDifference:
    """Difference in kind between ``low`` and ``high`` in Hz, whose ends are known to ± ``open``, a share.

    ``alone``: one of the two has contact, the other has none in the whole sweep of this ``direction``.
    """

    low: float
    high: float
    open: float
    direction: str
    ours: SteadyKind
    reference: SteadyKind
    alone: bool = False

    @property
    def width(self) -> float:
        """Relative width in frequency; ∞ of a sweep at this frequency alone."""
        return width(self.low, self.high) if self.high > self.low else inf

    def within(self, allowed: float) -> bool | None:
        """Test whether it is as narrow as is allowed; contact where the other has none at all never is."""
        return False if self.alone else _within(self.width, self.open, allowed)


@dataclass(frozen=True)
class ResponseComparison:
    """Comparison of a response with a ``reference``: see the module.

    ``amplitude``: where it is surely most off, None without a place at which both make the same motion with contact;
    ``scattered``: where it may be most off; ``ends`` that both have, the worst first; ``kinds``: differences in kind,
    the gravest first; ``places``: at how many the amplitudes were compared. ``unknown``: ranges in Hz, of which the
    motion of one of the two is not known.
    """

    amplitude: AmplitudeError | None = None
    scattered: AmplitudeError | None = None
    ends: tuple[EndError, ...] = ()
    kinds: tuple[KindDifference, ...] = ()
    places: int = 0
    unknown: tuple[tuple[str, float, float], ...] = ()

    @property
    def amplitude_error(self) -> float:
        """Size of the amplitude error; NaN without a place to compare, or with one reading alone."""
        return float("nan") if self.amplitude is None or self.amplitude.scatter == inf else abs(self.amplitude.error)

    @property
    def frequency_error(self) -> float:
        """Size of the frequency error; 0 without an end that both have."""
        return abs(self.ends[0].error) if self.ends else 0.0

    @property
    def kind_width(self) -> float:
        """Relative width of the gravest difference in kind; 0 without any."""
        return self.kinds[0].width if self.kinds else 0.0

    def carried_on(self, factor: float) -> ResponseComparison:
        """The comparison with a reference from which this one's differs by so many times the errors."""
        amplitude, scattered = (each and each.carried_on(factor) for each in (self.amplitude, self.scattered))
        return replace(
            self, amplitude=amplitude, scattered=scattered, ends=tuple(each.carried_on(factor) for each in self.ends)
        )

    def suffices(self, asked: Asked) -> bool | None:
        """Test whether the response is within what is asked of the reference; None where that is not known."""
        found = [self._amplitude_within(asked.amplitude)]
        found += [_within(abs(each.error), each.open, asked.frequency) for each in self.ends]
        found += [each.within(asked.frequency) for each in self.kinds]
        found += [None for _, low, high in self.unknown if width(low, high) > asked.frequency]
        return False if False in found else None if None in found else True

    def _amplitude_within(self, allowed: float) -> bool | None:
        if self.amplitude is None or self.scattered is None:
            return True
        return False if self.amplitude.least > allowed else True if self.scattered.most <= allowed else None

    def shares(self, asked: Asked) -> tuple[float, float, float]:
        """Amplitude error, frequency error and gravest difference in kind, each in units of what is asked."""
        amplitude = 0.0 if self.amplitude is None else self.amplitude.least / asked.amplitude
        kind = inf if any(each.alone for each in self.kinds) else self.kind_width / asked.frequency
        return amplitude, self.frequency_error / asked.frequency, kind

    def worst(self, asked: Asked) -> float:
        """Largest of the errors in units of what is asked."""
        return max(self.shares(asked))


def _within(size: float, open_: float, allowed: float) -> bool | None:
    """Test whether a number known to ± ``open_`` is at most so large; None where that is open."""
    return True if size + open_ <= allowed else False if size - open_ > allowed else None


@dataclass(frozen=True)
class ComparedFidelity:
    """Comparison of a fidelity with its ``reference``; of a finest one, whose reference is empty, with a fuller model.

    ``modes`` of the reference, on so many ``elements`` where these are others than the case's; ``limit``: the errors
    are carried on to infinitely many modes. ``whole``: it is all that the case gives, and so exact; ``why``: there is
    no comparison.
    """

    fidelity: str
    reference: str
    comparison: ResponseComparison | None
    modes: int = 0
    elements: int = 0
    limit: bool = False
    whole: bool = False
    why: str = ""

    def suffices(self, asked: Asked) -> bool | None:
        """Test whether it is within what is asked of its reference; None where that is not known."""
        if self.whole:
            return True
        return None if self.comparison is None else self.comparison.suffices(asked)


def asked_of(case: Case) -> Asked:
    """Errors that a case allows its models."""
    return Asked.of(case.asked["verdict"].accuracy, case.asked["verdict"].frequency_accuracy)
