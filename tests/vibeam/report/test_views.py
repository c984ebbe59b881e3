"""Views in a notebook, and tables and data sets for pandas and xarray."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.report.views import SHEETS, UNITS
from vibeam.system.labelled import Viewed
from vibeam_models.registry import loaded

CASE = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
SHORT = {"sweep.frequency.points": 3, "sweep.settle": 5, "sweep.hold": 4, "title": "a <b> & c"}
AXES = {"stop.gap": [0.0, 1e-4], "sweep.frequency": [14.0, 15.0, 16.0]}


def case(**more: Any) -> vibeam.Case:
    return vibeam.load(CASE, set=SHORT | more)


def orbit() -> Any:
    system = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72)
    return vibeam.orbits(system, vibeam.Drive(95.0, 1e-4))[0]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    own, known = case(), dict[str, Any]()
    makers: dict[str, Callable[[], Any]] = {
        "Case": case, "Result": lambda: vibeam.run(own, show=False), "ModeTable": lambda: vibeam.modes(own, 3),
        "Branches": lambda: of("Result")["beam"], "FrequencyResponse": lambda: of("Result")["beam"].up,
        "DerivedTable": lambda: vibeam.derive(own), "Orbit": orbit,
        "Verdict": lambda: vibeam.verdict(case(**{"modes_needed.most": 3}), only=["modes", "effects"]),
        "Stability": lambda: vibeam.stability(own, points=3, frequencies=5, fidelities=["sdof"]),
        "GridResponse": lambda: vibeam.evaluate(own, "sdof", AXES, direction="both"),
        "MapResult": lambda: vibeam.run_map(mapped(), "m", tmp_path_factory.mktemp("map") / "m.h5"),
    }  # fmt: skip

    def of(kind: str) -> Any:
        if kind not in known:
            known[kind] = makers[kind]()
        return known[kind]

    return of


def mapped() -> vibeam.Case:
    axes = {"stop.gap": ["0 mm", "0.1 mm"], "sweep.frequency": ["14 Hz", "15 Hz", "16 Hz"]}
    return case(**{"map.m.axes": [{"key": key, "values": each} for key, each in axes.items()]})


class Words(HTMLParser):
    """Elements and texts of a piece of HTML; it must be closed everywhere."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attributes: Any) -> None:
        self.tags.append(tag)
        self.open += [] if tag in ("img", "progress") else [tag]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, text: str) -> None:
        self.texts.append(text.strip())


VIEWED = {
    "Case": ("two_modes", True), "Result": ("two_modes", True), "ModeTable": ("7.597", True),
    "DerivedTable": ("stiffness", False), "Orbit": ("Stable motion with one impact in 1 drive period.", True),
    "Branches": ("Branches", True), "FrequencyResponse": ("Frequency response", True), "Stability": ("Stability", True),
    "GridResponse": ("stop.gap", True), "MapResult": ("not periodic", True), "Verdict": ("How many modes?", False),
}  # fmt: skip


@pytest.mark.parametrize("kind", VIEWED)
def test_a_notebook_shows_answer_table_and_figure(made: Callable[[str], Any], kind: str) -> None:
    record, (word, drawn) = made(kind), VIEWED[kind]
    text = record._repr_html_()
    words = Words(text)
    assert any(word in each for each in words.texts) or kind == "Stability"
    assert ("img" in words.tags) == drawn
    assert not re.search(r"<script|https?://(?!www\.w3\.org)|<b> &", text)
    assert len(text) < 300_000
    assert len(repr(record)) < 900


def test_every_record_with_a_view_is_one() -> None:
    """A name in the table of views without its mixin has a sheet that no notebook shows."""
    named = {name: getattr(place, name) for place in (vibeam, vibeam.studies) for name in dir(place)}
    classes = {name: named[name] for name in SHEETS if isinstance(named.get(name), type)}
    assert {"Result", "FidelityMap", "Verdict"} < classes.keys()
    assert [name for name, each in classes.items() if not issubclass(each, Viewed)] == []


@pytest.mark.parametrize("kind", [kind for kind, (_, drawn) in VIEWED.items() if drawn and kind != "Case"])
def test_a_notebook_shows_what_is_plotted_without_a_backend(made: Callable[[str], Any], kind: str) -> None:
    image = made(kind).plot()._repr_png_()
    assert image[:8] == b"\x89PNG\r\n\x1a\n"
    assert 5_000 < len(image) < 400_000


def test_a_stop_that_yields_has_no_coefficient() -> None:
    text = vibeam.load(CASE.parent / "rigs" / "tube.toml")._repr_html_()
    assert "nan" not in Words(text).texts


