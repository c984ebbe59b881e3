"""Stand-ins for the commands of schedulers, and for ``vibeam map``: tasks as processes, with the variables they have.

``install`` puts them into a folder for ``PATH``. Each scheduler stops one task: by SIGTERM after its first step, or as
if its node were lost, and does with it what the true one does. Tasks run one after the other.
"""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

ITEMS, STOPPED_PART = 12, 2


def vibeam(arguments: Sequence[str]) -> int:
    """The contract of ``vibeam map``: items as files, each computed once; 143 after SIGTERM, 0 of a complete share.

    The part ``STOPPED_PART`` waits after its first item, the first time, to be stopped.
    """
    (out,) = (Path(value) for key, value in pairwise(arguments) if key == "--out")
    folder = Path(f"{out}.parts")
    if "--gather" in arguments:
        missing = [each for each in range(ITEMS) if not (folder / str(each)).exists()]
        if not missing:
            out.write_text(f"{arguments[1]} {arguments[2]}")
        return 2 if missing else 0
    number, of = map(int, arguments[arguments.index("--part") + 1].split("/"))
    told: list[int] = []
    signal.signal(signal.SIGTERM, lambda *_: told.append(1))
    folder.mkdir(exist_ok=True)
    for item in range(number - 1, ITEMS, of):
        if (folder / str(item)).exists():
            continue
        (folder / str(item)).write_text(arguments[1])
        with (folder / "log").open("a") as log:
            log.write(f"{item}\n")
        while number == STOPPED_PART and item == number - 1 and not told:
            time.sleep(0.01)
        if told:
            return 143
    return 0


def _options(lines: Sequence[str]) -> dict[str, str]:
    """Options as ``--name=value`` or ``--name value``."""
    words = [part for line in lines for word in shlex.split(line) for part in word.split("=", 1)]
    return {one: other for one, other in zip(words, [*words[1:], ""], strict=True) if one.startswith("--")}


def _directives(script: Path, mark: str) -> dict[str, str]:
    """Options in the comments of a script, those before its first command."""
    lines = script.read_text().splitlines()
    if lines[0] != "#!/bin/bash":
        raise SystemExit("a script begins with its interpreter")
    head = lines[: next(at for at, line in enumerate(lines) if line and not line.startswith("#"))]
    return _options([line.removeprefix(mark) for line in head if line.startswith(f"{mark} ")])


def _numbers(array: str) -> Iterator[int]:
    for each in array.split(","):
        first, _, last = each.partition("-")
        yield from range(int(first), int(last or first) + 1)


def _run(command: Sequence[str], stop: int | None = None, **more: str) -> int:
    """Exit code of a task in a process group of its own, which the signal ``stop`` ends after its first step."""
    environment: Mapping[str, str] = os.environ | more
    task = subprocess.Popen(command, env=environment, start_new_session=True)
    if stop is not None:
        first = Path(f"{os.environ['OUT']}.parts/{STOPPED_PART - 1}")
        while task.poll() is None and not first.exists():
            time.sleep(0.01)
        time.sleep(0.1)
        os.killpg(task.pid, stop)
    return task.wait()


def sbatch(arguments: Sequence[str]) -> int:
    """Slurm: an array whose second task is out of time; requeued tasks run again, a job that depends on it after it."""
    given, state = _options([shlex.join(arguments)]), Path(os.environ["STATE"])
    if "--wrap" in given:
        failed = (state / "failed").read_text()
        return 1 if given["--dependency"] != "afterok:7" or failed else _run(["bash", "-c", given["--wrap"]])
    script = Path(arguments[-1])
    said = _directives(script, "#SBATCH") | given
    failed = ""
    for number in _numbers(said["--array"]):
        names = {"SLURM_ARRAY_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": str(number), "SLURM_JOB_ID": str(7 + number)}
        stop = signal.SIGTERM if number == STOPPED_PART and said["--signal"] == "TERM@60" else None
        code = _run(["bash", str(script)], stop, **names)
        requeued = state / f"requeue-7_{number}"
        if requeued.exists() and "--requeue" in said:
            requeued.rename(state / "requeued")
            code = _run(["bash", str(script)], **names, SLURM_RESTART_COUNT="1")
        failed += f" {number}" * bool(code)
    (state / "failed").write_text(failed)
    print("7" if "--parsable" in given else "Submitted batch job 7")
    return 0


def srun(arguments: Sequence[str]) -> int:
    """Slurm: a step of the task that is under way."""
    os.execvp(arguments[0], list(arguments))


def scontrol(arguments: Sequence[str]) -> int:
    """Slurm: a task back into the queue."""
    what, which = arguments
    Path(os.environ["STATE"], f"{what}-{which}").touch()
    return 0


