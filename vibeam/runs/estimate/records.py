"""Records of error estimates: of one branch, of one fidelity, and what each is of. They compute nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array


class Basis(Enum):
    """The value says in words what an estimate is of, or why there is none; the order is the code in arrays."""

    ORBIT = "along the exact orbit"
    NO_ORBIT = "the full model has no such motion near: too close to a fold, or beyond it"
    STRIKES = "the full model strikes the stop in between"
    UNSTABLE = "the full model's motion is unstable there"
    TOUCHES = "the full model touches the stop, this one does not"
    APERIODIC = "the motion does not repeat, and of its means nothing can be claimed without flying the full model"
    RESTS = "the motion rests on the stop"
    SEVERAL = "too many impacts before the motion repeats"
    UNSETTLED = "no exact orbit agrees with the point"
    FAILED = "the point failed"
    RESONANT = "an undamped mode is driven at a resonance"
    FREE = "clear of the stop, as the full model"
    ANOTHER = "the full model makes another motion"

    @property
    def code(self) -> int:
        """Number in arrays and files."""
        return _CODES[self]

    @classmethod
    def of_code(cls, code: int) -> Basis:
        """Member with a given number."""
        return list(cls)[code]


KNOWN = (Basis.ORBIT, Basis.FREE)  # those with an estimate
WITHOUT_IMPACTS = (Basis.FREE, Basis.FAILED)  # neither model is known to touch the stop
_CODES = {member: code for code, member in enumerate(Basis)}


QUANTITIES = ("amplitude", "reach", "impact_velocity")


@dataclass(frozen=True, eq=False)
class ErrorEstimate:
    """Estimated error of a response against a fuller model, (points,) in the order swept; shares of its value there.

    ``amplitude``, ``reach``, ``impact_velocity``: this model's over the fuller one's, less 1; the same with ``_bound``:
    the estimate of the error's size, which has the uncertainty of the estimate on top. NaN where ``basis``, the code of
    a ``Basis``, is another than ORBIT or FREE, and velocities also without impacts. ``correction``: size of the first
    Newton correction of the impacts, rad and share of the impulse: it grows without bound toward a fold.
    """

    frequency: Array
    amplitude: Array
    reach: Array
    impact_velocity: Array
    amplitude_bound: Array
    reach_bound: Array
    impact_velocity_bound: Array
    correction: Array
    basis: NDArray[np.int64]

    @property
    def known(self) -> NDArray[np.bool_]:
        """Points (points,) with an estimate."""
        return np.isin(self.basis, [each.code for each in KNOWN])

    @property
    def impacting(self) -> NDArray[np.bool_]:
        """Points (points,) at which this model or the full one touches the stop."""
        return ~np.isin(self.basis, [each.code for each in WITHOUT_IMPACTS])

    @property
    def reasons(self) -> dict[Basis, int]:
        """Number of impacting points without an estimate, by the reason."""
        codes, counts = np.unique(self.basis[self.impacting & ~self.known], return_counts=True)
        return {Basis.of_code(int(code)): int(count) for code, count in zip(codes, counts, strict=True)}


@dataclass(frozen=True, eq=False)
class FidelityEstimate:
    """Estimates of one fidelity, by direction; ``why``: there is none at all.

    Against a full model of ``modes`` modes; ``whole``: it is that model itself.
    """

    modes: int
    branches: Mapping[str, ErrorEstimate]
    why: str = ""
    whole: bool = False
    cpu_seconds: float = 0.0
