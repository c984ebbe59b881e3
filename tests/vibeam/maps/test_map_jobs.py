"""Job scripts of maps under stand-ins for their schedulers: a task that is stopped keeps its work, and is run again."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import schedulers

import vibeam

JOBS = Path(__file__).parents[3] / "cases" / "maps" / "jobs"
PARTS = 4


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """Folder with copies of the scripts, of four parts, and the stand-ins beside."""
    for script in JOBS.iterdir():
        shutil.copy(script, tmp_path)
        copy = tmp_path / script.name
        copy.write_text(re.sub(r"\b1-64\b", f"1-{PARTS}", copy.read_text()))
    schedulers.install(tmp_path / "bin")
    return tmp_path


def run(place: Path, line: str, **more: str) -> subprocess.CompletedProcess[str]:
    own = {"CASE": "case.toml", "NAME": "plane", "OUT": "out.h5", "PARTS": str(PARTS), "STATE": str(place)}
    known = os.environ | own | {"PATH": f"{place / 'bin'}{os.pathsep}{os.environ['PATH']}"} | more
    return subprocess.run(["bash", "-c", line], cwd=place, env=known, capture_output=True, text=True, timeout=60)


def require_each_once(place: Path) -> None:
    """All items are there, none was computed twice, and the gathered file is of the map that was asked for."""
    computed = (place / "out.h5.parts/log").read_text().split()
    assert sorted(map(int, computed)) == list(range(schedulers.ITEMS))
    assert (place / "out.h5").read_text() == "case.toml plane"


GATHER = "vibeam map case.toml plane --gather --out out.h5"


def test_a_slurm_array_queues_what_is_out_of_time_again(place: Path) -> None:
    line = f'id=$(sbatch --parsable slurm.sh) && sbatch --dependency=afterok:$id --mem=4G --wrap "{GATHER}"'
    done = run(place, line)
    assert done.returncode == 0, done.stderr
    assert (place / "requeued").exists()
    require_each_once(place)


def test_some_parts_of_a_slurm_array_are_the_same_parts(place: Path) -> None:
    assert run(place, "sbatch --array=1,3 slurm.sh").returncode == 0
    assert sorted(map(int, (place / "out.h5.parts/log").read_text().split())) == [0, 2, 4, 6, 8, 10]


@pytest.mark.parametrize("lost", ["", "yes"])
def test_hyperqueue_computes_what_is_missing(place: Path, lost: str) -> None:
    line = f"hq submit --wait ./hyperqueue.sh && {GATHER}"
    first = run(place, line, LOST=lost)
    assert (first.returncode, (place / "out.h5").exists()) == ((0, True) if lost else (1, False)), first.stderr
    assert run(place, line).returncode == 0
    require_each_once(place)


def test_gnu_parallel_tries_a_part_again(place: Path) -> None:
    done = run(place, "./parallel.sh")
    assert done.returncode == 0, done.stderr
    require_each_once(place)


def test_snakemake_tries_a_part_again_and_gathers_at_the_end(place: Path) -> None:
    done = run(place, f"snakemake --cores 2 --config case=case.toml name=plane out=out.h5 parts={PARTS}")
    assert done.returncode == 0, done.stderr
    require_each_once(place)


NAMED = re.compile(r"""NAME:-(\w+)|"name", "(\w+)"|fig18\.toml (\w+) --gather""")


@pytest.mark.parametrize("script", sorted(JOBS.iterdir()), ids=lambda each: each.name)
def test_a_script_is_short_and_names_a_map_that_there_is(script: Path) -> None:
    text = script.read_text()
    assert len(text.splitlines()) <= 30
    assert "cases/maps/fig18.toml" in text
    names = {name for found in NAMED.findall(text) for name in found if name}
    assert names
    assert names <= set(vibeam.load(JOBS.parent / "fig18.toml").maps)
