"""A few files that are made to do harm: each is told in the message that it deserves, within 2 GiB and 10 s."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hostile_files import LIMITS, fault_of, judge, read_file
from hostile_kinds import HOSTILE
from limited import Ended

FEW = (
    "matrix0.npz", "matrix1.h5", "matrix2.npz", "matrix3.h5", "matrix_index.mat", "matrix_pointer.mat",
    "matrix_bsr.npz", "matrix_coo.npz", "matrix_bomb.npz", "matrix_shape.mat", "matrix_point.npy",
    "matrix_unwritten.h5", "matrix_external.h5", "matrix_virtual.h5", "matrix_deep.h5",
    "matrix_far.inp", "matrix_real.pch", "matrix_kernel.csv", "curve_kernel.csv", "curve_digits.csv",
    "curve_unwanted.h5", "curve_words.h5",
)  # fmt: skip


@pytest.mark.parametrize("name", FEW)
def test_a_hostile_file_is_told(name: str, tmp_path: Path) -> None:
    (kind,) = (each for each in HOSTILE if each.name == name)
    assert fault_of(read_file(kind, tmp_path, np.random.default_rng(1)), kind) == ""


@pytest.mark.slow
def test_two_hundred_files_are_told_or_read() -> None:
    found = {number: judge(1, number, lambda stage: None).findings for number in range(200)}
    assert {number: each for number, each in found.items() if each} == {}


@pytest.mark.parametrize(
    ("ended", "said", "fault"),
    [
        (Ended(2, "", "case.toml: is empty", 0.1, 10**8), "is empty", ""),
        (Ended(0, "", "", 0.1, 10**8), "is empty", "not 'is empty' but 'read'"),
        (Ended(2, "", "case.toml: is empty", 0.1, 10**8), None, "told: 'case.toml: is empty'"),
        (Ended(-11, "", "", 0.1, 10**8), "", "ended by SIGSEGV: "),
        (Ended(0, "", "", 0.1, LIMITS.memory + 2**30), "", "3.0 GiB"),
    ],
)
def test_the_judge_sees(ended: Ended, said: str | None, fault: str) -> None:
    assert fault_of(ended, HOSTILE[0].__class__("a", said, HOSTILE[0].write)) == fault