def test_a_stored_map_of_models_is_shown_without_a_flight(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    axes = [{"key": "stop.gap", "values": ["0 mm", "0.1 mm"]}, {"key": "sweep.frequency", "values": ["14 Hz", "15 Hz"]}]
    own = case(**{"map.m": {"axes": axes, "picture": "verdict", "fidelities": ["sdof", "two_modes"]}})
    stored = vibeam.run_map(own, "m", tmp_path / "m.h5")
    for module, name in (("evaluate", "evaluate_block"), ("run", "evaluate_here")):
        monkeypatch.setattr(import_module(f"vibeam.maps.{module}"), name, lambda *_, **__: pytest.fail("simulated"))
    text = stored._repr_html_()
    assert "two_modes is needed" in text
    assert "<img" in text


def test_every_view_is_of_a_function_that_is_there() -> None:
    assert all(callable(loaded(place)) for place in SHEETS.values())
    assert set(UNITS) < set(SHEETS)


def test_a_case_that_cannot_be_run_is_shown_with_its_faults() -> None:
    text = case(**{"fidelity.beam.solver": "averaging"})._repr_html_()
    assert "This case cannot be run" in text
    assert "fidelity.beam" in text


def test_tables_are_tidy(made: Callable[[str], Any]) -> None:
    modes, derived = made("ModeTable"), made("DerivedTable")
    frame = modes.to_dataframe()
    assert frame["frequency"].tolist() == [row.frequency for row in modes.rows]
    assert frame.attrs["units"] == {"frequency": "Hz", "contact": "kg^-½", "sensor": "kg^-½", "load": "kg^½"}
    assert derived.to_dataframe().set_index("name")["value"]["stiffness"] == derived["stiffness"].value
    found = made("Stability").to_dataframe()
    assert set(found["fidelity"]) == {"sdof"}


@pytest.mark.parametrize("kind", ["GridResponse", "MapResult"])
def test_grids_are_tidy_tables_and_data_sets(made: Callable[[str], Any], kind: str) -> None:
    record = made(kind)
    grid = record if kind == "GridResponse" else record["beam"]
    frame, data = record.to_dataframe(), record.to_xarray()
    ways, name = grid.ways, grid.fidelity
    assert len(frame) == (len(record.responses) if kind == "MapResult" else 1) * len(ways) * 6
    some = frame[(frame["fidelity"] == name) & (frame["direction"] == ways[-1]) & (frame["stop.gap"] == 1e-4)]
    assert some["amplitude"].tolist() == grid.way(ways[-1])["amplitude"][1].tolist()
    assert set(frame["ended"]) == {"COMPLETE"}
    wanted = {"stop.gap": "m", "sweep.frequency": "Hz", "amplitude": "m"}
    assert wanted.items() <= frame.attrs["units"].items()
    at = {"direction": ways[-1], "stop.gap": 1e-4, "sweep.frequency": 15.0}
    chosen = data.sel(at | {"fidelity": name})
    assert float(chosen.amplitude) == some["amplitude"].tolist()[1]
    assert {key: data[key].attrs["units"] for key in wanted} == wanted
    assert data.amplitude.attrs["long_name"] == "amplitude of the output, ½(max − min)"
    case = vibeam.load(CASE, set=SHORT) if kind == "GridResponse" else record.case
    for attributes in (data.attrs, frame.attrs):
        assert (attributes["title"], attributes["case_key"]) == (case.title, case.key)
        assert attributes["vibeam_version"] == vibeam.__version__


def test_random_starts_and_strobes_are_dimensions_of_their_own() -> None:
    found = vibeam.evaluate(
        case(), "sdof", {"sweep.frequency": [14.0, 15.0]}, direction="apart", starts=vibeam.Starts(4, 1, 1e-3),
        quantities=("amplitude", "strobes"), strobes=3,
    )  # fmt: skip
    data, frame = found.to_xarray(), found.to_dataframe()
    assert dict(data.sizes) == {"fidelity": 1, "direction": 1, "sweep.frequency": 2, "start": 4, "strobe": 3}
    assert len(frame) == 8
    np.testing.assert_array_equal(frame["strobes_3"], found["strobes"][..., 2].ravel())


def test_results_say_what_they_are_of(made: Callable[[str], Any]) -> None:
    result = made("Result")
    data, frame = result.to_xarray(), result.to_dataframe()
    for attributes in (data.attrs, frame.attrs):
        assert {key: attributes[key] for key in ("title", "source", "case_key")} == result.case.about
        assert attributes["numpy_version"] == np.__version__
    assert all({"long_name", "units"} <= set(each.attrs) for each in data.data_vars.values())
    assert data.to_netcdf() is not None


def test_a_batch_is_a_table_over_its_shape() -> None:
    system = orbit().system
    found = vibeam.batch(system, [[90.0, 95.0, 100.0]], 1e-4, settle=3, hold=2)
    frame, data = found.to_dataframe(), found.to_xarray()
    assert (len(frame), dict(data.sizes)["axis_2"]) == (3, 3)
    np.testing.assert_array_equal(frame["reach"], found.reach[0])
    assert data.lyapunov.attrs["units"] == "s-1"
    one = vibeam.batch(system, 95.0, 1e-4, settle=3, hold=2)
    assert one.to_dataframe()["amplitude"].tolist() == [float(one.amplitude)]


@pytest.mark.parametrize(("package", "method"), [("xarray", "to_xarray"), ("pandas", "to_dataframe")])
@pytest.mark.parametrize("kind", ["GridResponse", "Result", "ModeTable"])
def test_a_missing_package_is_named(
    made: Callable[[str], Any], kind: str, package: str, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = made(kind)
    if (kind, package) == ("ModeTable", "xarray"):
        pytest.skip("a table of modes is no data set")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=f"{method} needs the package {package}: pip install {package}"):
        getattr(record, method)()


def test_a_record_is_plotted_as_a_notebook_shows_it(made: Callable[[str], Any], tmp_path: Path) -> None:
    figure = orbit().plot(tmp_path / "orbit.svg")
    assert figure.axes[0].get_xlabel() == "time (drive periods)"
    assert (tmp_path / "orbit.svg").exists()
    twisted = replace(made("ModeTable"), shapes=np.zeros_like(made("ModeTable").shapes))
    assert not twisted.plot().axes[0].lines[0].get_ydata().any()
    with pytest.raises(ValueError, match="a DerivedTable has no figure"):
        made("DerivedTable").plot()


def test_an_orbit_through_the_stop_is_no_motion() -> None:
    through = replace(orbit(), admissible=False)
    assert "which passes through the stop between: no motion" in through._repr_html_()
