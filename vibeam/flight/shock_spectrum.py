"""Shock response spectra of records and of motions, and of devices with stops under a record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from vibeam.flight.extremes import extremes
from vibeam.flight.trajectory import Trajectory, simulate
from vibeam.observe.shock_spectrum import ShockSpectrum, checked, spectrum_of_pieces, spectrum_of_record
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.record import Record
from vibeam.system.response import Ended
from vibeam.system.rows import TimeDerivative
from vibeam_models.arguments import refuse, require, shown
from vibeam_models.arrays import Array

AFTER = 2.0  # periods of its lowest mode that a device is followed after the shock
FAR = 1e6  # gap of a stop that is taken away, in the largest displacements of the base and at rest


def shock_spectrum(
    shock: Record | Trajectory,
    frequencies: ArrayLike,
    damping: float | None = None,
    *,
    output: str = "sensor",
    device: ImpactSystem | None = None,
) -> ShockSpectrum:
    """Shock response spectrum: oscillators of natural ``frequencies`` (F,), Hz, and one ``damping`` ratio, from rest.

    Their base moves with a ``shock``: a record of acceleration, or a motion, where they are equipment, too light to
    act back, mounted at its ``output`` (a displacement relative to the base, which moves too, or an acceleration); a
    motion goes on, so that its spectrum has no residual part. Responses are exact for a record's polynomials, extremes
    between its samples too. Damping 0.05, which absent stands for, is a quality factor of 10, as in ISO 18431-4.

    ``device``: in place of oscillators, a system with its stops under a record, all its natural frequencies multiplied
    so that the lowest is each of ``frequencies``; damping ratios, shapes and gaps stay. Its spectrum is of its
    ``output``, a displacement, and has the impacts, which one of an oscillator without stop cannot tell. After the
    shock it is followed for two periods of the lowest mode, in which a single mode without load has its extremes.

    ValueError for a record of another quantity, frequencies that are not above 0, a damping ratio outside [0, 1), a
    device beside a motion or a damping ratio, or with a mode of frequency 0; KeyError for an unknown output.

    >>> import vibeam
    >>> step = vibeam.Record.step(10.0, 0.2)
    >>> vibeam.shock_spectrum(step, [20.0, 50.0], 0.0).of("acceleration").round(9).tolist()  # twice the step
    [20.0, 20.0]
    >>> relay = vibeam.ImpactSystem.from_modes(1.0, 0.0, -1.0, 1.0, gap=1e-3, restitution=0.5, outputs={"tip": [1.0]})
    >>> held = vibeam.shock_spectrum(step, [10.0, 50.0], device=relay, output="tip")
    >>> held.of("displacement").round(9).tolist(), (held.impacts > 0).tolist()
    ([0.001, 0.000202642], [True, False])
    """
    faults: list[str] = []
    rates, ratio = checked(frequencies, 0.05 if damping is None else damping, faults)
    if isinstance(shock, Record):
        if shock.quantity != "acceleration":
            faults.append(f"shock: a record of the base's acceleration is needed, this one is a {shock.quantity}")
    else:
        if not isinstance(shock, Trajectory):
            raise ValueError(f"shock: must be a Record or a Trajectory, not {shown(shock)}")
        if device is not None:
            faults.append("device: goes with a record, not with a motion")
    faults += [] if device is None else _device_faults(device, damping)
    refuse("shock_spectrum", faults)
    if not isinstance(shock, Record):
        from vibeam.flight.carried_base import pieces_at

        return spectrum_of_pieces(pieces_at(shock, output), rates, ratio, parts=1)
    if device is None:
        return spectrum_of_record(shock, rates, ratio)
    return _of_device(device, shock, rates, output)


def without_stops(system: ImpactSystem, record: Record) -> ImpactSystem:
    """The system, its stops out of reach of whatever a record does."""
    place = np.abs(system.contact) @ np.abs(system.static / np.maximum(system.omega, 1e-300) ** 2)
    thrown = float(np.abs(system.contact) @ np.abs(system.load)) * record.peak * record.duration * (1 + record.duration)
    return replace(system, gap=FAR * float(place + thrown + 1e-9), law=None, second_gap=None, further=None)


def _device_faults(device: ImpactSystem, damping: float | None) -> list[str]:
    require("device", device, ImpactSystem)
    faults = [] if damping is None else ["damping: goes without a device, which has its own"]
    if not np.min(device.omega) > 0:
        faults.append("device: a mode of frequency 0 has no frequency to be multiplied")
    return faults


def _of_device(device: ImpactSystem, record: Record, rates: Array, output: str) -> ShockSpectrum:
    row, lowest = device.output(output), float(np.min(device.omega))
    wanted = {"absolute": TimeDerivative(row, 2, base=1.0)}
    read = replace(device, outputs={**device.outputs, "relative": row}, derivatives=wanted)
    points = [_point(_scaled(read, 2 * np.pi * rate / lowest), record) for rate in rates.tolist()]
    sizes, impacts, hardest = (np.array(each) for each in zip(*points, strict=True))
    acceleration, displacement = np.moveaxis(sizes, (2, 0), (0, 3))
    first = float(device.zeta[int(np.argmin(device.omega))])
    return ShockSpectrum(rates, first, acceleration, displacement, impacts, hardest)


def _scaled(system: ImpactSystem, factor: float) -> ImpactSystem:
    """The system with all natural frequencies multiplied, damping ratios kept."""
    coupling = None if system.coupling is None else factor * system.coupling
    return replace(system, omega=factor * system.omega, coupling=coupling)


def _point(system: ImpactSystem, record: Record) -> tuple[Array, int, float]:
    """Extremes (2 parts, 2 outputs, 2 sides) of one device, its impacts, the velocity of the hardest."""
    lowest = float(np.min(system.omega))
    end = record.end + AFTER * 2 * np.pi / lowest
    path = simulate(system, record, end, t_start=record.start)
    if path.ended is not Ended.COMPLETE:
        at = f"lowest mode at {lowest / (2 * np.pi):g} Hz"
        raise ValueError(f"shock_spectrum: the device, {at}, ended at {path.t_end:g} s: {path.ended.value}")
    found = extremes(path, ("absolute", "relative"), [record.start, record.end, end])
    sizes = np.stack([found.least, found.greatest], axis=-1)  # (outputs, parts, sides)
    hardest = float(np.abs(path.impact_velocities).max(initial=0.0))
    return sizes.transpose(1, 0, 2), len(path.impact_times), hardest
