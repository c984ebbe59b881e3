"""Blocks of a map by other processes: the same bits, a lost worker's block again, other workers refused.

pip install 'vibeam[cluster]'; python -m pytest -m slow tests/vibeam/maps/test_maps_cluster.py
"""

from __future__ import annotations

import logging
import os
import pickle
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from stand_in import SI

import vibeam
from vibeam.maps import cluster as clusters
from vibeam.maps import run as running
from vibeam.maps.block import Block, Values, evaluate_block
from vibeam.maps.cluster import Cluster, ClusterError, connected

ROOT = Path(__file__).parents[3]

AXES = [
    {"key": "stop.gap", "from": 0.0, "to": 1e-4, "points": 12},
    {"key": "sweep.frequency", "from": "14 Hz", "to": "17 Hz", "points": 9},
]


def case(**more: Any) -> vibeam.Case:
    table = {"axes": AXES, "fidelities": ["sdof"], "direction": "both", "settle": 60, "hold": 8} | more
    return vibeam.load(ROOT / "cases/dtu_neutral.toml", set=SI | {"map": {"m": table}})


def data(path: Path) -> dict[str, Any]:
    with h5py.File(path) as file:
        return {name: file["sdof"][name][()] for name in ("amplitude", "period", "ended")}


def require_equal(one: Path, other: Path) -> None:
    for name, values in data(one).items():
        np.testing.assert_array_equal(values, data(other)[name], err_msg=name)


@pytest.fixture
def by_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "lines_of_block", lambda case, grid: 1)


@pytest.mark.usefixtures("by_lines")
def test_blocks_that_are_sent_elsewhere_give_the_same_file(tmp_path: Path) -> None:
    sent: list[int] = []

    def elsewhere(block: Block) -> Values:
        there: Block = pickle.loads(pickle.dumps(block))
        sent.append(there.first)
        values: Values = pickle.loads(pickle.dumps(evaluate_block(there, threads=1)))
        return values

    vibeam.run_map(case(), "m", tmp_path / "here.h5")
    vibeam.run_map(case(), "m", tmp_path / "there.h5", cluster=Cluster(elsewhere, 3))
    require_equal(tmp_path / "here.h5", tmp_path / "there.h5")
    assert sorted(sent) == list(range(12))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such scheduler file"), ("nonsense{", "is no scheduler file"), ("[" * 9999, "is no sch"),
        ('{"id": 5}', "names no address"), ('{"address": "rm -rf"}', "names no address"), ("7", "names no address"),
    ],
)  # fmt: skip
def test_a_scheduler_file_that_is_none_is_named_at_once(
    content: str | None, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if content is not None:
        (tmp_path / "s.json").write_text(content)
    client = SimpleNamespace(Client=lambda *given, **named: pytest.fail("Dask was asked"))
    monkeypatch.setitem(sys.modules, "distributed", client)
    with (
        pytest.raises(ClusterError, match=f"^{re.escape(str(tmp_path / 's.json'))}: .*{said}.*: start dask scheduler "),
        connected(str(tmp_path / "s.json")),
    ):
        pass


@pytest.mark.parametrize("where", ["nonsense", "tcp://", "tcp://a b:1", "host:", ""])
def test_what_is_no_address_is_refused_at_once(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=lambda *_, **__: pytest.fail("asked")))
    with pytest.raises(ClusterError, match=r"is no address of a scheduler: write tcp://host:8786"), connected(where):
        pass


def test_what_dask_logs_of_a_lost_scheduler_is_not_printed(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    loggers = [logging.getLogger(name) for name in ("distributed.client", "distributed.core", "asyncio")]
    levels = [each.level for each in loggers]

    def lost(*given: Any, **named: Any) -> None:
        for each in loggers:
            each.error("Traceback (most recent call last)")
        raise OSError("nobody there")

    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=lost))
    with pytest.raises(ClusterError, match="no scheduler answers there"), connected("tcp://localhost:8786"):
        pass
    assert caplog.records == []
    assert [each.level for each in loggers] == levels


def test_without_dask_the_cure_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"pip install 'vibeam\[cluster\]'"), connected("tcp://localhost:8786"):
        pass


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two workers as processes of their own; the scheduler's file and the workers."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    paths = os.pathsep.join(map(str, (ROOT, ROOT / "models", ROOT / "reductions", os.environ.get("PYTHONPATH", ""))))
    keys = os.environ | {"PYTHONPATH": paths, "OMP_NUM_THREADS": "1"}
    python = [sys.executable, "-m"]
    begin: Any = {"env": keys, "cwd": tmp_path, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    main = subprocess.Popen(
        [*python, "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)],
        **begin,
    )
    options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--scheduler-file", str(file)]
    workers = [subprocess.Popen([*python, "distributed.cli.dask_worker", *options], **begin) for _ in range(2)]
    try:
        deadline = time.monotonic() + 60
        while not file.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        yield str(file), workers
    finally:
        for process in (*workers, main):
            process.kill()
            process.wait()


@pytest.mark.slow
@pytest.mark.usefixtures("by_lines")
def test_a_map_survives_the_loss_of_a_worker_to_the_bit(
    tmp_path: Path, scheduler: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    file, workers = scheduler
    long = {"settle": 4000}
    lost: list[int] = []

    def progress(done: int, total: int) -> None:
        if done > 3 * 18 and not lost:
            lost.append(done)
            workers[0].kill()

    with connected(file) as cluster:
        assert cluster.blocks == 4
        vibeam.run_map(case(**long), "m", tmp_path / "there.h5", cluster=cluster, progress=progress)
    vibeam.run_map(case(**long), "m", tmp_path / "here.h5")
    require_equal(tmp_path / "here.h5", tmp_path / "there.h5")
    assert lost


@pytest.mark.slow
def test_workers_of_another_code_are_refused(
    scheduler: tuple[str, list[subprocess.Popen[bytes]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clusters, "_own", lambda: "another")
    with (
        pytest.raises(ClusterError, match=r"workers would give other numbers: tcp://.* has another vibeam"),
        connected(scheduler[0]),
    ):
        pass
