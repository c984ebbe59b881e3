"""Solvers: state in, state out, nothing remembered.

A solver is made for one system and then asked for steady points or for a motion; it never knows which reduction made
its system. ``solver`` makes one by name.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.motion_curves import MotionCurves
    from vibeam.system.response import FrequencyResponse
    from vibeam.system.state import State


HOMES = {
    "flight": "vibeam.flight.solver:FlightSolver",
    "orbit": "vibeam.solvers.orbit:OrbitSolver",
    "averaging": "vibeam.solvers.averaging.solver:AveragingSolver",
    "mapping": "vibeam.solvers.mapping.solver:MappingSolver",
    "direct": "vibeam.solvers.integration.direct:DirectSolver",
    "zhuravlev": "vibeam.solvers.integration.zhuravlev:ZhuravlevSolver",
    "ivanov": "vibeam.solvers.integration.ivanov:IvanovSolver",
    "moreau": "vibeam.solvers.integration.moreau:MoreauSolver",
}

NAMES = tuple(HOMES)

STATIONARY = ("orbit", "averaging", "mapping")  # steady motions by formula: nothing settles, no impact is flown

EXACT = ("flight", "orbit", "mapping")  # whose motion is exact between impacts; the others have samples: ``motion``

GIVEN = ("system", "slowest", "span")  # to every solver

BEYOND_PLAIN = {  # the same name for systems that are more than plain; a solver that is not here cannot take them
    "flight": "vibeam.flight.regime_solver:RegimeSolver",
    "direct": "vibeam.solvers.integration.direct:DirectSolver",
}


class Solver(Protocol):
    """What every solver does. It is made as ``Class(system, slowest, span, **options)`` and raises ValueError there
    for a system or an option that it cannot take.
    """

    def steady(
        self,
        omegas: Sequence[float] | NDArray[np.float64],
        amplitude: float,
        state: State | None,
        settle: int,
        hold: int,
        output: str,
    ) -> tuple[FrequencyResponse, State]:
        """Steady points at ``omegas`` (rad/s) in turn under base motion of ``amplitude`` m, the state carried."""
        ...


class CurveSolver(Solver, Protocol):
    """A solver that knows all motions of its kind, stable or not."""

    def curves(self, omegas: NDArray[np.float64], amplitude: float, output: str) -> MotionCurves:
        """Both branches at ``omegas`` (rad/s) under base motion of ``amplitude`` m."""
        ...


def knows_curves(name: str) -> bool:
    """Whether the solver of that name is a ``CurveSolver``."""
    module, kind = HOMES[name].split(":")
    return hasattr(getattr(import_module(module), kind), "curves")


def solver(name: str, system: ImpactSystem, slowest: float, span: float = 0.0, **options: Any) -> Any:
    """The solver of that name for one system and drives of ``slowest`` rad/s and more.

    ValueError names the solvers or the options that there are, or says why this one cannot take the system.
    """
    if name not in HOMES:
        raise ValueError(f"no solver {name!r}: there are {', '.join(NAMES)}")
    home = HOMES[name]
    if system.beyond_plain:
        if name not in BEYOND_PLAIN:
            system.require_plain(f"solver {name!r}")
        home = BEYOND_PLAIN[name]
    module, kind = home.split(":")
    made = getattr(import_module(module), kind)
    known = _options_of(made)
    unknown = [key for key in options if key not in known]
    if unknown:
        raise ValueError(f"solver {name!r} has no option {', '.join(unknown)}: there are {', '.join(known) or 'none'}")
    return made(system, slowest, span, **options)


def _options_of(made: type[Any]) -> list[str]:
    """The options of a solver, those that it hands on to what it is made from among them."""
    parameters = signature(made).parameters
    handed_on = any(each.kind is Parameter.VAR_KEYWORD for each in parameters.values())
    own = [name for name, each in parameters.items() if each.kind is not Parameter.VAR_KEYWORD and name not in GIVEN]
    return own + (_options_of(made.__mro__[1]) if handed_on else [])
