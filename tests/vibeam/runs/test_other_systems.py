"""Files and locks by the calls of Windows: in a process that lacks those of POSIX, with a stand-in for ``msvcrt``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

WITHOUT_POSIX = r"""
import os, sys, pathlib, tempfile, types, warnings, platform, subprocess, ctypes, numpy
held, close, unlink, paths = {}, os.close, pathlib.Path.unlink, {}

def locking(handle, mode, count):  # a byte of a file is locked for a descriptor, until that is closed
    state = os.fstat(handle)
    byte = (state.st_ino, os.lseek(handle, 0, os.SEEK_CUR), count)
    if held.setdefault(byte, handle) != handle:
        raise PermissionError(13, "Permission denied")

def closing(handle):
    for byte in [byte for byte, owner in held.items() if owner == handle]:
        del held[byte]
    close(handle)

def unlinking(path, missing_ok=False):  # what is open cannot be deleted
    links = (os.path.join("/proc/self/fd", each) for each in os.listdir("/proc/self/fd"))
    if str(path) in [os.readlink(each) for each in links if os.path.lexists(each)]:
        raise PermissionError(13, "The process cannot access the file because it is being used by another process")
    unlink(path, missing_ok)

sys.modules.update(msvcrt=types.SimpleNamespace(LK_NBLCK=2, locking=locking), fcntl=None, resource=None)
os.close, pathlib.Path.unlink, sys.platform = closing, unlinking, "win32"
for name in ("pwrite", "pread", "fchmod", "memfd_create"):
    delattr(os, name)
from vibeam.exchange.whole_files import is_sealed, read_sealed, write_sealed
from vibeam.store.errors import StoreError
from vibeam.store.place import locked
from vibeam_models.memory import free_bytes

out, content = pathlib.Path(sys.argv[1]), bytes(range(256)) * 9000
"""

FILES = """
write_sealed(out, b"before")
write_sealed(out, content)
assert is_sealed(out) and read_sealed(out) == content and free_bytes()
assert os.listdir(out.parent) == [out.name]
"""

LOCKS = """
with locked(out) as place:
    try:
        with locked(out):
            raise SystemExit("a second writer has the lock")
    except StoreError as fault:
        assert f"process {os.getpid()} on" in str(fault) and "is writing it" in str(fault), fault
    place.replace(content)
    waiting = os.open(out.parent / ".out.h5.lock", os.O_RDWR)  # another process is about to try
assert os.listdir(out.parent) != [out.name]
os.close(waiting)
with locked(out):
    pass
assert os.listdir(out.parent) == [out.name] and out.read_bytes().startswith(content)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="takes Linux's calls away")
@pytest.mark.parametrize("work", [FILES, LOCKS])
def test_the_store_needs_no_call_of_posix(work: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", WITHOUT_POSIX + work, str(tmp_path / "out.h5")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
