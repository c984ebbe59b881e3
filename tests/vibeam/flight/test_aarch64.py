"""The libraries for aarch64, run by an emulator: the numbers are those of the libraries for this machine.

Needs qemu-aarch64 and a cross compiler (apt install qemu-user gcc-aarch64-linux-gnu).
"""

from __future__ import annotations

import lzma
import shutil
import struct
import subprocess
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.engine.call import Call
from vibeam.flight.engine.entries import ENTRIES, EntryPoint
from vibeam.flight.engine.loading import file_of, function_of, manifest
from vibeam_models.laws.compliant import HuntCrossley

COMPILER, EMULATOR = "aarch64-linux-gnu-gcc", "qemu-aarch64"

HARNESS = r"""
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Reads slots and the arrays that they point to, calls the function, writes both back. */
int main(int count, char **words)
{
    FILE *in = fopen(words[3], "rb"), *out = fopen(words[4], "wb");
    void *library = dlopen(words[1], RTLD_NOW);
    if (!library) { fprintf(stderr, "%s\n", dlerror()); return 2; }
    int32_t (*function)(int64_t *) = (int32_t (*)(int64_t *))dlsym(library, words[2]);
    int64_t sizes[2];
    if (!function || fread(sizes, 8, 2, in) != 2) return 3;
    int64_t *slots = malloc(8 * sizes[0] + 8), (*heads)[2] = malloc(16 * sizes[1] + 16);
    if (fread(slots, 8, sizes[0], in) != sizes[0] || fread(heads, 16, sizes[1], in) != sizes[1]) return 4;
    for (int64_t i = 0; i < sizes[1]; i++) {
        char *array = malloc(heads[i][1] + 8);
        if (fread(array, 1, heads[i][1], in) != heads[i][1]) return 5;
        slots[heads[i][0]] = (int64_t)array;
    }
    int status = function(slots);
    fwrite(slots, 8, sizes[0], out);
    for (int64_t i = 0; i < sizes[1]; i++)
        fwrite((char *)slots[heads[i][0]], 1, heads[i][1], out);
    fclose(out);
    return status;
}
"""

DRIVE = vibeam.Drive(95.0, 2e-4)

SYSTEM = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], restitution=0.72)


def recorded(monkeypatch: pytest.MonkeyPatch) -> list[tuple[EntryPoint, Any, Any, Any]]:
    """Calls of every entry point: arguments before and after, results."""
    calls: list[tuple[EntryPoint, Any, Any, Any]] = []

    def noting(entry: EntryPoint) -> Any:
        function = function_of(entry.library, entry.module, entry.name)

        def called(*given: Any) -> Any:
            before = deepcopy(given)
            results = function(*given)
            calls.append((entry, before, deepcopy(given), results))
            return results

        return called

    for entry in ENTRIES:
        monkeypatch.setitem(vars(entry), "function", noting(entry))
    vibeam.simulate(SYSTEM, DRIVE, 0.5, certify=True).at([0.1, 0.3])
    vibeam.simulate(replace(SYSTEM, law=HuntCrossley(1e8, 0.4)), DRIVE, 0.3, certify=True).at([0.1, 0.2])
    vibeam.sweep(SYSTEM, omega=[95.0], amplitude=2e-4, settle=5, hold=5)
    vibeam.sweep(SYSTEM, omega=[95.0], amplitude=2e-4, settle=5, hold=5, solver="moreau")
    return calls


def arrays_in(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """The arrays in nested tuples."""
    if isinstance(value, tuple):
        for each in value:
            yield from arrays_in(each)
    elif isinstance(value, np.ndarray):
        yield value


def slots_of(entry: EntryPoint, given: tuple[Any, ...]) -> tuple[np.ndarray[Any, Any], list[int]]:
    """The slots of a call, and which of them are addresses."""
    about = manifest()["libraries"][entry.library]["entries"][entry.name]
    call = Call(lambda address: 0, entry.name, **about)
    call(*given)
    slots, places = np.array(call._local.frame.slots), []
    for group in call._groups:
        at = group.at // 8
        for dtype, axes in group._kinds:
            places += [at] if dtype else []
            at += 1 + axes if dtype else 1
    return slots, places


@pytest.mark.slow
@pytest.mark.skipif(not (shutil.which(COMPILER) and shutil.which(EMULATOR)), reason="no emulator")
def test_an_emulated_aarch64_gives_the_same_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "harness.c").write_text(HARNESS)
    subprocess.run([COMPILER, "-O1", "-w", "harness.c", "-o", "harness", "-ldl", "-lm"], cwd=tmp_path, check=True)
    seen = {}
    for entry, before, after, results in recorded(monkeypatch):
        if seen.setdefault(entry, 0) >= 4:
            continue
        seen[entry] += 1
        (tmp_path / "kernels.so").write_bytes(lzma.decompress(file_of(entry.library, "aarch64").read_bytes()))
        (slots, places), arrays = slots_of(entry, before), list(arrays_in(before))
        heads = b"".join(struct.pack("=qq", at, each.nbytes) for at, each in zip(places, arrays, strict=True))
        content = struct.pack("=qq", len(slots), len(arrays)) + slots.tobytes() + heads
        (tmp_path / "in").write_bytes(content + b"".join(each.tobytes() for each in arrays))
        command = [EMULATOR, "-L", "/usr/aarch64-linux-gnu", "./harness", "./kernels.so"]
        subprocess.run([*command, f"{entry.library}_{entry.name}", "in", "out"], cwd=tmp_path, check=True)
        out = (tmp_path / "out").read_bytes()[slots.nbytes :]
        for each in arrays_in(after):
            found = np.frombuffer(out[: each.nbytes], each.dtype).reshape(each.shape)
            out = out[each.nbytes :]
            size = np.max(np.abs(each[np.isfinite(each)]), initial=0.0)
            np.testing.assert_allclose(found, each, rtol=1e-9, atol=1e-9 * size)
        assert not out
        assert results is None or np.all(np.isfinite(results))
    assert set(seen) == set(ENTRIES)
