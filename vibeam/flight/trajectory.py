"""Trajectory: one motion from beginning to end, its outcome, and snapshots of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts.layout import PUSHED_AT
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.outcome import Outcome, outcome_of
from vibeam.flight.readout import sides, struck
from vibeam.flight.solver import exact_solver, warm_up_motion
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arguments import count, counted, floats, number, refuse, require
from vibeam_models.arrays import Array, Index, ValueRecord

if TYPE_CHECKING:
    from vibeam.flight.event_driven import EventDrivenSolver, Segments
    from vibeam.flight.proof.certificate import Certificate
    from vibeam.flight.proof.errors import ImpactErrors
    from vibeam.system.record import Record

MOST_IMPACTS = 10**15  # what is counted in an int64, with room to spare
INSTANTS = 2000


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(ValueRecord):
    """A motion, exact between its events: SI units, times in s; the drive's phase is 0 at time 0.

    ``drive`` is a sine or a ``Record``, of whose motions ``flight.record`` has more to read off.

    ``stats``: impacts, evaluations, cpu_seconds; ``segments``: flights and rests as the solver left them
    (``kernels.layout``).

    >>> import vibeam
    >>> free = vibeam.ImpactSystem.from_modes(1.0, 0.0, 1.0, 0.0, gap=9.0)  # cos t, which never reaches the stop
    >>> path = vibeam.simulate(free, vibeam.Drive(1.0, 0.0), 3.2, vibeam.State([1.0], [0.0]))
    >>> path, path.at([0.0, 3.141592653589793]).round(9).tolist()
    (Trajectory(0 … 3.2 s, 1 mode, 0 impacts, 0 rests, COMPLETE), [1.0, -1.0])
    """

    system: ImpactSystem
    drive: Any  #: a Drive, or the Record
    t_start: float
    t_end: float
    state: State
    ended: Ended
    stats: Mapping[str, float] = field(compare=False)
    _solver: EventDrivenSolver = field(compare=False)
    segments: Segments
    certificate: Certificate | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        span, modes = f"{self.t_start:g} … {self.t_end:g} s", counted(self.system.size, "mode")
        met = f"{counted(self.stats['impacts'], 'impact')}, {counted(len(self.rests), 'rest')}"
        return f"Trajectory({span}, {modes}, {met}, {self.ended.name})"

    @property
    def outcome(self) -> Outcome:
        """Outcome of the motion; how often it chattered to rest on the way is ``len(path.chatters)``."""
        return outcome_of(self)

    @cached_property
    def errors(self) -> ImpactErrors:
        """Round-off grown up to each impact, and the number of impacts that still mean something; computed when asked.

        A state carried in is taken as exact to its last digit.
        """
        from vibeam.flight.proof.errors import errors_of

        if not isinstance(self.drive, Drive):
            raise ValueError("errors: how round-off grows is not known of motions under a record")
        return errors_of(self)

    @property
    def impact_times(self) -> Array:
        """Times (m,) of the impacts computed one by one, s: at one of them ``velocity_at`` is the one after it."""
        trace = self.segments.trace
        ends = trace[:, layout.START] + trace[:, layout.DURATION]
        ends[:-1] = trace[1:, layout.START]  # where the next segment begins, to the bit
        return np.asarray(ends[struck(trace)])

    @property
    def impact_velocities(self) -> Array:
        """Contact velocities (m,) just before the impacts, positive toward the stop, m/s."""
        trace = self.segments.trace
        return np.asarray(trace[struck(trace), layout.BEFORE])

    @property
    def chatters(self) -> Array:
        """(m, 2): when each accumulation of impacts was over, and a bound of the error of that time, s.

        ∞ where R → 1 and it has no end: from then on the contact is held, see ``left_out``.
        """
        trace = self.segments.trace
        trace = trace[trace[:, layout.END] == layout.CHATTER]
        return np.stack(
            [trace[:, layout.START] + trace[:, layout.DURATION] + trace[:, layout.LEFT], trace[:, layout.REMAINDER]],
            axis=1,
        )

    @property
    def left_out(self) -> Array:
        """(m, 3): what endless accumulations of impacts (R → 1) that were taken as rest still did.

        When, s; the energy W₀ = ½ v⁺²/S of the contact then, J; the most that W is until that rest's end: no mode's
        velocity, nor ω times its displacement, is off by more than √2W there, nor the gap wider than W over the
        contact force.
        """
        from vibeam.flight.proof.errors import left_out_of

        return left_out_of(self)

    @property
    def rests(self) -> Array:
        """(m, 2): begin (an accumulation of impacts completed) and end of each rest on the stop, s."""
        if self._in_sets:
            return self._holds(None)
        trace = self.segments.trace
        resting = np.flatnonzero(trace[:, layout.WHAT] == layout.RESTING)
        before = trace[np.maximum(resting - 1, 0)]
        waited = np.where((resting > 0) & (before[:, layout.END] == layout.CHATTER), before[:, layout.LEFT], 0.0)
        begin, end = trace[resting, layout.START], np.append(trace[1:, layout.START], self.t_end)[resting]
        return np.stack([np.minimum(begin + waited, end), end], axis=1)

    @property
    def impact_contacts(self) -> Index:
        """Index (m,) of the contact that each impact strikes: 0 the first stop, then as in ``gaps``."""
        trace = self.segments.trace
        return sides(trace)[struck(trace)]

    def holds(self, contact: int | None = None) -> Array:
        """(m, 2): begin and end of each hold of a contact, None: of any, s; with several contacts alone.

        ValueError with contact in one place, which has ``rests``.
        """
        if self.system.further is None:
            raise ValueError("holds: there is one place of contact: rests has its holds")
        return self._holds(contact)

    @property
    def _in_sets(self) -> bool:
        """True where its segments are of sets of contacts: of several contacts, or under a record."""
        return self.system.further is not None or not isinstance(self.drive, Drive)

    def _holds(self, contact: int | None) -> Array:
        from vibeam.flight.contacts.readout import holds_of

        return holds_of(self.segments.trace, self.t_end, contact)

    @property
    def contacts(self) -> Array:
        """(m, 3): begin, s, duration, s, and largest force, N, of each contact with stops that yield."""
        trace = self.segments.trace
        pushing = trace[:, layout.WHAT] == regime_layout.CONTACT
        if self._in_sets:
            pushing = trace[:, PUSHED_AT] > 0
        pushed = np.flatnonzero(pushing)
        if not len(pushed):
            return np.empty((0, 3))
        begin, end = trace[pushed, layout.START], trace[pushed, layout.START] + trace[pushed, layout.DURATION]
        fresh = np.diff(pushed, prepend=-2) > 1  # what follows at once goes on with the same contact
        first = np.flatnonzero(fresh)
        last = np.append(first[1:], len(pushed)) - 1
        peaks = np.maximum.reduceat(trace[pushed, regime_layout.PEAK], first)
        return np.stack([begin[first], end[last] - begin[first], peaks], axis=1)

    def at(self, t: ArrayLike, output: str = "contact") -> Array:
        """The output at times t (any shape), m or what it is in; at an impact the value after it.

        ValueError outside [t_start, t_end], KeyError for an unknown name.
        """
        return self._read(t, output, 0)

    def gaps(self, t: ArrayLike) -> Array:
        """Gap of every contact (…, k) at times t, m: the first stop, a second one on its other side, further ones."""
        contacts = Contacts.of(self.system)
        return np.asarray(contacts.gaps - self.modes_at(t)[..., 0, :] @ contacts.rows.T)

    def velocity_at(self, t: ArrayLike, output: str = "contact") -> Array:
        """The output's rate at times t (any shape), m/s where it is in m; at an impact the one after it."""
        return self._read(t, output, 1)

    def modes_at(self, t: ArrayLike) -> Array:
        """Modal displacements and velocities (…, 2, n) at times t of any shape; ValueError outside the motion."""
        times = floats("t", t)
        if times.size and not (np.min(times) >= self.t_start and np.max(times) <= self.t_end):
            raise ValueError(f"t: must lie in [{self.t_start}, {self.t_end}]")
        found = self._solver.poses_at(self.drive, self.segments, np.ascontiguousarray(times.ravel()))
        return np.asarray(found.reshape(*times.shape, 2, self.system.size))

    def _read(self, t: ArrayLike, output: str, more: int) -> Array:
        """The output, or its rate (``more`` 1), at times t of any shape."""
        wanted = self.system.derivative(output)
        if wanted is None:
            return np.asarray(self.modes_at(t)[..., more, :] @ self.system.output(output))
        from vibeam.flight.disturbance.derivatives import derivative_along

        times, poses = floats("t", t).ravel(), self.modes_at(t)
        loads = None if isinstance(self.drive, Drive) else cast(Any, self._solver).course.loads(times)
        found = derivative_along(
            self.system, self.drive, self.segments.trace, times, poses.reshape(-1, 2, self.system.size), wanted, more,
            loads,
        )  # fmt: skip
        return np.asarray(found.reshape(poses.shape[:-2]))


