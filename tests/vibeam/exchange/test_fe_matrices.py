"""Matrices as finite-element programs write them: Abaqus, CalculiX, Harwell–Boeing, Matrix Market, Nastran."""

import sys
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from nastran_files import OP2, OP4, Output2, op4_binary, op4_text
from scipy.io import hb_write
from scipy.sparse import csc_array

from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.declaration import digest_with, read_matrix
from vibeam.exchange.matrices.entries import FileMatrix

K = np.array([[9.5, -4.0, 0.0, 0.25], [-4.0, 4.0, -1.5, 0.0], [0.0, -1.5, 7.0, 0.0], [0.25, 0.0, 0.0, 2.0]])
M = np.diag([2.0, 3.0, 5.0, 7.0])
SKEWED = np.array([[9.0, 0.0], [-4.0, 4.0]])


def read(path: Path, content: str | bytes, name: str = "", wanted: str = "") -> FileMatrix:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_matrix(path, name, wanted)


def full(found: FileMatrix) -> list[list[float]]:
    return (found.matrix if isinstance(found.matrix, np.ndarray) else found.matrix.toarray()).tolist()


def refusal(path: Path, content: str | bytes, name: str = "", wanted: str = "") -> str:
    with pytest.raises(FormatError) as caught:
        read(path, content, name, wanted)
    return str(caught.value)


LOWER = "1,1,1,1, 9.0\n2,1,1,1,-4.0\n2,1,2,1, 4.0\n"
HALVES = {
    LOWER: ([[9, -4], [-4, 4]], "lower half, mirrored"),
    LOWER.replace("2,1,1,1", "1,1,2,1"): ([[9, -4], [-4, 4]], "upper half, mirrored"),
    LOWER + "1,1,2,1,-4.0\n": ([[9, -4], [-4, 4]], "both halves"),
    LOWER + "3,1,1,1,1.\n1,1,3,1,1.\n3,1,3,1,5.\n": (
        [[9, -4, 1], [-4, 4, 0], [1, 0, 5]], "both halves",
    ),
    "1,1,1,1,9.\n2,1,2,1,4.\n": ([[9, 0], [0, 4]], "diagonal"),
}  # fmt: skip


@pytest.mark.parametrize("entries", HALVES)
def test_a_symmetric_matrix_of_abaqus_is_taken_by_either_half_or_both(entries: str, tmp_path: Path) -> None:
    found = read(tmp_path / "K.inp", "*MATRIX INPUT, NAME=K\n" + entries)
    assert full(found) == HALVES[entries][0]
    size = len(HALVES[entries][0])
    assert found.taken("K.inp") == f"taken: K.inp, {size} × {size}, Abaqus, {HALVES[entries][1]}, TYPE=SYMMETRIC"


def test_parameters_of_abaqus(tmp_path: Path) -> None:
    head = "** from a superelement\n*Matrix Input, name=Kext, type=Symmetric,\n  Scale Factor = 1e3\n"
    found = read(tmp_path / "K.inp", head + LOWER)
    assert full(found) == [[9000, -4000], [-4000, 4000]]
    assert found.labels == ((1, 1), (2, 1))
    assert found.notes == ("Abaqus", "lower half, mirrored", "TYPE=SYMMETRIC", "× 1000 by SCALE FACTOR")
    assert (
        full(read(tmp_path / "unsymmetric.inp", "*MATRIX INPUT, NAME=K, TYPE=UNSYMMETRIC\n" + LOWER)) == SKEWED.tolist()
    )


DECK = (
    f"*MATRIX INPUT, NAME=ONE\n{LOWER}** next\n*MATRIX INPUT, NAME=TWO, SCALE FACTOR=-.5\n1,1,1,1, 4.0\n2,1,2,1, 6.\n"
)


def test_several_matrices_of_a_deck(tmp_path: Path) -> None:
    assert full(read(tmp_path / "a.inp", DECK, "two")) == [[-2, 0], [0, -3]]
    assert "holds ONE, TWO: say which by name" in refusal(tmp_path / "b.inp", DECK, "", "M")


