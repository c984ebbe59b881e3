"""Declarations of the solvers."""

from __future__ import annotations

from vibeam.solvers.declaration import CostSettings, SolverDeclaration

HOME = "vibeam.extensions.paper"
SOLVERS = (
    SolverDeclaration(
        "averaging",
        f"{HOME}.averaging:AveragingSolver",
        stationary=True,
        motion="samples",
        curves=True,
        gaps=f"{HOME}.averaging:gaps_per_drive",
        settings=CostSettings(options={"paper": {"damping": "paper"}, "log": {"damping": "log"}}),
        marker=("v", 5.0),
    ),
    SolverDeclaration("mapping", f"{HOME}.mapping:MappingSolver", stationary=True, marker=("X", 5.5)),
    SolverDeclaration(
        "zhuravlev",
        f"{HOME}.zhuravlev:ZhuravlevSolver",
        motion="samples",
        settings=CostSettings(methods=("RK23", "DOP853"), limit=200),
        marker=("<", 4.5),
    ),
    SolverDeclaration(
        "ivanov",
        f"{HOME}.ivanov:IvanovSolver",
        motion="samples",
        settings=CostSettings(methods=("RK23", "DOP853"), limit=20_000),
        marker=(">", 4.5),
    ),
)
