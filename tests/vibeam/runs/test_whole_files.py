"""Files are written as a whole or not at all: what was there stays where the disk takes no more."""

from __future__ import annotations

import os
import resource
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from vibeam.exchange.whole_files import regular, write_whole
from vibeam.report.output import write_csv

LIMITED = """
import resource, sys
sys.path[:0] = {path!r}
from pathlib import Path
from matplotlib.figure import Figure
from vibeam.report.output import write_csv
from vibeam.figures.page import write_page
resource.setrlimit(resource.RLIMIT_FSIZE, (256, resource.RLIM_INFINITY))
folder, failed = Path({folder!r}), 0
writers = [lambda: write_csv([{{"a": number}} for number in range(9999)], folder / "a.csv")]
writers += [lambda name=name: write_page(Figure, [folder / name]) for name in ("a.png", "a.svg", "a.pdf")]
for write in writers:
    try:
        write()
    except OSError as fault:
        failed += fault.filename.startswith({folder!r}) and ".part" not in fault.filename
sys.exit(failed)
"""


def test_a_disk_that_is_full_leaves_what_was_there(tmp_path: Path) -> None:
    names = ("a.csv", "a.png", "a.svg", "a.pdf")
    for name in names[:2]:
        tmp_path.joinpath(name).write_text("before", encoding="utf-8")
    script = LIMITED.format(path=sys.path, folder=str(tmp_path))
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == len(names)
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == dict.fromkeys(
        names[:2], "before"
    )
    assert resource.getrlimit(resource.RLIMIT_FSIZE) != (256, resource.RLIM_INFINITY)


def test_what_is_no_file_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    pipe, link, place = tmp_path / "pipe.csv", tmp_path / "link.csv", tmp_path / "socket.csv"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(place))
        for path, what in ((pipe, "a pipe"), (link, "a pipe"), (place, "a socket"), (Path("/dev/null"), "a device")):
            with pytest.raises(OSError, match=f"is {what}, not a file") as caught:
                write_csv([{"a": 1}], path)
            assert caught.value.filename == str(path)
    with pytest.raises(OSError, match="is a folder"):
        write_whole(tmp_path, b"")


def test_a_link_stays_and_permissions_too(tmp_path: Path) -> None:
    there, link = tmp_path / "a.csv", tmp_path / "b.csv"
    there.write_bytes(b"before")
    there.chmod(0o640)
    link.symlink_to(there)
    write_whole(link, b"after")
    assert (link.is_symlink(), there.read_bytes(), there.stat().st_mode & 0o777) == (True, b"after", 0o640)
    assert regular(tmp_path / "new.csv") == (tmp_path / "new.csv").resolve()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_name_of_any_allowed_length_is_written_and_a_longer_one_is_told_by_itself(tmp_path: Path) -> None:
    longest = tmp_path / ("ä" * 125 + ".csv")
    write_whole(longest, b"1")
    assert longest.read_bytes() == b"1"
    with pytest.raises(OSError, match="too long") as told:
        write_whole(tmp_path / ("a" * 300), b"1")
    assert told.value.filename == str(tmp_path / ("a" * 300))
    assert list(tmp_path.iterdir()) == [longest]
