"""Other people's solvers on the same impacts: cost an impact, error, impacts missed, flight and each peer in turn.

    pip install -e '.[peers]'                             # and Debian's python3-siconos
    python tests/benchmarks/against_peers.py              # both sweeps, about half an hour
    python tests/benchmarks/against_peers.py --only sdof  # or modes-8: the other sections of the results are kept

Writes results/peers.json and results/peers.png beside itself. The nominal SDOF sweep (β = 0.015, B = 0.5e-3, R = 0.9,
Δ = 0, Ω = 1.5 … 2.5, 250 periods a point, state carried), and the DTU rig's first 1 … 32 modes (14 … 17 Hz) from their
settled motion. Costs are CPU time of all threads, compilation apart; errors are those of the last impact
velocity against the exact one-impact orbit. What is slow runs a part of the sweep only (``points`` and ``periods``).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from peers import entries
from peers.cases import nominal, rig
from peers.job import Entry, Job
from peers.measure import Flight, Row, flight_rows, peer_row

RESULTS = Path(__file__).with_name("results")
MODES = (1, 2, 4, 8, 16, 32)
HOPELESS = 0.5  # CPU seconds an impact: a peer above it is not tried with more modes


def main() -> None:
    """Measure, print, write."""
    arguments = parse()
    found, absent = entries()
    found = [entry for entry in found if arguments.peer in entry.name]
    for name, reason in absent.items():
        print(f"without {name}: {reason}")
    target = arguments.out / "peers.json"
    results = json.loads(target.read_text()) if target.exists() else {}
    slow: set[str] = set()
    for section in arguments.only or ["sdof", *(f"modes-{n}" for n in MODES)]:
        job = nominal() if section == "sdof" else rig(int(section.split("-")[1]))
        results[section] = measured(section, job, found, slow, arguments.rounds, arguments.patience)
        arguments.out.mkdir(exist_ok=True)
        target.write_text(json.dumps(results, indent=1) + "\n")
    from peers.picture import draw

    draw(results, arguments.out / "peers.png")


def measured(
    section: str, job: Job, peers: list[Entry], slow: set[str], rounds: int, patience: float
) -> dict[str, object]:
    """One section of the results, printed as it comes."""
    print(
        f"\n{section}\n{'':34}{'µs each':>12}{'ratio':>10}{'median error':>14}{'worst':>9}{'missed':>8}{'invented':>9}"
    )
    begun, flight = os.getloadavg(), Flight.of(job)
    rows: list[Row] = []
    costs = [flight.cost() for _ in range(rounds)]
    for entry in peers:
        if not entry.fewest_modes <= job.size <= entry.most_modes or entry.name in slow:
            continue
        try:
            row, beside = peer_row(entry, job, flight, rounds, patience)
        except Exception as error:  # a peer that fails is a row that says so
            row, beside = {"name": entry.name, "peer": entry.peer, "failed": f"{type(error).__name__}: {error}"}, []
        costs += beside
        rows.append(row)
        if float(row.get("cost_us", 0.0)) > 1e6 * HOPELESS:
            slow.add(entry.name)
        show(row)
    ours = flight_rows(flight, costs, rounds)
    for row in ours:
        show(row)
    load = {"before": begun, "after": os.getloadavg()}
    return {"modes": job.size, "rounds": rounds, "machine": machine(peers), "load": load, "rows": [*ours, *rows]}


def show(row: Row) -> None:
    """One line of the table."""
    if "failed" in row:
        print(f"{row['name']:34} failed: {row['failed']}", flush=True)
        return
    print(
        f"{row['name']:34}{row['cost_us']:12.4g}{row['ratio']:10.4g}{row['error_median']:14.1e}"
        f"{row['error_worst']:9.1e}{row.get('missed', 0):8d}{row.get('invented', 0):9d}"
        f"{row.get('failed_points', 0):8d}",
        flush=True,
    )


def machine(peers: list[Entry]) -> dict[str, object]:
    """Processor, cores and versions."""
    told = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    models = [line.split(":")[1].strip() for line in told.splitlines() if line.startswith("model name")]
    names = sorted({"vibeam", "numpy", "numba", "jax", *(entry.package for entry in peers)})
    versions = {name: known for name in names if (known := installed(name))}
    return {
        "processor": models[0] if models else platform.processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "versions": versions,
    }


def installed(name: str) -> str | None:
    """Version of a package; of Siconos as its own Python tells."""
    if name == "siconos":
        from peers.siconos_event_driven import VERSION

        return VERSION
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", help="sections: sdof, modes-1 … modes-32")
    parser.add_argument("--peer", default="", help="only what has this in its name")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--patience", type=float, default=3.0, help="CPU seconds a peer may take in a round, about")
    parser.add_argument("--out", type=Path, default=RESULTS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
