"""Parts of a long computation, which any process anywhere computes, without a scheduler: steps on disk, gathered."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from os.path import lexists
from pathlib import Path
from threading import Event, Lock
from time import monotonic

from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam.flight.engine.entries import origin
from vibeam.flight.engine.threads import OutOfTime, Stopped, ending_at, run_parallel
from vibeam.store.blocks import MANIFEST, Values
from vibeam.store.errors import ELSEWHERE, StoreError, writing
from vibeam.store.long_work import LongWork, WorkPart, WorkStep
from vibeam.store.place import locked
from vibeam.store.steps import StepFile, scanned

PATIENCE = 25.0  # s that a step in hand is given when its part is to end
UNSAFE = 0.5  # s between two synchronisations, where steps take less
LAYOUT = b"vibeam steps 1"
FOREIGN = f"{ELSEWHERE}, or delete {{}} and compute it anew by one version and one kernel level"


@dataclass(frozen=True)
class PartsManifest:
    """Content of the manifest: keys and items of a step by name, steps of a file, digest of the code, kernels."""

    keys: Mapping[str, str]
    sizes: Mapping[str, int]
    together: int = 0
    code: str = ""
    kernels: str = ""


def known_manifest(folder: Path) -> PartsManifest | None:
    """The manifest in ``folder``; None where there is none, or a damaged one. OSError where it cannot be read."""
    file = folder / MANIFEST
    content = read_sealed(file, MANIFEST) if lexists(file) else None
    if content is None:
        return None
    found = json.loads(content)
    return PartsManifest(**{name: found.get(name, "") for name in PartsManifest.__dataclass_fields__})


class StepsOnDisk:
    """Files of the steps of ``work``, as cut by who began them: each read through once, then known.

    StoreError where those there are of another computation, of other code or other kernels, or the disk fails.
    """

    def __init__(self, work: LongWork, files: Callable[[int], bool] = lambda file: True) -> None:
        wanted = PartsManifest(
            dict(work.keys),
            {name: cut.step for name, cut in work.steps.items()},
            work.steps_a_file,
            work.code,
            origin(),
        )
        found = _begun(work, wanted)
        cuts = {name: range(0, cut.stop, found.sizes[name]) for name, cut in work.steps.items()}
        self.work = replace(work, steps=cuts, together=found.together)
        of = sha256(json.dumps([found.keys, found.sizes, found.together]).encode()).hexdigest()
        self._line = LAYOUT + f": of {of}, code {found.code}, kernels {found.kernels}\n".encode()
        self._files = {number: self._scanned(number) for number in range(1, self.work.files + 1) if files(number)}
        if foreign := {number: each.foreign for number, each in self._files.items() if each.foreign}:
            raise StoreError(self._said_of(foreign))

    def _scanned(self, number: int) -> StepFile:
        return scanned(self.work.folder / f"{number:05d}.steps", self._line)

    def _said_of(self, foreign: Mapping[int, bytes]) -> str:
        other = sorted({each.rpartition(b"kernels ")[2].decode(errors="replace").strip() for each in foreign.values()})
        return (
            f"{self.work.folder}: files {spans(foreign)} are of other code, other kernels or another computation "
            f"(kernels there: {', '.join(other)}; here: {origin()}): {FOREIGN.format('them')}"
        )

    def file_of(self, step: WorkStep) -> StepFile:
        """The file of a step."""
        return self._files[step.number // self.work.steps_a_file + 1]

    def missing(self) -> list[WorkStep]:
        """Steps of these files that are not there, or damaged."""
        return [step for step in self.steps() if step.number not in self.file_of(step).places]

    def steps(self) -> Iterator[WorkStep]:
        """Steps of these files."""
        each = self.work.steps_a_file
        return (step for step in self.work.every if step.number // each + 1 in self._files)

    def again(self, step: WorkStep) -> None:
        """Read the file of a step through once more: another process may have written to it."""
        number = step.number // self.work.steps_a_file + 1
        self._files[number] = self._scanned(number)

    def require_all(self) -> None:
        """StoreError that names every file that lacks steps, with the command that computes them."""
        lost = self.missing()
        lacking = {step.number // self.work.steps_a_file + 1 for step in lost}
        if lacking:
            damaged = [number for number in sorted(lacking) if self._files[number].damaged]
            first = f"{self.work.command} --part {min(lacking)}/{self.work.files}"
            raise StoreError(
                f"{self.work.folder}: {len(lost)} of {len(self.work.every)} steps are not there, in the files "
                f"{spans(lacking)}{f' (damaged: {spans(damaged)})' if damaged else ''}: run the same parts again, or "
                f"those of one file alone ({first}), or all here ({self.work.command})"
            )

    def values(self, step: WorkStep) -> Values:
        """Values of a step that is there; StoreError where it was damaged meanwhile."""
        found = self.file_of(step).read(step.number)
        if found is None:
            raise StoreError(f"{self.work.folder}: a step was damaged meanwhile: run again to compute it anew")
        return found


def spans(numbers: Iterator[int] | Mapping[int, object] | Sequence[int] | set[int]) -> str:
    """Whole numbers in words: 3, 17 to 20; of very many spans the first."""
    found: list[list[int]] = []
    for number in sorted(numbers):
        if found and number == found[-1][-1] + 1:
            found[-1] = [found[-1][0], number]
        else:
            found.append([number])
    said = ", ".join(" to ".join(map(str, each)) for each in found[:20])
    return said + (f" and {len(found) - 20} more spans" if len(found) > 20 else "")


def _begun(work: LongWork, wanted: PartsManifest) -> PartsManifest:
    """The manifest that is there, ``wanted`` where there is none or a damaged one: files say what they are of."""
    with writing(work.folder, ELSEWHERE):
        work.folder.mkdir(exist_ok=True)
        found = known_manifest(work.folder)
        if found is None:
            write_sealed(work.folder / MANIFEST, json.dumps(asdict(wanted), indent=1).encode(), MANIFEST)
            return wanted
    anew = f"{ELSEWHERE}, or delete it to compute it anew"
    if found.keys != wanted.keys:
        raise StoreError(f"{work.folder}: holds steps of another case, or of this one before it was changed: {anew}")
    if found.code != wanted.code:
        raise StoreError(f"{work.folder}: holds steps that another version of vibeam computed: {anew}")
    if found.kernels != wanted.kernels:
        level = f" (VIBEAM_KERNELS={found.kernels.removeprefix('library ')})"
        raise StoreError(
            f"{work.folder}: holds steps of other kernels, {found.kernels}; here they are {wanted.kernels}: "
            f"take the same everywhere{level}, or {anew}"
        )
    return found


class Ending:
    """Wish that a part ends: no step is begun any more; those in hand are given ``PATIENCE`` seconds."""

    def __init__(self) -> None:
        self._since: float | None = None

    def wish(self) -> None:
        """Wish it from now on."""
        self._since = monotonic() if self._since is None else self._since

    def waited(self) -> float:
        """Seconds since it was wished; 0 before."""
        return 0.0 if self._since is None else monotonic() - self._since

    @property
    def wished(self) -> bool:
        """Test whether it is wished."""
        return self._since is not None


@dataclass(frozen=True)
class TakenPart:
    """Share of a part: points in all, those ``found`` on disk and those ``done`` now with them."""

    total: int
    found: int
    done: int

    @property
    def complete(self) -> bool:
        """Test whether nothing of it is missing."""
        return self.done == self.total


ALL = WorkPart()


def take_part(
    work: LongWork, part: WorkPart = ALL, workers: int | None = None,
    tell: Callable[[int, int], None] | None = None, ending: Ending | None = None,
) -> TakenPart:  # fmt: skip
    """Compute what is missing of a part's files, each step written once it is done.

    ``workers``: threads (None: one a core); ``tell`` is called with points done and their total, from any thread.
    StoreError where another process computes it, where files are another's, or the disk fails.
    """
    ending = ending or Ending()
    stored = StepsOnDisk(work, part.has)
    with locked(stored.work.folder / f"part {part.number} of {part.of}", own=True), ExitStack() as held:
        missing = stored.missing()
        total = sum(map(stored.work.size, stored.steps()))
        found = total - sum(map(stored.work.size, missing))
        writer = _Writer(stored, missing, held, tell or (lambda *_: None), found, total)

        def task(step: WorkStep, stop: Event) -> None:
            if ending.wished:
                return
            values = work.evaluate(step)
            if stop.is_set():
                raise Stopped
            writer.write(step, values)

        try:
            with ending_at(ending.waited, PATIENCE):
                run_parallel(task, missing, workers)
        except OutOfTime:
            if not ending.wished:
                raise
    return TakenPart(total, found, writer.done)


class _Writer:
    """Writer of steps, one at a time; each file is locked from its first step on until it is whole."""

    def __init__(
        self, stored: StepsOnDisk, missing: Sequence[WorkStep], held: ExitStack, tell: Callable[[int, int], None],
        done: int, total: int,
    ) -> None:  # fmt: skip
        self._stored, self._held, self._tell, self._lock = stored, held, tell, Lock()
        self._left = Counter(stored.file_of(step).path for step in missing)
        self._open, self._due = dict[Path, ExitStack](), 0.0
        self.done, self._total = done, total
        tell(done, total)

    def write(self, step: WorkStep, values: Values) -> None:
        """Write a step."""
        with self._lock:
            path = self._stored.file_of(step).path
            if path not in self._open:
                self._open[path] = self._held.enter_context(ExitStack())
                self._open[path].enter_context(locked(path, own=True))
                self._stored.again(step)
            file = self._stored.file_of(step)
            if step.number not in file.places:
                sync = monotonic() > self._due
                file.append(self._stored.work.path, step.number, values, sync)
                self._due = monotonic() + UNSAFE if sync else self._due
            self._left[path] -= 1
            if not self._left[path]:
                self._open.pop(path).close()
            self.done += self._stored.work.size(step)
        self._tell(self.done, self._total)


def gathered(work: LongWork) -> Iterator[tuple[WorkStep, Values]]:
    """All steps with their values, in order; StoreError that names every file that lacks some, with the cure."""
    stored = StepsOnDisk(work)
    stored.require_all()
    return ((step, stored.values(step)) for step in stored.work.every)
