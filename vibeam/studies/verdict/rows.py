"""Rows of the verdict: how far each model is off, what it costs, where it is wrong, what it is good for."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.verdict.judgement import SAME, difference, within
from vibeam.studies.verdict.motions import CHAOTIC, FAILED, IRREGULAR, NO_CONTACT, Motions
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.studies.verdict.axes import VerdictAxis


EVERYWHERE = 0.99  # share of the map that counts as all of it
WORTH = 1.5  # gain as a control variate from which it pays

KINDS = {
    NO_CONTACT: "no contact", IRREGULAR: "long or quasiperiodic", CHAOTIC: "chaos", FAILED: "failed",
}  # fmt: skip


@dataclass(frozen=True)
class FidelityRow:
    """One model beside the finest one. Shares and relative differences as plain numbers.

    ``cost_ratio``: how many times cheaper a point is than of the finest (CPU time here); ``within``: share of the map
    where it suffices; ``bias``, ``rms``: mean and root mean square of the relative difference where both are of one
    kind; ``correlation`` over the whole map; ``gain``: factor by which it lowers the variance of a mean over the map at
    equal cost, as a control variate; ``other_kind``: share of the map where it differs in kind, ``kinds``: of what the
    finest has there; ``wrong_frequency`` (Hz) and ``wrong_key`` (SI): the ranges where it does not suffice.
    """

    fidelity: str
    modes: int
    cpu: float
    cost_ratio: float
    within: float
    bias: float
    rms: float
    correlation: float
    gain: float
    other_kind: float
    kinds: str
    wrong_frequency: tuple[float, float] | None
    wrong_key: tuple[float, float] | None
    use_it_for: str


def fidelity_row(model: Motions, finest: Motions, frequency: Array, axis: VerdictAxis, accuracy: float) -> FidelityRow:
    """The row of one model."""
    apart, near = difference(model, finest), within(model, finest, accuracy)
    alike = (model.kind == finest.kind) & (model.kind != FAILED) & (finest.value != 0)
    shares = model.value[alike] / finest.value[alike] - 1
    bias = float(shares.mean()) if shares.size else float("nan")
    rms = float(np.sqrt(np.mean(shares**2))) if shares.size else float("nan")
    ratio, rho = finest.cpu / model.cpu, correlation(model.value, finest.value)
    gain = control_variate_gain(rho, ratio)
    wrong = ~near
    share, other = float(near.mean()), float((apart != SAME).mean())
    return FidelityRow(
        model.name, model.modes, model.cpu, ratio, share, bias, rms, rho, gain, other,
        _kinds(finest, apart != SAME), *_ranges(wrong, frequency, axis), _use(model is finest, share, other, rms, gain),
    )  # fmt: skip


def correlation(one: Array, other: Array) -> float:
    """Pearson's correlation over the places where both are known; NaN where one does not vary."""
    known = np.isfinite(one) & np.isfinite(other)
    if known.sum() < 2 or np.ptp(one[known]) == 0 or np.ptp(other[known]) == 0:
        return float("nan")
    return float(np.corrcoef(one[known], other[known])[0, 1])


def control_variate_gain(rho: float, ratio: float) -> float:
    """Variance of plain Monte Carlo over that with this control variate, at the same cost; 1 where it does not pay.

    Two models of correlation ρ, the cheap one ``ratio`` times cheaper: at the best share of runs of either,
    1/gain = (√(1 − ρ²) + √(ρ²/ratio))² (Ng & Willcox 2014; Peherstorfer, Willcox & Gunzburger 2016, §3.4).
    """
    if not np.isfinite(rho) or not rho * rho * (1 + ratio) > 1:  # fewer than one cheap run an expensive one
        return 1.0
    return max(1.0, 1 / (sqrt(max(1 - rho * rho, 0.0)) + sqrt(rho * rho / ratio)) ** 2)


def kind_name(kind: int) -> str:
    """A kind of motion in words."""
    return KINDS.get(kind, f"period {kind}")


def _kinds(finest: Motions, places: NDArray[np.bool_]) -> str:
    """The commonest kinds of the finest model at some places, with their shares."""
    found = finest.kind[:, places].ravel()
    if not found.size:
        return ""
    kinds, counts = np.unique(found, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:2]
    return ", ".join(f"{kind_name(int(kinds[i]))} ({counts[i] / found.size:.0%})" for i in order)


def _ranges(
    wrong: NDArray[np.bool_], frequency: Array, axis: VerdictAxis
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    if not wrong.any():
        return None, None
    columns, rows = frequency[wrong.any(axis=0)], axis.values[wrong.any(axis=1)]
    return (float(columns.min()), float(columns.max())), (float(rows.min()), float(rows.max()))


def _use(finest: bool, share: float, other: float, rms: float, gain: float) -> str:
    """What a model is good for, in a few words."""
    if finest:
        return "the reference"
    if share >= EVERYWHERE:
        return "everything here"
    parts = []
    if share >= 0.5:
        parts.append("its own regions of the map")
    if other <= 1 - EVERYWHERE:
        parts.append(f"which motion there is; sizes to {rms:.1%} (rms)")
    elif other < 0.5 and np.isfinite(rms):
        parts.append(f"sizes to {rms:.1%} (rms) where the motion is the same")
    if gain >= WORTH:
        parts.append(f"a control variate: {gain:.1f} times less variance")
    return "; ".join(parts) or "nothing here"
