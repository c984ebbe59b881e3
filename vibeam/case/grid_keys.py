"""Keys that a grid may vary: what each decides, and the rules between the axes of a grid."""

from __future__ import annotations

from collections.abc import Sequence

FREQUENCY = "sweep.frequency"
DISPLACEMENT, VELOCITY = "start.displacement", "start.velocity"
STARTS = (DISPLACEMENT, VELOCITY)  # of the contact: keys of a grid alone, no case has them
GAP, RESTITUTION = "stop.gap", "stop.restitution"

LEVELS = tuple(
    f"drive.{name}" for name in ("amplitude", "voltage", "gain", "force", "moment", "velocity", "acceleration")
)


def is_structural(key: str) -> bool:
    """Test whether the system has to be built anew for each value of a key."""
    return key not in (FREQUENCY, *STARTS, GAP, RESTITUTION, *LEVELS)


def axis_faults(keys: Sequence[str], carried: bool, frequency: float | None, random: bool) -> list[tuple[str, str]]:
    """Faults of the axes ``keys`` of a grid, each (axis, or other argument; message with the cure).

    ``carried``: the state goes from point to point along the last one; ``frequency``: of the drive, where it is no
    axis; ``random``: motions start at random.
    """
    found = [(key, "is an axis twice") for key in dict.fromkeys(keys) if keys.count(key) > 1]
    if FREQUENCY in keys and frequency is not None:
        found.append(("frequency", f"{FREQUENCY} is an axis already: leave one of the two away"))
    elif FREQUENCY not in keys and frequency is None:
        found.append(("frequency", f'missing where {FREQUENCY} is no axis: write frequency = "15.3 Hz"'))
    given = [key for key in keys if key in STARTS]
    if carried and keys and is_structural(keys[-1]):
        found.append((keys[-1], 'changes the modes, so no state is carried along it: put another axis last, or write '
                      'direction = "apart"'))  # fmt: skip
    if carried and (given or random):
        what = given[0] if given else "starts"
        found.append((what, 'where each motion has a start of its own none is carried: write direction = "apart"'))
    if given and random:
        found.append(("starts", f"{given[0]} says already where motions start: leave one of the two away"))
    return found
