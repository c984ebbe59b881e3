"""Solver of systems with contacts in several places."""

from __future__ import annotations

from collections.abc import Sequence
from threading import local
from typing import Any, ClassVar

import numpy as np

from vibeam.flight.contacts.readout import keys_of
from vibeam.flight.contacts.sets import ContactSets
from vibeam.flight.engine.entries import contacts_cover, contacts_move, contacts_poses_at
from vibeam.flight.equilibrium import Contacts
from vibeam.flight.event_driven import EventDrivenSolver, Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts import layout as contact_layout
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.linear.packing import slowest_rate, top_level
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array


class ContactsSolver(EventDrivenSolver):
    """One system with contacts in several places; its methods take a state and give one back.

    Flights, holds and pushes of linear stops are closed forms with proved first roots, as in ``RegimeSolver``; each set
    of contacts held and pushed is made when first met. Impacts in one instant follow ``kernels.contacts.strikes``.
    ``FrequencyResponse.rest`` is the share of time in which any contact is held or pushed.
    """

    _a_thread: ClassVar[type[Any]] = local  # what each thread has of its own

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        super().__init__(system, limit)
        self.contacts, self._slowest = Contacts.of(system), slowest_rate(system, slowest, span)
        self._top = top_level(self._slowest, self.contacts.fastest_rate)
        self._status_rows = contact_layout.status_rows(len(self.contacts.gaps))
        self._trace_columns = contact_layout.trace_columns(len(self.contacts.gaps))
        self._own = self._a_thread()

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_own"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, _own=self._a_thread())

    @property
    def sets(self) -> ContactSets:
        """The calling thread's sets."""
        try:
            found: ContactSets = self._own.sets
        except AttributeError:
            found = self._own.sets = ContactSets(self.contacts, self._slowest, self._top)
        return found

    def _engine_for(self, size: float) -> ContactEngine:
        own = self.sets.engine
        own.drive[layout.MOTION] = size
        return own

    def _regimes(self) -> Sequence[Regime]:
        return ()

    def _carries(self) -> bool:
        engine = self.sets.engine
        return bool(engine.blocks[engine.sets >= 0, layout.CARRIED].any())

    def _restart(self, pose: Array, status: Array, kind: float) -> None:
        super()._restart(pose, status, kind)
        status[layout.ORDER] = regime_layout.UNKNOWN

    def _move(
        self, engine: ContactEngine, omega: float, amplitude: float, pose: Array, status: Array, *given: Any
    ) -> Any:
        """The kernels' ``move``; a set for want of which it pauses is made."""
        outcome, value = contacts_move(self.sets.engine, omega, amplitude, pose, status, *given)
        if outcome == layout.PAUSED and status[contact_layout.WANTED] > 0:
            self.sets.make(int(status[contact_layout.WANTED]) - 1)
        return outcome, value

    _poses_at, _cover = staticmethod(contacts_poses_at), staticmethod(contacts_cover)

    def poses_at(self, drive: Drive, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        self._make_all(segments.trace)
        return super().poses_at(drive, segments, times)

    def cover(
        self, drive: Drive, trace: Array, poses: Array, size: float, tasks: Array, first: int, pieces: Array
    ) -> tuple[int, int]:
        """Fill ``pieces`` from task ``first`` on: as for the others."""
        self._make_all(trace)
        return super().cover(drive, trace, poses, size, tasks, first, pieces)

    def _make_all(self, trace: Array) -> None:
        """Make the sets of a trace that the calling thread has not made."""
        for key in np.unique(keys_of(trace, len(self.contacts.gaps))):
            self.sets.make(int(key))

    def _watch(self, output: str | None) -> Array:
        wanted = None if output is None else self.system.derivative(output)
        curved = [law.name for law in self.contacts.laws if law.integrated]
        if wanted is not None and curved:
            said = f"output {output!r}: the {wanted.called} in a contact that is integrated is not read"
            raise ValueError(f"{said}, {curved[0]!r}: take a linear stop, or one with a restitution")
        if wanted is not None:
            self.sets.watch(np.array(wanted.row), wanted.order, wanted.base)
            return np.array(wanted.row)
        row = np.array(self.system.contact if output is None else self.system.output(output))
        self.sets.watch(row)
        return row
