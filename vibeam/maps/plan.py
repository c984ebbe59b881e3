"""Plan of a map that no table of the case says: a picture over frequency and another key, as options ask for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from vibeam.case.grid_keys import FREQUENCY, PICTURES, READ, AxisPlan, MapPlan, is_structural, planned
from vibeam.casefile.quantities import RATIO, UnitError, to_si
from vibeam.casefile.tables.maps import OF_PICTURE
from vibeam.exchange.faults import suggest
from vibeam.maps.axes import axes_over, points_of
from vibeam.maps.models import models_of, usual_points

if TYPE_CHECKING:
    from vibeam.case.case import Case

POINTS = {"bifurcation": (201,)}  # usual numbers of values of each axis
USUAL = (61,)
COMPARED = ("amplitude", "reach")  # quantities of a fidelity map
SHARES = ("accuracy", "frequency_accuracy")


def plan_over(
    case: Case,
    picture: str = "period",
    over: str | None = None,
    low: str | float | None = None,
    high: str | float | None = None,
    points: Sequence[int] | None = None,
    *,
    fidelities: Sequence[str] | None = None,
    **given: Any,
) -> MapPlan:
    """Plan of a map named by its ``picture``; None: as is usual for it.

    ``over``, ``low``, ``high``, ``points``: as in ``axes_over``. ``given``: quantity, periods, accuracy and
    frequency_accuracy. ValueError names the option; errors of models as in ``models_of``.
    """
    if picture not in PICTURES:
        raise ValueError(f"--picture: {picture!r}: {suggest(picture, PICTURES)}")
    if picture == "basins":
        raise ValueError(
            "--picture basins: its starts have keys of their own: write a table [map.NAME] (vibeam keys map)"
        )
    shares = {name: _share(name, given.get(name)) for name in SHARES}
    said = {name: value for name, value in {**given, **shares}.items() if value is not None}
    _require_fitting(picture, said)
    names = tuple(fidelities or ())
    plane = picture != "bifurcation"  # which is of one axis
    axis = AxisPlan(FREQUENCY, tuple(case.sweep.frequency.tolist()), "Hz")  # models are the same of any plane
    models = models_of(case, planned(picture, (axis, axis), case.sweep, picture, fidelities=names)).names
    words = over or ("gap" if plane else "frequency")
    usual: Sequence[int] = POINTS.get(picture, USUAL)
    if picture == "stability":
        usual = points_of(words, *usual_points(case.system(name) for name in models))
    axes = axes_over(case, words, low, high, points or usual, models[0], plane)
    if axes[-1].key != FREQUENCY and len(case.sweep.frequency) > 1:
        raise ValueError(f"--over {words}: at one frequency: --set 'sweep.frequency=[\"15.3 Hz\"]'")
    direction = "apart" if is_structural(axes[-1].key) else None
    return planned(picture, axes, case.sweep, picture, fidelities=names, direction=direction, **said)


def _require_fitting(picture: str, said: dict[str, Any]) -> None:
    for name in said:
        if picture not in OF_PICTURE[name]:
            raise ValueError(f"--{name}: goes with --picture {' or '.join(OF_PICTURE[name])}")
    known = COMPARED if picture == "verdict" else READ
    if said.get("quantity", known[0]) not in known:
        raise ValueError(f"--quantity: {said['quantity']!r} is none of {', '.join(known)}")


def _share(name: str, given: str | float | None) -> float | None:
    try:
        share = None if given is None else float(to_si(given, RATIO))
    except UnitError as fault:
        raise ValueError(f"--{name.replace('_', '-')}: {fault}") from None
    if share is not None and not 0 < share < 1:
        raise ValueError(f"--{name.replace('_', '-')}: must lie between 0 and 100 %, not {given}: write '5 %' or 0.05")
    return share
