"""scipy's ``solve_ivp``: terminal events on gaps that close, started again behind each."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from scipy.integrate import solve_ivp
from scipy.sparse import csc_array

from tests.others.scenes.restarts import Equations, is_stiff, longest_step, march
from tests.others.scenes.told import Answer, Array, Peer, Told

RTOL, LOOSE = 1e-10, 1e-6
SETTING = (
    "`solve_ivp`, DOP853, rtol 1e-10, atol 1e-12 of the scales (402 modes: Radau with its sparse Jacobian, 1e-6 and "
    "1e-8), no step over 1/50 of the drive's period or 1/100 of the motion; a terminal event for each gap that closes, "
    "restart"
)


def prepare(told: Told) -> Callable[[], Answer]:
    """Nothing is compiled."""
    equations = Equations(told)
    longest, stiff = longest_step(told), is_stiff(told)
    rtol = LOOSE if stiff else RTOL
    options: dict[str, Any] = {"rtol": rtol, "atol": told.tolerances(rtol), "max_step": longest}
    row, n = told.stops[0].row, told.size

    def closes(t: float, y: Array, stop: int) -> float:
        return -equations.beyond(y, stop)

    def leg(t: float, y: Array, held: int | None, soon: float) -> tuple[float, Array, int | None, Array, str]:
        if held is None:
            events: list[Any] = [partial(closes, stop=k) for k in range(len(told.stops))]
        else:
            events = [partial(equations.press, stop=held)]
        for event in events:
            event.terminal, event.direction = True, -1.0
        first = min(soon / 10, longest, told.end - t) if soon > 0 and held is None else None
        rate = partial(equations.rate, held=held)
        method = {"method": "Radau", "jac": csc_array(equations.jacobian(held))} if stiff else {"method": "DOP853"}
        done = solve_ivp(rate, (t, told.end), y, events=events, first_step=first, **options, **method)
        met = next((k for k, times in enumerate(done.t_events) if len(times)), None)
        complaint = "gives up" if done.status < 0 else ""
        return float(done.t[-1]), done.y[:, -1], met, row @ done.y[:n], complaint

    return lambda: march(told, equations, leg)


PEERS = [Peer("scipy", "scipy", SETTING, prepare)]