def simulate(
    system: ImpactSystem,
    drive: Drive | Record,
    t_end: float,
    state: State | None = None,
    *,
    t_start: float = 0.0,
    solver: str = "flight",
    max_impacts: int = 10_000_000,
    certify: bool = False,
) -> Trajectory:
    """The motion of ``system`` under ``drive``, a sine or a ``Record``, from ``t_start`` to ``t_end`` seconds.

    ``state``: where it starts, static equilibrium where None. ``max_impacts``: it ends there with Ended.EVENT_LIMIT.
    ``certify``: the result carries a ``certificate`` that no impact was missed, at less than the motion's cost again
    where that is a millisecond or more (of contact that is integrated, Hertz and Hunt–Crossley, it proves nothing and
    says so).
    ValueError for times that do not ascend, a state of the wrong shape, an unknown solver or an argument of another
    type; a start beyond the stop ends at once with Ended.PENETRATED.

    >>> import vibeam
    >>> ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 0.0, static=1.0, restitution=0.5)  # falls onto the stop
    >>> path = vibeam.simulate(ball, vibeam.Drive(1.0, 0.0), 2.9, vibeam.State([-0.5], [0.0]))
    >>> path.impact_times.round(9).tolist(), path.impact_velocities.round(9).tolist()
    ([1.0, 2.0, 2.5, 2.75, 2.875], [1.0, 0.5, 0.25, 0.125, 0.0625])
    """
    require("system", system, ImpactSystem)
    require("state", state, State, none_too=True)
    start, end, limit = _checked(t_start, t_end, max_impacts)
    if solver != "flight":
        raise ValueError(f"solver: {solver!r} keeps no exact path, only 'flight' does; its class has motion() instead")
    if not isinstance(drive, Drive):
        return _under_record(system, drive, end, state, start, limit, certify)
    runner = exact_solver(system, drive.omega, end - start)
    warm_up_motion(system, drive)
    ended, last, after, segments, stats = runner.simulate(drive, state, start, end, limit)
    return Trajectory(
        system, drive, start, last, after, ended, stats, runner, segments,
        _certificate(runner, drive, segments) if certify else None,
    )  # fmt: skip


