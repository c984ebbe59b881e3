"""Losses of one reduction: in its response, frequencies, shapes, stiffness, mobility, restitution, transfer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from vibeam.studies.modes_needed.transfer import ContactPulse, ModalForm, TransferStudy
from vibeam.system.curves import Difference
from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.laws.restitution import first_mode_restitution
from vibeam_reductions.projection import Reduction

ALIKE = 0.9  # share of the full model's motions that a model within the accuracy must make too


@dataclass(frozen=True)
class ResponseError(Difference):
    """Difference in amplitude over a sweep from that of all modes, at the ``points`` where both make the same motion.

    ``worst`` at ``mu`` Hz; ``total`` motions of all modes are known. ``complete``: these are all that are looked at,
    and not only those known in closed form; ``given_up``: the flight ended where the model was seen to be off by more
    than the accuracy, and its peak is not known.
    """

    mu: float = nan
    complete: bool = False
    given_up: bool = False

    def within(self, accuracy: float) -> bool:
        """Test whether no motion, and not the peak, is off by more, and next to none is another one."""
        near = abs(self.worst) <= accuracy and not abs(self.peak) > accuracy
        return near and self.points >= ALIKE * self.total

    def strays(self, accuracy: float) -> bool:
        """Test whether the flight ended because the model makes other motions, not because it is off by more."""
        return self.given_up and not abs(self.worst) > accuracy


UNKNOWN = ResponseError()


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Amplitudes in m of a model's motions at points of a sweep, by kind: (points, kinds), NaN where there is none.

    ``which``: the points' places in the sweep's frequencies, ``mu`` these in Hz; the first ``done`` of them were looked
    at, by so many evaluations × modes, the ``cost``.
    """

    which: Index
    mu: Array
    values: Array
    done: int
    cost: float = 0.0

    @property
    def points(self) -> Flags:
        """Mask of the points with a motion that is known."""
        return np.asarray(np.isfinite(self.values).any(axis=1))


def response_error(pairs: Sequence[tuple[Amplitudes, Amplitudes]]) -> ResponseError:
    """Error of a model's amplitudes, each beside those of all modes at the same points, kind by kind.

    The peak is the largest amplitude of any kind, over the points at which a motion of all modes is known.
    """
    if not pairs:
        return UNKNOWN
    mu = np.concatenate([np.repeat(full.mu[: len(full.values)], full.values.shape[1]) for _, full in pairs])
    ours = np.concatenate([np.where(full.points[:, None], found.values, nan).ravel() for found, full in pairs])
    whole = np.concatenate([full.values.ravel() for _, full in pairs])
    known = np.isfinite(whole) & (whole != 0)
    alike = np.flatnonzero(known & np.isfinite(ours))
    off = ours[alike] / whole[alike] - 1
    found = ResponseError.of(off, int(known.sum()))
    if not len(off):
        return found
    peak = float(np.nanmax(ours) / np.nanmax(whole)) - 1
    return replace(found, peak=peak, mu=float(mu[alike[np.argmax(np.abs(off))]]))


@dataclass(frozen=True)
class Losses:
    """Losses of a reduction to ``modes`` coordinates, each a share of the full model's value.

    - ``frequency``: largest relative error of a natural frequency in the band (1 where the mode is missing);
    - ``mac``: least modal assurance criterion of full against reduced modes in the band, 1: the same shapes;
    - ``static_stiffness``: excess of the contact's static stiffness, NaN of a free body;
    - ``mobility``: share of w M⁻¹ wᵀ that is lost; NaN of a contact without mass; ``first_mode_restitution``
      and ``contact_restitution``: the case holds one, the other follows (above 1: no contact can do that); NaN of
      another law;
    - ``restitution``: change of 1 − R₁, the share of its speed that mode 1 loses at an impact, relative to that of the
      full model; 0 where the case holds R₁, NaN as before;
    - ``contact``, ``sensor``: largest errors of the transfer functions from the drive;
    - ``impact``: of the contact's displacement in a half-sine pulse as long as the contact; where no contact time is
      known, ``mobility``, to which it goes as that time goes to 0;
    - ``loss``: the largest of frequency, static stiffness, restitution, contact, sensor, impact; ``decided_by``: which.

    ``response``: the error of the response itself. ``why``: why there is no such reduction, all else is then NaN.
    """

    basis: str
    modes: int
    loss: float = nan
    decided_by: str = ""
    frequency: float = nan
    mac: float = nan
    static_stiffness: float = nan
    mobility: float = nan
    first_mode_restitution: float = nan
    contact_restitution: float = nan
    restitution: float = nan
    contact: float = nan
    sensor: float = nan
    impact: float = nan
    why: str = ""
    response: ResponseError = UNKNOWN


