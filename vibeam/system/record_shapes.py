"""Records of shapes: shock pulses, bursts, sines and chirps; polynomials are exact, sines cubic pieces to a bound.

A cubic through four points of a piece of h seconds, its ends among them, at the zeros of the Chebyshev polynomial of
degree 4 stretched to the ends, is off by at most h⁴ max|u⁗| / 2238 (cos⁴(π/8) 2⁷ 4!). A sum of sines of at most A in
size and of frequencies up to ω has |u⁗| ≤ A ω⁴ (Bernstein's inequality), which gives the number of pieces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from vibeam.system import record_pieces as pieces
from vibeam.system.record_samples import extent, require_peak
from vibeam_models.arguments import count, number, refuse, word
from vibeam_models.arrays import Array

NODES = np.array([0.0, 0.5 - 0.5 * np.tan(np.pi / 8), 0.5 + 0.5 * np.tan(np.pi / 8), 1.0])
BOUND = 2238.0
MOST_PIECES = 20_000_000
LEVELS = 1001  # frequencies at which the largest peak of a chirp is looked for
#: windows over 0 … 1 as sums of a_k cos 2πkx
WINDOWS = {
    "rectangular": (1.0,),
    "hann": (0.5, -0.5),
    "hamming": (0.54, -0.46),
    "blackman": (0.42, -0.5, 0.08),
}
SAW_TEETH = ("terminal", "initial")


class ShapedRecords(pieces.MadeOfPieces):
    """Chapter of ``Record``: records of shapes. ``error``: as a share of the peak, 10⁻¹² where it is not said."""

    @classmethod
    def half_sine(
        cls, peak: float, duration: float, *, quantity: str = "acceleration", start: float = 0.0, error: float = 1e-12
    ) -> Self:
        """Half-sine pulse (IEC 60068-2-27): peak · sin(πt/duration), from ``start`` on, s.

        >>> import vibeam
        >>> pulse = vibeam.Record.half_sine(50 * 9.80665, 0.011)
        >>> print(f"{pulse.drift[0]:.9f} m/s")  # 2/π · peak · duration
        3.433924066 m/s
        """
        faults: list[str] = []
        omega = np.pi / extent("duration", duration, faults)
        return cls._fitted(peak, duration, omega, lambda t: np.sin(omega * t), quantity, start, error, faults)

    @classmethod
    def saw_tooth(
        cls, peak: float, duration: float, *, kind: str = "terminal", quantity: str = "acceleration", start: float = 0.0
    ) -> Self:
        """Saw-tooth pulse that ends at its peak, ``kind = "terminal"``, or begins with it, ``"initial"``; exact."""
        faults: list[str] = []
        word("kind", kind, SAW_TEETH, faults)
        ends, lasts = (0, 1) if kind == "terminal" else (1, 0), extent("duration", duration, faults)
        return cls._lines(peak, [ends], [lasts], quantity, start, faults)

    @classmethod
    def trapezoid(
        cls, peak: float, duration: float, *, rise: float, fall: float | None = None,
        quantity: str = "acceleration", start: float = 0.0,
    ) -> Self:  # fmt: skip
        """Trapezoidal pulse: up in ``rise``, down in ``fall`` seconds (None: as long), all in ``duration``; exact."""
        faults: list[str] = []
        duration = extent("duration", duration, faults)
        up = number("rise", rise, faults, least=0.0)
        down = up if fall is None else number("fall", fall, faults, least=0.0)
        flat = duration - up - down
        if flat < -1e-12 * abs(duration):
            faults.append(f"rise, fall: {up:g} s and {down:g} s are longer than the {duration:g} s of the pulse")
        parts = [(0, 1), (1, 1), (1, 0)]
        return cls._lines(peak, parts, [up, max(flat, 0.0), down], quantity, start, faults)

    @classmethod
    def step(
        cls, peak: float, duration: float, *, rise: float = 0.0, quantity: str = "acceleration", start: float = 0.0
    ) -> Self:
        """Step to ``peak`` within ``rise`` seconds, held to the end of ``duration``; exact. 0 is a quiet time."""
        return cls.trapezoid(peak, duration, rise=rise, fall=0.0, quantity=quantity, start=start)

    @classmethod
    def sine(
        cls, peak: float, frequency: float, duration: float, *, phase: float = 0.0,
        quantity: str = "acceleration", start: float = 0.0, error: float = 1e-12,
    ) -> Self:  # fmt: skip
        """Sine peak · sin(2π frequency (t − start) + phase), ``duration`` s long; ``frequency`` Hz, ``phase`` rad."""
        faults: list[str] = []
        omega = 2 * np.pi * extent("frequency", frequency, faults)
        phase = number("phase", phase, faults)
        return cls._fitted(peak, duration, omega, lambda t: np.sin(omega * t + phase), quantity, start, error, faults)

    @classmethod
    def chirp(
        cls, peak: float | Callable[[Array], Array], first: float, last: float, duration: float, *,
        quantity: str = "acceleration", start: float = 0.0, error: float = 1e-9,
    ) -> Self:  # fmt: skip
        """Sine whose frequency goes from ``first`` to ``last`` (Hz) in a straight line over ``duration`` seconds.

        ``peak``: a number, or a function of frequencies (Hz); one that is smooth over a period keeps the bound.
        """
        faults: list[str] = []
        low, high = (
            number(name, each, faults, least=0.0, most=1e12) for name, each in (("first", first), ("last", last))
        )
        duration = extent("duration", duration, faults)
        bend = np.pi * (high - low) / duration
        top = 2 * np.pi * max(low, high)
        fastest = (top**4 + 12 * top**2 * abs(bend) + 12 * bend**2) ** 0.25  # |d⁴ sin φ/dt⁴|, φ'' = 2 bend

        def swept(t: Array) -> Array:
            return np.sin((2 * np.pi * low + bend * t) * t)

        if not callable(peak):
            return cls._fitted(peak, duration, fastest, swept, quantity, start, error, faults)
        refuse("record", faults)
        level, most = peak, float(np.max(np.abs(peak(np.linspace(low, high, LEVELS)))))
        share = most or 1.0
        return cls._fitted(
            most, duration, fastest, lambda t: level(low + bend / np.pi * t) / share * swept(t), quantity, start,
            error, faults,
        )  # fmt: skip

    @classmethod
    def tone_burst(
        cls, peak: float, frequency: float, cycles: float, *, window: str = "hann",
        quantity: str = "acceleration", start: float = 0.0, error: float = 1e-12,
    ) -> Self:  # fmt: skip
        """Sine of ``cycles`` periods at ``frequency`` Hz under a window: rectangular, hann, hamming or blackman.

        ``peak`` is that of the sine where the window is 1, in its middle.
        """
        faults: list[str] = []
        frequency, cycles = extent("frequency", frequency, faults), extent("cycles", cycles, faults)
        terms, omega, span = WINDOWS[word("window", window, WINDOWS, faults)], 2 * np.pi * frequency, cycles / frequency

        def burst(t: Array) -> Array:
            shape = sum(share * np.cos(2 * np.pi * k / span * t) for k, share in enumerate(terms))
            return np.asarray(shape * np.sin(omega * t))

        top = omega + 2 * np.pi * (len(terms) - 1) / span
        return cls._fitted(peak, span, top, burst, quantity, start, error, faults)

    @classmethod
    def sine_beat(
        cls, peak: float, frequency: float, cycles: float, *, beats: int = 1, pause: float = 0.0,
        quantity: str = "acceleration", start: float = 0.0, error: float = 1e-12,
    ) -> Self:  # fmt: skip
        """Sine beats (IEC 60068-2-57): ``cycles`` periods at ``frequency`` Hz each, in a half-sine as their envelope.

        ``beats`` of them, with a ``pause`` in seconds between two.

        >>> import vibeam
        >>> vibeam.Record.sine_beat(10.0, 5.0, 10, beats=5, pause=2.0).duration
        18.0
        """
        faults: list[str] = []
        frequency, cycles = extent("frequency", frequency, faults), extent("cycles", cycles, faults)
        beats, pause = count("beats", beats, faults, least=1, most=100_000), number("pause", pause, faults, least=0.0)
        omega, slow, span = 2 * np.pi * frequency, np.pi * frequency / cycles, cycles / frequency
        one = cls._fitted(
            peak, span, omega + slow, lambda t: np.sin(omega * t) * np.sin(slow * t), quantity, start, error, faults
        )
        quiet = 1 if pause else 0
        starts = start + np.arange(beats)[:, None] * (span + pause)
        times = (starts + (one.times[1 - quiet :] - start)).ravel()
        parts = np.tile(np.concatenate([np.zeros((quiet, 4)), one.coefficients]), (beats, 1))
        return cls(times if quiet else np.concatenate([[start], times]), parts[quiet:], quantity)

    @classmethod
    def _lines(
        cls, peak: float, ends: Sequence[tuple[int, int]], lengths: Sequence[float],
        quantity: str, start: float, faults: list[str],
    ) -> Self:  # fmt: skip
        """Record of straight lines between shares 0 and 1 of the peak; those without a length are left out."""
        peak, start = number("peak", peak, faults), number("start", start, faults)
        refuse("record", faults)
        require_peak(peak, quantity)
        kept = [(pair, length) for pair, length in zip(ends, lengths, strict=True) if length > 0]
        lines = [[peak * first, peak * (last - first) / length, 0.0, 0.0] for (first, last), length in kept]
        times = start + np.concatenate([[0.0], np.cumsum([length for _, length in kept])])
        return cls(times, np.array(lines), quantity)

    @classmethod
    def _fitted(
        cls, peak: float, duration: float, omega: float, function: Callable[[Array], Array],
        quantity: str, start: float, error: float, faults: list[str],
    ) -> Self:  # fmt: skip
        """Record of cubics through ``peak`` times a function whose fourth derivative is ``omega``⁴ at most."""
        peak, start = number("peak", peak, faults), number("start", start, faults)
        duration = extent("duration", duration, [] if faults else faults)
        error = number("error", error, faults, least=1e-15, most=0.1)
        refuse("record", faults)
        require_peak(peak, quantity)
        wanted = duration * omega / (BOUND * error) ** 0.25
        if wanted > MOST_PIECES:
            raise ValueError(
                f"record: {wanted:.3g} pieces, {MOST_PIECES:.3g} at most: shorten it, lower its frequency, or raise "
                f"error from {error:g}"
            )
        times = np.linspace(0.0, duration, int(np.ceil(wanted)) + 1)
        lengths = np.diff(times)[:, None]
        values = peak * function(times[:-1, None] + lengths * NODES)
        made = values @ np.linalg.inv(np.vander(NODES, 4, increasing=True)).T / lengths**pieces.POWERS
        return cls(start + times, made, quantity)
