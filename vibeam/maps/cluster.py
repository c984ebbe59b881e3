"""Blocks of a map as tasks of Dask's workers, on this machine or others; the client alone writes.

A block is described by plain data and a worker computes it by the function that computes it here, so that the numbers
are the same to the bit; workers of another code or other kernels are refused. A block whose worker is lost goes to
another one.
"""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vibeam.flight.engine.threads import pause
from vibeam.maps.block import Block, evaluate_block
from vibeam.store.blocks import Values
from vibeam.store.errors import reason

Evaluate = Callable[[Block], Values]
WAIT = 15.0  # s for the scheduler and its first worker
LOOK = 0.2  # s between two looks whether the run is to stop
AHEAD = 2  # blocks in flight for each thread of a worker: one computed, one waiting


ADDRESS = re.compile(r"(\w+://)?[^\s/]+:\d+")


class ClusterError(ValueError):
    """Scheduler that cannot be used: the message says why, and the cure."""


@dataclass(frozen=True)
class Cluster:
    """``evaluate`` a block by some worker; ``blocks``: how many are in flight at once."""

    evaluate: Evaluate
    blocks: int


def evaluate_here(block: Block) -> Values:
    """One block in one thread of this process."""
    return evaluate_block(block, threads=1)


@contextmanager
def connected(where: str) -> Iterator[Cluster]:
    """The workers of a Dask scheduler, by its address (``tcp://host:8786``) or its scheduler file (.json).

    ClusterError where Dask is not installed, no scheduler or worker answers, or workers would give other numbers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ClusterError("--cluster needs Dask: pip install 'vibeam[cluster]'") from None
    address = _address_in(Path(where)) if where.endswith(".json") else where
    if not ADDRESS.fullmatch(address):  # Dask would look for it for half a minute
        raise ClusterError(f"{where}: is no address of a scheduler: write tcp://host:8786, or name its file (.json)")
    with _silent():
        try:
            made: Any = Client
            client = made(address, timeout=WAIT, set_as_default=False)
        except (OSError, ValueError, TypeError) as fault:
            raise ClusterError(f"{where}: no scheduler answers there ({fault})") from None
        try:
            _require_alike(client, where)
            yield Cluster(lambda block: _result(client, block), AHEAD * max(sum(client.nthreads().values()), 1))
        finally:
            client.close()


@contextmanager
def _silent() -> Iterator[None]:
    """Context without what Dask and asyncio log of a lost connection: tracebacks above the one message."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client", "asyncio")]
    levels = [each.level for each in loggers]
    for each in loggers:
        each.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for each, level in zip(loggers, levels, strict=True):
            each.setLevel(level)


def _address_in(file: Path) -> str:
    """The address in a scheduler file."""
    begin = f"start dask scheduler --scheduler-file {file}"
    try:
        address = json.loads(file.read_bytes())["address"]
        if ADDRESS.fullmatch(address):
            return str(address)
    except FileNotFoundError:
        raise ClusterError(f"{file}: there is no such scheduler file: {begin}") from None
    except OSError as fault:
        raise ClusterError(f"{file}: cannot be read ({reason(fault)}): {begin}") from None
    except (ValueError, TypeError, KeyError, RecursionError):
        pass
    raise ClusterError(f"{file}: is no scheduler file, it names no address: {begin}")


def fingerprint() -> str:
    """Digest of what decides the bits of a number in this process: code, libraries below it, compiled kernels."""
    from vibeam.flight.engine.entries import origin
    from vibeam.runs.keys import digest_of_code

    return f"{digest_of_code()} {origin()}"


_own = fingerprint


def _require_alike(client: Any, where: str) -> None:
    try:
        client.wait_for_workers(1, timeout=WAIT)
    except Exception as fault:  # Dask's own timeout, of several kinds
        raise ClusterError(f"{where}: no worker has come within {WAIT:g} s: start dask worker {where}") from fault
    found: Mapping[str, Any] = client.run(fingerprint, on_error="return")
    own = _own()
    other = [name for name, each in found.items() if each != own]
    if other:
        said = found[other[0]]
        failed = isinstance(said, BaseException)
        why = f"cannot run vibeam ({said})" if failed else "has another vibeam or other kernels"
        raise ClusterError(
            f"{where}: {len(other)} of {len(found)} workers would give other numbers: {other[0]} {why}: "
            "install the same version of vibeam and of the libraries below it there"
        )


def _result(client: Any, block: Block) -> Values:
    from concurrent.futures import CancelledError

    from distributed import TimeoutError as Late

    future = client.submit(evaluate_here, block, pure=False)
    try:
        while True:
            pause()
            try:
                values: Values = future.result(timeout=LOOK)
            except Late:
                continue
            return values
    except CancelledError:
        raise ClusterError("the scheduler has gone: run again to go on from what is stored") from None
    finally:
        future.cancel()
