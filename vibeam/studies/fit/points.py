"""Measured points of a fit: of which reference, with which uncertainty, on what kind of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.curves.reference import read_curve
from vibeam.exchange.faults import CaseError
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import Reference
    from vibeam.observe.measuring_chain import Chain


MORE_THAN_ONE = 1.01  # impacts until the motion repeats
Gain = Callable[[Array], NDArray[np.complex128]]


@dataclass(frozen=True)
class Points:
    """Points of one reference and period: ``frequency`` Hz, ``value`` and standard ``uncertainty`` in SI, (points,).

    ``several``: their motions are known to have several impacts until they repeat. ``gain``: of the filter that they
    were measured behind. ``unstable``: unstable motions may be among them.
    """

    reference: str
    fidelity: str
    quantity: str
    periods: int
    several: bool
    frequency: Array
    value: Array
    uncertainty: Array
    unstable: bool = False
    gain: Gain | None = None

    @property
    def omega(self) -> Array:
        """Drive frequencies, rad/s."""
        return 2 * np.pi * self.frequency

    def __len__(self) -> int:
        return len(self.frequency)

    def some(self, which: NDArray[np.int64]) -> Points:
        """Points at the indices ``which``."""
        return replace(
            self, frequency=self.frequency[which], value=self.value[which], uncertainty=self.uncertainty[which]
        )

    def at(self, frequency: Array) -> Points:
        """Points of the same kind at ``frequency`` (points,) Hz, with nothing measured."""
        return replace(self, frequency=frequency, value=np.ones_like(frequency), uncertainty=np.ones_like(frequency))


def points_of(case: Case) -> tuple[list[Points], list[str]]:
    """Points of the references that a case is fitted to, and notes on those left out; ValueError for unusable ones."""
    if case.fit is None:
        raise ValueError(
            'there is no [fit] in this case: say keys = { "stop.restitution" = [0.5, 0.9], … } and references; '
            "keys from measured modal frequencies: --key beam.thickness"
        )
    if not case.fit.references:
        raise ValueError("there is no [reference.NAME] to fit to")
    found, notes = [], []
    for name in case.fit.references:
        made, left = _of_reference(case, name)
        found += made
        notes += left
    if not sum(len(each) for each in found):
        raise ValueError("the references have no points that could be fitted")
    return found, notes


def _of_reference(case: Case, name: str) -> tuple[list[Points], list[str]]:
    reference = case.references[name]
    curve = reference.read()
    if curve.recorded:
        raise ValueError(f"reference.{name}: it was recorded from a model of ours, which is no measurement")
    points = [each for each in curve.points if each.value is not None]
    kept = [each for each in points if each.period is None or each.period > 0]
    without = [each for each in kept if not each.uncertainty]
    if without:
        raise ValueError(
            f"reference.{name}: line {without[0].line} has no uncertainty, by which its point is weighted: write "
            f'uncertainty = "1 %", or what it is, into [reference.{name}], or give the file such a column'
        )
    lost = len(points) - len(kept)
    notes = [f"{name}: {lost} points without a period are left out"] if lost else []
    several = _several_impacts(reference)
    gain = _gain(case.chain_of(reference.fidelity))
    made = []
    kinds = {each.line: (each.period or 1, each.line in several) for each in kept}
    for kind in sorted(set(kinds.values())):
        own = [each for each in kept if kinds[each.line] == kind]
        frequency, value, spread = (
            np.array([getattr(each, part) for each in own], dtype=float)
            for part in ("frequency", "value", "uncertainty")
        )
        unstable = case.fit is not None and name in case.fit.unstable
        made.append(
            Points(name, reference.fidelity, reference.quantity, *kind, frequency, value, spread, unstable, gain)
        )
    return made, notes


def _several_impacts(reference: Reference) -> set[int]:
    """Lines of a file of our own form whose motions have more than one impact until they repeat."""
    if reference.curve is not None or not reference.form.own:
        return set()
    try:
        counts = read_curve(reference.file, "impacts_per_period", quote=reference.quote).points
    except CaseError:  # no such column
        return set()
    return {each.line for each in counts if each.value and each.period and each.value * each.period > MORE_THAN_ONE}


def _gain(chain: Chain | None) -> Gain | None:
    if chain is None:
        return None
    if chain.noise is not None or chain.quantum is not None:
        raise ValueError(
            "measurement: noise and quantisation shift extremes, which a fit does not know: leave them away; the "
            "uncertainty of the references stands for them"
        )
    return None if chain.low_pass is None else chain.low_pass.response
