"""Packing of a system for the kernels: once for one object, anew for another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import vibeam
from vibeam.flight.linear.packing import pack

MODES = {"omega": [1.0, 6.0], "zeta": 0.02, "contact": [1.0, 0.7], "load": [1.0, 0.4]}


def test_a_system_is_packed_once_for_drives_of_one_octave() -> None:
    system = vibeam.ImpactSystem.from_modes(**MODES, gap=0.1, restitution=0.8)
    first = pack(system, 2.0)
    assert pack(system, 2.0) is first
    assert pack(system, 200.0) is not first


def test_another_system_is_packed_anew() -> None:
    system = vibeam.ImpactSystem.from_modes(**MODES, gap=0.1, restitution=0.8)
    assert pack(replace(system), 2.0) is not pack(system, 2.0)


def test_motions_by_one_packed_system_do_not_disturb_each_other() -> None:
    system = vibeam.ImpactSystem.from_modes(**MODES, gap=0.1, restitution=0.8)
    slow, fast = vibeam.Drive(1.9, 0.1), vibeam.Drive(2.1, 0.2)
    alone = vibeam.simulate(replace(system), slow, t_end=50.0)
    shared = vibeam.simulate(system, slow, t_end=50.0)
    vibeam.simulate(system, fast, t_end=50.0)
    vibeam.sweep(system, omega=[2.0], amplitude=0.1, settle=10, hold=5)
    times = np.linspace(0.0, 50.0, 99)
    np.testing.assert_array_equal(alone.modes_at(times), shared.modes_at(times))
