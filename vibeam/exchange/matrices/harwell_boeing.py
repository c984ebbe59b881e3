"""Matrices of Harwell–Boeing and Rutherford–Boeing files, by scipy: assembled and real, symmetric ones with one half.

scipy (1.17) reads unsymmetric ones alone, of exponents with E, and takes what is left of a last number that is cut off:
a symmetric matrix is given to it as an unsymmetric one, and the other half is added here (Duff, Grimes & Lewis, Users'
Guide for the Harwell–Boeing Sparse Matrix Collection, 1992). Numbers that touch, and right-hand sides, it refuses."""

from __future__ import annotations

import re
import warnings
from io import StringIO
from pathlib import Path

from vibeam.exchange.files import FormatError, read_by, require_coordinates, shown, text_of, whole
from vibeam.exchange.matrices.entries import FileMatrix, assembled, compressed
from vibeam.exchange.matrices.text import require_no_name

SYMMETRIC = {"RSA": True, "ISA": True, "RUA": False, "IUA": False}


def read_harwell_boeing(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file."""
    from scipy.io import hb_read

    require_no_name(name)
    title, *lines = [line.rstrip() for line in text_of(path).upper().splitlines()]
    if len(lines) < 4:
        raise FormatError("has no head of four lines with numbers below: is it cut off?")
    kind = lines[1][:3]
    with read_by("", line=3):
        if kind not in SYMMETRIC:
            raise FormatError(f"its matrix is {shown(kind)}: one of {', '.join(SYMMETRIC)} is read, real and assembled")
        rows, columns, count = (whole(lines[1][at : at + 14].strip()) for at in (14, 28, 42))
        require_coordinates(rows, columns)
    lines[1] = f"{kind[0]}UA{lines[1][3:]:67}"
    lines[2:] = (re.sub(r"\b1P,?", "", line).replace("D", "E") for line in lines[2:])
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of numbers that cannot be read
        found = hb_read(StringIO("\n".join([f"{title:80}", *lines, ""])))
    total, below = (whole(lines[0][at : at + 14].strip()) for at in (0, 42))
    widths = {len(line) / max(len(line.split()), 1) for line in lines[-below:]}
    if len(found.data) != count or len(lines) != total + 3 or len(widths) > 1:
        raise FormatError(f"has not {count} numbers of one width on {total} lines, as its head says: is it cut off?")
    entries = compressed(found.data, found.indices, found.indptr, (rows, columns)).tocoo()
    return assembled(entries.row, entries.col, entries.data, (rows, columns), SYMMETRIC[kind])
