"""Random systems, a hundred impacts each, against arbitrary precision.

    python tests/hard/exhaustive.py --systems 10000 --processes 2

Prints what was missed, invented or wrong, and the worst errors. A system on which nothing returns within ``--patience``
seconds is a fault too; its process is ended and another one goes on. The truth of stiff systems is slow: after a
quarter of that time a system's motion is judged no further.
"""

from __future__ import annotations

import argparse
import multiprocessing as mp
import time
from multiprocessing.connection import Connection, wait

from agreement import Tally, follow
from random_systems import random_case


def work(options: argparse.Namespace, pipe: Connection) -> None:
    """Take numbers from the pipe, give tallies back, until None comes."""
    while (number := pipe.recv()) is not None:
        try:
            tally = follow(random_case(options.seed, number), options.impacts, options.each, options.patience / 4)
        except Exception as error:
            tally = Tally(faults=[f"{type(error).__name__}: {error}"])
        pipe.send(tally)


class Worker:
    """A process and the number that it is at."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.pipe, other = mp.Pipe()
        self.process = mp.Process(target=work, args=(options, other), daemon=True)
        self.process.start()
        self.number, self.since = -1, 0.0

    def give(self, number: int | None) -> None:
        self.number, self.since = (-1 if number is None else number), time.monotonic()
        self.pipe.send(number)


def run(options: argparse.Namespace) -> Tally:
    total, numbers = Tally(), iter(range(options.first, options.first + options.systems))
    workers = [Worker(options) for _ in range(options.processes)]
    for worker in workers:
        worker.give(next(numbers, None))
    done = 0
    while busy := [worker for worker in workers if worker.number >= 0]:
        ready = wait([worker.pipe for worker in busy], timeout=1.0)
        for worker in busy:
            if worker.pipe in ready:
                tally = worker.pipe.recv()
            elif time.monotonic() - worker.since > options.patience:
                tally = Tally(faults=["never ends"])
                worker.process.kill()
                fresh, number = Worker(options), worker.number
                workers[workers.index(worker)], worker = fresh, fresh
                worker.number = number
            else:
                continue
            for fault in tally.faults:
                print(f"seed {options.seed}, number {worker.number}: {fault}", flush=True)
            total.add(tally)
            done += 1
            if done % 25 == 0:
                print(f"{done} systems: {figures(total)}", flush=True)
            worker.give(next(numbers, None))
    return total


def figures(tally: Tally) -> str:
    shown = {name: value for name, value in vars(tally).items() if name != "faults"}
    return ", ".join(
        f"{name} {value:.2g}" if isinstance(value, float) else f"{name} {value}" for name, value in shown.items()
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    for name, default in {"systems": 10_000, "first": 0, "impacts": 100, "each": 8, "processes": 1, "seed": 4}.items():
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--patience", type=float, default=120.0)
    options = parser.parse_args()
    total = run(options)
    print(f"all: {figures(total)}, systems with a fault {len(total.faults)}")


if __name__ == "__main__":
    main()
