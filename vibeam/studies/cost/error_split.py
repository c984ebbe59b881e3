"""Split of the error: a chain of models from one fidelity to the finest, one change at each link.

The difference of the ends is the sum of the links' differences, point by point and so in the mean:

    a − a_finest = Σ (a_i − a_{i+1}).

The links are: the contact law (R does not carry over between models: the fidelity takes the R that gives its first
mode the R₁ of the finest), the reduction (the finest's, with that same R₁), the effects left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from vibeam.runs.models import Model, equal, first_mode_restitution_of, with_first_mode_restitution
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, periodic
from vibeam_models.arrays import Array

LINKS = ("contact law", "reduction", "effects left out", "finest fidelity itself")  # last link, to a reference file


@dataclass(frozen=True)
class Part:
    """Contribution of one link to the amplitude's error, over the finest's amplitude.

    Signed are ``mean``, ``lowest``, ``highest`` and ``peak``, the value at the finest's peak, NaN where not all of the
    chain repeats there; means and values at the peak add up. ``worst``: the largest, without its sign. ``note``: reason
    for missing numbers (NaN); the next link then holds both contributions.
    """

    name: str
    mean: float = np.nan
    rms: float = np.nan
    worst: float = np.nan
    note: str = ""
    lowest: float = np.nan
    highest: float = np.nan
    peak: float = np.nan


@dataclass(frozen=True)
class Split:
    """Exact error of a fidelity against the finest and its parts, over ``points`` at which the whole chain is periodic.

    ``restitution``: of its first mode. ``cpu``: seconds of its exact run.
    """

    fidelity: str
    modes: int
    restitution: float
    total: Part
    parts: tuple[Part, ...]
    points: int
    cpu: float


@dataclass(frozen=True)
class LinkShare:
    """Relative difference in amplitude over a link, (points,), and ``at_peak`` of the last curve (NaN: not there)."""

    values: Array
    at_peak: float


def shares(chain: Sequence[FrequencyResponse]) -> list[LinkShare]:
    """Shares of each link and, last, of the chain, over the points where all are periodic."""
    last = chain[-1]
    where = np.logical_and.reduce([periodic(each) for each in chain]) & (last.amplitude > 0)
    top = last.peak.point if last.peak.point >= 0 and where[last.peak.point] else None
    steps = [np.divide(each.amplitude, last.amplitude, out=np.full(len(last), np.nan), where=where) for each in chain]
    pairs = [*pairwise(steps), (steps[0], steps[-1])]
    return [
        LinkShare((one - other)[where], np.nan if top is None else float((one - other)[top])) for one, other in pairs
    ]


def part(name: str, found: LinkShare) -> Part:
    """Part from the share of one link."""
    values = found.values
    if not len(values):
        return Part(name, note="no point where all of the chain repeats")
    low, high = float(np.min(values)), float(np.max(values))
    mean, rms = float(np.mean(values)), float(np.sqrt(np.mean(values**2)))
    return Part(name, mean, rms, max(abs(low), abs(high)), lowest=low, highest=high, peak=found.at_peak)


Build = Callable[[Model, Model], ImpactSystem]
Fly = Callable[[ImpactSystem], FrequencyResponse]


def split(
    model: Model,
    finest: Model,
    exact: FrequencyResponse,
    top: FrequencyResponse,
    build: Build,
    fly: Fly,
    cpu: float,
    file: FrequencyResponse | None = None,
) -> Split:
    """Split the error of ``model``. ``build(model, finest)``: its system with the finest's reduction, its own
    effects; ``fly``: the exact response of a system; ``exact`` and ``top``: those of the two ends;
    ``file``: the reference of the finest.
    """
    chain, notes = [exact], ["", "", "", ""]
    try:
        r1 = first_mode_restitution_of(finest.system)
        chain.append(exact if model is finest else fly(with_first_mode_restitution(model.system, r1)))
    except ValueError as refusal:
        chain.append(exact)
        notes[0] = str(refusal)
    chain += [_reduced_alike(model, finest, top, build, fly), top, *([] if file is None else [file])]
    *steps, whole = shares(chain)
    parts = [
        Part(name, note=note) if note else part(name, each)
        for name, each, note in zip(LINKS, steps, notes, strict=False)
    ]
    r1, total = first_mode_restitution_of(model.system), part("total", whole)
    return Split(model.name, model.system.size, r1, total, tuple(parts), len(whole.values), cpu)


def _reduced_alike(model: Model, finest: Model, top: FrequencyResponse, build: Build, fly: Fly) -> FrequencyResponse:
    alike = build(model, finest)
    try:
        alike = with_first_mode_restitution(alike, first_mode_restitution_of(finest.system))
    except ValueError:
        alike = replace(alike, restitution=finest.system.restitution)
    rounded = replace(alike, restitution=finest.system.restitution)
    return top if equal(rounded, finest.system) else fly(alike)
