"""Arguments of a batch, broadcast to one shape: every point with its system, as the kernels take plain ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.flight.points.points import PlainPoints
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State
from vibeam_models.arguments import counted, real_array, refuse, shown
from vibeam_models.arrays import Array, Flags, Index

if TYPE_CHECKING:
    from vibeam.batches.response import BatchResponse


Systems = ImpactSystem | Sequence[ImpactSystem] | NDArray[np.object_]


@dataclass(frozen=True)
class BatchPoints:
    """The points of a batch, (m,) each, in C order of its shape."""

    shape: tuple[int, ...]
    bases: tuple[ImpactSystem, ...]  # the distinct systems given
    base: Index  # which of them
    omega: Array  # rad/s
    amplitude: Array  # m
    gap: Array  # m
    restitution: Array
    damping: Array  # factor on every damping ratio
    state: Array | None = None  # (m, 2n)
    resting: Flags | None = None

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.bases[0].size

    def start(self, point: int) -> State | None:
        """Start of a point; None: at equilibrium."""
        if self.state is None:
            return None
        n, values = self.size, self.state[point]
        return State(values[:n], values[n:], self.resting is not None and bool(self.resting[point]))

    def system(self, point: int) -> ImpactSystem:
        """The system of a point with its changes; the one given where there are none."""
        base = self.bases[self.base[point]]
        return changed(base, float(self.gap[point]), float(self.restitution[point]), float(self.damping[point]))


def changed(base: ImpactSystem, gap: float, restitution: float, damping: float) -> ImpactSystem:
    """``base`` with that gap, restitution and all its damping times a factor."""
    changes: dict[str, Any] = {}
    if gap != base.gap:
        changes["gap"] = gap
    if restitution != base.restitution:
        changes["restitution"] = restitution
    if damping != 1.0:
        changes["zeta"] = base.zeta * damping
        if base.coupling is not None:
            changes["coupling"] = base.coupling * damping
    return replace(base, **changes) if changes else base


def points_of(
    systems: Systems,
    omega: ArrayLike,
    amplitude: ArrayLike,
    gap: ArrayLike | None,
    restitution: ArrayLike | None,
    damping: ArrayLike | None,
    state: ArrayLike | BatchResponse | None,
) -> BatchPoints:
    """Broadcast the arguments of ``vibeam.batch``; ValueError names every one that is wrong."""
    faults: list[str] = []
    bases, base = _distinct(systems, faults)
    given = {
        "omega": _numbers("omega", omega, faults, "positive frequencies in rad/s", above=0.0),
        "amplitude": _numbers("amplitude", amplitude, faults, "finite numbers"),
        "gap": None if gap is None else _numbers("gap", gap, faults, "finite numbers"),
        "restitution": _restitution(restitution, bases, faults),
        "damping": None if damping is None else _numbers("damping", damping, faults, "factors ≥ 0", least=0.0),
    }
    starts = _starts(state, bases[0].size, faults) if bases else None
    refuse("batch", faults)
    known = {name: values for name, values in given.items() if values is not None}
    shape = _common_shape({"systems": base, **known} | ({} if starts is None else {"state": starts[1]}))
    flat: dict[str, Any] = {name: np.broadcast_to(values, shape).ravel() for name, values in known.items()}
    base = np.ascontiguousarray(np.broadcast_to(base, shape).ravel())
    flat.setdefault("gap", np.array([each.gap for each in bases])[base])
    flat.setdefault("restitution", np.array([each.restitution for each in bases])[base])
    flat.setdefault("damping", np.ones(len(base)))
    if starts is not None:
        values, resting = starts
        flat["state"] = np.broadcast_to(values, (*shape, values.shape[-1])).reshape(len(base), -1)
        flat["resting"] = np.broadcast_to(resting, shape).ravel()
    return BatchPoints(shape=shape, bases=bases, base=base, **flat)


def _distinct(systems: Any, faults: list[str]) -> tuple[tuple[ImpactSystem, ...], Index]:
    """The distinct systems, and which of them each entry is."""
    if isinstance(systems, ImpactSystem):
        return (systems,), np.zeros((), dtype=np.int64)
    entries = np.array(systems, dtype=object)
    places: dict[int, int] = {}
    which = np.array([places.setdefault(id(each), len(places)) for each in entries.flat], dtype=np.int64)
    found = {id(each): each for each in entries.flat}
    strangers = [each for each in found.values() if not isinstance(each, ImpactSystem)]
    if strangers or not found:
        what = shown(strangers[0]) if strangers else "none"
        faults.append(f"systems: must be ImpactSystem or an array of them, not {what}")
        return (), which.reshape(entries.shape)
    bases = tuple(found.values())
    sizes = sorted({each.size for each in bases})
    if len(sizes) > 1:
        faults.append(f"systems: must have the same number of modes, not {', '.join(map(str, sizes))}")
    return bases, which.reshape(entries.shape)


def _numbers(
    name: str, value: Any, faults: list[str], what: str, *, least: float = -np.inf, above: float = -np.inf,
    most: float = np.inf,
) -> Array | None:  # fmt: skip
    """``value`` as an array of finite numbers in the bounds; None, and a line in ``faults``, where it is none."""
    found = real_array(value)
    if found is None:
        faults.append(f"{name}: must be a number or an array of numbers, not {shown(value)}")
        return None
    fine = np.isfinite(found) & (found >= least) & (found > above) & (found <= most)
    if not fine.all():
        faults.append(f"{name}: must be {what}, not {found[~fine].flat[0]:g}")
    return found


def _restitution(value: Any, bases: tuple[ImpactSystem, ...], faults: list[str]) -> Array | None:
    if value is None:
        return None
    laws = [each.law.name for each in bases if each.law is not None]
    if laws:
        faults.append(f'restitution: a system has the contact law "{laws[0]}", which says all of its impacts')
    return _numbers("restitution", value, faults, "in [0, 1]", least=0.0, most=1.0)


def _common_shape(given: dict[str, Any]) -> tuple[int, ...]:
    try:
        shape = np.broadcast_shapes(*(values.shape for values in given.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in given.items() if values.ndim)
        raise ValueError(f"batch: shapes do not broadcast to one: {shapes}") from None
    if 0 in shape:
        raise ValueError(f"batch: there is no point in shape {shape}")
    return shape


def _starts(state: Any, n: int, faults: list[str]) -> tuple[Array, Flags] | None:
    """States (…, 2n) and which of them rest; None: none are given, or a line in ``faults`` says what is wrong."""
    from vibeam.batches.response import BatchResponse

    if state is None:
        return None
    values = real_array(state.state if isinstance(state, BatchResponse) else state)
    if values is None or not values.ndim or values.shape[-1] != 2 * n or not np.isfinite(values).all():
        faults.append(
            f"state: must be finite numbers (…, {2 * n}): displacements of {counted(n, 'mode')}, then velocities"
        )
        return None
    resting = state.resting if isinstance(state, BatchResponse) else np.zeros((), dtype=bool)
    return values, np.broadcast_to(resting, values.shape[:-1])


def plain_points(points: BatchPoints, which: Index) -> PlainPoints:
    """The points ``which``, where those of one base and one damping are neighbours: these are systems."""
    base, damping, first = points.base[which], points.damping[which], np.ones(len(which), dtype=bool)
    first[1:] = (base[1:] != base[:-1]) | (damping[1:] != damping[:-1])
    kinds = [(points.bases[i], float(factor)) for i, factor in zip(base[first], damping[first], strict=True)]
    systems = [changed(own, own.gap, own.restitution, factor) for own, factor in kinds]
    starts = None if points.state is None else points.state[which].reshape(len(which), 2, points.size)
    resting = None if points.resting is None else points.resting[which]
    return PlainPoints(
        systems, np.cumsum(first) - 1, points.omega[which], points.amplitude[which], points.gap[which],
        points.restitution[which], starts, resting,
    )  # fmt: skip