HEAD = "*MATRIX INPUT, NAME=K"
REFUSED = {
    f"{HEAD}, SCALE FACTOR=0\n{LOWER}": "line 1: SCALE FACTOR is a number, not 0, and TYPE is SYMMETRIC or UNSYMMETRIC",
    f"{HEAD}, SCALE FACTOR=1,5\n{LOWER}": "line 1: '*MATRIX INPUT, NAME=K, SCALE FACTOR=1,5' is not read",
    f"{HEAD}, SCALE FACTOR=1.5N\n{LOWER}": "line 1: '1.5N' is no number",
    f"{HEAD}, TYPE=DIAGONAL\n{LOWER}": "line 1: SCALE FACTOR is a number",
    f"{HEAD}, INPUT=K.txt\n": "line 1: '*MATRIX INPUT, NAME=K, INPUT=K.txt' is not read: keep",
    f"{HEAD}, SCALE=1000.\n{LOWER}": "line 1: '*MATRIX INPUT, NAME=K, SCALE=1000.' is not read: keep",
    f"{HEAD}, MATRIX=STIFFNESS\n": "line 1: '*MATRIX INPUT, NAME=K, MATRIX=STIFFNESS' is not read",
    f"{HEAD}, NAME=L\n{LOWER}": "line 1: '*MATRIX INPUT, NAME=K, NAME=L' is not read: keep",
    f"{HEAD}\n{LOWER}{HEAD}\n{LOWER}": "line 5: '*MATRIX INPUT, NAME=K': two matrices have one NAME",
    f"{LOWER}{HEAD}\n{LOWER}": "line 1: '1 1 1 1  9.0' stands above the first keyword",
    f"*NODE\n1, 0., 0., 0.\n{HEAD}\n{LOWER}": "line 1: '*NODE' is not read: keep *MATRIX INPUT",
    f"{HEAD}\n{LOWER}*MATRIX ASSEMBLE, MASS=K\n": "line 5: '*MATRIX ASSEMBLE, MASS=K' is not read: keep",
    f"{HEAD}\n{LOWER}1,1,2,1,-5.\n": "has -5 at node 1 direction 1, node 2 direction 1 and -4 opposite",
    f"{HEAD}\n{LOWER}2,1,2,1,4.\n": "the entry of node 2 direction 1, node 2 direction 1 is there twice: add them up",
    f"{HEAD}\n": "holds no entries",
    f"{HEAD},\n SCALE FACTOR=2\n** rows\n{LOWER}1,1,x,1,2.\n": "line 7: 'x' is no number",
    f"{HEAD}\r{LOWER}*MATRIX INPUT, NAME=L\r{LOWER}".replace("\n", "\r"): "line 5: '*MATRIX INPUT  NAME=L' has",
    "*MATRIX INPUT\n" * 101: "line 101: has more than 100 keywords",
}  # fmt: skip


@pytest.mark.parametrize("deck", REFUSED)
def test_a_deck_that_says_more_than_is_read_is_refused(deck: str, tmp_path: Path) -> None:
    assert REFUSED[deck] in refusal(tmp_path / "K.inp", deck)


def test_calculix_with_the_names_of_its_nodes(tmp_path: Path) -> None:
    (tmp_path / "rig.dof").write_text("12.3\n2.1\n2.2\n")
    rows = " 1  1  9.0000000000000e+03\n 2  2  4.e+03\n 3  3  1.\n 1  2 -4.e+03\n"
    found = read(tmp_path / "rig.sti", rows)
    assert full(found) == [[9000, -4000, 0], [-4000, 4000, 0], [0, 0, 1]]
    assert found.labels == ((12, 3), (2, 1), (2, 2))
    assert found.notes == ("CalculiX", "upper half, mirrored", "nodes of rig.dof")
    before = digest_with(tmp_path / "rig.sti")
    (tmp_path / "rig.dof").write_text("12.3\n2.1\n2.3\n")
    assert digest_with(tmp_path / "rig.sti") != before  # what stands beside is looked at again
    assert read_matrix(tmp_path / "rig.sti").labels == ((12, 3), (2, 1), (2, 3))
    alone = read(tmp_path / "alone.mas", "1 1 2.\n2 2 3.\n")
    assert alone.labels is None
    assert alone.notes[-1] == "nodes without names, which alone.dof beside it would have"


@pytest.mark.parametrize(
    ("dof", "message"),
    [("1.1\n", "has the row 1, and they are 0 to 0"),
     ("1.1\n1.1\n", "line 2: '1.1' is no node and direction, 12.3, or there twice"),
     ("1.1\n2.7\n", "line 2: rig.dof: '2.7' is no node"), ("1.1\nx.1\n", "rig.dof: 'x' is no whole number"),
     ("1.1\n2\n", "'2' is no node and direction, 12.3")],
)  # fmt: skip
def test_names_of_nodes_that_do_not_fit(dof: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "rig.dof").write_text(dof)
    assert message.rpartition(": ")[2] in refusal(tmp_path / "rig.sti", "1 1 2.\n2 2 3.\n")


