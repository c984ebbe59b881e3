"""Picture of the modes of a frequency response: the response, and the modes of fits with more and more of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.studies.fit.linear_estimates import Identification

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def modes_figure(found: Identification) -> Figure:
    """Moduli, measured and fitted, and a cross at each mode of fits with 1, 2, … modes: one that stays is one."""
    from matplotlib.figure import Figure

    figure = Figure((4.3, 3.4), layout="constrained")
    axes, (frequency, measured, fitted) = figure.add_subplot(), found.fit or [np.empty(0)] * 3
    axes.semilogy(frequency, measured.T, ".", color="0.6", markersize=2)
    axes.semilogy(frequency, fitted.T, linewidth=1)
    axes.set_xlabel("frequency in Hz")
    axes.set_ylabel(f"modulus of the {found.of or 'response'}, measured and fitted")
    orders = axes.twinx()
    orders.plot(*np.transpose([(mode[0], n) for n, modes in enumerate(found.orders, 1) for mode in modes]), "k+")
    orders.set_yticks(range(len(found.orders) + 2))
    orders.set_ylabel("modes in the fit (+)")
    return figure
