"""Modes from frequency responses and from spectra: natural frequencies, damping ratios, residues, mode shapes.

A response is a sum of modes (``residues``). Of a receptance, mobility or accelerance p = 0, 1, 2 derivatives of a
displacement are over a force, and a residue r_k = φ_k(output) φ_k(input) is in 1/kg. Over a base displacement −s² is
a factor, and 1 is added where the motion is absolute. With r = f/f_n and D = √((1 − r²)² + (2ζr)²) the modulus of one
mode of a gain g is

    base displacement   g r²/D     base acceleration, force   g/D     spectrum of a decay   √(a² + b² r²)/D

(eq. 43 of the paper is the first). The last is |X| of X(s) = (s x₀ + v₀ + 2ζω x₀)/(s² + 2ζωs + ω²), one mode with a
complex residue, of a record that begins at the release; one that is cut before the motion has died, or whose spectrum
is taken over too few frequencies, has leakage that a note tells of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam.exchange.faults import suggest
from vibeam.extensions.identification.residues import MOST, Fit, ModalResponses, fitted
from vibeam.studies.fit.linear_estimates import Estimate, Identification, correlation, estimates, spread_of
from vibeam.studies.measured_panel import MeasuredCurve
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array
from vibeam_models.memory import check_room

DRIVES = ("base displacement", "base acceleration", "force")
#: form of a response: its unit, the power of s, what is added, the sign of a residue
FORMS: dict[str, tuple[str, int, float, int]] = {
    "receptance": ("m/N", 0, 0.0, 1),
    "mobility": ("m/s/N", 1, 0.0, 1),
    "accelerance": ("m/s^2/N", 2, 0.0, 1),
    "transmissibility": ("1", 2, 1.0, -1),
    "relative transmissibility": ("1", 2, 0.0, -1),
}
CUT = 0.02  # share of the motion left at the end of a record from which on its spectrum leaks
REMAINS = 0.05  # residual, relative to the largest value, from which on there are no such modes
CORRELATED = 0.3  # correlation of neighbouring residuals from which on noise is not white
A_POINT = 6000.0  # bytes of memory of a fit of several modes
NEAR = 0.15  # share of the peak from which on a spectrum is fitted: below, noise has a floor
RANGE = "; the largest lies between 1e-60 and 1e+60 in its unit"
SAMPLE = ("natural frequency", "damping ratio")


@dataclass(frozen=True)
class _Wanted:
    """Form of what is fitted, and the name, unit and factor of a residue; ``static``: over the square of ω_k."""

    power: int
    offset: float = 0.0
    residue: str = ""
    unit: str = ""
    factor: float = 1.0
    static: bool = False
    most: int = MOST
    terms: bool = True
    twisted: bool = False


def identify_frequency_response(
    frequency: ArrayLike, response: ArrayLike, *, of: str, uncertainty: ArrayLike | None = None, modes: int = MOST
) -> Identification:
    """Natural frequencies (Hz), damping ratios and residues of the modes of a frequency response (n,), or of several.

    ``response``: complex, or moduli, in SI; (m, n) of m responses with the same modes. ``of``: ``"receptance"``,
    ``"mobility"``, ``"accelerance"``, over a force; ``"transmissibility"``, absolute, or ``"relative
    transmissibility"``, over a base motion of the same kind. ``uncertainty``: standard deviations of each part; None:
    taken from the scatter. At most ``modes``, and residual terms of those outside the band. ValueError for what is no
    response.

    >>> import numpy as np
    >>> import vibeam
    >>> s = 2j * np.pi * np.linspace(5.0, 15.0, 101)
    >>> receptance = 2.0 / (s**2 + 2.5 * s + (20 * np.pi) ** 2)
    >>> found = vibeam.identify_frequency_response(s.imag / 2 / np.pi, receptance, of="receptance")
    >>> {row.name: round(row.value, 4) for row in found.rows}
    {'natural frequency': 10.0, 'damping ratio': 0.0199, 'residue': 2.0, 'modal mass': 0.5}
    """
    if of not in FORMS:
        raise ValueError(f"of: {of!r} is none of these: {suggest(of, FORMS)}")
    unit, power, offset, sign = FORMS[of]
    called, unit = ("gain", "1") if unit == "1" else ("residue", "1/kg")
    return _modes(frequency, response, uncertainty, _Wanted(power, offset, called, unit, sign, most=modes))


def identify_response(
    frequency: ArrayLike, amplitude: ArrayLike, *, drive: str = "base displacement", level: float = 1.0,
    uncertainty: ArrayLike | None = None, modes: int = 1, motion: int = 0,
) -> Identification:  # fmt: skip
    """Natural frequency (Hz), damping ratio and gain (unit of amplitude over ``level``'s) from a forced response (n,).

    ``level``: amplitude of the drive, in m, m/s², N or V, the same at all frequencies. ``uncertainty``: standard
    deviations (n,) or one; None: taken from the scatter. The gain includes the mode's value at the sensor. Amplitudes
    are of a displacement, velocity or acceleration: ``motion`` 0, 1, 2. Of more than one of ``modes`` with residual
    terms. ValueError for what is no response.

    >>> import numpy as np
    >>> import vibeam
    >>> ratio = np.linspace(0.5, 1.5, 101)
    >>> found = vibeam.identify_response(10.0 * ratio, ratio**2 / np.abs(1 - ratio**2 + 0.04j * ratio))
    >>> {row.name: round(row.value, 4) for row in found.rows}
    {'natural frequency': 10.0, 'damping ratio': 0.02, 'gain': 1.0}
    """
    if drive not in DRIVES:
        raise ValueError(f"drive: {drive!r} is none of {', '.join(DRIVES)}")
    if not (np.isfinite(level) and level > 0):
        raise ValueError(f"level: {level!r} is not above 0")
    moved, sign = drive == DRIVES[0], 1 if drive == DRIVES[2] else -1
    wanted = _Wanted(
        motion + 2 * moved, residue="gain", unit="amplitude/level", factor=sign / level, static=not moved, most=modes,
        terms=modes > 1,
    )  # fmt: skip
    return _modes(frequency, amplitude, uncertainty, wanted)


def identify_spectrum(
    frequency: ArrayLike, magnitude: ArrayLike, *, uncertainty: ArrayLike | None = None
) -> Identification:
    """Natural frequency (Hz) and damping ratio from the spectrum (n,) of a decay: magnitudes, without a window.

    Points above 15 % of the peak are fitted, around it. ValueError for what is no spectrum.

    >>> import numpy as np
    >>> import vibeam
    >>> ratio = np.linspace(0.5, 1.5, 101)
    >>> found = vibeam.identify_spectrum(10.0 * ratio, 1 / np.abs(1 - ratio**2 + 0.04j * ratio))
    >>> {row.name: round(row.value, 4) for row in found.rows}
    {'natural frequency': 10.0, 'damping ratio': 0.02}
    """
    f, a, u = _checked(frequency, np.abs(magnitude), uncertainty, 5)
    inside = _around_peak(a[0])
    if len(f[inside]) < 5:
        raise ValueError(f"{len(f[inside])} points above {100 * NEAR:.0f} % of the peak: a longer record is needed")
    wanted = _Wanted(0, most=1, terms=False, twisted=True)
    found = _modes(f[inside], a[0, inside], None if u is None else u[0, inside], wanted)
    found = replace(found, method="the spectrum of a decaying cosine, fitted")
    return _with_leakage(found, float(np.min(np.diff(np.unique(f)))))


def _with_leakage(found: Identification, step: float) -> Identification:
    """A note where the record ends before the motion has died."""
    left = float(np.exp(-2 * np.pi * found.rows[0].value * found.rows[1].value / step))
    said = (
        f"after {1 / step:.3g} s, the length of the record by its lines, {100 * left:.2g} % of the motion are left: "
        "damping is too high by leakage; take the decay itself",
    )
    return replace(found, notes=found.notes + said * (left > CUT))


def usable(values: Array) -> bool:
    """Test whether values are finite, and 0 or such that the fourth power of the largest is a number."""
    return bool(1e-60 <= np.max(np.abs(values), initial=0.0) <= 1e60 or not np.any(values))


def _checked(
    frequency: ArrayLike, response: ArrayLike, uncertainty: ArrayLike | None, least: int
) -> tuple[Array, Any, Array | None]:
    """Frequencies (n,) that ascend, responses (m, n), uncertainties of each."""
    f, a = np.asarray(frequency, dtype=float), np.atleast_2d(np.asarray(response))
    a = a if np.iscomplexobj(a) else a.astype(float)
    if f.ndim != 1 or a.ndim != 2 or a.shape[1] != len(f):
        raise ValueError(f"frequency {f.shape} and response {np.shape(response)} must be of one shape (n,)")
    if len(f) < least:
        raise ValueError(f"{counted(len(f), 'point')}: too few, {least} are needed")
    require_room(a.size)
    negative = not np.iscomplexobj(a) and (a < 0).any()
    if not (usable(f) and usable(a) and (f >= 0).all()) or negative:
        raise ValueError(f"every frequency and amplitude must be a finite number, not below 0{RANGE}")
    if not np.abs(a).max(axis=1).all() or np.ptp(f) == 0:
        raise ValueError("there is no response in it: all amplitudes are 0, or all frequencies the same")
    if f[np.argmax(np.abs(a[0]))] == 0:
        raise ValueError("the largest value is at 0 Hz: there is no peak in it")
    order = np.argsort(f, kind="stable")
    if uncertainty is None:
        return f[order], a[:, order], None
    u = np.broadcast_to(np.asarray(uncertainty, dtype=float), a.shape)
    if not (usable(u) and (u > 0).all()):
        raise ValueError(f"every uncertainty must be a finite number above 0{RANGE}")
    return f[order], a[:, order], u[:, order]


def require_room(points: int, each: float = A_POINT) -> None:
    """Error where there is no room for a fit."""
    check_room(f"a fit to {points} points", each * points, "cut the record, or take every second point of it")


def _around_peak(a: Array) -> slice:
    """The neighbours of the peak above the share that is fitted."""
    peak, low = int(np.argmax(a)), a < NEAR * a.max()
    before, after = np.flatnonzero(low[:peak]), np.flatnonzero(low[peak:])
    return slice(int(before[-1]) + 1 if len(before) else 0, peak + int(after[0]) if len(after) else len(a))


def _modes(frequency: ArrayLike, response: ArrayLike, uncertainty: ArrayLike | None, wanted: _Wanted) -> Identification:
    """Modes of responses in the form that is wanted."""
    f, a, u = _checked(frequency, response, uncertainty, 4)
    inside = f > 0  # s^p = 0 tells nothing, and s^-2 is none
    f, a, u = f[inside], a[:, inside], None if u is None else u[:, inside]
    unit, top = 2 * np.pi * float(np.sqrt(f[0] * f[-1])), float(np.abs(a).max())
    scatter, s = None if u is None else u / top, 2j * np.pi * f / unit
    data = ModalResponses(s, a / top, wanted.power, wanted.offset / top, scatter, lower=wanted.unit != "1")
    path = fitted(data, wanted.most, wanted.terms, wanted.twisted)
    best = path[-1]
    order = np.argsort(best.poles[:, 0])
    names = numbered(SAMPLE if len(a) > 1 or not wanted.residue else (*SAMPLE, wanted.residue), len(order))
    jacobian, sizes = _by_names(best, order, wanted)
    residual = best.residual()
    spread = spread_of(
        jacobian, None if u is not None else residual.ravel(), names, parts=residual.shape[0] * residual.shape[1]
    )
    omega, ratio = np.exp(best.poles[order].T)
    residues = sizes * top * unit ** (2 - wanted.power) * wanted.factor / ((omega * unit) ** 2 if wanted.static else 1)
    values = np.stack([omega * unit / (2 * np.pi), ratio, residues], axis=1)[:, : len(names) // len(order)]
    units = ("Hz", "1", wanted.unit)[: values.shape[1]] * len(order)
    rows = estimates(names, values.ravel().tolist(), spread.half, units)
    left = best.data.parts(best.data.values) - best.data.parts(np.abs(best.model) if data.moduli else best.model)
    share = float(np.sqrt(np.sum(left**2) / a.size))
    orders = tuple(
        tuple((float(np.exp(w) * unit / (2 * np.pi)), float(np.exp(z))) for w, z in each.poles) for each in path
    )
    found = Identification(
        rows, _method(best), a.size, share, spread.directions, tuple(notes_on(residual.ravel(), share)), orders=orders,
        curve=MeasuredCurve(f, np.abs(a), f > 0, (f, np.abs(best.model) * top)),
    )  # fmt: skip
    shapes = best.weights[: len(order)][order] * top * unit ** (2 - wanted.power) * wanted.factor
    return _with_shapes(found, shapes) if wanted.unit == "1/kg" else found


def _with_shapes(found: Identification, residues: Array) -> Identification:
    """Modal masses at a driving point, and of residues (k, m) of several responses a table [modes].

    A residue is the product of the mode's values at output and input: all are positive where these are one point.
    """
    rows = [list(found.rows[at : at + 3]) for at in range(0, len(found.rows), 3)]
    if residues.shape[1] == 1:
        for mode in rows:
            one = mode[2]
            name = one.name.replace("residue", "modal mass")
            value, low, high = (1 / abs(each) for each in (one.value, one.high, one.low))
            mode.append(Estimate(name, value, min(low, high), max(low, high), "kg"))
        return replace(found, rows=tuple(row for mode in rows for row in mode))
    driven = np.flatnonzero((residues > 0).all(axis=0))
    if not len(driven):
        told = "no response is of the driving point, where all residues are positive: the shapes have no scale"
        return replace(found, notes=(*found.notes, told))
    point = int(driven[0])
    shapes = residues / np.sqrt(residues[:, [point]])
    values = {"frequency": [f'"{row.value:.6g} Hz"' for row in found.rows[::2]]}
    values["damping_ratio"] = [f"{row.value:.4g}" for row in found.rows[1::2]]
    values |= {f"outputs.response_{k}": [f"{each:.5g}" for each in shape] for k, shape in enumerate(shapes.T, 1)}
    values["force"] = values[f"outputs.response_{point + 1}"]
    lines = [f"{key} = [{', '.join(each)}]" for key, each in values.items()]
    return replace(found, shapes="\n".join(["[modes]", 'modal_mass = "1 kg"', *lines]))


def numbered(names: Sequence[str], count: int) -> list[str]:
    """Names of the parameters of modes, which bear a number where there are several."""
    return [f"{name} {k}" if count > 1 else name for k in range(1, count + 1) for name in names]


def _by_names(fit: Fit, order: Any, wanted: _Wanted) -> tuple[Array, Array]:
    """Jacobian by the logarithms of what is asked for, then the rest; and residues, of one response."""
    whole, k, count = fit.jacobian(), len(order), fit.weights.shape[1]
    whole = whole.reshape(-1, whole.shape[-1])
    poles, weights = whole[:, : 2 * k].reshape(-1, k, 2)[:, order], whole[:, 2 * k :]
    if count > 1 or not wanted.residue:
        return np.hstack([poles.reshape(-1, 2 * k), weights]), np.zeros(k)
    sizes, columns, rest = fit.weights[order, 0], weights[:, order], weights[:, k:]
    by_size = columns * sizes
    if fit.data.moduli and not fit.data.offset and sizes[0] * wanted.factor < 0:
        sizes = -sizes
    if wanted.static:
        poles = poles + np.stack([2 * by_size, 0 * by_size], axis=2)
    return np.hstack([np.dstack([poles, by_size]).reshape(-1, 3 * k), rest]), sizes


def _method(fit: Fit) -> str:
    """Method: what was fitted to what."""
    terms = {(): "no residual term", (-2,): "a lower residual", (0,): "an upper residual"}
    rest = terms.get(fit.terms, "lower and upper residual")
    to = "moduli" if fit.data.moduli else "real and imaginary parts"
    return f"{counted(len(fit.poles), 'mode')} and {rest}, fitted to {to}"


def notes_on(residual: Array, left: float) -> list[str]:
    """Notes on a share ``left`` of the largest value that no such modes explain, and on noise that is not white."""
    found = [f"{100 * left:.2g} % of the largest value remain: this is no single linear mode"] if left > REMAINS else []
    alike = correlation(residual)
    if abs(alike) > CORRELATED and left > 1e-6:
        told = f"neighbouring residuals are correlated ({alike:+.2f})"
        found.append(f"{told}: the noise is not white, and the intervals are too narrow")
    return found