def harwell_boeing(matrix: np.ndarray, kind: str, form: str = "(2E22.14)", write: str = "{:22.14E}") -> str:
    """Harwell–Boeing text, of a symmetric matrix the lower half."""
    found = csc_array(np.tril(matrix) if kind[1] == "S" else matrix)
    parts = [
        (found.indptr + 1, 8, "{:8}"),
        (found.indices + 1, 8, "{:8}"),
        (found.data, int(form[form.upper().index("E") - 1]), write),
    ]
    blocks = [
        ["".join(map(each.format, numbers[at : at + repeat])) for at in range(0, len(numbers), repeat)]
        for numbers, repeat, each in parts
    ]
    counts = [sum(map(len, blocks)), *map(len, blocks), 0]
    sizes = [*found.shape, len(found.data), 0]
    head = [
        f"{'a frame':72}{'KEY':8}", "".join(f"{each:14}" for each in counts),
        f"{kind:14}" + "".join(f"{each:14}" for each in sizes), f"{'(8I8)':16}{'(8I8)':16}{form:20}",
    ]  # fmt: skip
    return "\n".join([*head, *chain.from_iterable(blocks)]) + "\n"


FORMS = {"(2E22.14)": "{:22.14E}", "(3e20.12)": "{:20.12E}", "(1P,4E15.6)": "{:15.6E}", "(4E14.6E2)": "{:14.6E}"}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", ["RSA", "RUA", "rsa"])
def test_harwell_boeing(kind: str, form: str, tmp_path: Path) -> None:
    text = harwell_boeing(K, kind.upper(), form, FORMS[form]).replace("RSA", kind)
    found = read(tmp_path / "K.hb", text)
    assert full(found) == K.tolist()
    assert found.notes == ("Harwell–Boeing", "every entry as it stands" if kind == "RUA" else "lower half, mirrored")
    assert full(read(tmp_path / "K.rsa", text.replace("E+0", "D+0"))) == K.tolist()


def test_harwell_boeing_as_scipy_writes_it(tmp_path: Path) -> None:
    hb_write(tmp_path / "scipy.hb", csc_array(K))
    assert full(read_matrix(tmp_path / "scipy.hb")) == K.tolist()


def test_harwell_boeing_that_is_not_read(tmp_path: Path) -> None:
    text = harwell_boeing(K, "RSA")
    for kind in ("CSA", "PSA", "RZA", "RSE", "RRA"):
        assert f"line 3: its matrix is '{kind}'" in refusal(tmp_path / "kind.hb", text.replace("RSA", kind))
    assert "cannot be read as a file of Harwell–Boeing" in refusal(tmp_path / "F.hb", text.replace("2E22", "2F22"))
    assert "cannot be read as" in refusal(tmp_path / "touch.hb", harwell_boeing(K, "RSA", "(4E8.2)", "{:8.2E}"))
    assert "is it cut off?" in refusal(tmp_path / "cut.hb", text[:-2])
    assert "should have the same size" in refusal(tmp_path / "short.hb", text.rpartition("\n ")[0])
    assert "leave name = 'K' away" in refusal(tmp_path / "name.hb", text, "K")


MARKET = "%%MatrixMarket matrix coordinate {}\n2 2 {}\n1 1 9.0\n2 1 -4.0\n2 2 4.0\n{}"


def test_matrix_market_by_its_kinds_of_symmetry(tmp_path: Path) -> None:
    both = MARKET.format("real symmetric", 4, "1 2 -4.0\n")
    found = read(tmp_path / "both.mtx", both)
    assert (full(found), found.notes[1]) == ([[9, -4], [-4, 4]], "both halves")
    julia = read(tmp_path / "julia.mtx", MARKET.format("real hermitian", 3, ""))
    assert (full(julia), julia.notes[1]) == ([[9, -4], [-4, 4]], "lower half, mirrored")
    assert (
        full(read(tmp_path / "general.mtx", MARKET.format("integer general", 3, "").replace(".0", "")))
        == SKEWED.tolist()
    )
    said = refusal(tmp_path / "differ.mtx", both.replace("1 2 -4", "1 2 -3"))
    assert said == "is symmetric by its head, but has -3 at row 1, column 2 and -4 opposite"
    assert "row 2, column 2 is there twice" in refusal(tmp_path / "twice.mtx", both.replace("1 2 -4.0", "2 2 4.0"))


@pytest.mark.parametrize("kind", ["real skew-symmetric", "pattern symmetric", "complex hermitian"])
def test_matrix_market_of_another_kind_is_named(kind: str, tmp_path: Path) -> None:
    word = kind.split()[0 if "real" not in kind else 1]
    assert f"line 1: its matrix is '{word}'" in refusal(tmp_path / "K.mtx", MARKET.format(kind, 3, ""))
    lean = "%%MatrixMarket matrix array real symmetric\n2 3\n1.\n2.\n3.\n"
    assert refusal(tmp_path / "lean.mtx", lean) == "line 1: is 2 × 3, and symmetric by its head"


