"""Shock response spectra of records and of motions."""

from __future__ import annotations

from numpy.typing import ArrayLike

from vibeam.flight.trajectory import Trajectory
from vibeam.observe.shock_spectrum import ShockSpectrum, checked, spectrum_of_pieces, spectrum_of_record
from vibeam.system.record import Record
from vibeam_models.arguments import refuse, require


def shock_spectrum(
    shock: Record | Trajectory,
    frequencies: ArrayLike,
    damping: float = 0.05,
    *,
    output: str = "sensor",
) -> ShockSpectrum:
    """Shock response spectrum: oscillators of natural ``frequencies`` (F,), Hz, and one ``damping`` ratio, from rest.

    Their base moves with a ``shock``: a record of acceleration, or a motion, where they are equipment, too light to
    act back, mounted at its ``output`` (a displacement relative to the base, which moves too, or an acceleration); a
    motion goes on, so that its spectrum has no residual part. Responses are exact for a record's polynomials, extremes
    between its samples too. Damping 0.05 is a quality factor of 10, as in ISO 18431-4.

    ValueError for a record of another quantity, frequencies that are not above 0, a damping ratio outside [0, 1);
    KeyError for an unknown output.

    >>> import vibeam
    >>> step = vibeam.Record.step(10.0, 0.2)
    >>> found = vibeam.shock_spectrum(step, [20.0, 50.0], 0.0)
    >>> found.of("acceleration").round(9).tolist()  # twice the step
    [20.0, 20.0]
    """
    faults: list[str] = []
    rates, ratio = checked(frequencies, damping, faults)
    if not isinstance(shock, Record):
        require("shock", shock, Trajectory)
    elif shock.quantity != "acceleration":
        faults.append(f"shock: a record of the base's acceleration is needed, this one is a {shock.quantity}")
    refuse("shock_spectrum", faults)
    if not isinstance(shock, Record):
        from vibeam.flight.carried_base import pieces_at

        return spectrum_of_pieces(pieces_at(shock, output), rates, ratio, parts=1)
    return spectrum_of_record(shock, rates, ratio)
