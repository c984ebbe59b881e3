"""Quantities of interest: unit, admissible change and presentation of each."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from vibeam.case.plans import InfluencePlan


NAN = float("nan")
How = Literal["relative", "absolute"]


@dataclass(frozen=True)
class Quantity:
    """Quantity: ``label`` in words; ``unit`` in SI; ``how`` its change is computed; ``tolerance`` of the change."""

    name: str
    label: str
    unit: str
    how: How
    tolerance: float


@dataclass(frozen=True)
class Value:
    """Value of a quantity in one model; NaN with the reason ``why``, or a number with a remark."""

    number: float
    why: str = ""


@dataclass(frozen=True)
class Change:
    """Change from the complete model: ``value``, ``amount`` as the quantity defines it, ``share``: of the
    tolerance, in absolute value; ∞ where only one of the two models has the quantity. ``why``: the remarks.
    """

    quantity: str
    value: float
    amount: float
    share: float
    why: str = ""


def quantities(plan: InfluencePlan) -> tuple[Quantity, ...]:
    """Quantities that the case asks for, with its tolerances."""
    ratio, hertz = plan.tolerance, plan.frequency_tolerance
    known = (
        Quantity("peak", "the peak", "m", "relative", ratio),
        Quantity("peak_frequency", "its frequency", "Hz", "absolute", hertz),
        Quantity("period_one_from", "the lower end of period 1", "Hz", "absolute", hertz),
        Quantity("period_one_to", "the upper end of period 1", "Hz", "absolute", hertz),
        Quantity("ringing", "the ringing", "m/s", "relative", ratio),
        Quantity("ringing_frequency", "its frequency", "Hz", "relative", ratio),
        Quantity("apparent_restitution", "the apparent R", "1", "absolute", plan.restitution_tolerance),
    )
    return tuple(each for each in known if each.name in plan.quantities)


def change(quantity: Quantity, ours: Value, whole: Value) -> Change:
    """Change from the complete model's value to another one's; none where neither has one."""
    reasons = "; ".join(dict.fromkeys(filter(None, (ours.why, f"all effects: {whole.why}" if whole.why else ""))))
    present = isfinite(ours.number), isfinite(whole.number)
    if present == (False, False):
        return Change(quantity.name, ours.number, NAN, 0.0, reasons)
    if not all(present):
        return Change(quantity.name, ours.number, NAN, inf, reasons)
    amount = ours.number - whole.number
    if quantity.how == "relative":
        if not whole.number:
            return Change(quantity.name, ours.number, NAN, inf if amount else 0.0, reasons)
        amount /= abs(whole.number)
    return Change(quantity.name, ours.number, amount, abs(amount) / quantity.tolerance, reasons)
