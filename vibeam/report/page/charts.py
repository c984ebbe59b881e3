"""Numbers of the page's charts: curves over frequency, participation."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.case.beam_field import held_at_zero, stations
from vibeam.exchange.faults import CaseError
from vibeam.figures.panels import NOT_FROM_ZERO, SLIGHT, TOP
from vibeam.figures.response_curve import grazing_heights
from vibeam.figures.style import COLOURS, DASH, DOT, LINES, looks_of, name_of
from vibeam.figures.units import DisplayUnits, units_for
from vibeam.observe.branches import MotionClass, pieces
from vibeam.report.page.parts import colours_on_page, look_on_page
from vibeam.studies.regression.references import COVERAGE
from vibeam.system.response import Ended, FrequencyResponse, complete
from vibeam_models.arrays import Array
from vibeam_models.outputs import DISPLACEMENT

if TYPE_CHECKING:
    from vibeam.case.plans import MeasuredNumber, Reference
    from vibeam.runs.result import Result
    from vibeam.runs.stored_result import StoredResult


STEPS = 65535  # of an array's range


def rounded(values: ArrayLike, digits: int = 6) -> list[float | None]:
    """Numbers with so many significant digits; None for what is not finite."""
    return [float(f"{each:.{digits}g}") if np.isfinite(each) else None for each in np.ravel(np.asarray(values, float))]


def packed(values: ArrayLike) -> dict[str, Any]:
    """An array of finite numbers in steps of 1/65535 of its range: value = low + step · integer."""
    flat: NDArray[np.float64] = np.ravel(np.asarray(values, dtype=float))
    low = float(flat.min(initial=np.inf)) if len(flat) else 0.0
    step = (float(flat.max()) - low) / STEPS if len(flat) else 0.0
    whole = np.rint((flat - low) / step if step > 0 else 0 * flat).astype("<u2")
    return {"low": low, "step": step, "data": b64encode(whole.tobytes()).decode()}


@dataclass(frozen=True)
class ChartQuantity:
    """A quantity that may be drawn over frequency, with the factor to its unit."""

    name: str
    label: str
    unit: str
    factor: float


def chart_quantities(units: DisplayUnits) -> list[ChartQuantity]:
    """Quantities of the chart over frequency, the amplitude first."""
    length = units.length, units.length_factor
    contact = length if units.quantity == DISPLACEMENT.name else ("mm", 1e3)
    return [
        ChartQuantity("amplitude", "Amplitude ½(max − min) of the output", *length),
        ChartQuantity("maximum", "Maximum of the output", *length),
        ChartQuantity("minimum", "Minimum of the output", *length),
        ChartQuantity("reach", "Largest distance of the contact from its stop", *contact),
        ChartQuantity("impact_velocity", "Mean velocity before impact", *_contact_speed(units)),
        ChartQuantity("impacts_per_period", "Impacts a drive period", "", 1.0),
        ChartQuantity("period", "Period of the motion in drive periods (0: does not repeat, −1: no contact)", "", 1.0),
        ChartQuantity("rest", "Share of the time at rest on the stop", "", 1.0),
    ]


def _contact_speed(units: DisplayUnits) -> tuple[str, float]:
    """Unit of the contact's velocity, which is no output, and the factor to it."""
    return ("mm/s", 1e3) if units.frequency else ("", units.speed_factor)


def chart_data(stored: StoredResult) -> dict[str, Any]:
    """All numbers of the page's charts, as plain lists."""
    result, units = stored.result, units_for(stored.result)
    quantities = chart_quantities(units)
    return {
        "frequency": {"unit": units.frequency, "factor": units.frequency_factor},
        "output": {"unit": units.length, "factor": units.length_factor, "name": result.case.sweep.output},
        "speed": {"unit": units.speed, "factor": units.speed_factor},
        "quantities": [asdict(each) for each in quantities],
        "contact_speed": dict(zip(("unit", "factor"), _contact_speed(units), strict=True)),
        "palette": [colours_on_page(each) for each in (*COLOURS, "#5E35B1", "#B3261E")],
        "kinds": [_kind(each) for each in MotionClass],
        "upward": {"top": TOP, "slight": SLIGHT, "note": NOT_FROM_ZERO},
        "fidelities": _fidelities(result),
        "curves": [
            _curve(name, way, response, quantities)
            for name, branches in result.items()
            for way, response in branches.items()
        ],
        "references": list(_references(result)),
    }


