"""SUNDIALS' CVODE with its root finding, through scikit-SUNDAE, started again behind each root.

An object used again after a terminal event gives old events back (1.2.0), so each flight has a new one. Modes that turn
10⁵ times in the span want an implicit method that is stable on the imaginary axis, which BDF is up to order 2 alone.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_array
from sksundae.cvode import CVODE

from tests.others.scenes.restarts import Equations, is_stiff, longest_step, march
from tests.others.scenes.told import Answer, Array, Peer, Told

RTOL, LOOSE = 1e-10, 1e-5
SETTING = (
    "CVODE by scikit-SUNDAE: Adams, rtol 1e-10, atol 1e-12 of the scales (402 modes: BDF up to order 2, sparse "
    "Jacobian, 1e-5 and 1e-7), no step over 1/50 of the drive's period or 1/100 of the motion; root finding on gaps "
    "that close, restart"
)


def prepare(told: Told) -> Callable[[], Answer]:
    """Nothing is compiled."""
    warnings.filterwarnings("ignore", "Custom sparse Jacobian")
    equations = Equations(told)
    stiff = is_stiff(told)
    rtol = LOOSE if stiff else RTOL
    options: dict[str, Any] = {"method": "BDF", "max_order": 2} if stiff else {"method": "Adams"}
    options |= {
        "rtol": rtol,
        "atol": told.tolerances(rtol),
        "max_step": longest_step(told),
        "max_num_steps": 10_000_000,
    }
    row, n = told.stops[0].row, told.size

    def leg(t: float, y: Array, held: int | None, soon: float) -> tuple[float, Array, int | None, Array, str]:
        def rate(now: float, state: Array, slope: Array) -> None:
            slope[:] = equations.rate(now, state, held)

        def roots(now: float, state: Array, events: Array) -> None:
            if held is None:
                events[:] = equations.gaps - equations.rows @ state[:n]
            else:
                events[0] = equations.press(now, state, held)

        count = len(told.stops) if held is None else 1
        roots.terminal, roots.direction = [True] * count, [-1] * count  # type: ignore[attr-defined]
        solver = CVODE(rate, eventsfn=roots, num_events=count, **options, **linear(equations, held, stiff))
        done: Any = solver.solve(np.array([t, told.end]), y)
        met = None
        if done.i_events is not None and len(done.i_events):
            met = int(np.flatnonzero(done.i_events[-1])[0])
        complaint = "" if done.success else "gives up"
        return float(done.t[-1]), np.array(done.y[-1]), met, row @ np.array(done.y)[:, :n].T, complaint

    return lambda: march(told, equations, leg)


def linear(equations: Equations, held: int | None, stiff: bool) -> dict[str, Any]:
    """Jacobian and linear solver: sparse in a stiff flight, whose modes are apart."""
    jacobian = equations.jacobian(held)
    sparse = csc_array(jacobian) if stiff and held is None else None

    def slopes(_: float, state: Array, slope: Array, matrix: Array) -> None:
        matrix[:] = jacobian if sparse is None else sparse.data

    return {"jacfn": slopes} if sparse is None else {"jacfn": slopes, "linsolver": "sparse", "sparsity": sparse}


PEERS = [Peer("SUNDIALS CVODE", "scikit-sundae", SETTING, prepare)]
