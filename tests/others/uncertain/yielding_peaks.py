"""Peaks of many samples over drive frequencies by motions with one contact a period: the highest is climbed to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.others.uncertain.yielding_modes import Motions, Yielding

Array = Any
TOGETHER = 500  # samples computed at once, which stay in the processor's cache
DURATIONS = np.geomspace(0.002, 0.4, 240)  # shares of the period at which a motion is looked for


@dataclass(frozen=True)
class Found:
    """Motions of m samples: ``lasting`` (m,) s, ``side`` ±1, and ``height`` of the output, −∞ without one."""

    lasting: Array
    side: Array
    height: Array


def searched(rig: Yielding) -> Found:
    """The highest motion of each sample, of all durations."""
    found = Found(np.full(len(rig), np.nan), np.ones(len(rig)), np.full(len(rig), -np.inf))
    for place in range(len(rig)):
        many = Motions(rig.at(np.full(len(DURATIONS), place)))
        tried = DURATIONS * many.period
        quotient = many.quotient(tried)
        for side in (-1.0, 1.0):
            turns = np.flatnonzero(np.diff(np.sign(quotient - side)))
            few = Motions(rig.at(np.full(len(turns), place)))
            durations = few.between(tried[turns], tried[turns + 1], side)
            for lasting, height in zip(durations, few.watched(durations), strict=True):
                if height > found.height[place]:
                    found.lasting[place], found.side[place], found.height[place] = lasting, side, height
    return found


def yielding_peaks(rig: Yielding, omega: Array, base: Array, own: Yielding) -> Array:
    """Peaks (m,) of rigs at drives ``omega`` (k,) under ``base`` (m, k); NaN without one. ``own`` (1,): near all."""
    begun = searched(own.at(np.zeros(len(omega), dtype=int), omega=omega, base=np.full(len(omega), own.base[0])))
    found = np.empty(len(rig))
    for first in range(0, len(found), TOGETHER):
        part = slice(first, first + TOGETHER)
        found[part] = _climbed(rig.at(part), omega, base[part], begun, own.stiffness)
    return found


def _climbed(rig: Yielding, omega: Array, base: Array, begun: Found, stiffness: Array) -> Array:
    """Peaks of samples: the drives beside the highest are tried until both are lower."""
    heights, tried, own = np.full(base.shape, -np.inf), np.zeros(base.shape, dtype=bool), np.arange(len(base))
    top = np.full(len(base), int(np.argmax(begun.height)))
    while True:
        wanted = np.zeros_like(tried)
        for shift in (-1, 0, 1):
            wanted[own, np.clip(top + shift, 0, len(omega) - 1)] = True
        rows, places = np.nonzero(wanted & ~tried)
        if not len(rows):
            return np.where(np.isfinite(heights.max(axis=1)), heights.max(axis=1), np.nan)
        driven = rig.at(rows, omega=omega[places], base=base[rows, places])
        guess = begun.lasting[places] * np.sqrt(stiffness / driven.stiffness)
        heights[rows, places] = _heights(driven, guess, begun.side[places])
        tried[rows, places] = True
        top = np.argmax(heights, axis=1)


def _heights(rig: Yielding, lasting: Array, side: Array) -> Array:
    """Heights (m,) of motions near those of a duration (m,), or of any where there is none."""
    motions = Motions(rig)
    heights = motions.watched(motions.near(lasting, side))
    left = np.flatnonzero(np.isinf(heights))
    if len(left):
        heights[left] = searched(rig.at(left)).height
    return heights