def _fidelities(result: Result) -> list[dict[str, Any]]:
    case, references = result.case, set(result.finest.values())
    looks, heights = looks_of(case, result), dict(grazing_heights(result))
    return [
        {
            "name": name,
            "label": name_of(case, name),
            **look_on_page(looks[name]),
            "grazing": heights.get(name),
            "reference": name in references,
            "places": [0.0, *stations(case, name).values()] if name in case.fidelities else [],
            "held": name in case.fidelities and held_at_zero(case, name),
        }
        for name in result
    ]


def _kind(kind: MotionClass) -> dict[str, Any]:
    """Style of a class of motion: that of the figures. ``alone``: of a point that no line joins to another."""
    keys, alone = LINES[kind], DASH if kind is MotionClass.NO_CONTACT else DOT
    style = keys.get("linestyle", "-")
    return {
        "name": kind.value,
        "width": keys.get("linewidth", 1.0) if style else 0.0,
        "dash": list(style[1]) if isinstance(style, tuple) else [],
        "marker": keys.get("marker", ""),
        "alone": alone["marker"],
        "size": keys.get("markersize", alone["markersize"]),
    }


def chart_pieces(response: FrequencyResponse, values: dict[str, Array]) -> dict[str, list[list[int]]]:
    """Pieces of every quantity as figures draw them: class, begin and end; those of the amplitude are said once."""
    kinds = list(MotionClass)
    found = {
        name: [[kinds.index(each.kind), each.points.start, each.points.stop] for each in pieces(response, each_values)]
        for name, each_values in values.items()
    }
    return {name: own for name, own in found.items() if name == "amplitude" or own != found["amplitude"]}


def _curve(name: str, way: str, response: FrequencyResponse, quantities: list[ChartQuantity]) -> dict[str, Any]:
    done = complete(response)
    values = {each.name: np.where(done, getattr(response, each.name) * each.factor, np.nan) for each in quantities}
    energy = response.mode_energy
    total = np.nansum(energy, axis=1, keepdims=True)
    shares = np.divide(energy, total, out=np.full_like(energy, np.nan), where=total > 0)[:, :8]
    return {
        "fidelity": name,
        "way": way,
        "frequency": rounded(response.frequency),
        "values": {key: rounded(value) for key, value in values.items()},
        "pieces": chart_pieces(response, values),
        "ended": {str(i): Ended.of_code(int(response.ended[i])).value for i in np.flatnonzero(~done)},
        "shares": [rounded(column, 4) for column in shares.T],
    }


def _references(result: Result) -> Iterator[dict[str, Any]]:
    """Curves of references; measured numbers at a frequency, and peaks whose frequency was measured as well."""
    for reference in result.case.references.values():
        try:
            points = [each for each in reference.points() if each.value is not None]
        except CaseError:
            continue
        rows = [(each.frequency, each.value or 0.0, COVERAGE * (each.uncertainty or 0.0)) for each in points]
        yield _marks(reference, reference.quantity, rows, single=False)
    numbers = [each for each in result.case.measured.values() if each.against is None and each.show is None]
    peaks = {each.fidelity: each.value for each in numbers if each.quantity == "peak_frequency"}
    for each in numbers:
        at = peaks.get(each.fidelity) if each.quantity == "peak" else each.frequency
        if at is not None and each.fidelity in result:
            quantity = "amplitude" if each.quantity == "peak" else each.quantity
            yield _marks(each, quantity, [(at, each.value, each.uncertainty or 0.0)], single=True)


def _marks(
    of: Reference | MeasuredNumber, quantity: str, rows: Sequence[tuple[float, float, float]], single: bool
) -> dict[str, Any]:
    """Marks over the curves of a quantity, each (Hz, value, half of its bar)."""
    columns = zip(("frequency", "value", "bar"), np.reshape(rows, (-1, 3)).T, strict=True)
    head = {"name": of.name, "fidelity": of.fidelity, "quantity": quantity, "single": single}
    return head | {name: rounded(column) for name, column in columns}
