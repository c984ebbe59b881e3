"""Errors and uncertainties of each fidelity's peak side by side, after ASME V&V 20.

Comparison error E = S − D of simulation S and measurement D; u_val² = u_num² + u_input² + u_D² of numerical, input and
data uncertainty. |E| well above u_val is error of the model's form; below it nothing is told apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, nan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.studies.uncertainty.statistics import Spread


@dataclass(frozen=True)
class ErrorRow:
    """Peak of one fidelity, all in its unit; NaN where not known.

    ``numerical``: distance of the fidelity from its own limit; ``given``: standard deviation by the inputs;
    ``measured`` value and its ``scatter``, ``chose``: keys of the fidelity that it chose, so that it validates nothing;
    ``form``: difference to the finest, which is error of the reduction.
    """

    fidelity: str
    peak: float
    numerical: float
    given: float
    measured: float
    scatter: float
    form: float
    chose: tuple[str, ...] = ()

    @property
    def comparison(self) -> float:
        """E = S − D."""
        return self.peak - self.measured

    @property
    def validation(self) -> float:
        """u_val of what is known of it; NaN without a measurement."""
        known = [each for each in (self.numerical, self.given, self.scatter) if each == each]
        return hypot(*known) if self.measured == self.measured else nan


def error_rows(result: Result, peaks: Mapping[str, Spread]) -> tuple[ErrorRow, ...]:
    """A row for each fidelity; ``result``: of the case's own values, with its comparisons."""
    limits = {each.finest: each.limit.held.peak for each in result.comparisons if not each.limit.why}
    finest = list(peaks)[-1]
    rows = []
    for name, spread in peaks.items():
        measured = next(
            (each for each in result.case.measured.values() if each.fidelity == name and each.quantity == "peak"), None
        )
        rows.append(
            ErrorRow(
                name,
                spread.nominal,
                abs(limits[name]) * spread.nominal if name in limits else nan,
                spread.deviation,
                nan if measured is None else measured.value,
                nan if measured is None or measured.scatter is None else measured.scatter,
                nan if name == finest else spread.nominal - peaks[finest].nominal,
                () if measured is None else measured.chose,
            )
        )
    return tuple(rows)