@dataclass(frozen=True)
class Question:
    """Question to every reduction: a transfer study, the number of modes in the band, the contact."""

    transfer: TransferStudy
    in_band: int
    pulse: ContactPulse | None
    restitution: float
    of_first_mode: bool

    def losses(self, name: str, n: int, made: Reduction) -> Losses:
        """Losses of the reduction ``made``."""
        full, small = self.transfer.full, ModalForm.of(made.structure)
        off, mac = frequency_errors(full, small), assurance(full, made, small)
        band = np.append(off, np.ones(max(self.in_band - len(off), 0)))[: max(self.in_band, 1)]
        curves = self.transfer.errors_of(small)
        mobility = 1 - made.mobility_kept if np.isfinite(made.mobility_kept) else nan
        seen = self._restitutions(small)
        parts: dict[str, float] = {
            "frequency": float(band.max()),
            "static_stiffness": _stiffening(made),
            "restitution": self._change(seen),
            "contact": float(curves["contact"].max()),
            "sensor": float(curves["sensor"].max()),
            "impact": mobility if self.pulse is None else self._in_contact(self.pulse, small),
        }
        largest = max(parts, key=lambda part: abs(parts[part]) if np.isfinite(parts[part]) else -1.0)
        return Losses(
            basis=name,
            modes=n,
            loss=abs(parts[largest]),
            decided_by=largest,
            mac=float(mac[: max(min(self.in_band, len(mac)), 1)].min()),
            mobility=mobility,
            **{**parts, **seen},  # type: ignore[arg-type]
        )

    def _in_contact(self, pulse: ContactPulse, small: ModalForm) -> float:
        full = self.transfer.full
        exact = pulse.deflection(full.omega, full.row(full.structure.contact))
        own = small.row(small.structure.contact)
        return pulse.error(exact, pulse.deflection(small.omega, own, small.structure.contact_flexibility))

    def _change(self, seen: dict[str, float]) -> float:
        """Change of 1 − R₁ against the full model, where R is held."""
        full = self._restitutions(self.transfer.full)
        if not seen or not full:
            return nan
        exact, found = full["first_mode_restitution"], seen["first_mode_restitution"]
        return abs(found - exact) / max(1 - exact, np.finfo(float).eps)

    def _restitutions(self, small: ModalForm) -> dict[str, float]:
        if np.isnan(self.restitution) or small.structure.contact_flexibility:
            return {}
        c = small.row(small.structure.contact)
        first, mobility = float(c[0]), float(c @ c)
        if self.of_first_mode:
            held, of_contact = self.restitution, (1 + self.restitution) * mobility / first**2 - 1
            return {"first_mode_restitution": held, "contact_restitution": of_contact}
        seen = first_mode_restitution(self.restitution, first, mobility)
        return {"first_mode_restitution": seen, "contact_restitution": self.restitution}


def _stiffening(made: Reduction) -> float:
    """Excess of the contact's static stiffness; NaN of a free body, which has none."""
    try:
        return 1 / made.flexibility_kept - 1
    except ValueError:
        return nan


def frequency_errors(full: ModalForm, small: ModalForm) -> Array:
    """|ω_reduced/ω_full − 1| (n,) of mode after mode; of a rigid-body mode relative to the first elastic one."""
    exact = full.omega[: len(small.omega)]
    scale = np.where(exact > 1e-6 * full.omega[-1], exact, full.omega[full.omega > 1e-6 * full.omega[-1]][0])
    return np.asarray(np.abs(small.omega - exact) / scale)


def assurance(full: ModalForm, made: Reduction, small: ModalForm) -> Array:
    """MAC (n,) with the mass matrix of each reduced mode and the full one of its number: (φᵀMψ)² over both sizes."""
    shapes = made.basis @ small.shapes
    momenta = full.structure.M @ shapes
    along = np.sum(full.shapes[:, : shapes.shape[1]] * momenta, axis=0)
    return np.asarray(along**2 / np.sum(shapes * momenta, axis=0))
