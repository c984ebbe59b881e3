"""Base: the drive of a rig, by its base or on the beam, as frozen data in SI units, and its size at a frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.keys import count, quantity

#: what a drive may be said by, without voltage, and the power of Ω by which B is less
POWERS = {"amplitude": 0, "velocity": 1, "acceleration": 2, "force": 2, "moment": 2}
NEAR = 1e-9  # share of a table's ends by which a frequency may lie outside and still be that end, rounded


@dataclass(frozen=True)
class Base:
    """The drive, harmonic: a motion of the base, or a force on a beam whose base is at rest.

    A base motion b(t) = B sin Ωt has the ``amplitude`` B (m), the ``velocity`` ΩB (m/s) or the ``acceleration`` Ω²B
    (m/s²), the same at every frequency, or is ``voltage`` (V) times ``gain`` γ (1/V, eq. 46 of the paper:
    B = γ V φ(L_m) L, with φ of the massless beam). On a platform it may be the ``force`` (N) on that instead, or the
    ``voltage`` alone of its shaker.

    With ``at`` (m), ``force`` (N) pushes the beam there toward the stop, or a ``moment`` (N m) turns it there.

    ``frequency`` (Hz, ascending): a table over frequency; what is a tuple then has one value for each, linear between.

    ``harmonic``: orders of further harmonics, each with its ``harmonic_share`` of the first's Ω²B (a force's,
    a moment's) and its ``harmonic_phase`` (rad; None: 0).
    """

    voltage: float | tuple[float, ...] | None = quantity(
        "V", "amplitude of the shaker's voltage", "0.6 V", None, least=0
    )
    gain: float | None = quantity(
        "1/V", "γ of eq. 46: base amplitude over mode shape at the mass, length and voltage", "5.16e-4 1/V", None,
        above=0,
    )  # fmt: skip
    amplitude: float | tuple[float, ...] | None = quantity(
        "m", "amplitude of the base's displacement", "0.05 mm", None, least=0,
        plain=("of the base B, in the unit of the motion", 0.5e-3, ""),
    )  # fmt: skip
    velocity: float | tuple[float, ...] | None = quantity(
        "m/s", "amplitude of the base's velocity, in place of amplitude", "5 mm/s", None, least=0,
        plain=("ΩB, instead: the same at every Ω", 1e-3, ""),
    )  # fmt: skip
    acceleration: float | tuple[float, ...] | None = quantity(
        "m/s^2", "amplitude of the base's acceleration, in place of amplitude; of a shape its peak: positive, the base "
        "leaves the beam behind, away from the stop; g is 9.80665 m/s^2",
        "0.05 g", None, least=0,
        plain=("Ω²B, instead: a force over the mass that is the same at every Ω", 2e-3, ""),
    )  # fmt: skip
    force: float | tuple[float, ...] | None = quantity(
        "N",
        "of a force on the beam at drive.at, or on the platform, in place of a moving base; of a shape its peak, "
        "positive toward the stop",
        "5 N",
        None,
        least=0,
    )
    moment: float | tuple[float, ...] | None = quantity(
        "N m",
        "of a moment on the beam at drive.at, in place of a moving base; of a shape its peak",
        "0.1 N m",
        None,
        least=0,
    )
    at: float | None = quantity(
        "m", "where the force or the moment acts on the beam, whose base is then at rest; from x = 0, in (0, length]",
        "120 mm", None, above=0,
    )  # fmt: skip
    frequency: tuple[float, ...] | None = quantity(
        "Hz", "of a drive that is a list: one frequency for each of its numbers, linear between, none outside; of a "
        "shape its own, of a chirp the first and the last",
        ["14 Hz", "17 Hz"], None, above=0, several=True, ascending=True, plain=("", ["1.5 rad/s", "2.5 rad/s"], ""),
    )  # fmt: skip
    harmonic: tuple[int, ...] | None = count(
        2, 1000, "orders of further harmonics, whole multiples of the drive's frequency; absent = none", [2, 3], None,
        several=True,
    )  # fmt: skip
    harmonic_share: tuple[float, ...] | None = quantity(
        "", "their amplitudes as shares of the first's acceleration, whatever key says that; of a force or a moment, "
        "of it", ["5 %", "2 %"], None, least=0, several=True, plain=("", ["5 %", "2 %"], ""),
    )  # fmt: skip
    harmonic_phase: tuple[float, ...] | None = quantity(
        "rad", "their phases at the first's zero: sin Ωt + share · sin(order · Ωt + phase); absent = 0",
        ["30 deg", "0 deg"], None, several=True,
    )  # fmt: skip

    @property
    def harmonics(self) -> tuple[tuple[int, float, float], ...]:
        """Order, share and phase of every further harmonic; empty where there is none. ValueError for other lengths."""
        orders = self.harmonic or ()
        phases = self.harmonic_phase or (0.0,) * len(orders)
        return tuple(zip(orders, self.harmonic_share or (), phases, strict=True))

    @property
    def on_beam(self) -> tuple[float, int] | None:
        """Place on the beam (m) that is driven by a force (0) or a moment (1, on the slope); None: its base is."""
        return None if self.at is None else (self.at, int(self.moment is not None))

    @property
    def place(self) -> Base:
        """The same without its size: all of it that a structure depends on."""
        if self.at is None:
            return Base()
        return Base(at=self.at, force=0.0) if self.moment is None else Base(at=self.at, moment=0.0)


#: a force on a platform, whose size is a record's
ON_PLATFORM = Base(force=0.0)


def level(base: Base, name: str, omega: Array) -> float | Array | None:
    """The amplitude ``name`` of a drive at ``omega`` (rad/s): as given, or of its table one each, linear between.

    ValueError for a frequency outside the table.
    """
    given = getattr(base, name)
    if not isinstance(given, tuple):
        return None if given is None else float(given)
    table, frequency = np.array(base.frequency or ()), np.asarray(omega, dtype=float) / (2 * np.pi)
    if table.shape != (len(given),):
        raise ValueError(f"drive: {len(given)} values of {name} for {len(table)} frequencies")
    for outside in frequency[(frequency < table[0] * (1 - NEAR)) | (frequency > table[-1] * (1 + NEAR))]:
        raise ValueError(
            f"drive: {outside:.6g} Hz is outside its table of {table[0]:g} … {table[-1]:g} Hz: lengthen the table"
        )
    return np.interp(frequency, table, given)


def is_constant(base: Base) -> bool:
    """Test whether B is the same at every frequency, platforms aside: a displacement, or a voltage and a gain."""
    return base.frequency is None and not any(
        getattr(base, name) is not None for name, power in POWERS.items() if power
    )
