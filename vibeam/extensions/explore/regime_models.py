"""Systems beyond plain ones as numbers for the page: any law, a second stop, damping that couples the modes.

Plain modes too where the output is a velocity or an acceleration, which regimes read. The page finds no eigenvalues: it
is given the blocks of every regime, and how their constants go with the gap (``flight.linear.over_gap``).
``engine/regimes.js`` packs them.
"""

from __future__ import annotations

from typing import Any

from vibeam.extensions.explore.own_numbers import restitution
from vibeam.flight.linear.over_gap import PlanOverGap, RegimeOverGap
from vibeam.system.impact_system import ImpactSystem

MOST_MODES = 24  # of a system by regimes: its matrices of 48 × 48 take 0.25 MB of the page, as much as its kernels
ROWS = ("omega", "zeta", "contact", "load", "static")
OWN = ("law", "curve", "contact", "yields", "gaps", "omega", "spring", "damper", "damping", "load", "static")
DAMPED = ("law", "damper", "damping")
RUNGE_KUTTA = ("nodes", "weights")
MATRICES = ("pairs", "blocks", "into", "outof", "held", "signals")
SHARES = ("constants", "held", "signals")


def regimes_refusal(system: ImpactSystem, output: str) -> str:
    """Reason why the page cannot fly a system by regimes, a sentence; empty where it can."""
    if system.further is not None:
        return "It has contacts in several places, whose kernels the page does not carry. Take vibeam run."
    wanted = system.derivative(output)
    if wanted is not None and system.contact_law.integrated:
        return f"The {wanted.called} in a contact that is integrated is not read: take a displacement as sweep.output."
    if system.size > MOST_MODES:
        what = system.beyond_plain[0] if system.beyond_plain else "the output of a derivative"
        return (
            f"It has {what}: then the page carries {MOST_MODES} modes at most, and this fidelity has {system.size}. "
            "Take fewer modes."
        )
    return ""


def beyond_plain(system: ImpactSystem, output: str) -> dict[str, Any]:
    """Model of a system for the page's engine of regimes; ValueError where its modes have no blocks.

    ``restitution``: the number that one sets, R at the contact or the coefficient of R(v).
    """
    found = regimes_of(system)
    number, wanted = found["coefficient"], system.derivative(output)
    derivatives = {} if wanted is None else {output: {"row": wanted.row, "order": wanted.order, "base": wanted.base}}
    return {
        **{name: getattr(system, name) for name in ROWS},
        "restitution": 1.0 if number is None else number,
        "damped": False,
        "rest": None,
        "outputs": dict(system.outputs),
        "derivatives": derivatives,
        "regimes": found,
    }


def regimes_of(system: ImpactSystem) -> dict[str, Any]:
    """Numbers of which the page builds a ``RegimeEngine``, at any gap and drive; ValueError as ``PlanOverGap.of``.

    ``coefficient``: what a restitution sets in the law, None where that has no such number.
    """
    over = PlanOverGap.of(system)
    own = (*OWN, *RUNGE_KUTTA) if over.integrated else OWN
    return {name: getattr(over.plan, name) for name in own} | {"coefficient": restitution(system)} | _damped(over)


def regimes_at_damping(system: ImpactSystem, factor: float) -> dict[str, Any]:
    """Numbers of a ``RegimeEngine`` that other damping changes, of the ``system`` with ``factor`` times its own."""
    over = PlanOverGap.of(system)
    return {name: getattr(over.plan, name) for name in DAMPED} | {"factor": factor} | _damped(over)


def _damped(over: PlanOverGap) -> dict[str, Any]:
    lower = None if over.lower is None else _regime(over.lower)
    return {"fastest": over.fastest, "free": _regime(over.free), "upper": _regime(over.upper), "lower": lower}


def _regime(over: RegimeOverGap) -> dict[str, Any]:
    own = {name: getattr(over.regime, name) for name in MATRICES}
    return {**own, "share": {name: getattr(over, name) for name in SHARES}}
