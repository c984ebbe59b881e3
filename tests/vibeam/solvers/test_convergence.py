"""Every solver converges to the flight solver, each at its theoretical order: one test for all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from convergence import SOLVERS, B, observed_order, sdof, three_modes

import vibeam
from vibeam.solvers import SOLVERS as DECLARED

Measured = tuple[list[float], list[float]]  # tolerances, steps or small parameters, and the errors there
WRONG = 1e-4  # by which restitution is off where the test must fail
TOLERANCES = 10.0 ** -np.arange(4)
STEPS = [2000 * 2**k for k in range(6)]
STARTS = tuple(np.linspace(1.2, 1.6, 12))  # where in a step the impacts fall is chance: averaged over starts
SMALL = [0.1, 0.05, 0.025]
GRID = [1.7, 2.0, 2.3]


@dataclass(frozen=True)
class Claim:
    """What a solver is said to do: ``order`` None is exact, to ``bar``. ``measure`` takes how wrong R is made."""

    solver: str
    measure: Callable[[float], Measured]
    order: float | None
    within: float
    bar: float  # of the last error
    about: str = ""

    def __str__(self) -> str:
        return f"{self.solver} {self.about}".strip()


def by_tolerance(name: str, method: str, loosest: float, modes: int = 1) -> Callable[[float], Measured]:
    """Impact velocities over 40 s; ``loosest``: where the tolerance, not the longest step allowed, sets the steps."""

    def measure(wrong: float) -> Measured:
        tolerances = list(loosest * TOLERANCES)
        options = [{"method": method, "rtol": tol, "atol": tol * 1e-4} for tol in tolerances]
        return tolerances, observed_order(name, options, tolerances, model(modes, wrong), 40.0)[1]

    return measure


def by_step(name: str, t_end: float, modes: int = 1) -> Callable[[float], Measured]:
    def measure(wrong: float) -> Measured:
        steps, options = [1 / s for s in STEPS], [{"steps": s} for s in STEPS]
        return steps, observed_order(name, options, steps, model(modes, 100 * wrong), t_end, STARTS)[1]

    return measure


def model(modes: int, wrong: float) -> vibeam.ImpactSystem:
    return three_modes() if modes == 3 else sdof(restitution=0.9 + wrong)


def settled(name: str, options: dict[str, Any]) -> Callable[[float], Measured]:
    """Steady motions; no parameter makes them better."""

    def measure(wrong: float) -> Measured:
        exact = vibeam.sweep(sdof(), omega=GRID, amplitude=B, settle=400, hold=4)
        found = vibeam.sweep(
            sdof(restitution=0.9 + wrong), omega=GRID, amplitude=B, solver=name, settle=0, hold=4, options=options
        )
        assert isinstance(exact, vibeam.FrequencyResponse)
        assert isinstance(found, vibeam.FrequencyResponse)
        miss = [getattr(found, q) / getattr(exact, q) - 1 for q in ("reach", "amplitude", "impact_velocity")]
        return GRID, list(np.abs(miss).max(axis=0))

    return measure


def by_small_parameter(form: str) -> Callable[[float], Measured]:
    """Q at 2:1 with β, B and 1 − R all scaled: the losses and the drive are what averaging takes for small."""

    def measure(wrong: float) -> Measured:
        errors = []
        for small in SMALL:
            beta, drive, r = 0.15 * small, 5e-3 * small, 1 - small
            system = vibeam.ImpactSystem.from_modes([1.0], beta, 1.0, 1.0, restitution=r)
            off = vibeam.ImpactSystem.from_modes([1.0], beta, 1.0, 1.0, restitution=r - 100 * wrong)
            exact = vibeam.sweep(system, omega=[2.0], amplitude=drive, settle=int(40 / small), hold=4)
            found = vibeam.sweep(off, omega=[2.0], amplitude=drive, solver="averaging", options={"damping": form})
            assert isinstance(exact, vibeam.FrequencyResponse)
            assert isinstance(found, vibeam.FrequencyResponse)
            errors.append(abs(float(found.reach[0] / exact.reach[0]) - 1))
        return SMALL, errors

    return measure


# Local error a step ~ tolerance, and the order of the solution carried on is that of the error, so global ~ tolerance¹.
LOOSEST = {"RK23": 1e-4, "RK45": 1e-5, "DOP853": 1e-9}
INTEGRATED = {
    "direct": LOOSEST | {"LSODA": 1e-5},
    "zhuravlev": LOOSEST,
    "ivanov": dict.fromkeys(LOOSEST, 1e-4),
}
CLAIMS = [
    *(
        Claim(name, by_tolerance(name, method, loosest), 0.9 if method == "LSODA" else 1.0, 0.3, 1e-5, method)
        for name, methods in INTEGRATED.items()
        for method, loosest in methods.items()
    ),
    Claim("direct", by_tolerance("direct", "RK45", 1e-5, 3), 1.0, 0.3, 1e-5, "three modes"),
    Claim("moreau", by_step("moreau", 20.0), 1.0, 0.35, 2e-3),
    Claim("moreau", by_step("moreau", 4.5, 3), 1.0, 0.35, 2e-3, "three modes"),
    Claim("mapping", settled("mapping", {}), None, 0.0, 1e-11),
    Claim("orbit", settled("orbit", {}), None, 0.0, 1e-11),
    Claim("averaging", by_small_parameter("paper"), 1.0, 0.06, 2e-2, "paper"),
    Claim("averaging", by_small_parameter("log"), 2.0, 0.06, 1e-3, "log"),
]
ONE_EACH = [claim for claim in CLAIMS if claim.about in ("", "RK45", "paper")]


def holds(claim: Claim, wrong: float = 0.0) -> tuple[bool, str]:
    sizes, errors = claim.measure(wrong)
    told = f"{claim}: errors {errors} at {sizes}"
    if claim.order is None:
        return max(errors) < claim.bar, told
    found = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
    return abs(found - claim.order) < claim.within and errors[-1] < claim.bar, f"{told}: order {found:.2f}"


@pytest.mark.parametrize("claim", CLAIMS, ids=str)
def test_every_solver_converges_to_flight(claim: Claim) -> None:
    kept, told = holds(claim)
    assert kept, told


@pytest.mark.parametrize("claim", ONE_EACH, ids=str)
def test_none_does_where_the_restitution_is_wrong(claim: Claim) -> None:
    kept, told = holds(claim, WRONG)
    assert not kept, told


def test_no_solver_and_no_method_is_left_out() -> None:
    assert {claim.solver for claim in CLAIMS} == {*DECLARED} - {"flight"}
    for name, methods in INTEGRATED.items():
        with pytest.raises(ValueError, match="none of") as refused:
            SOLVERS[name](sdof(), 2.0, method="none")
        assert str(refused.value).split("none of ")[1].split(", ") == [*methods]