def hq(arguments: Sequence[str]) -> int:
    """HyperQueue: one task is told to end, and fails; the worker of another is lost, and the server runs it again."""
    script = Path(arguments[-1]).resolve()
    said, codes = _directives(script, "#HQ"), []
    if arguments[0] != "submit" or int(said["--crash-limit"]) < 1:
        return 2
    for number in _numbers(said["--array"]):
        names = {"HQ_JOB_ID": "1", "HQ_TASK_ID": str(number)}
        begun = Path(f"{os.environ['OUT']}.parts", str(number - 1)).exists()
        lost = os.environ.get("LOST") and not begun
        code = _run([str(script)], None if number != STOPPED_PART or begun else _signal(bool(lost)), **names)
        codes.append(_run([str(script)], **names, HQ_INSTANCE_ID="1") if code == -signal.SIGKILL else code)
    return int(any(codes))


def _signal(lost: bool) -> int:
    return signal.SIGKILL if lost else signal.SIGTERM


def parallel(arguments: Sequence[str]) -> int:
    """GNU parallel: a line for each value, one of them told to end, tried anew as often as asked."""
    at = arguments.index(":::")
    first = next(i for i, each in enumerate(arguments) if each == "vibeam")
    said, codes = _options([shlex.join(arguments[:first])]), []
    if int(said["--jobs"]) < 1 or not said["--termseq"].startswith("TERM,"):
        return 2
    for value in arguments[at + 1 :]:
        line = ["bash", "-c", " ".join(each.replace("{}", value) for each in arguments[first:at])]
        code = _run(line, signal.SIGTERM if int(value) == STOPPED_PART else None)
        for _ in range(1, int(said["--retries"])):
            code = code and _run(line)
        codes.append(code)
    Path(said["--joblog"]).write_text("\n".join(map(str, codes)))
    return sum(map(bool, codes))


RULE = re.compile(r"^rule (\w+):\n((?:    .*\n)+)", re.MULTILINE)


class _Named(dict[str, object]):
    __getattr__ = dict.__getitem__


def snakemake(arguments: Sequence[str]) -> int:
    """Snakemake: the files that a rule needs first; a task that fails is tried anew."""
    text = Path("Snakefile").read_text()
    config = dict(each.split("=", 1) for each in arguments if "=" in each)
    known: dict[str, object] = {
        "config": config, "touch": lambda path: path,
        "expand": lambda path, part: [path.format(part=each) for each in part],
    }  # fmt: skip
    exec(text[: RULE.search(text).start()], known)  # type: ignore[union-attr]  # the head is Python's
    rules = {name: eval(f"dict({_keywords(body)})", known) for name, body in RULE.findall(text)}
    return 0 if _made(rules, rules["all"]["input"]) else 1


def _keywords(body: str) -> str:
    return ",".join(
        f"{key}=dict({said})" if key in ("params", "resources") else f"{key}={said}"
        for key, _, said in (line.strip().partition(": ") for line in body.splitlines())
    )


def _made(rules: Mapping[str, dict[str, object]], wanted: object) -> bool:
    """Make a file by the rule whose output it is."""
    for rule in rules.values():
        pattern = re.sub(r"\\{(\w+)\\}", r"(?P<\1>[^/]+)", re.escape(str(rule.get("output", ""))))
        found = re.fullmatch(pattern, str(wanted))
        if not found:
            continue
        needed = rule.get("input", [])
        if not all(_made(rules, each) for each in needed):  # type: ignore[union-attr, attr-defined]
            return False
        named = _Named(rule.get("params", {}))  # type: ignore[call-overload]
        line = str(rule["shell"]).format(params=named, wildcards=_Named(found.groupdict()), output=wanted)
        stopped = found.groupdict().get("part") == str(STOPPED_PART)
        codes = [_run(["bash", "-c", line], signal.SIGTERM if stopped else None)]
        while codes[-1] and len(codes) <= int(str(rule.get("retries", 0))):
            codes.append(_run(["bash", "-c", line]))
        if not codes[-1] and found.groupdict():
            Path(str(wanted)).parent.mkdir(exist_ok=True)
            Path(str(wanted)).touch()
        return not codes[-1]
    return False


COMMANDS: tuple[Callable[[Sequence[str]], int], ...] = (vibeam, sbatch, srun, scontrol, hq, parallel, snakemake)


def install(folder: Path, *names: str) -> None:
    """Put the stand-ins into a folder; ``names``: these alone."""
    folder.mkdir(exist_ok=True)
    for command in COMMANDS:
        if not names or command.__name__ in names:
            file = folder / command.__name__
            file.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -S {__file__} {command.__name__} "$@"\n')
            file.chmod(0o755)


if __name__ == "__main__":
    sys.exit(next(each for each in COMMANDS if each.__name__ == sys.argv[1])(sys.argv[2:]))
