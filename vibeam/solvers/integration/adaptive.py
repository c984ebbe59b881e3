"""Base class of the solvers by scipy: their options, and the tolerances that follow from these."""

from __future__ import annotations

from abc import abstractmethod

from vibeam.solvers.integration.coordinates import EXPLICIT, Settings, chosen
from vibeam.solvers.integration.stepper import Stepper
from vibeam.system.impact_system import ImpactSystem


class AdaptiveStepper(Stepper):
    """Base class of the solvers by scipy, whose steps follow tolerances."""

    METHODS: tuple[str, ...] = EXPLICIT
    LIMIT = 1000  #: of events or evaluations in a drive period
    REPEATS = 10  #: tolerance between states a period apart, in units of rtol

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float,
        span: float = 0.0,
        *,
        method: str = "RK23",
        rtol: float = 1e-4,
        atol: float = 1e-8,
        limit: int | None = None,
        repeats: float | None = None,
    ) -> None:
        """``slowest`` and ``span`` are ignored.

        ``method``: scipy's name, one of ``METHODS``; "RK23" is the paper's (Matlab's ode23). ``rtol``: a step's; no
        step is longer than an eighth of the drive period.
        ``atol``: of the contact displacement, m; a mode's own is atol/√(Σ contact²), its velocity's ω times that. The
        default is the paper's for displacements near 10⁻²: keep it near 10⁻⁶ of the amplitude. Flights that rise less
        than it count as rest on the stop. ``limit``: events a drive period, None: ``LIMIT``. ``repeats``: how far
        states a period apart may differ, as a share of the motion's size; None: ``REPEATS`` rtol, at least 1e-5
        (settled runs repeat to about rtol). ValueError for others.
        """
        self.takes(system)
        limit = self.LIMIT if limit is None else limit
        self.system, self.settings = system, Settings(chosen(method, self.METHODS), rtol, atol, limit)
        self.repeats = max(1e-5, self.REPEATS * rtol) if repeats is None else repeats

    @abstractmethod
    def takes(self, system: ImpactSystem) -> None:
        """Raise ValueError for a system that this solver cannot take."""
