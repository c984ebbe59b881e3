"""vibeam: how much model does a vibro-impact beam need?

The public names, loaded when first used: ``import vibeam`` itself loads no scipy, matplotlib, numba or pint, nor
anything that the interpreter has not loaded before it runs a module.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType

TYPE_CHECKING = False  # known to type checkers by its name: importing ``typing`` takes longer than all else here

if TYPE_CHECKING:
    from vibeam import observe as observe
    from vibeam.batch.batch import batch as batch
    from vibeam.batch.response import BatchResponse as BatchResponse
    from vibeam.case.case import Case as Case
    from vibeam.case.faults import CaseError as CaseError
    from vibeam.case.reference_curves import read_curve as read_curve
    from vibeam.case.reference_files import ReferenceForm as ReferenceForm
    from vibeam.case.reference_record import ReferenceCurve as ReferenceCurve
    from vibeam.casefile.read import load as load
    from vibeam.casefile.registration import register_effect as register_effect
    from vibeam.casefile.registration import register_law as register_law
    from vibeam.figures import register_figure as register_figure
    from vibeam.figures.declaration import FigureKind as FigureKind
    from vibeam.flight.trajectory import Outcome as Outcome
    from vibeam.flight.trajectory import Trajectory as Trajectory
    from vibeam.flight.trajectory import simulate as simulate
    from vibeam.maps.evaluate import GridResponse as GridResponse
    from vibeam.maps.evaluate import evaluate as evaluate
    from vibeam.maps.points import Starts as Starts
    from vibeam.maps.run import MapResult as MapResult
    from vibeam.maps.run import run_map as run_map
    from vibeam.orbits.bifurcation_functions import Kind as Kind
    from vibeam.orbits.boundaries import boundaries as boundaries
    from vibeam.orbits.continuation import follow as follow
    from vibeam.orbits.lyapunov import LyapunovSpectrum as LyapunovSpectrum
    from vibeam.orbits.lyapunov import lyapunov as lyapunov
    from vibeam.orbits.orbit import Orbit as Orbit
    from vibeam.orbits.orbit import orbits as orbits
    from vibeam.orbits.orbit_curve import orbit_curve as orbit_curve
    from vibeam.orbits.orbit_map import orbit_map as orbit_map
    from vibeam.orbits.train_boundaries import train_boundaries as train_boundaries
    from vibeam.orbits.train_orbits import settled_orbit as settled_orbit
    from vibeam.orbits.train_orbits import train_orbit as train_orbit
    from vibeam.report.figures import plot as plot
    from vibeam.run.estimate.error import estimate_error as estimate_error
    from vibeam.run.result import Result as Result
    from vibeam.run.run import run as run
    from vibeam.run.store.errors import StoreError as StoreError
    from vibeam.run.sweep import sweep as sweep
    from vibeam.solvers import register_solver as register_solver
    from vibeam.solvers.declaration import CostSettings as CostSettings
    from vibeam.solvers.declaration import SolverDeclaration as SolverDeclaration
    from vibeam.solvers.several_harmonics import Harmonic as Harmonic
    from vibeam.solvers.several_harmonics import SeveralHarmonics as SeveralHarmonics
    from vibeam.studies.cost.study import cost as cost
    from vibeam.studies.declaration import StudyDeclaration as StudyDeclaration
    from vibeam.studies.declaration import register_study as register_study
    from vibeam.studies.derive import derive as derive
    from vibeam.studies.export_matrices import export_matrices as export_matrices
    from vibeam.studies.fit.study import fit as fit
    from vibeam.studies.identification.decay import identify_decay as identify_decay
    from vibeam.studies.identification.modes import identify_keys as identify_keys
    from vibeam.studies.identification.response import identify_response as identify_response
    from vibeam.studies.identification.response import identify_spectrum as identify_spectrum
    from vibeam.studies.influence.study import influence as influence
    from vibeam.studies.limit.study import limit as limit
    from vibeam.studies.modes import modes as modes
    from vibeam.studies.reduce.study import reduce as reduce
    from vibeam.studies.regression.check import check as check
    from vibeam.studies.regression.check import compare_measured as compare_measured
    from vibeam.studies.stability.study import stability as stability
    from vibeam.studies.stored import read as read
    from vibeam.studies.uncertainty.study import uncertainty as uncertainty
    from vibeam.studies.verdict.study import Verdict as Verdict
    from vibeam.studies.verdict.study import verdict as verdict
    from vibeam.system.contact import Contact as Contact
    from vibeam.system.impact_system import Drive as Drive
    from vibeam.system.impact_system import ImpactSystem as ImpactSystem
    from vibeam.system.response import Branches as Branches
    from vibeam.system.response import Ended as Ended
    from vibeam.system.response import FrequencyResponse as FrequencyResponse
    from vibeam.system.state import State as State
    from vibeam.system.time_derivative import TimeDerivative as TimeDerivative
    from vibeam_models.structure import Structure as Structure
    from vibeam_reductions.craig_bampton import craig_bampton as craig_bampton
    from vibeam_reductions.declaration import ReductionDeclaration as ReductionDeclaration
    from vibeam_reductions.declaration import register_reduction as register_reduction
    from vibeam_reductions.krylov import krylov as krylov
    from vibeam_reductions.massless_boundary import massless_boundary as massless_boundary
    from vibeam_reductions.modal import modal as modal
    from vibeam_reductions.residual_flexibility import residual_flexibility as residual_flexibility
    from vibeam_reductions.static_correction import static_correction as static_correction
    from vibeam_reductions.static_shapes import static_shapes as static_shapes

__version__ = "0.1.0"

_HOMES = {
    "load": "vibeam.casefile.read",
    "register_effect": "vibeam.casefile.registration",
    "register_law": "vibeam.casefile.registration",
    "run": "vibeam.run.run",
    "derive": "vibeam.studies.derive",
    "ImpactSystem": "vibeam.system.impact_system",
    "Contact": "vibeam.system.contact",
    "Drive": "vibeam.system.impact_system",
    "State": "vibeam.system.state",
    "TimeDerivative": "vibeam.system.time_derivative",
    "simulate": "vibeam.flight.trajectory",
    "evaluate": "vibeam.maps.evaluate",
    "GridResponse": "vibeam.maps.evaluate",
    "MapResult": "vibeam.maps.run",
    "run_map": "vibeam.maps.run",
    "Starts": "vibeam.maps.points",
    "sweep": "vibeam.run.sweep",
    "batch": "vibeam.batch.batch",
    "BatchResponse": "vibeam.batch.response",
    "orbits": "vibeam.orbits.orbit",
    "Orbit": "vibeam.orbits.orbit",
    "lyapunov": "vibeam.orbits.lyapunov",
    "LyapunovSpectrum": "vibeam.orbits.lyapunov",
    "orbit_curve": "vibeam.orbits.orbit_curve",
    "boundaries": "vibeam.orbits.boundaries",
    "orbit_map": "vibeam.orbits.orbit_map",
    "stability": "vibeam.studies.stability.study",
    "read": "vibeam.studies.stored",
    "uncertainty": "vibeam.studies.uncertainty.study",
    "fit": "vibeam.studies.fit.study",
    "influence": "vibeam.studies.influence.study",
    "verdict": "vibeam.studies.verdict.study",
    "Verdict": "vibeam.studies.verdict.study",
    "Kind": "vibeam.orbits.bifurcation_functions",
    "follow": "vibeam.orbits.continuation",
    "settled_orbit": "vibeam.orbits.train_orbits",
    "train_orbit": "vibeam.orbits.train_orbits",
    "train_boundaries": "vibeam.orbits.train_boundaries",
    "Ended": "vibeam.system.response",
    "Outcome": "vibeam.flight.trajectory",
    "FrequencyResponse": "vibeam.system.response",
    "cost": "vibeam.studies.cost.study",
    "identify_decay": "vibeam.studies.identification.decay",
    "identify_spectrum": "vibeam.studies.identification.response",
    "identify_response": "vibeam.studies.identification.response",
    "identify_keys": "vibeam.studies.identification.modes",
    "limit": "vibeam.studies.limit.study",
    "estimate_error": "vibeam.run.estimate.error",
    "ReferenceCurve": "vibeam.case.reference_record",
    "ReferenceForm": "vibeam.case.reference_files",
    "read_curve": "vibeam.case.reference_curves",
    "check": "vibeam.studies.regression.check",
    "compare_measured": "vibeam.studies.regression.check",
    "modes": "vibeam.studies.modes",
    "reduce": "vibeam.studies.reduce.study",
    "export_matrices": "vibeam.studies.export_matrices",
    "plot": "vibeam.report.figures",
    "Case": "vibeam.case.case",
    "CaseError": "vibeam.case.faults",
    "StoreError": "vibeam.run.store.errors",
    "Result": "vibeam.run.result",
    "Branches": "vibeam.system.response",
    "Trajectory": "vibeam.flight.trajectory",
    "Structure": "vibeam_models.structure",
    "modal": "vibeam_reductions.modal",
    "craig_bampton": "vibeam_reductions.craig_bampton",
    "krylov": "vibeam_reductions.krylov",
    "massless_boundary": "vibeam_reductions.massless_boundary",
    "residual_flexibility": "vibeam_reductions.residual_flexibility",
    "static_correction": "vibeam_reductions.static_correction",
    "static_shapes": "vibeam_reductions.static_shapes",
    "CostSettings": "vibeam.solvers.declaration",
    "FigureKind": "vibeam.figures.declaration",
    "register_figure": "vibeam.figures",
    "SolverDeclaration": "vibeam.solvers.declaration",
    "register_solver": "vibeam.solvers",
    "Harmonic": "vibeam.solvers.several_harmonics",
    "SeveralHarmonics": "vibeam.solvers.several_harmonics",
    "StudyDeclaration": "vibeam.studies.declaration",
    "register_study": "vibeam.studies.declaration",
    "ReductionDeclaration": "vibeam_reductions.declaration",
    "register_reduction": "vibeam_reductions.declaration",
}
_OF_A_CASE = (
    *("run", "modes", "cost", "fit", "limit", "stability", "uncertainty", "influence", "verdict", "reduce", "derive"),
    *("check", "compare_measured", "identify_keys", "evaluate", "run_map"),
)  # which take the case's file, or its tables, as well

_MODULES = ("observe",)  # handed on whole
__all__ = sorted((*_HOMES, *_MODULES, "__version__"))


class _House(ModuleType):
    """A package in which ``vibeam.sweep`` stays the function, though importing it brings a module of that name."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> object:
        if name in _MODULES:
            return import_module(f"vibeam.{name}")
        if name not in _HOMES:
            raise AttributeError(f"module 'vibeam' has no attribute {name!r}")
        value = getattr(import_module(_HOMES[name]), name)
        if name in _OF_A_CASE:
            value = import_module("vibeam.casefile.by_file").loading(value, __name__)
        setattr(self, name, value)
        return value

    def __dir__(self) -> list[str]:
        return __all__


sys.modules[__name__].__class__ = _House
