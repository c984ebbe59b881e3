"""A stop that yields and is just touched: rest there is an equilibrium, whatever round-off says of it."""

from __future__ import annotations

import numpy as np
import pytest
from apart import run_apart

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

STILL = vibeam.Drive(2.27, 0.0)
LAWS = [Hertz(52.7), HuntCrossley(52.7, 0.1), HuntCrossley(52.7, 0.1, 1.0), LinearStop(52.7), LinearStop(52.7, 3.0)]
RIG = """
import numpy as np
import vibeam
from vibeam_models.laws.compliant import LinearStop

def rig(damping=104.26741952508146, zeta=0.017, gap=0.0):
    return vibeam.ImpactSystem.from_modes(
        [47.73307211979106, 635.0706480710485], zeta, [2.1238579795879406, 0.30991833180957423],
        [0.462867542714578, 0.09066548216204676], gap=gap, law=LinearStop(1e6, damping),
    )

def ends(given):
    for omega in 2 * np.pi * np.array([14.0, 15.5]):
        for amplitude in (8.660311939459456e-05, 0.0):
            for end in (1e-6, 0.01):
                yield vibeam.simulate(rig(**given), vibeam.Drive(omega, amplitude), end).ended.name
            found = vibeam.sweep(rig(**given), omega=[omega], amplitude=amplitude, settle=3, hold=2)
            yield vibeam.Ended.of_code(found.ended[0]).name

for given in (
    {}, {"zeta": [0.017000000000000043, 0.016999999999999436]}, {"damping": 104.0}, {"damping": 1.0},
    {"damping": 0.0}, {"gap": 1e-5}, {"gap": -1e-5},
):
    print(*ends(given), given if set(ends(given)) != {"COMPLETE"} else "")
"""


def test_a_drive_sets_in_at_equilibrium_on_a_linear_stop() -> None:
    """The acceleration away from the stop is zero at the start; what round-off makes of it is no flight."""
    assert set(run_apart(RIG).split()) == {"COMPLETE"}


def touching(law: object, static: float, gap: float) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [1.0, 1.2], 0.05, [1.0, 0.4], [1.0, 0.3], gap=gap, law=law, static=[static, 0.0]
    )


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("static", [0.0, 1e-9, 1e-3, 0.3])
def test_equilibrium_stays(law: object, static: float) -> None:
    """Just touching, or pressed in by a static force."""
    path = vibeam.simulate(touching(law, static, 0.0), STILL, 10.0, max_impacts=20_000)
    assert path.outcome is vibeam.Outcome["SETTLED_ON_STOP" if static else "SETTLED"]
    assert path.stats["impacts"] == 0


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("digits", [-2, -1, 0, 1, 2])
def test_a_gap_that_the_static_displacement_closes_to_the_last_digits(law: object, digits: int) -> None:
    place = 0.3 / 1.0**2
    system = touching(law, 0.3, place + digits * np.spacing(place))
    path = vibeam.simulate(system, STILL, 10.0, max_impacts=20_000)
    assert path.outcome in (vibeam.Outcome.SETTLED, vibeam.Outcome.SETTLED_ON_STOP)
    assert path.stats["impacts"] <= 1


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("static", [0.0, 0.3])
def test_a_motion_that_dies_out_on_the_stop_settles(law: object, static: float) -> None:
    """Thrown off, it comes to rest where the forces balance."""
    system = touching(law, static, 0.0)
    thrown = vibeam.State(np.array([-0.1, 0.0]), np.array([0.0, 0.05]))
    path = vibeam.simulate(system, STILL, 900.0, thrown, max_impacts=20_000)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.outcome is vibeam.Outcome["SETTLED_ON_STOP" if static else "SETTLED"] or static == 0.0
    np.testing.assert_allclose(path.state.displacement, equilibrium(system).displacement, atol=1e-12)


def test_a_stop_with_much_damping_pushes_again_while_it_is_still_penetrated() -> None:
    """Let go at k d + b d' = 0, the contact goes deeper once more before it is out: there is no pull, and no free fall.

    Where the modes are off the stop by the solver, the law's own formula must give no force.
    """
    law = LinearStop(30.0, 40.0)
    system = vibeam.ImpactSystem.from_modes([1.0, 9.0], 0.01, [1.0, 0.9], [1.0, 0.3], gap=0.0, law=law)
    path = vibeam.simulate(system, vibeam.Drive(1.9, 1.0), 60.0)
    trace = path.segments.trace
    for start, duration in trace[(trace[:, layout.WHAT] == layout.FREE) & (trace[:, layout.DURATION] > 0)][
        :, [layout.START, layout.DURATION]
    ]:
        modes = path.modes_at(start + duration * np.linspace(0.01, 0.99, 99))
        deep, rate = modes[:, 0] @ system.contact - system.gap, modes[:, 1] @ system.contact
        assert not np.any((deep > 1e-9) & (law.stiffness * deep + law.damping * rate > 1e-9))
    again = (trace[1:, layout.WHAT] == regime_layout.CONTACT) & (trace[:-1, layout.END] == regime_layout.PASS)
    assert np.sum(again & (trace[1:, layout.DURATION] > 0)) > 0
