"""Periodic motions by shooting against Newton's method on flights in 30 digits, multipliers against their differences.

The second program shares no code with the product: flights by Taylor series (``yielding``), its Jacobian by central
differences of them, the fixed point found from a start 1e-5 away.
"""

from __future__ import annotations

from dataclasses import replace

import gmpy2
import numpy as np
import pytest
from test_tangent_maps import COUPLED, independent
from yielding import Yielding, flown, tangent

import vibeam
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

TWO = vibeam.ImpactSystem.from_modes([1.0, 2.6], [0.02, 0.05], [1.0, 0.6], [1.0, 0.3], gap=0.3)
SYSTEMS = {  # with a drive, how far states may be off as a share of the motion's size, and the digits of the judge
    "linear": (replace(TWO, law=LinearStop(400.0)), vibeam.Drive(1.9, 0.5), 1e-12, 30),
    "linear, damped": (replace(TWO, law=LinearStop(400.0, 6.0)), vibeam.Drive(1.9, 0.5), 1e-12, 30),
    "linear, damped, two impacts": (replace(TWO, law=LinearStop(900.0, 9.0)), vibeam.Drive(1.3, 0.5), 1e-12, 30),
    "linear, damped, two stops, coupled": (
        replace(TWO, law=LinearStop(300.0, 6.0), second_gap=0.5, coupling=COUPLED, static=np.array([0.3, -0.1])),
        vibeam.Drive(1.9, 0.5), 1e-12, 30,
    ),
    "Hertz": (replace(TWO, law=Hertz(400.0)), vibeam.Drive(1.9, 0.5), 1e-11, 21),
    "Hunt-Crossley": (replace(TWO, law=HuntCrossley(300.0, 0.6)), vibeam.Drive(1.9, 0.5), 1e-11, 21),
}  # fmt: skip


@pytest.mark.parametrize("name", SYSTEMS)
def test_states_velocities_and_multipliers_of_orbits(name: str) -> None:
    system, drive, share, digits = SYSTEMS[name]
    found = vibeam.orbits(system, drive)
    assert found
    own = independent(system)
    for orbit in found:
        known = np.concatenate([orbit.state.displacement, orbit.state.velocity])
        size = np.abs(known).max()
        far = known * (1 + 1e-5 * np.cos(np.arange(4)))
        exact, matrix = fixed_point(own, drive, far, orbit.time, digits)
        assert np.abs(known - np.array(exact, dtype=float)).max() < share * size
        values = np.linalg.eigvals(matrix)
        values = values[np.argsort(-np.abs(values))]
        apart = np.abs(values[:, None] - orbit.multipliers).min(axis=1)
        assert apart.max() < 100 * share * np.abs(values[0])
        assert orbit.stable == (np.abs(values[0]) < 1)


def fixed_point(
    system: Yielding, drive: vibeam.Drive, start: np.ndarray, time: float, digits: int
) -> tuple[list, np.ndarray]:
    """State in many digits to which Newton's method leads, and the Jacobian there."""
    with gmpy2.context(precision=int(digits * 3.33) + 20):
        here, given = [gmpy2.mpfr(x) for x in start], (drive.omega, drive.amplitude)
        end = gmpy2.mpfr(time) + 2 * gmpy2.const_pi() / gmpy2.mpfr(drive.omega)
        step = np.ones(len(start))
        for _ in range(12):
            if np.abs(step).max() > 1e-6:  # else with the last Jacobian
                matrix = tangent(system, given, here, time, end, digits)
            after, _ = flown(system, given, here, time, end, digits)
            apart = np.array([float(a - b) for a, b in zip(after, here, strict=True)])
            step = np.linalg.solve(matrix - np.eye(len(start)), apart)
            here = [a - gmpy2.mpfr(b) for a, b in zip(here, step, strict=True)]
            if np.abs(step).max() < 1e-16:
                break
        assert np.abs(step).max() < 1e-14
    return here, tangent(system, given, here, time, end, digits)