def test_a_square_matrix_of_dmig_stays_as_it_stands(tmp_path: Path) -> None:
    cards = "DMIG,KGG,0,{},1,0\nDMIG,KGG,1,1,,1,1,9.,,+\n+,2,1,-4.\nDMIG,KGG,2,1,,2,1,4.\n"
    assert full(read(tmp_path / "square.pch", cards.format(1))) == SKEWED.tolist()
    assert full(read(tmp_path / "half.pch", cards.format(6))) == [[9, -4], [-4, 4]]


@OP4
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_output4(kind: str, sparse: bool, big: bool, tmp_path: Path) -> None:
    matrices = {"KAA": (6, K), "MAA": (6, M), "ROW": (2, K[:, :1])}
    files = {order: op4_binary(matrices, sparse=sparse, big=big, kind=kind, order=order) for order in "<>"}
    files["text"] = op4_text(matrices, sparse=sparse, big=big, kind=kind).encode()
    for number, content in enumerate(files.values()):
        path = tmp_path / f"{number}.op4"
        assert full(read(path, content, "", "K")) == K.tolist()
        assert full(read_matrix(path, "", "M")) == M.tolist()
        assert full(read_matrix(path, "row")) == K[:, :1].tolist()
        assert read_matrix(path, "KAA").notes == ("Nastran OUTPUT4", "both halves")
        assert "holds KAA, MAA, ROW: say which by name" in refusal(path, content)


@OP4
def test_output4_of_halves_and_other_forms(tmp_path: Path) -> None:
    half = read(tmp_path / "half.op4", op4_binary({"K": (6, np.tril(K))}))
    assert (full(half), half.notes[1]) == (K.tolist(), "lower half, mirrored")
    square = read(tmp_path / "square.op4", op4_text({"K": (1, SKEWED)}))
    assert (full(square), square.notes[1]) == (SKEWED.tolist(), "every entry as it stands")
    assert "is symmetric by its head, but has -4 at row 1, column 2 and -5" in refusal(
        tmp_path / "differ.op4", op4_binary({"K": (6, np.array([[9.0, -4.0], [-5.0, 4.0]]))})
    )
    assert "'K' has form 8 and is float64: square (1)" in refusal(tmp_path / "form.op4", op4_binary({"K": (8, M)}))
    content = op4_binary({"K": (6, K)})
    assert "is it cut off" in refusal(tmp_path / "cut.op4", content[:-9])
    assert "is it cut off" in refusal(tmp_path / "end.op4", op4_text({"K": (6, K)}).rpartition("       5")[0])
    assert "has an entry that is no finite number" in refusal(tmp_path / "inf.op4", op4_binary({"K": (6, K + np.inf)}))


@OP2
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_output2(kind: str, order: str, tmp_path: Path) -> None:
    file = Output2(order)
    file.table("GEOM1", [file.words(*range(300))])
    file.matrix("KAA", 6, np.tril(K), kind)
    file.matrix("MAA", 6, M, kind)
    found = read(tmp_path / "rig.op2", file.content, "", "K")
    assert full(found) == K.tolist()
    assert found.notes == ("Nastran OUTPUT2", "lower half, mirrored")
    assert full(read_matrix(tmp_path / "rig.op2", "maa")) == M.tolist()
    assert "is it cut off" in refusal(tmp_path / "cut.op2", file.content[:-30])


@OP4
def test_output4_with_two_matrices_of_one_name(tmp_path: Path) -> None:
    two = {"binary": op4_binary({"K": (6, K)}) * 2, "text": op4_text({"K": (6, K)}).encode() * 2}
    for name, content in two.items():
        assert "has several matrices 'K': write" in refusal(tmp_path / f"{name}.op4", content, "", "K")


@OP2
def test_output2_with_two_matrices_of_one_name(tmp_path: Path) -> None:
    file = Output2()
    file.matrix("KAA", 6, K)
    file.matrix("KAA", 6, 2 * K)
    assert "has several matrices 'KAA': write" in refusal(tmp_path / "two.op2", file.content, "KAA")


@pytest.mark.parametrize(("name", "module"), [("rig.op4", "op4.op4"), ("rig.op2", "op2.op2")])
def test_without_pynastran(name: str, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, f"pyNastran.{module}", None)
    said = refusal(tmp_path / name, op4_binary({"K": (6, K)}))
    assert "pip install 'vibeam[fe]', or export DMIG" in said
