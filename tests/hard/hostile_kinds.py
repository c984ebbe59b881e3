"""Kinds of files that are sound, and of ones that are made to do harm, each with what must be said of it."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from scipy.io import mmwrite, savemat
from scipy.sparse import bsr_array, coo_array, csc_array, csr_array, dia_array, save_npz

Generator = np.random.Generator
Write = Callable[[Path, Generator], object]

K = np.array([[9e3, -4e3, 0.0, 0.0], [-4e3, 9e3, -4e3, 0.0], [0.0, -4e3, 8e3, -4e3], [0.0, 0.0, -4e3, 4e3]])

LOWER = [(i + 1, j + 1, K[i, j]) for i, j in np.argwhere(np.tril(K))]

MATRIX, CURVE = "matrix", "curve"  # what a file's name begins with

F, X = [14.0, 14.5, 15.0], [1.25e-4, 2.5e-4, 1e-3]

PARTS = ("data", "indices", "indptr")

TABLE = "f [Hz];x [m]\n14;1.25e-4\n14.5;2.5e-4\n15;1e-3\n"

COORDINATE = "%%MatrixMarket matrix coordinate real general\n"


@dataclass(frozen=True)
class Hostile:
    """File of that ``name``; ``said``: what stands in the message, None where it is sound and only looks odd."""

    name: str
    said: str | None
    write: Write


def group(path: Path, parts: Mapping[str, Any], **attributes: Any) -> None:
    with h5py.File(path, "w") as file:
        made = file.create_group("K")
        made.attrs.update(attributes)
        for name, part in parts.items():
            made[name] = part


def sparse(change: Callable[[dict[str, Any], Generator], object]) -> tuple[Write, Write]:
    """The parts of a compressed matrix, changed: as scipy's .npz, and as a group of HDF5."""

    def parts(rng: Generator) -> dict[str, Any]:
        matrix = csc_array(K)
        made = {name: getattr(matrix, name).copy() for name in PARTS}
        change(made, rng)
        return made

    def npz(path: Path, rng: Generator) -> None:
        np.savez(path, format=np.array(b"csc"), shape=np.array(K.shape), **parts(rng))

    return npz, lambda path, rng: group(path, parts(rng), format="csc")


def text(content: str) -> Write:
    return lambda path, rng: path.write_text(content, encoding="utf-8")


def put(name: str, index: int, values: Callable[[Generator], int]) -> Callable[[dict[str, Any], Generator], object]:
    """One number of one part is another."""
    return lambda parts, rng: parts[name].__setitem__(index, values(rng))


def head_of_npy(shape: tuple[int, ...], kind: str = "<f8") -> bytes:
    """The head of an array that is not there."""
    made = BytesIO()
    np.lib.format.write_array_header_1_0(made, {"descr": kind, "fortran_order": False, "shape": shape})
    return made.getvalue()


def packed(path: Path, content: bytes, name: str = "K.npy") -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(name, content)


def many_members(path: Path, rng: Generator) -> None:
    with zipfile.ZipFile(path, "w") as file:
        for number in range(15_000):
            file.writestr(f"{number:040}.npy", b"")


def dataset(path: Path, **how: Any) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("K", **how)


def elsewhere(how: str) -> Write:
    """Values in another file: by external storage, as a virtual dataset, or by a link."""

    def write(path: Path, rng: Generator) -> None:
        K.tofile(path.with_name("K.bin"))
        with h5py.File(path.with_name("other.h5"), "w") as other:
            other["K"] = K
        with h5py.File(path, "w") as file:
            if how == "external":
                file.create_dataset("K", K.shape, "f8", external=[("K.bin", 0, K.nbytes)])
            elif how == "virtual":
                layout = h5py.VirtualLayout(K.shape, "f8")
                layout[:] = h5py.VirtualSource("other.h5", "K", K.shape)
                file.create_virtual_dataset("K", layout)
            else:
                file["K"] = h5py.ExternalLink("other.h5", "K") if how == "link" else h5py.SoftLink("/nothing")

    return write


def deep(path: Path, rng: Generator) -> None:
    with h5py.File(path, "w") as file:
        inner: Any = file
        for _ in range(int(rng.integers(100, 400))):
            inner = inner.create_group("g")
        inner["K"] = K


def circle(path: Path, rng: Generator) -> None:
    with h5py.File(path, "w") as file:
        file["K"] = K
        inner = file.create_group("a/b")
        inner["a"] = file["a"]


def mat_with(old: Any, new: Any, matrix: Any = K) -> Write:
    """A variable of MATLAB's with some of its bytes changed."""

    def write(path: Path, rng: Generator) -> None:
        savemat(path, {"K": matrix})
        content = path.read_bytes()
        was, now = (np.array(each, dtype="<i4").tobytes() for each in (old, new))
        assert content.count(was) == 1
        path.write_bytes(content.replace(was, now))

    return write


