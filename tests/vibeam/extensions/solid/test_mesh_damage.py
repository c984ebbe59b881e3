"""Damaged files of meshes: each ends in words, within 2 GiB of memory, and in time."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from damaged_meshes import WRITERS

SCRIPT = Path(__file__).parents[3] / "support" / "damaged_meshes.py"
LIMIT = 300  # seconds: what never ends is stopped


def read(folder: Path, first: int, count: int, *names: str) -> None:
    ran = subprocess.run(
        [sys.executable, str(SCRIPT), str(folder), str(first), str(count), *names],
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    assert ran.returncode == 0, (ran.stdout.splitlines()[-3:], ran.stderr)
    assert ran.stdout.count(f"of {count} sound") == len(names)


def test_damaged_files_end_in_words(tmp_path: Path) -> None:
    read(tmp_path, 100, 12, *WRITERS)


@pytest.mark.slow
def test_hundreds_of_damaged_files_of_every_format(tmp_path: Path) -> None:
    def many(name: str) -> None:
        folder = tmp_path / name.replace(".", "_")
        folder.mkdir()
        read(folder, 1000, 300, name)

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(many, WRITERS))
