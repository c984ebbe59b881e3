"""Batch of motions of one system under many records, side by side in threads: the kernels hold no lock."""

from __future__ import annotations

from collections.abc import Sequence

from vibeam.flight.engine.threads import run_parallel
from vibeam.flight.record.solver import RecordSolver
from vibeam.flight.trajectory import Trajectory
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.record import Record
from vibeam.system.state import State
from vibeam_models.arguments import refuse


def simulate_records(
    system: ImpactSystem,
    records: Sequence[Record],
    t_end: float,
    states: Sequence[State | None] | None = None,
    *,
    t_start: float = 0.0,
    max_impacts: int = 10_000_000,
    certify: bool = False,
    workers: int | None = None,
) -> list[Trajectory]:
    """Motions of ``system`` under each of the ``records``, in their order; each as ``vibeam.simulate`` gives it.

    ``states``: where each starts (None: static equilibrium); ``workers``: threads (None: one for each processor).
    ValueError for another number of states than of records.

    >>> import vibeam
    >>> ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=1e-3, restitution=0.5)
    >>> pushes = [vibeam.Record.half_sine(peak, 0.01) for peak in (-10.0, -20.0)]
    >>> [len(path.impact_times) for path in vibeam.simulate_records(ball, pushes, 0.1)]
    [1, 1]
    """
    starts = [None] * len(records) if states is None else list(states)
    if len(starts) != len(records):
        refuse("simulate_records", [f"states: {len(starts)} of them, but {len(records)} records"])
    if not records:
        return []
    first = RecordSolver(system, records[0], t_start, t_end)

    def one(record: Record, state: State | None) -> Trajectory:
        return Trajectory(**first.sibling(record, t_start, t_end).fly(state, max_impacts, certify))

    pairs = list(zip(records, starts, strict=True))
    return run_parallel(lambda pair, _: one(*pair), pairs, workers)
