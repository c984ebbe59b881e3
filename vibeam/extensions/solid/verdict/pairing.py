"""Pairing of the modes of two models of one rig by their shapes along the mean line.

Two shapes a and b, deflections and slopes at the same places, are alike by the modal assurance criterion
MAC = (a·b)²/((a·a)(b·b)) (R. J. Allemang, Sound and Vibration 37, 2003), each place weighed by the mass or the moment
of inertia that moves there: 1 where one is a multiple of the other, and 0 of two modes of one beam, which are
M-orthogonal. Both are mass-normalised, so that the mean line of partners moves alike: where it moves less than the
beam's, as in a strip that waves across its width, the MAC counts by the ratio of b·b to a·a. The pairs are those whose
sum is largest. A mode that leaves the mean line at rest (lateral bending, stretching, twist) has no partner.
"""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.scene import Scene

ALIKE = 0.3  # from which two modes are one
STILL = 0.02  # size of a mode of size 1 on the mean line below which it does not bend it


def likeness(ours: Array, theirs: Array) -> Array:
    """(a·b)²/((a·a) max(a·a, b·b)) of every pair (a, b) of mass-normalised shapes (k, a) and (k, b), none zero."""
    own, other = (np.sum(shapes**2, axis=0) for shapes in (ours, theirs))
    return np.asarray((ours.T @ theirs) ** 2 / (own[:, None] * np.maximum(own[:, None], other)))


def bending(shapes: Array) -> Flags:
    """Mask (n,) of the mass-normalised modes whose weighed ``shapes`` (k, n) bend the mean line."""
    return np.asarray(np.sqrt(np.sum(shapes**2, axis=0)) > STILL)


def inertias_along(scene: Scene, name: str, count: int) -> tuple[Array, Array]:
    """Masses in kg and moments of inertia in kg m², (count,) each, at even places along the ``"beam"`` or the other."""
    other = next(iter(scene.named("opposite")), None)
    beam = scene.carrier if name == "beam" or other is None else other.beam(scene)
    places = np.linspace(0, beam.length, count)
    ends = np.concatenate([[0.0], (places[1:] + places[:-1]) / 2, [beam.length]])
    masses, turned = -np.diff(beam.mass_beyond(ends)), np.zeros(count)
    weights = scene.weights if name == "beam" else [each for effect in scene.of(name) for each in effect.weights]
    for mass, position in weights:
        masses[np.argmin(np.abs(places - position))] += mass
    for effect in scene.named("mass.rotary_inertia") if name == "beam" and scene.mass is not None else ():
        turned[np.argmin(np.abs(places - scene.attached(effect.name).position))] += effect.rotary_inertia
    return masses, turned


def partners(ours: Array, theirs: Array) -> tuple[Index, Array]:
    """Place (a,) of the partner among ``theirs`` (k, b) of each of ``ours`` (k, a), −1 without; likeness (a,), NaN."""
    from scipy.optimize import linear_sum_assignment

    alike = likeness(ours, theirs)
    found, known = np.full(len(alike), -1), np.full(len(alike), np.nan)
    for one, other in zip(*linear_sum_assignment(-alike), strict=True):
        if alike[one, other] >= ALIKE:
            found[one], known[one] = other, alike[one, other]
    return found, known