def unwanted(path: Path, rng: Generator) -> None:
    """A curve beside an array that was never written."""
    with h5py.File(path, "w") as file:
        file.create_dataset("huge", shape=(40_000, 40_000), dtype="f8")
        file["f"], file["x"] = F, X


def words(path: Path, rng: Generator) -> None:
    """One long text in a heap."""
    with h5py.File(path, "w") as file:
        file["f"], file["x"] = F, X
        file.create_dataset("direction", data=["up" * 1000] * 3, dtype=h5py.string_dtype())


def link(target: str) -> Write:
    return lambda path, rng: path.symlink_to(target)


SOUND: dict[str, Callable[[Path], object]] = {
    "matrix.npy": lambda path: np.save(path, K),
    "matrix.npz": lambda path: np.savez(path, K=K),
    "matrix_packed.npz": lambda path: np.savez_compressed(path, K=K),
    "matrix_sparse.npz": lambda path: save_npz(path, csc_array(K)),
    "matrix.mtx": lambda path: mmwrite(path, csc_array(K), precision=17),
    "matrix_full.mtx": lambda path: mmwrite(path, K, precision=17),
    "matrix.csv": lambda path: np.savetxt(path, K, delimiter=", ", fmt="%.17g"),
    "matrix.inp": lambda path: path.write_text("".join(f"{i},1,{j},1,{value:.17g}\n" for i, j, value in LOWER)),
    "matrix.pch": lambda path: path.write_text(
        "DMIG,K,0,6,1,0\n" + "".join(f"DMIG,K,{j},1,,{i},1,{value:.5E}\n" for i, j, value in LOWER)
    ),
    "matrix.h5": lambda path: dataset(path, data=K),
    "matrix_packed.h5": lambda path: dataset(
        path, data=K, chunks=(2, 2), compression="gzip", shuffle=True, fletcher32=True
    ),
    "matrix_sparse.h5": lambda path: group(path, {name: getattr(csc_array(K), name) for name in PARTS}, format="csc"),
    "matrix.mat": lambda path: savemat(path, {"K": K}),
    "matrix_packed.mat": lambda path: savemat(path, {"K": K}, do_compression=True),
    "matrix_sparse.mat": lambda path: savemat(path, {"K": csc_array(K)}),
    "matrix_4.mat": lambda path: savemat(path, {"K": K}, format="4"),
    "curve.csv": lambda path: path.write_text(TABLE),
    "curve_own.csv": lambda path: path.write_text("frequency_hz,direction,amplitude\n14,up,1e-3\n15,down,2e-3\n"),
    "curve.mat": lambda path: savemat(path, {"data": {"f": np.array(F), "x": np.array(X)}}),
    "curve.h5": lambda path: group(path, {"f": F, "x": X}),
}

below, above, far = (lambda rng: -int(rng.integers(1, 2**30))), (lambda rng: int(rng.integers(4, 2**30))), 10**9

SPARSE = {
    "has the index -": sparse(put("indices", 2, below)),
    "and they are 0 to 3": sparse(put("indices", -1, above)),
    "has pointers that do not rise": sparse(put("indptr", 2, above)),
    "has pointers that do not rise from 0": sparse(put("indptr", 1, below)),
    "has pointers that are not 5 whole numbers": sparse(lambda parts, rng: parts.update(indptr=parts["indptr"] / 1)),
    "in place of whole numbers": sparse(lambda parts, rng: parts.update(indices=parts["indices"] + 0.5)),
    "of different shapes": sparse(lambda parts, rng: parts.update(data=parts["data"][:-1])),
    "in place of real numbers": sparse(lambda parts, rng: parts.update(data=parts["data"] * 1j)),
}

