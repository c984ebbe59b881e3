"""A solver that a program brings itself, run from a case file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from stand_in import SDOF, curve

import vibeam
from vibeam.casefile.read import parse
from vibeam.solvers import SOLVERS
from vibeam.studies.cost.measure import settings_of


class Still:
    """Finds the same amplitude at every frequency."""

    def __init__(
        self, system: vibeam.ImpactSystem, slowest: float, span: float = 0.0, amplitude: float = 0.001
    ) -> None:
        self.system, self.amplitude = system, amplitude

    def steady(self, omegas: Any, amplitude: float, state: Any, settle: int, hold: int, output: str) -> Any:
        start = vibeam.State([0.0] * self.system.size, [0.0] * self.system.size)
        return curve(omegas / (2 * 3.141592653589793), [self.amplitude] * len(omegas)), start


@pytest.fixture
def still() -> Iterator[None]:
    options = {"low": {"amplitude": 0.001}, "high": {"amplitude": 0.002}}
    settings = vibeam.CostSettings(options=options)
    vibeam.register_solver(vibeam.SolverDeclaration("still", Still, stationary=True, settings=settings))
    yield
    SOLVERS.remove("still")


@pytest.mark.usefixtures("still")
def test_a_registered_solver_runs_from_a_case_file() -> None:
    result = vibeam.run(parse(SDOF, set={"fidelity.sdof.solver": "still", "fidelity.sdof.options": {"amplitude": 3.0}}))
    assert set(result["sdof"].up.amplitude) == {3.0}
    assert [setting.label for setting in settings_of("still", 1.0)] == ["still low", "still high"]


@pytest.mark.usefixtures("still")
def test_its_name_is_taken_and_its_options_are_known() -> None:
    with pytest.raises(ValueError, match="solver 'still' is declared already"):
        vibeam.register_solver(vibeam.SolverDeclaration("still", Still))
    with pytest.raises(vibeam.CaseError, match="'still' has no option speed: there are amplitude"):
        vibeam.run(parse(SDOF, set={"fidelity.sdof.solver": "still", "fidelity.sdof.options": {"speed": 3.0}}))


def test_without_it_a_case_that_names_it_is_refused() -> None:
    with pytest.raises(vibeam.CaseError, match="'still' is not one of"):
        parse(SDOF, set={"fidelity.sdof.solver": "still"})
