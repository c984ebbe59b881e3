"""vibeam itself: ``simulate``, the proof apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import vibeam
from tests.others.scenes.told import Answer, Peer, Told

SETTING = "`simulate`: closed form from impact to impact, no tolerance, no step"


def prepare(told: Told) -> Callable[[], Answer]:
    """The system; kernels are compiled beforehand, or read."""
    run = motion(told)
    run(certify=False)

    def answer() -> Answer:
        path = run(certify=False)
        impacts = np.stack([path.impact_times, path.impact_velocities], axis=1)
        last = np.stack([path.state.displacement, path.state.velocity])
        complaint = "" if path.ended is vibeam.Ended.COMPLETE else path.ended.value
        return Answer(impacts, np.array([told.stops[0].row @ last[0]]), last, complaint)

    return answer


def motion(told: Told) -> Callable[..., vibeam.Trajectory]:
    """The motion, with its certificate or without."""
    first, *others = told.stops
    system = vibeam.ImpactSystem.from_modes(
        told.omega, told.zeta, first.row, told.load, gap=first.gap, restitution=first.restitution, static=told.static
    )
    if others:
        system = replace(system, second_gap=others[0].gap)
    drive, start = (
        vibeam.Drive(told.drive, told.amplitude),
        vibeam.State(told.displacement, told.velocity, told.held is not None),
    )
    return lambda certify: vibeam.simulate(system, drive, told.end, start, t_start=told.begin, certify=certify)


PEERS = [Peer("vibeam", "vibeam", SETTING, prepare)]
