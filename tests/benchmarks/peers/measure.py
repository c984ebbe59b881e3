"""How the times are taken: flight and a peer in turn, a peer only as much of the sweep as patience allows."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from peers.cases import exact_velocities, system, true_impacts
from peers.job import Array, Entry, Impacts, Job
from vibeam.flight.kernels import layout
from vibeam.flight.solver import FlightSolver
from vibeam.system.state import State

NEAR = 0.02  # of the drive period: how far two impacts may be apart and still be the same one
OBSERVED = 50  # periods of 250 over which a sweep also takes extremes and modal energies
FEWEST_POINTS = 3
Row = dict[str, float | int | str]


@dataclass(frozen=True)
class Flight:
    """vibeam's own solver on the whole sweep, the state carried.

    A peer tells impacts and nothing else, so flight is asked for little more: the output's extremes over one period
    (``hold``). Over ``OBSERVED`` periods everything is read off.
    """

    solver: FlightSolver
    job: Job

    @classmethod
    def of(cls, job: Job) -> Flight:
        """Ready and compiled."""
        flight = cls(FlightSolver(system(job), float(job.grid.min())), job)
        flight.run()
        return flight

    def run(self, hold: int = 1) -> tuple[float, int, Array]:
        """CPU seconds, impacts, last impact velocity of each point."""
        start = State(self.job.starts[0, 0], self.job.starts[0, 1])
        begun = time.process_time()
        reading = layout.OUTPUT_ALONE if hold == 1 else layout.EVERYTHING
        response, _ = self.solver.steady(
            self.job.grid, self.job.amplitude, start, self.job.periods - hold, hold, "contact", reading
        )
        spent = time.process_time() - begun
        return spent, int(response.impacts.sum()), response.impact_velocities[:, -1]

    def cost(self, hold: int = 1) -> float:
        """CPU seconds an impact, once."""
        seconds, impacts, _ = self.run(hold)
        return seconds / impacts

    def row(self, name: str, costs: list[float], ratio: float) -> Row:
        """As ``peer_row``."""
        _, impacts, last = self.run()
        found: Row = {"name": name, "peer": "vibeam", "cost_us": 1e6 * float(np.median(costs))}
        found |= {"cost_least_us": 1e6 * min(costs), "ratio": ratio, "points": len(self.job.grid)}
        return found | {"periods": self.job.periods, "impacts": impacts} | errors(self.job, list(last))


def flight_rows(flight: Flight, costs: list[float], rounds: int) -> list[Row]:
    """Flight alone, its ``costs`` taken beside the peers'; and with what a sweep observes besides."""
    pairs = np.array([(flight.cost(), flight.cost(OBSERVED)) for _ in range(max(rounds, 3))])
    ratio = float(np.median(pairs[:, 1] / pairs[:, 0]))
    return [
        flight.row("vibeam flight", costs, 1.0),
        flight.row("vibeam flight, observed", list(pairs[:, 1]), ratio),
    ]


def peer_row(entry: Entry, job: Job, flight: Flight, rounds: int, patience: float) -> tuple[Row, list[float]]:
    """Costs an impact in µs (median and least), their ratio to flight's in the same round (median), errors, misses.

    And flight's costs.
    """
    part = sized(entry, job, patience)
    run = entry.prepare(part)
    costs, base = [], []
    for _ in range(rounds):
        base.append(flight.cost())
        seconds, found = run()
        costs.append(seconds / max(1, sum(len(point.times) for point in found)))
    base.append(flight.cost())
    around = (np.array(base[:-1]) + np.array(base[1:])) / 2
    row: Row = {"name": entry.name, "peer": entry.peer, "cost_us": 1e6 * float(np.median(costs))}
    row |= {"cost_least_us": 1e6 * min(costs), "ratio": float(np.median(np.array(costs) / around))}
    row |= {"ratio_of_least": min(costs) / min(base), "points": len(part.grid), "periods": part.periods}
    row |= {"impacts": sum(len(point.times) for point in found)}
    row |= {"failed_points": sum(bool(point.failed) for point in found)}
    last = [np.nan if point.failed or not len(point.velocities) else point.velocities[-1] for point in found]
    return row | errors(part, last) | misses(part, found), base


def sized(entry: Entry, job: Job, patience: float) -> Job:
    """As much of the job as takes about ``patience`` seconds of CPU, by a short trial.

    Fewer points first, then fewer periods; the other way round where points run side by side.
    """
    trial = job.part(len(job.grid), 2) if entry.wide else job.part(2, 4)
    seconds, found = entry.prepare(trial)()
    each = max(seconds / max(1, sum(len(point.times) for point in found)), 1e-9)
    room = patience / each  # impacts
    if entry.wide:
        return job.part(len(job.grid), int(np.clip(room / len(job.grid), 2, job.periods)))
    points = int(np.clip(room / job.periods, FEWEST_POINTS, len(job.grid)))
    return job.part(points, int(np.clip(room / points, 2, job.periods)))


def errors(job: Job, last: list[float]) -> Row:
    """Of the last impact velocities against the exact orbits."""
    wrong = np.abs(np.array(last) / exact_velocities(job) - 1)
    if np.all(np.isnan(wrong)):
        raise RuntimeError("not one point came to its end")
    return {"error_median": float(np.nanmedian(wrong)), "error_worst": float(np.nanmax(wrong))}


def misses(job: Job, found: list[Impacts]) -> Row:
    """Impacts of flight's without a counterpart (missed) and the other way round (invented), where it did not fail."""
    missed = invented = 0
    for omega, true, point in zip(job.grid, true_impacts(job), found, strict=True):
        if point.failed:
            continue
        period = 2 * np.pi / omega
        sure = job.periods * period * (1 - 1e-9) - NEAR * period  # an impact at the very end falls on either side
        missed += alone(true.times, point.times, NEAR * period, sure)
        invented += alone(point.times, true.times, NEAR * period, sure)
    return {"missed": missed, "invented": invented}


def alone(these: Array, those: Array, near: float, before: float) -> int:
    """How many of ``these`` have none of ``those`` nearby."""
    these = these[these < before]
    if not len(those):
        return len(these)
    right = np.clip(np.searchsorted(those, these), 0, len(those) - 1)
    left = np.clip(right - 1, 0, None)
    gap = np.minimum(np.abs(those[right] - these), np.abs(those[left] - these))
    return int(np.sum(gap > near))
