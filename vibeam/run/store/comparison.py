"""Comparisons of fidelities in the file: what is held, the differences with both choices, the finest one's limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import h5py

    from vibeam.run.comparison.held_comparison import HeldComparison


COMPARISON = "comparison"  # group of the file, one group in it for each fidelity

Attributes = Mapping[str, Mapping[str, str | float]]


def comparison_attributes(found: Sequence[HeldComparison]) -> Attributes:
    """Attributes of each fidelity's group: shares of the amplitude, NaN left out; texts where something is named."""
    groups: dict[str, dict[str, str | float]] = {}
    for each in found:
        other = "" if each.other is None else each.other.label
        groups[each.finest] = _known(
            held=each.held.label, other_choice=other, limit_peak=each.limit.held.peak, limit_rms=each.limit.held.rms,
            limit_peak_other_choice=each.limit.other.peak, limit_unknown=each.limit.why,
        )  # fmt: skip
        for row in each.rows:
            groups[row.fidelity] = _known(
                held=each.held.label, other_choice=other, finest=each.finest, peak=row.held.peak,
                peak_other_choice=row.other.peak, verdict_turns="yes" if row.turns else "no", unknown=row.why,
            )  # fmt: skip
    return groups


def _known(**values: str | float) -> dict[str, str | float]:
    return {name: value for name, value in values.items() if value == value and value != ""}  # NaN is not itself


def write_comparisons(file: h5py.File, groups: Attributes) -> None:
    """Replace the group of comparisons."""
    if COMPARISON in file:
        del file[COMPARISON]
    for name, attributes in groups.items():
        file.create_group(f"{COMPARISON}/{name}").attrs.update(attributes)


def read_comparisons(file: h5py.File) -> Attributes:
    """Read the attributes of every fidelity; empty without comparisons."""
    if COMPARISON not in file:
        return {}
    return {name: dict(group.attrs) for name, group in file[COMPARISON].items()}
