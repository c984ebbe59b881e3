"""The level of libraries that this machine's processor takes."""

from __future__ import annotations

import platform
import struct
import sys
from pathlib import Path

V2 = {"cx16", "lahf_lm", "popcnt", "pni", "sse4_1", "sse4_2", "ssse3"}
V3 = V2 | {"abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe", "xsave"}
FIRST = 16384  # bytes of /proc/cpuinfo in which the first processor's flags stand


def level(cpuinfo: Path = Path("/proc/cpuinfo")) -> str | None:
    """The highest level that runs here (see ``manifest.LEVELS``); None where none does."""
    machine = platform.machine()
    if sys.platform != "linux" or struct.calcsize("P") != 8:
        return None
    if machine == "aarch64":
        return "aarch64" if sys.byteorder == "little" else None
    flags = _flags(cpuinfo) if machine == "x86_64" else set()
    return "x86-64-v3" if flags >= V3 else "x86-64-v2" if flags >= V2 else None


def _flags(cpuinfo: Path) -> set[str]:
    try:
        with cpuinfo.open(encoding="utf-8") as file:
            lines = file.read(FIRST).splitlines()
    except OSError:
        return set()
    return next((set(line.partition(":")[2].split()) for line in lines if line.startswith("flags")), set())