def _under_record(
    system: ImpactSystem, record: Any, end: float, state: State | None, start: float, limit: int, certify: bool
) -> Trajectory:
    """The motion under a record; ValueError where it is none."""
    from vibeam.flight.record.solver import RecordSolver
    from vibeam.system.record import Record

    if not isinstance(record, Record):
        raise ValueError(f"drive: must be a Drive or a Record, not {type(record).__name__}")
    return Trajectory(**RecordSolver(system, record, start, end).fly(state, limit, certify))


def _checked(t_start: Any, t_end: Any, max_impacts: Any) -> tuple[float, float, int]:
    """The same as floats and an int; ValueError with every fault."""
    faults: list[str] = []
    start, end = number("t_start", t_start, faults, least=0.0), number("t_end", t_end, faults)
    limit = count("max_impacts", max_impacts, faults, most=MOST_IMPACTS)
    if end < start:
        faults.append(f"t_end {end:g} must not be before t_start {start:g}")
    refuse("simulate", faults)
    return start, end, limit


def _certificate(runner: EventDrivenSolver, drive: Drive, segments: Segments) -> Certificate:
    if runner.system.further is not None:
        from vibeam.flight.proof.contacts import certificate_of_contacts

        return certificate_of_contacts(runner, drive, segments)
    from vibeam.flight.proof.certificate import certificate_of

    return certificate_of(runner, drive, segments)


def modal_snapshots(system: ImpactSystem, drive: Drive, periods: int) -> tuple[Array, Array]:
    """Displacements and velocities (modes, instants) over ``periods`` of the drive, from static equilibrium.

    ValueError where the motion ends before.
    """
    path = simulate(system, drive, periods * 2 * np.pi / drive.omega)
    if path.ended is not Ended.COMPLETE:
        raise ValueError(f"the flight of the full model ended at {path.t_end:.4g} s: {path.ended.value}")
    poses = path.modes_at(np.linspace(0.0, path.t_end, INSTANTS + 1)[1:])
    return poses[:, 0].T, poses[:, 1].T
