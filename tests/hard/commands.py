"""``vibeam run`` as a process of its own, the cases that it is disturbed in, and what it gives undisturbed."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from progress import IDLE, Idleness

BEAM = """[beam]
length = "180 mm"
width = "20 mm"
thickness = "1.034 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.017
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0 mm"
restitution = 0.72
[sensor]
position = "100 mm"
[drive]
voltage = "0.6 V"
gain = "5.16e-4 1/V"
[sweep]
frequency = { from = "14 Hz", to = "17 Hz", points = 61 }
settle = 60
hold = 20
[fidelity.beam]
reduction = "modal"
modes = 8
[fidelity.sdof]
reduction = "static_mode"
[figure]
format = "svg"
"""
SETTLED = BEAM.replace("settle = 60", "settle = 2000").replace("points = 61", "points = 401")
FORMULA = '[fidelity.orbit]\nreduction = "static_mode"\nsolver = "orbit"\n'
STEPPED = '[fidelity.steps]\nreduction = "static_mode"\nsolver = "moreau"\n'
SHOWN = '[show.motion]\nkind = "portrait"\nfrequency = "15.3 Hz"\n'
SAMPLED = '[show.orders]\nkind = "harmonics"\nfrequency = "15.3 Hz"\nfidelities = ["beam"]\n'

DISTURBED = {
    "points": SETTLED,
    "curves": BEAM + FORMULA + SHOWN,
    "steps": BEAM + STEPPED + SHOWN + SAMPLED,
}

DESCRIPTIONS = ("long_name", "units", "flag_meanings", "flag_values", "meaning", "NAME", "CLASS")  # of no use to vibeam
REFERENCES = ("DIMENSION_LIST", "REFERENCE_LIST", "checksum")

OTHER_EACH_TIME = ("cpu_seconds", "checksum")  # the checksum of a point is of its CPU time too

OF_TIMES = ("comparison@key", "compared@key")  # keys that are of CPU times too

SECONDS = re.compile(rb'"\w*seconds": [^,}]*')  # in what is stored as JSON

PATIENCE = 300  # seconds of CPU time

GLANCE = 1.0  # seconds after which it is looked whether a command works


@dataclass(frozen=True)
class Run:
    """How a command ended: exit ``code`` (negative: by that signal), output, wall seconds."""

    code: int
    out: str
    err: str
    seconds: float


def vibeam(
    arguments: Sequence[str | Path],
    folder: Path,
    *,
    before: Callable[[], None] = lambda: None,
    environment: Mapping[str, str] | None = None,
    kill: tuple[float, int] | None = None,
    interpreter: Sequence[str] = (),
) -> Run:
    """Run a command in ``folder``; ``before``: in its process, first; ``kill``: a signal after so many seconds."""

    def first() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a background job inherits it as ignored
        resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
        before()

    start = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, *interpreter, "-m", "vibeam", *map(str, arguments)],
        cwd=folder, env=usual_environment() if environment is None else dict(environment), stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=first, text=True, errors="replace",
    )  # fmt: skip
    if kill is not None:
        time.sleep(kill[0])
        process.send_signal(kill[1])
    out, err = _ended(process)
    return Run(process.returncode, out, err, time.monotonic() - start)


def _ended(process: subprocess.Popen[str]) -> tuple[str, str]:
    """What a command printed; one that waits for ``IDLE`` seconds without working is ended."""
    idleness, more = Idleness(process.pid), ""
    while True:
        try:
            out, err = process.communicate(timeout=GLANCE)
        except subprocess.TimeoutExpired:
            if idleness.lasts() and not more:
                more = f"\nwaits for {IDLE:g} s without working"
                process.kill()
        else:
            return out, err + more


def usual_environment() -> dict[str, str]:
    """Environment of a command: this process's, its paths, no window."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return {**os.environ, "PYTHONPATH": paths, "MPLBACKEND": "agg", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def write_case(name: str, folder: Path) -> Path:
    file = folder / f"{name}.toml"
    file.write_text(DISTURBED[name], encoding="utf-8")
    return file


@dataclass(frozen=True)
class Undisturbed:
    """A run that nothing disturbed: its data, the bytes and names of its files, wall seconds."""

    data: dict[str, bytes]
    content: bytes
    files: frozenset[str]
    seconds: float


