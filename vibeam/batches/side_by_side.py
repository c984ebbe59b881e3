"""Sweeps of many systems at once: samples, variants, fidelities.

Plain systems go in step, side by side in the processor's lanes; what the lanes do not take is swept by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.flight.kernels.layout import ELASTIC
from vibeam.flight.points.in_step import compute_in_step
from vibeam.flight.points.points import SIDE_BY_SIDE, PlainPoints, PointSettings
from vibeam.runs.sweep import SweepPoints, SweepSettings, march_blocks
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, join


@dataclass(frozen=True, eq=False)
class SystemSweep:
    """Sweep of one system in one direction, from equilibrium: its points in the order swept, ``settings`` of each."""

    system: ImpactSystem
    points: SweepPoints
    settings: SweepSettings

    @property
    def in_lanes(self) -> bool:
        """Whether it goes in step with others: a plain system of few modes, exact, under one drive, at a fixed gap."""
        system, settings = self.system, self.settings
        exact = settings.solver == "flight" and not settings.options and settings.settle > 0
        fixed = self.points.drift is None and settings.wear is None and not settings.harmonics
        plain = not system.beyond_plain and system.derivative(settings.output) is None
        return exact and fixed and plain and system.size <= SIDE_BY_SIDE

    def alone(self) -> FrequencyResponse:
        """Its response by itself, to the bit that of ``vibeam.sweep``."""
        blocks = march_blocks(self.system, self.points, self.settings, block=len(self.points.omega))
        return join([response for response, _ in blocks])

    @property
    def alike(self) -> tuple[object, ...]:
        """What sweeps in step have in common."""
        elastic, settings = 1.0 - self.system.restitution < ELASTIC, self.settings
        return self.system.size, elastic, self.points.omega.tobytes(), settings.settle, settings.hold, settings.output


def sweep_side_by_side(sweeps: Sequence[SystemSweep]) -> list[FrequencyResponse]:
    """Responses of all, one for each; numbers of one depend on no other to the bit.

    In lanes they are those of ``vibeam.sweep`` to round-off, so that motions that do not repeat differ; elsewhere to
    the bit. ``impact_velocities`` and all other columns are those of a sweep.
    """
    found: dict[int, FrequencyResponse] = {}
    groups: dict[tuple[object, ...], list[int]] = {}
    for place, each in enumerate(sweeps):
        if each.in_lanes:
            groups.setdefault(each.alike, []).append(place)
        else:
            found[place] = each.alone()
    for places in groups.values():
        found.update(zip(places, _in_lanes([sweeps[place] for place in places]), strict=True))
    return [found[place] for place in range(len(sweeps))]


def _in_lanes(sweeps: Sequence[SystemSweep]) -> list[FrequencyResponse]:
    """Responses of sweeps that have all of ``SystemSweep.alike`` in common."""
    first, systems = sweeps[0], [each.system for each in sweeps]
    omega, settings = first.points.omega, first.settings
    amplitude = np.stack([np.broadcast_to(each.points.amplitude, omega.shape) for each in sweeps])
    gap, restitution = (np.array([getattr(each, name) for each in systems]) for name in ("gap", "restitution"))
    own = np.arange(len(systems))
    points = PlainPoints(systems, own, np.full(len(own), omega[0]), amplitude[:, 0], gap, restitution)
    elastic = bool(1.0 - restitution[0] < ELASTIC)
    asked = PointSettings(settings.settle, settings.hold, settings.output, 0, elastic, SIDE_BY_SIDE)
    return compute_in_step(points, omega, amplitude, asked)
