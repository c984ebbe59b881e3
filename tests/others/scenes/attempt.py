"""A peer at a scene in a process of its own: so many seconds of CPU time, after it has prepared what it compiles."""

from __future__ import annotations

import math
import multiprocessing as mp
import os
import resource
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from multiprocessing.connection import Connection
from time import process_time

import numpy as np

from tests.others.scenes.told import Answer, Told

READY = 60  # CPU seconds in which it must have prepared
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false"}
SHORT, REPEATS = 0.3, 5000  # CPU seconds up to which a run is done again, and how often at most


@dataclass
class Attempt:
    """What came of it; ``answer`` None where it did not end or broke.

    Times of CPU, s: of a run, and of getting ``ready``, its package imported and what it compiles compiled.
    """

    peer: str
    package: str = ""
    setting: str = ""
    answer: Answer | None = None
    complaint: str = "not prepared"
    seconds: float | None = None
    ready: float = math.nan


def attempt(file: str, number: int, told: Told, seconds: int) -> Attempt:
    """The peer of that number in a file of this folder, with so many seconds of CPU time."""
    context = mp.get_context("fork")
    mine, its = context.Pipe(duplex=False)
    process = context.Process(target=_alone, args=(file, number, told, seconds, its))
    process.start()
    its.close()
    found = Attempt(file)
    try:
        while True:
            found = mine.recv()
    except EOFError:
        return found
    finally:
        process.join()


def _alone(file: str, number: int, told: Told, seconds: int, pipe: Connection) -> None:
    os.environ.update(ONE_THREAD)
    for printed in (1, 2):  # by libraries
        os.dup2(os.open(os.devnull, os.O_WRONLY), printed)
    np.seterr(all="ignore")
    begun, found = process_time(), Attempt(file)
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (_used() + READY, resource.RLIM_INFINITY))
        peer = import_module(f"tests.others.scenes.{file}").PEERS[number]
        found = Attempt(peer.name, peer.package, peer.setting)
        run = peer.prepare(told)
        found = replace(found, complaint=f"not within {seconds} s", ready=process_time() - begun)
        pipe.send(found)
        resource.setrlimit(resource.RLIMIT_CPU, (_used() + seconds, resource.RLIM_INFINITY))
        answer, spent = _timed(run)
        pipe.send(replace(found, answer=answer, complaint=answer.complaint, seconds=spent))
    except TimeoutError:
        return
    except Exception as error:
        lines = str(error).strip().splitlines() or [""]
        pipe.send(replace(found, complaint=f"{type(error).__name__}: {lines[-1][:80]}"))


def _used() -> int:
    return math.ceil(process_time())


def _timed(run: Callable[[], Answer]) -> tuple[Answer, float]:
    """The answer, and the mean of CPU seconds: the clock of a process with a limit ticks every 4 ms."""
    begun, spent, own, count = process_time(), 0.0, 0.0, 0
    while not count or (max(spent, own) < SHORT and count < REPEATS):
        answer, count = run(), count + 1
        spent, own = process_time() - begun, own + (answer.seconds or 0.0)
    return answer, (own or spent) / count