@cache
def undisturbed(name: str) -> Undisturbed:
    with tempfile.TemporaryDirectory() as folder:
        write_case(name, Path(folder))
        ran = vibeam(["run", f"{name}.toml"], Path(folder))
        assert ran.code == 0, ran.err
        file = Path(folder, f"{name}.h5")
        names = frozenset(path.name for path in Path(folder).iterdir())
        return Undisturbed(data_of(file), file.read_bytes(), names, ran.seconds)


def data_of(file: Path) -> dict[str, bytes]:
    """Every dataset and attribute but provenance, CPU times, references, as bytes by name."""
    found: dict[str, bytes] = {}

    def note(name: str, item: Any) -> None:
        if name.startswith("provenance") or name.rsplit("/", 1)[-1] in OTHER_EACH_TIME:
            return
        for key in set(item.attrs) - set(REFERENCES):
            found[f"{name}@{key}"] = _bytes(item.attrs[key])
        if isinstance(item, h5py.Dataset):
            found[name] = _bytes(item[()])

    with h5py.File(file, "r") as opened:
        found["@"] = b" ".join(_bytes(opened.attrs[key]) for key in sorted(opened.attrs))
        opened.visititems(note)
    for key in [each for each in found if each in OF_TIMES or each.endswith("@cpu_seconds")]:
        del found[key]
    return found


def _bytes(value: Any) -> bytes:
    if isinstance(value, bytes):
        return SECONDS.sub(b"", value)
    values = np.asarray(value)
    return f"{values.dtype.str} {values.shape} ".encode() + values.tobytes()


def difference(file: Path, name: str, *, described: bool = True) -> str:
    """What differs in a results file from that of the undisturbed run; empty: nothing.

    Not ``described``: only what vibeam reads back, each by its name.
    """
    wanted = undisturbed(name).data
    if not described:
        wanted = {key: each for key, each in wanted.items() if key != "@" and key.partition("@")[2] not in DESCRIPTIONS}
    found = data_of(file) if described else _data_named(file, wanted)
    names = sorted(key for key in found.keys() | wanted.keys() if found.get(key) != wanted.get(key))
    return f"{len(names)} data differ: {', '.join(names[:4])}" if names else ""


def _data_named(file: Path, names: Iterable[str]) -> dict[str, bytes]:
    """Datasets and attributes of these names, as ``data_of`` has them."""
    found = {}
    with h5py.File(file, "r") as opened:
        for name in names:
            place, _, attribute = name.partition("@")
            item = opened[place]
            found[name] = _bytes(item.attrs[attribute] if attribute else item[()])
    return found


def fault_of_message(ran: Run, codes: Sequence[int]) -> str:
    """A command ends with one of the codes, without a traceback; unless 0 or by a signal, with a message."""
    if not has_begun(ran):
        return ""
    if "Traceback" in ran.err or ran.code not in codes:
        lines = [line for line in ran.err.strip().splitlines() if line.strip()]
        return f"exit {ran.code}: {' | '.join(lines[-4:])[:500]}"
    return "exit 2 without a message" if ran.code == 2 and not ran.err.strip() else ""


def has_begun(ran: Run) -> bool:
    """Whether a command was not interrupted before its first line: Python imports ``site`` and ``runpy`` until then."""
    by_hand = ran.code == -signal.SIGINT or (ran.code == 1 and "KeyboardInterrupt" in ran.err)
    return not by_hand or "/vibeam/" in ran.err


def fault_of_completion(name: str, folder: Path) -> str:
    """The run is continued: it ends well, with the data of an undisturbed one, and leaves no other files."""
    ran = vibeam(["run", f"{name}.toml"], folder)
    if fault := fault_of_message(ran, [0]):
        return f"continued: {fault}"
    if fault := difference(folder / f"{name}.h5", name):
        return f"continued: {fault}"
    more = sorted({path.name for path in folder.iterdir()} - undisturbed(name).files)
    return f"left behind: {', '.join(more)}" if more else ""


def limited(kind: int, most: int) -> Callable[[], None]:
    """What sets a resource limit in a new process."""
    return lambda: resource.setrlimit(kind, (most, most))
