"""Read-off quantities of motions with one impact a span, or none, and their exact derivatives by parameters.

``orbit_derivatives`` has the mathematics of motions, ``output_signals`` that of extremes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.periodic.orbit_derivatives import Struck, driven, offset_of, struck
from vibeam.periodic.output_signals import FilteredOutput, Gain, SampledOutput
from vibeam.periodic.tangents import ModalData, Tangents
from vibeam_models.arrays import Array

QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impact_velocity")


@dataclass(frozen=True)
class Value:
    """Quantity (points,) and its derivatives (P, points); ``beyond`` and its own: see ``Struck``."""

    value: Array
    by: Array
    beyond: Array
    by_beyond: Array


def of_orbits(
    data: ModalData, tangents: Tangents, omega: Array, periods: int, root: int, quantity: str, gain: Gain | None = None,
    samples: int = 0,
) -> Value:  # fmt: skip
    """Quantity of one root, at drives ``omega`` (points,) rad/s; NaN where it has no motion at any drive.

    ``samples``: extremes are the largest and least of so many values a period (of an unfiltered output); 0: exact.
    """
    found = struck(data, tangents, omega, np.full(len(omega), periods), root)
    if quantity == "impact_velocity":
        return Value(*_velocity(data, tangents, found), found.beyond, found.by_beyond)
    row, by_row = (data.contact, tangents.contact) if quantity == "reach" else (data.row, tangents.row)
    kind = SampledOutput if gain is None else FilteredOutput
    signal = kind(data, tangents, row, by_row, omega, periods, found, gain)
    if samples and gain is None:
        sampled, no = signal.samples(np.linspace(0.0, 1.0, samples * periods + 1)), np.zeros_like(found.by_impulse)
        ends: tuple[Both, Both] = (sampled.max(axis=1), no), (sampled.min(axis=1), no)
    else:
        high = signal.extreme(1.0) if quantity in ("amplitude", "maximum") else (0.0, 0.0)
        ends = high, signal.extreme(-1.0) if quantity != "maximum" else (0.0, 0.0)
    return Value(*_read(quantity, data, tangents, *ends), found.beyond, found.by_beyond)


def without_contact(
    data: ModalData, tangents: Tangents, omega: Array, quantity: str, gain: Gain | None = None
) -> Value:
    """Quantity of the motion without contact; ``beyond``: ln of how much it exceeds the gap, 0 where it does not."""
    contact = driven(data, tangents, data.contact, tangents.contact, omega)
    static, by_static = offset_of(data, tangents, data.contact, tangents.contact)
    clear, by_clear = data.gap - static, (tangents.gap - by_static)[:, None]
    size, by_size = np.abs(contact.value), (contact.value.conj() * contact.by).real / np.abs(contact.value)
    with np.errstate(invalid="ignore", divide="ignore"):
        over = np.where(clear > 0, np.log(size / clear), np.nan)
        beyond, by_beyond = np.maximum(over, 0.0), np.where(over > 0, by_size / size - by_clear / clear, 0.0)
    if quantity == "impact_velocity":
        return Value(np.zeros(len(omega)), np.zeros_like(by_size), beyond, by_beyond)
    row, by_row = (data.contact, tangents.contact) if quantity == "reach" else (data.row, tangents.row)
    rest, by_rest = offset_of(data, tangents, row, by_row)
    seen = driven(data, tangents, row, by_row, omega)
    passed = 1.0 if gain is None else np.abs(gain(omega / (2 * np.pi)))
    still = 1.0 if gain is None else float(np.abs(gain(np.zeros(1)))[0])
    wide = passed * np.abs(seen.value)
    by_wide = passed * (seen.value.conj() * seen.by).real / np.maximum(np.abs(seen.value), 1e-300)
    middle, by_middle = still * rest, still * by_rest[:, None]
    high, low = (middle + wide, by_middle + by_wide), (middle - wide, by_middle - by_wide)
    return Value(*_read(quantity, data, tangents, high, low), beyond, by_beyond)


Both = tuple[Array | float, Array | float]


def _read(quantity: str, data: ModalData, tangents: Tangents, high: Both, low: Both) -> tuple[Array, Array]:
    if quantity == "amplitude":
        return np.asarray((high[0] - low[0]) / 2), np.asarray((high[1] - low[1]) / 2)
    if quantity == "reach":
        return np.asarray(data.gap - low[0]), np.asarray(tangents.gap[:, None] - low[1])
    return (np.asarray(high[0]), np.asarray(high[1])) if quantity == "maximum" else (
        np.asarray(low[0]), np.asarray(low[1])
    )  # fmt: skip


def _velocity(data: ModalData, tangents: Tangents, found: Struck) -> tuple[Array, Array]:
    """v = −p S/(1 + R)."""
    mobility, lost = float(data.contact @ data.contact), 1 + data.restitution
    by_share = 2 * (tangents.contact @ data.contact) / lost - mobility * tangents.restitution / lost**2
    return -found.impulse * mobility / lost, -found.by_impulse * mobility / lost - found.impulse * by_share[:, None]
