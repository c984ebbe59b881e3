"""Keys that a grid may vary: what each decides, the rules between the axes of a grid, the plan of a map over them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from vibeam.case.plans import SweepPlan
from vibeam.case.study_plans import MOST_POINTS
from vibeam_models import keys as declare

FREQUENCY = "sweep.frequency"
DISPLACEMENT, VELOCITY = "start.displacement", "start.velocity"
STARTS = (DISPLACEMENT, VELOCITY)  # of the contact: keys of a grid alone, no case has them
GAP, RESTITUTION = "stop.gap", "stop.restitution"
SHARE = "drive.share"  # of the drive as the case has it: a key of a grid alone

LEVELS = tuple(
    f"drive.{name}" for name in ("amplitude", "voltage", "gain", "force", "moment", "velocity", "acceleration")
)


def is_structural(key: str) -> bool:
    """Test whether the system has to be built anew for each value of a key."""
    return key not in (FREQUENCY, *STARTS, GAP, RESTITUTION, SHARE, *LEVELS)


def axis_faults(keys: Sequence[str], carried: bool, frequency: float | None, random: bool) -> list[tuple[str, str]]:
    """Faults of the axes ``keys`` of a grid, each (axis, or other argument; message with the cure).

    ``carried``: the state goes from point to point along the last one; ``frequency``: of the drive, where it is no
    axis; ``random``: motions start at random.
    """
    found = [(key, "is an axis twice") for key in dict.fromkeys(keys) if keys.count(key) > 1]
    if FREQUENCY in keys and frequency is not None:
        found.append(("frequency", f"{FREQUENCY} is an axis already: leave one of the two away"))
    elif FREQUENCY not in keys and frequency is None:
        found.append(("frequency", f'missing where {FREQUENCY} is no axis: write frequency = "15.3 Hz"'))
    given = [key for key in keys if key in STARTS]
    if carried and keys and is_structural(keys[-1]):
        cure = 'put another axis last, or write direction = "apart"'
        found.append((keys[-1], f"changes the modes, so no state is carried along it: {cure}"))
    if carried and (given or random):
        what = given[0] if given else "starts"
        found.append((what, 'where each motion has a start of its own none is carried: write direction = "apart"'))
    if given and random:
        found.append(("starts", f"{given[0]} says already where motions start: leave one of the two away"))
    return found


RUNS = ("up", "down", "both", "apart")
STROBES = 32  # of a bifurcation diagram that does not say
READ = (
    "amplitude",
    "reach",
    "maximum",
    "minimum",
    "impacts_per_period",
    "impact_velocity",
    "period",
    "rest",
    "energy",
    "lyapunov",
)

PICTURES = {
    "period": "class of the motion over two axes, a panel for each value of a third",
    "bifurcation": "the output at the end of each period over one axis, with periodic motions in closed form",
    "basins": "which of the coexisting motions a start leads to, or how many are found, or their shares",
    "values": "a quantity over one or two axes",
    "stability": "where motions with one impact (by shooting: with contacts) exist and are stable, over two axes",
    "verdict": "the cheapest fidelity that suffices, and how far each is off, over two axes",
}

NEEDED: Mapping[str, tuple[str, ...]] = {
    "period": ("period", "rest"),
    "bifurcation": ("period",),
    "basins": ("period", "impacts_per_period", "maximum", "minimum", "impact_velocity"),
    "values": (),
}

ORBITS = ("impact_velocity", "admissible", "stable")  # stored of a stability map
JUDGED = ("error", "kind", "cpu_seconds")  # of a fidelity map, beside its quantity


@dataclass(frozen=True)
class AxisPlan:
    """Axis of a map: a dotted key and its values in ``unit``, that of its SI (empty: a plain number)."""

    key: str
    values: tuple[float, ...]
    unit: str


@dataclass(frozen=True, kw_only=True)
class MapPlan:
    """Plan of one [map.NAME] table: quantities over ``axes``, the last of which is swept ``direction``.

    ``direction``: "up", "down" or "both", the state carried; "apart": every point from its own start. ``frequency`` in
    Hz, where it is no axis; ``settle`` and ``hold`` in drive periods; ``strobes``: how many values at the end of a
    period; ``starts`` at random, from ``seed``, within ``spread`` (m). ``picture`` and the ``quantity`` that it shows;
    ``boundaries``: whether exact ones are laid over it. ``fidelities`` empty: those that the picture suits. Of a
    fidelity map ``accuracy`` of the quantity and ``frequency_accuracy`` of the ends of branches, as shares; of a
    stability map ``periods`` of the drive from impact to impact.
    """

    name: str
    axes: tuple[AxisPlan, ...]
    picture: str = declare.word(
        tuple(PICTURES), "; ".join(f"{name}: {meaning}" for name, meaning in PICTURES.items()), "period", "period"
    )
    fidelities: tuple[str, ...] = declare.text("whose; absent = all", ["sdof"], None)
    direction: Literal["up", "down", "both", "apart"] = declare.word(
        RUNS,
        "which way the last axis is swept, the state carried; apart = every point from its own start; absent = the "
        "sweep's, or apart where starts are given",
        "up",
        None,
    )
    frequency: float | None = declare.quantity(
        "Hz", "of the drive, where sweep.frequency is no axis", "15.3 Hz", None, above=0
    )
    settle: int = declare.count(0, MOST_POINTS, "drive periods left out; absent = the sweep's", 350, None)
    hold: int = declare.count(1, MOST_POINTS, "drive periods read; absent = the sweep's", 50, None)
    output: str = declare.text("the output that is read; absent = the sweep's", "contact", None)
    quantities: tuple[str, ...] = declare.word(
        READ,
        "what is stored; absent = amplitude and period, and what the picture needs",
        ["amplitude", "period"],
        None,
        several=True,
    )
    quantity: str = declare.word(
        READ,
        'what picture = "values" shows, or "verdict" compares (amplitude or reach); absent = amplitude',
        "impact_velocity",
        None,
    )
    accuracy: float = declare.quantity(
        "", 'how near the reference a model of picture = "verdict" has to come; absent = 1 %', "1 %", None,
        above=0, most=0.999,
    )  # fmt: skip
    frequency_accuracy: float | None = declare.quantity(
        "", "how near the reference's its branches have to end, of the frequency; absent = a fifth of accuracy",
        "0.2 %", None, above=0, most=0.999,
    )  # fmt: skip
    periods: int = declare.count(
        1, 100, 'drive periods from impact to impact, of picture = "stability"; absent = 1', 1, None
    )
    strobes: int = declare.count(
        1,
        10_000,
        f"values at the end of a period that are stored; absent = {STROBES} of a bifurcation diagram, else none",
        64,
        None,
    )
    starts: int | None = declare.count(1, 100_000, "random starts of every point: what coexists is counted", 50, None)
    seed: int = declare.count(0, 2**31 - 1, "of the random starts", 1, 1)
    spread: float | None = declare.quantity(
        "m", "how far from 0 the contact starts at random, its velocity within Ω times that", "1 mm", None, above=0
    )
    boundaries: bool = declare.flag(
        "whether exact boundaries of motions with one impact a period are laid over, where a closed form knows them",
        False,
        True,
    )


USUAL: Mapping[str, Any] = {"quantity": "amplitude", "accuracy": 0.01, "periods": 1}


def planned(name: str, axes: Sequence[AxisPlan], sweep: SweepPlan, picture: str = "period", **given: Any) -> MapPlan:
    """Plan of a map; what is not ``given``, or None, is as the ``sweep`` has it, or as the picture needs it."""
    said = {key: value for key, value in given.items() if value is not None}
    own = {**USUAL, "settle": sweep.settle, "hold": sweep.hold, "output": sweep.output, **said}
    own.setdefault("strobes", min(STROBES, own["hold"]) if picture == "bifurcation" else 0)
    own["direction"] = way_of(said.get("direction"), picture, axes, "starts" in said, sweep.direction)
    shown = (own["quantity"],) if picture == "values" else ()
    stored = {"stability": ORBITS, "verdict": (own["quantity"], *JUDGED)}.get(picture) or (
        *said.get("quantities", ("amplitude", "period")), *NEEDED[picture], *shown,
        *(("strobes",) if own["strobes"] else ()),
    )  # fmt: skip
    return MapPlan(name=name, axes=tuple(axes), picture=picture, **own | {"quantities": tuple(dict.fromkeys(stored))})


def way_of(said: str | None, picture: str, axes: Sequence[Any], starts: bool, swept: str | None) -> Any:
    """Way of the last of the ``axes``: as said, else apart where motions have starts of their own, else the sweep's."""
    if picture == "verdict" or said is not None:
        return said or "both"
    return "apart" if starts or any(axis.key in STARTS for axis in axes) else swept or "both"
