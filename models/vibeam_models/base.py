"""Base: the drive of a rig, by its base or on the beam, as frozen data in SI units, and its size at a frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array

Level = float | tuple[float, ...]  # one amplitude, or one for each frequency of a table

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

    amplitude: Level | None = None
    voltage: Level | None = None
    gain: float | None = None
    force: Level | None = None
    velocity: Level | None = None
    acceleration: Level | None = None
    moment: Level | None = None
    at: float | None = None
    frequency: tuple[float, ...] | None = None
    harmonic: tuple[int, ...] | None = None
    harmonic_share: tuple[float, ...] | None = None
    harmonic_phase: tuple[float, ...] | None = None

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