HOSTILE = (
    *(
        Hostile(f"matrix{n}.{kind}", said, write)
        for n, (said, writes) in enumerate(SPARSE.items())
        for kind, write in zip(("npz", "h5"), writes, strict=True)
    ),
    Hostile(
        "matrix_coo.npz",
        "has 1000000000 coordinates; a matrix may have 1 000 000 at most",
        lambda path, rng: np.savez(
            path,
            format=np.array(b"coo"),
            shape=np.array([far, far]),
            data=np.ones(1),
            row=np.zeros(1, int),
            col=np.zeros(1, int),
        ),
    ),
    Hostile(
        "matrix_head.npy",
        "an array may have 25 000 000 numbers at most",
        lambda path, rng: path.write_bytes(head_of_npy((int(rng.integers(10**8, 2**62)), 4))),
    ),
    Hostile(
        "matrix_less.npy",
        "says that it is -4 × 4",
        lambda path, rng: path.write_bytes(head_of_npy((-4, 4)) + K.tobytes()),
    ),
    Hostile(
        "matrix_wide.npy",
        "in place of real numbers",
        lambda path, rng: path.write_bytes(head_of_npy((4, 4), "|S500000000")),
    ),
    Hostile(
        "matrix_long.npy",
        "has a head of more than 10000 bytes",
        lambda path, rng: path.write_bytes(b"\x93NUMPY\x02\x00\xff\xff\xff\x7f" + bytes(100)),
    ),
    Hostile(
        "matrix_point.npy",
        "holds a single number: a matrix or a row is needed",
        lambda path, rng: np.save(path, np.float64(3)),
    ),
    Hostile("matrix_cube.npy", "holds an array of 3 dimensions", lambda path, rng: np.save(path, np.ones((4, 4, 4)))),
    Hostile(
        "matrix_object.npy",
        "holds object in place of real numbers",
        lambda path, rng: np.save(path, np.array([{}], dtype=object), allow_pickle=True),
    ),
    Hostile(
        "matrix_bomb.npz",
        "is 40000 × 40000; an array may have 25 000 000",
        lambda path, rng: packed(path, head_of_npy((40_000, 40_000)) + bytes(10**7)),
    ),
    Hostile(
        "matrix_head.npz",
        "has a head of more than 10000 bytes",
        lambda path, rng: packed(path, b"\x93NUMPY\x02\x00\x00\x00\x00\x08" + bytes(10**8)),
    ),
    Hostile("matrix_many.npz", "has a directory of more than 1 MB", many_members),
    Hostile(
        "matrix_bomb.mat",
        "is 20000 × 5000; an array may have",
        lambda path, rng: savemat(path, {"K": np.zeros((20_000, 5_000), dtype="i1")}, do_compression=True),
    ),
    Hostile("matrix_shape.mat", "is 2000000000 × 4; an array may have", mat_with([5, 8, 4, 4], [5, 8, 2 * far, 4])),
    Hostile("matrix_less.mat", "says that it is -4 × 4", mat_with([5, 8, 4, 4], [5, 8, -4, 4])),
    Hostile(
        "matrix_index.mat",
        "has the index 1073741824",
        mat_with([5, 16, 0, 1, 2, 3], [5, 16, 0, 1, 2**30, 3], csc_array(np.eye(4))),
    ),
    Hostile(
        "matrix_pointer.mat",
        "has pointers that do not rise",
        mat_with([0, 1, 2, 3, 4], [0, 2**30, 2, 3, 4], csc_array(np.eye(4))),
    ),
    Hostile(
        "matrix_wide.mat",
        "coordinates; a matrix may have 1 000 000 at most",
        mat_with([5, 8, 5, 4], [5, 8, 5, 2 * far], csc_array(np.eye(5, 4))),
    ),
    Hostile("matrix_external.h5", "has its values in other files: copy them into this one", elsewhere("external")),
    Hostile("matrix_virtual.h5", "has its values in other files: copy them into this one", elsewhere("virtual")),
    Hostile("matrix_link.h5", "'K' is a link to another place: copy the values", elsewhere("link")),
    Hostile("matrix_soft.h5", "'K' is a link to another place: copy the values", elsewhere("soft")),
    Hostile(
        "matrix_unwritten.h5",
        "has no values: they were never written",
        lambda path, rng: dataset(path, shape=(30_000, 30_000), dtype="f8"),
    ),
    Hostile(
        "matrix_large.h5",
        "is 50000 × 50000; an array may have",
        lambda path, rng: write_one(path, (50_000, 50_000), (10, 10)),
    ),
    Hostile("matrix_deep.h5", "has groups that lie deeper than 32 in each other", deep),
    Hostile("matrix_circle.h5", None, circle),
    Hostile(
        "matrix_far.inp", "coordinates; a matrix may have 1 000 000 at most", text("1,1,2.0\n300000000,300000000,1.0\n")
    ),
    Hostile(
        "matrix_vast.inp",
        "line 2: nodes, degrees of freedom, rows and columns are whole",
        text("1,1,1,1,2.0\n1e300,1,1,1,1.0\n"),
    ),
    Hostile("matrix_far.mtx", "has 900000000 coordinates", text(COORDINATE + "900000000 900000000 1\n1 1 1.0\n")),
    Hostile("matrix_long.mtx", "is it cut off?", text(COORDINATE + "4 4 999999999999\n1 1 1.0\n")),
    Hostile(
        "matrix_half.mtx",
        "an array may have",
        text("%%MatrixMarket matrix array real symmetric\n999999999999 999999999999\n1\n"),
    ),
    *(
        Hostile("matrix_digits.csv", f"line 2: {said!r} is", text(f"1, 0\n0, {said}\n"))
        for said in ("1_000", "١", "nan", "-inf", "0x10", "1e400", "1.+4", "１")
    ),
    Hostile(
        "matrix_real.pch",
        "line 2: '1.+400' is beyond the largest number",
        text("DMIG,K,0,6,1,0\nDMIG,K,1,1,,1,1,1.+400\n"),
    ),
    Hostile("matrix_whole.pch", "line 2: '1_0' is no whole number", text("DMIG,K,0,6,1,0\nDMIG,K,1_0,1,,1,1,1.0\n")),
    Hostile("matrix_nul.csv", "it is not UTF-8 text", lambda path, rng: path.write_bytes(bytes(10**7))),
    Hostile(
        "matrix_nuls.csv",
        "has 1900 MB; such a file may have 100 MB at most",
        lambda path, rng: hole(path, 1_900_000_000),
    ),
    Hostile("matrix_nuls.npy", "has 6000 MB", lambda path, rng: hole(path, 6 * 10**9)),
    Hostile(
        "matrix_line.csv", "a line may have 30000000 at most", lambda path, rng: path.write_bytes(b"1 " * (2 * 10**7))
    ),
    Hostile("matrix_lines.csv", "has more than 5000000 lines", lambda path, rng: path.write_bytes(b"\n" * (6 * 10**6))),
    Hostile(
        "matrix_row.csv", "coordinates; a matrix may have", lambda path, rng: path.write_bytes(b"1 " * (2 * 10**6))
    ),
    Hostile("matrix_pipe.npz", "is not a regular file", lambda path, rng: os.mkfifo(path)),
    Hostile("matrix_zero.npy", "is not a regular file", link("/dev/zero")),
    Hostile("matrix_folder.npy", "is a folder, not a file", lambda path, rng: path.mkdir()),
    Hostile(
        "matrix_loop.npy", "cannot be read: too many levels of symbolic links", lambda path, rng: path.symlink_to(path)
    ),
    Hostile("matrix_kernel.csv", "is empty", link("/proc/kmsg")),
    Hostile("matrix_big_endian.npy", None, lambda path, rng: np.save(path, np.asfortranarray(K).astype(">f8"))),
    Hostile("matrix_csr.npz", None, lambda path, rng: save_npz(path, csr_array(K))),
    Hostile("matrix_coo_sound.npz", None, lambda path, rng: save_npz(path, coo_array(K))),
    Hostile("matrix_dia.npz", "of the format 'dia'", lambda path, rng: save_npz(path, dia_array(K))),
    Hostile("matrix_bsr.npz", "save it as csc", lambda path, rng: save_npz(path, bsr_array(K, blocksize=(2, 2)))),
    Hostile(
        "matrix_latin.csv",
        None,
        lambda path, rng: path.write_bytes(
            "# Größe\r".encode("cp1252") + b"\r".join(b" ".join(b"%r" % v for v in row) for row in K.tolist())
        ),
    ),
    Hostile("curve_kernel.csv", "is empty", link("/proc/kmsg")),
    Hostile("curve_pipe.csv", "is not a regular file", lambda path, rng: os.mkfifo(path)),
    Hostile("curve_digits.csv", "is not a number: it has 40001 characters", text(f"f;x\n14;{'1' * 40_000}x\n")),
    Hostile("curve_first.csv", "has no line with numbers", text(f"{'1' * 40_000}x;2\n")),
    Hostile("curve_heads.csv", "has no column 'f'", text("a [b](c) " * 400 + ";x\n")),
    Hostile("curve_wide.csv", "a line may have 100000 at most", text(";" * 200_000 + "\n")),
    Hostile("curve_lines.csv", "has more than 500000 lines", text("f;x\n" + "14;1\n" * 1_100_000)),
    Hostile("curve_commas.csv", "has no column 'f'", text((";" * 9_000 + "\n") * 500)),
    Hostile("curve_under.csv", "is not a number", text("f;x\n14;1_000\n")),
    Hostile("curve_arabic.csv", "is not a number", text("f;x\n14;١٢\n")),
    Hostile("curve_nuls.csv", "has 1900 MB", lambda path, rng: hole(path, 1_900_000_000)),
    Hostile("curve_deep.h5", "has groups that lie deeper than 32", deep),
    Hostile("curve_unwanted.h5", None, unwanted),
    Hostile("curve_words.h5", "holds a word of 2000 characters", words),
    Hostile("curve_utf16.csv", None, lambda path, rng: path.write_bytes(TABLE.encode("utf-16"))),
)


def hole(path: Path, size: int) -> None:
    with path.open("wb") as file:
        file.truncate(size)


def write_one(path: Path, shape: tuple[int, int], chunks: tuple[int, int]) -> None:
    """A dataset in pieces, of which one is written."""
    with h5py.File(path, "w") as file:
        made = file.create_dataset(
            "K", shape=shape, maxshape=(None, None), dtype="f8", chunks=chunks, compression="gzip"
        )
        made[0, 0] = 1.0
