"""Time of a fidelity map of 61 × 61 places, and how often it is right between its places.

    python tests/benchmarks/verdict_map.py [CASE] [--places 200]

The case's fidelities (the neutral rig: three) over frequency and gap, with the case's own settling. Then all models are
flown anew at places drawn from the whole plane, with twice the settling, and the map's answer is compared.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import vibeam
from vibeam.studies.fidelity_map.between import verified

NEUTRAL = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?", default=str(NEUTRAL))
    parser.add_argument("--places", type=int, default=200)
    given = parser.parse_args()
    cpu, wall = time.process_time(), time.perf_counter()
    found = vibeam.fidelity_map(vibeam.load(given.case), verify=0)
    print(f"map: {time.process_time() - cpu:.1f} s of CPU, {time.perf_counter() - wall:.1f} s; {found.shares}")
    checked = verified(found, given.places)
    same, decided = int((checked.predicted == checked.flown).sum()), int(checked.decided.sum())
    print(f"right at {checked.right} of {decided} decided places, at {same} of all {given.places}")
    print(f"choice open by scatter on {found.doubtful:.1%} of the map")


if __name__ == "__main__":
    main()
